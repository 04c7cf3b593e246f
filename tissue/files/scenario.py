"""The groups of cells of a run that are not control cells: how many, and the chances of their events."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import NamedTuple

import numpy as np
from numpy.random import Generator, default_rng

from tissue.events.known import DRAWN_TOGETHER, events, mark_of, settled
from tissue.files.timing import Timing
from tissue.plugins import EmtEvent
from tissue.state.cells import Emt, Flags, emt_cells


class Scenario(NamedTuple):
    """Numbers and chances that EMT cells are drawn from; ``Parameters.scenario`` makes it from a file."""

    cells: int  # N^EMT
    inm: float  # probability of interkinetic nuclear movement
    times: Mapping[str, Timing]  # of the events by name; the others never begin
    together: tuple[str, ...] = ()  # events that begin in all cells when they do in the first one


class CellGroup(NamedTuple):
    """The EMT cells or those of a named type; made from the parameters of a file by ``Parameters.groups``."""

    name: str
    scenario: Scenario
    place: float | str  # of the middle of the group, as a part of the tissue from left to right; or APART, SCATTERED
    divides: bool
    may_leave: bool  # whether its cells have events, and so are EMT cells
    rest_length: float  # eta of both cytoskeleton springs at the start, without the radius R_soft

    @property
    def section(self) -> str:
        """Its section in a parameter file."""
        return self.name if self.name == "emt" else f"types.{self.name}"


def drawn(scenario: Scenario, draws: Generator) -> tuple[Emt, Flags]:
    """EMT cells, and whether each has INM.

    The random numbers of [A], [B], [S] and [P] are drawn whether they are needed or not, and those of any other event
    are a function of the seed and of its name: runs of one seed and other scenarios have the same.
    """
    inm, *pairs = draws.random((1 + 2 * len(DRAWN_TOGETHER), scenario.cells))
    chances = dict(zip(DRAWN_TOGETHER, zip(pairs[::2], pairs[1::2], strict=True), strict=True))
    if others := scenario.times.keys() - chances.keys():
        key = int(draws.integers(1 << 63))
        for name in others:
            chances[name] = tuple(default_rng([key, *name.encode()]).random((2, scenario.cells)))
    times = {name: scenario.times.get(name, Timing()).times(*pair) for name, pair in chances.items()}
    for name in times.keys() & {*scenario.together}:
        times[name] = np.full_like(times[name], times[name].min(initial=np.inf))
    return emt_cells(settled(times)), inm < scenario.inm


def remarks(groups: Iterable[CellGroup], end: float) -> list[str]:
    """Return a sentence for each event that may wait for another one, or that a run may end before.

    ``end``: of the run [h]. Source: section 2.2.4 of chapter 4, for [P], which waits for [B].
    """
    found: dict[str, None] = {}
    for section, event, times in _timed(groups):
        found |= dict.fromkeys(_waits(event, times[event.name], times.get(event.after or "", Timing())))
        found |= dict.fromkeys(_ends_before(section, event, times[event.name], end, sure=False))
    return list(found)


def too_late(groups: Iterable[CellGroup], end: float) -> list[str]:
    """Return a sentence for each event that no run begins, as it ends before [h]."""
    lines = (
        _ends_before(section, event, times[event.name], end, sure=True) for section, event, times in _timed(groups)
    )
    return list(dict.fromkeys(line for some in lines for line in some))


def _timed(groups: Iterable[CellGroup]) -> Iterator[tuple[str, EmtEvent, Mapping[str, Timing]]]:
    """Give the events that may begin in a group with its section, and with the times of all its events."""
    for group in groups:
        section, times = group.section, group.scenario.times
        yield from (
            (section, one, times) for one in events() if group.scenario.cells and times.get(one.name, Timing()).ever
        )


def _waits(event: EmtEvent, time: Timing, first: Timing) -> Iterator[str]:
    if time.low is None or first.high is None or time.low.value >= first.high.value:
        return
    mine, other = f"[{event.mark}]", f"[{mark_of(str(event.after))}]"
    if time.fixed is not None and first.fixed is not None:
        yield f"{mine} at {time.low} waits for {other} at {first.low}"
    else:
        missing = "" if first.sure else f", and does not begin in cells without {other}"
        yield f"{mine} ({time}) waits for {other} ({first}) where {other} is later{missing}"


def _ends_before(section: str, event: EmtEvent, time: Timing, end: float, *, sure: bool) -> Iterator[str]:
    why = f'{section}.{event.name} = "{time}", and numerics.t_end = "{end:g} h"'
    if time.low is not None and time.low.value > end:
        yield f"[{event.mark}] never begins: {why}"
    elif time.high is not None and time.high.value > end and not sure:
        yield f"[{event.mark}] does not begin in all cells: {why}"
