"""The named types of cells of a parameter file, [types.NAME]: how many, where, and what is theirs alone.

What a type may have of its own is a key of [cell], p^div, or d^max-basal: with check, unit and meaning of that key, and
with its value where the type says nothing.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Annotated, Any

from pydantic import ConfigDict, Field, ValidationInfo, create_model, model_serializer, model_validator

from tissue.events.known import events
from tissue.files.emt_sections import TYPESCRIPT, event_keys
from tissue.files.fields import MOST_CELLS, UNIT_INTERVAL, Begin, Check, Flag, Probability, count
from tissue.files.keys import KeyFacts, facts_of, key
from tissue.files.parameter_files import TYPE
from tissue.files.scenario import CellGroup, Scenario
from tissue.files.sections import CellSection, ParameterSection, TissueSection
from tissue.files.timing import Timing
from tissue.files.units import Measure

# The types that have no name in files, by their numbers.
UNNAMED = ("control", "emt")
MOST_TYPES = 8
# Parts of a cell by which a place is off that is computed.
ROUNDING = 1e-9
# Where a group is if not at a place: at random, or evenly over the tissue.
SCATTERED, APART = "scattered", "apart"
# The keys that a type may have of its own, and their sections.
OWN_KEYS = {
    **dict.fromkeys(CellSection.model_fields, "cell"),
    "two_daughters": "tissue",
    "max_basal_distance": "tissue",
}
# Of these the ones of which a pair of cells has the mean, or the sum.
PAIR_KEYS = ("soft_radius", "alpha_xx", "max_basal_distance")


PLACE = Check(
    f'a number from 0 to 1, without unit, "{APART}" or "{SCATTERED}"',
    f'0 to 1, "{APART}" or "{SCATTERED}"',
    lambda raw: raw if isinstance(raw, str) and raw in (APART, SCATTERED) else UNIT_INTERVAL.read(raw),
)


def first_of(cells: int, group: int, place: float) -> int:
    """Find the first cell of a group whose middle is nearest to this part of the tissue, with all cells inside.

    So groups at the places p and 1 - p mirror each other. Of two cells as near it is the outer one; for a group that
    cannot be in the very middle, the one on the left.
    """
    exact, middle = place * cells - group / 2, (cells - group) / 2
    nearest = math.floor(exact + 0.5 + ROUNDING) if exact > middle + ROUNDING else math.ceil(exact - 0.5 - ROUNDING)
    return min(max(0, nearest), cells - group)


class TypeKeys(ParameterSection):
    """A type without what it has of its own."""

    model_config = ConfigDict(frozen=True, extra="allow", validate_default=True)
    __pydantic_extra__: dict[str, Begin]

    cells: Annotated[int, count(MOST_CELLS, least=0)] = key("cells of this type at the start", "", TYPESCRIPT)
    place: Annotated[float | str, PLACE] = key(
        f"middle of the group, from left to right; {APART}: evenly over the tissue; {SCATTERED}: at random",
        "",
        TYPESCRIPT,
        0.5,
    )
    inm: Probability = key(
        "probability that a cell of the start performs interkinetic nuclear movement",
        "",
        "section 2.1 of chapter 4",
        1,
    )
    divides: Flag = key(
        "whether its cells divide; daughters have the events of their mother", "", "section 2.2.5 of chapter 3", True
    )

    def own(self) -> dict[str, Any]:
        """Return the values that the type gives itself, by keys of OWN_KEYS."""
        return {name: getattr(self, name) for name in OWN_KEYS if name in self.model_fields_set}

    def own_tables(self) -> dict[str, dict[str, Any]]:
        """Return these values by sections, without the soft radius: the unit of length stays."""
        tables: dict[str, dict[str, Any]] = {}
        for name, value in self.own().items():
            if name != "soft_radius":
                tables.setdefault(OWN_KEYS[name], {})[name] = value
        return tables

    def soft_radius_over(self, unit: Measure) -> float:
        """R_soft of its cells over that of [cell], the unit of length."""
        found: Measure = self.own().get("soft_radius", unit)
        return found.value / unit.value

    def times(self) -> dict[str, Timing]:
        """Return when the events begin, by name."""
        return {name: value for name, value in self if isinstance(value, Timing)}

    @property
    def has_events(self) -> bool:
        """Whether one may begin: then its cells are EMT cells."""
        return any(timing.ever for timing in self.times().values())

    def group(self, name: str, rest_length: float, together: tuple[str, ...]) -> CellGroup:
        """Return its cells at the start; ``rest_length``: of springs [R_soft]; ``together``: as of ``Scenario``."""
        scenario = Scenario(self.cells, self.inm, self.times(), together)
        return CellGroup(name, scenario, self.place, self.divides, self.has_events, rest_length)

    @model_serializer(mode="wrap")
    def _as_given(self, write: Any) -> dict[str, Any]:
        """Write the values that the type gives itself; the sections have the others."""
        own = self.own()
        return {name: value for name, value in write(self).items() if name not in OWN_KEYS or name in own}


def _field(name: str) -> Any:
    """Make the key of a section one that may be missing."""
    section = CellSection if OWN_KEYS[name] == "cell" else TissueSection
    field = section.model_fields[name]
    facts: Any = field.json_schema_extra
    own = Field(None, validate_default=False, description=field.description, json_schema_extra=facts)
    return Annotated[(field.annotation, *field.metadata)], own


if TYPE_CHECKING:
    TypeSection = TypeKeys
else:
    TypeSection = create_model(
        "TypeSection", __base__=TypeKeys, __module__=__name__, **{name: _field(name) for name in OWN_KEYS}
    )


class TypesSection(ParameterSection):
    """[types]: groups of cells with a name, parameters and events of their own, each a table [types.NAME].

    Up to eight. A key of [cell] holds for a type that does not have it; the unit R_soft is always that of [cell]. Two
    nuclei have the sum of their soft radii and the mean of their alpha_xx, basal neighbours the mean of their maximal
    distances. Cells of a type with events are EMT cells, as those of [emt] are, for tables, outcomes and studies, but
    may divide. Daughters are of the type of their mother, and have her events at her times; studies follow the EMT
    cells of the start.
    """

    model_config = ConfigDict(frozen=True, extra="allow", validate_default=True)
    __pydantic_extra__: dict[str, TypeSection]

    def named(self) -> Mapping[str, TypeKeys]:
        """Return the types by name, in the order of the file."""
        return self.__pydantic_extra__

    @classmethod
    def further_keys(cls) -> tuple[KeyFacts, ...]:
        """Return the keys of any type."""
        section = f"types.{TYPE}"
        facts = (facts_of(f"{section}.{name}", field) for name, field in TypeSection.model_fields.items())
        shown = (
            replace(one, default=f"that of {OWN_KEYS[name]}.{name}") if name in OWN_KEYS else one
            for name, one in ((one.name.rpartition(".")[2], one) for one in facts)
        )
        return *shown, *event_keys(section, events())

    @model_validator(mode="after")
    def _note_types(self, info: ValidationInfo) -> TypesSection:
        """Note each one."""
        if info.context is not None:
            info.context.update({(TypesSection, name): one for name, one in self.named().items()})
        return self
