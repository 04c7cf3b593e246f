"""All events there are: those of this folder, and those that were registered."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from tissue.events import apical, basal, constriction, protrusion, straightness
from tissue.plugins import EmtEvent, registered, registry
from tissue.state.cells import Floats

# The events of this folder in the one order that there is: of bits, of acting, of columns. A new one goes to the end.
BUILT_IN = (apical.EVENT, basal.EVENT, straightness.EVENT, protrusion.EVENT, constriction.EVENT)
# The events of chapter 4, which tables of studies always have, and whose random numbers are drawn together.
OF_THESIS = tuple(event.name for event in BUILT_IN[:4])


def events() -> tuple[EmtEvent, ...]:
    """Return all events; the k-th has the bit 2^k in ``Cells.events``, and row k of ``Emt.at``.

    Events of users have theirs by when they were registered, so that a bit means the same as long as a process lives.
    """
    return (*BUILT_IN, *registry(EmtEvent).values())


def acting() -> list[int]:
    """Return the rows of the events in the order in which they act and are written: built-in ones, others by name."""
    return [row(event.name) for event in (*BUILT_IN, *registered(EmtEvent))]


def row(name: str) -> int:
    """Return the row of an event in ``Emt.at``."""
    return [event.name for event in events()].index(name)


def bit(name: str) -> int:
    """Return the bit of an event in ``Cells.events``."""
    return 1 << row(name)


def mark_of(name: str) -> str:
    """Return how tables and pages write an event, which may not be registered in this process."""
    return next((event.mark for event in events() if event.name == name), name.capitalize())


class NamesOfEvents(Sequence[str]):
    """The events that have begun, by ``Cells.events``: "" for none, "A", "B", "AB", ..., "ABSP", "AC", ..."""

    def __len__(self) -> int:
        return 1 << len(events())

    def __getitem__(self, begun: Any) -> Any:
        if not 0 <= begun < len(self):
            raise IndexError(begun)
        return "".join(events()[k].mark for k in acting() if begun >> k & 1)


EVENTS = NamesOfEvents()


def settled(times: Mapping[str, Floats]) -> Floats:
    """Compute when the events of m cells begin [h], (events, m), from the times that were drawn; others never do.

    An event that waits for another one begins at the later time of both: [P] at max(T^P, T^B).

    Source: section 2.2.4 of chapter 4.
    """
    known = {event.name: event for event in events()}
    never = np.full_like(next(iter(times.values())), np.inf)

    def begin(name: str) -> Floats:
        mine, after = times.get(name, never), known[name].after
        return mine if after is None else np.maximum(mine, begin(after))

    return np.array([begin(name) for name in known])
