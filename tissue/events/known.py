"""All events there are: those of this folder, and those that were registered."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cache
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np

from tissue.plugins import EmtEvent, registered, registry
from tissue.state.cells import Floats

# The events of chapter 4, which tables of studies always have.
OF_THESIS = ("a", "b", "s", "p")
# Three orders that have nothing to do with each other, so that a new or a moved event changes no number of others:
# the bits of the built-in events (``events``), the order in which events act that begin at once (``acting``), and the
# columns of the random numbers that are drawn together (``tissue.files.scenario.drawn``). Other built-in events follow
# by name; the random numbers of all others are a function of the seed and of their name.
BITS = ACT_FIRST = DRAWN_TOGETHER = OF_THESIS


@cache
def built_in() -> tuple[EmtEvent, ...]:
    """Return the events of this folder, in the order of their bits."""
    files = sorted(path.stem for path in Path(__file__).parent.glob("*.py"))
    modules = (import_module(f"tissue.events.{stem}") for stem in files if stem not in ("__init__", "known"))
    found = {module.EVENT.name: module.EVENT for module in modules if hasattr(module, "EVENT")}
    return tuple(found[name] for name in (*BITS, *sorted(found.keys() - set(BITS))))


def events() -> tuple[EmtEvent, ...]:
    """Return all events; the k-th has the bit 2^k in ``Cells.events``, and row k of ``Emt.at``.

    Events of users have theirs by when they were registered, so that a bit means the same as long as a process lives.
    """
    return (*built_in(), *registry(EmtEvent).values())


def acting() -> list[int]:
    """Return the rows of the events in the order in which they act and are written: built-in ones, others by name."""
    names = [event.name for event in built_in()]
    first = (*ACT_FIRST, *sorted({*names} - {*ACT_FIRST}))
    return [row(name) for name in (*first, *(event.name for event in registered(EmtEvent)))]


def row(name: str) -> int:
    """Return the row of an event in ``Emt.at``."""
    return [event.name for event in events()].index(name)


def bit(name: str) -> int:
    """Return the bit of an event in ``Cells.events``."""
    return 1 << row(name)


def mark_of(name: str) -> str:
    """Return how tables and pages write an event, which may not be registered in this process."""
    return next((event.mark for event in events() if event.name == name), name.capitalize())


class EventNames(Sequence[str]):
    """The events that have begun, by ``Cells.events``: "" for none, "A", "B", "AB", ..., "ABSP", "AC", ..."""

    def __len__(self) -> int:
        return 1 << len(events())

    def __getitem__(self, begun: Any) -> Any:
        if not 0 <= begun < len(self):
            raise IndexError(begun)
        return "".join(events()[k].mark for k in acting() if begun >> k & 1)


EVENTS = EventNames()


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
