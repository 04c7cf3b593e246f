"""All events there are: those of this folder, and those that were registered."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from importlib import import_module
from pathlib import Path

import numpy as np

from tissue.events.event import EmtEvent
from tissue.registry import registered, shelf
from tissue.state.cells import Floats

# Those of the thesis have the first bits, in this order; where times are equal they happen in it.
FIRST = ("a", "b", "s", "p")


@cache
def house() -> tuple[EmtEvent, ...]:
    """The events of this folder."""
    files = sorted(path.stem for path in Path(__file__).parent.glob("*.py"))
    modules = (import_module(f"tissue.events.{stem}") for stem in files if stem not in ("__init__", "known"))
    found = {module.EVENT.name: module.EVENT for module in modules if hasattr(module, "EVENT")}
    return tuple(found[name] for name in (*FIRST, *sorted(found.keys() - set(FIRST))))


def events() -> tuple[EmtEvent, ...]:
    """All events; the k-th has the bit 2^k in ``Cells.events``, and row k of ``Emt.at``.

    Those of users have theirs by when they were registered, so that a bit means the same as long as a process lives.
    """
    return (*house(), *shelf(EmtEvent).values())


def in_order() -> list[int]:
    """The rows in the order in which events happen that begin at once, and are written: the house, others by name."""
    return [row(event.name) for event in (*house(), *registered(EmtEvent))]


def row(name: str) -> int:
    """The row of an event in ``Emt.at``."""
    return [event.name for event in events()].index(name)


def bit(name: str) -> int:
    """The bit of an event in ``Cells.events``."""
    return 1 << row(name)


def settled(times: Mapping[str, Floats]) -> Floats:
    """When the events of m cells begin [h], (events, m), from the times that were drawn for some; others never do.

    An event that waits for another one begins at the later time of both: [P] at max(T^P, T^B).

    Source: section 2.2.4 of chapter 4.
    """
    known = {event.name: event for event in events()}
    never = np.full_like(next(iter(times.values())), np.inf)

    def begin(name: str) -> Floats:
        mine, after = times.get(name, never), known[name].after
        return mine if after is None else np.maximum(mine, begin(after))

    return np.array([begin(name) for name in known])
