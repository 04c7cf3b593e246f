"""The sections on the EMT: which cells undergo it and when, and how the variants of the model carry it out."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Annotated, Any

from pydantic import ConfigDict, ValidationInfo, model_validator

from tissue.events.known import built_in, events
from tissue.files.fields import (
    EVENT_TIME,
    MOST_CELLS,
    Begin,
    DurationOrZero,
    Events,
    Length,
    NonNegative,
    Probability,
    Speed,
    count,
    one_of,
)
from tissue.files.keys import KeyFacts, key
from tissue.files.sections import ParameterSection
from tissue.files.timing import NEVER, Timing
from tissue.plugins import EmtEvent

TYPESCRIPT = "the public TypeScript program"


def event_keys(section: str, of: Iterable[EmtEvent]) -> tuple[KeyFacts, ...]:
    """Describe the times of events as keys of a section."""
    time = EVENT_TIME.unit, EVENT_TIME.allowed
    return tuple(KeyFacts(f"{section}.{one.name}", one.meaning, "", one.source, *time, NEVER) for one in of)


class EmtSection(ParameterSection):
    """[emt]: the group of cells in the middle of the tissue that undergoes EMT (section 2.3 of chapter 4).

    Besides those below each event of ``tissue.events.known.events`` is a key; where it is not given, it never begins.

    An event fires in the step dt that ends at its time, or in which its time lies: it acts from the beginning of this
    step, so up to dt before its time.
    """

    model_config = ConfigDict(frozen=True, extra="allow", validate_default=True)
    __pydantic_extra__: dict[str, Begin]

    cells: Annotated[int, count(MOST_CELLS, least=0)] = key(
        "cells of the group emt, in the middle of the tissue", "N^EMT", "section 2.2 of chapter 4"
    )
    inm: Probability = key(
        "probability that an EMT cell performs interkinetic nuclear movement", "", "section 2.1 of chapter 4"
    )
    a: Begin = key("when apical adhesion is lost, [A]", "T^A", "section 2.2.1 of chapter 4", NEVER)
    b: Begin = key("when basal adhesion is lost, [B]", "T^B", "section 2.2.2 of chapter 4", NEVER)
    s: Begin = key("when straightness is lost, [S]", "T^S", "section 2.2.3 of chapter 4", NEVER)
    p: Begin = key("when protrusions begin, [P]; they wait for [B]", "T^P", "section 2.2.4 of chapter 4", NEVER)

    @model_validator(mode="before")
    @classmethod
    def _with_events(cls, given: Any) -> Any:
        """Add the built-in events that are not given: they never begin."""
        return {**{event.name: NEVER for event in built_in()}, **given} if isinstance(given, Mapping) else given

    @classmethod
    def further_keys(cls) -> tuple[KeyFacts, ...]:
        """Return the keys of all events but those of the thesis."""
        return event_keys("emt", (event for event in events() if event.name not in cls.model_fields))

    @model_validator(mode="after")
    def _note_events(self, info: ValidationInfo) -> EmtSection:
        """Note the times of the other events, too."""
        if info.context is not None:
            for event in events():
                info.context[EmtSection, event.name] = getattr(self, event.name, Timing())
        return self

    def times(self) -> dict[str, Timing]:
        """Return when the events begin, by name."""
        return {name: value for name, value in self if isinstance(value, Timing)}


class EventsSection(ParameterSection):
    """[events]: how the variants of the model carry out the events (section 2.2 of chapter 4)."""

    freed_stiffness: NonNegative = key(
        "factor of the stiffness of the spring to a freed point, after [A] and [B]",
        "",
        'row "[A], [B]: stiffness of the freed spring"',
    )
    bridge: Annotated[str, one_of("sum", "distance")] = key(
        "rest length of the junction that bridges a cell after [A]: that of the two removed, or the distance",
        "",
        "section 2.2.1 of chapter 4",
    )
    bent_stiffness: NonNegative = key(
        "stiffness of the bending spring after [S]", "alpha^axb", "section 2.2.3 of chapter 4"
    )
    run_speed: Speed = key("speed of the basal point in [P]", "v^run", "(4.1)")
    run_depth: Length = key("depth below the basal layer at which its run ends", "", "(4.1)")
    spring_above: Annotated[str, one_of("no force", "gives way")] = key(
        "basal-nuclei spring in [P] while the basal point is above the layer", "", "section 2.2.4 of chapter 4"
    )
    contraction: DurationOrZero = key(
        "time constant of its rest length once the point is below the layer; 0: at once",
        "",
        "section 2.2.4 of chapter 4",
    )
    together: Events = key(
        "events that begin in all cells of a type at the first of their times, whatever their probability",
        "",
        TYPESCRIPT,
        [],
    )
    at_depth: Annotated[str, one_of("stays", "forces")] = key("what the basal point does at run_depth", "", "(4.1)")
