"""The groups of cells of a run that are not control cells: how many, and the chances of their events."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from numpy.random import Generator, default_rng

from tissue.events.known import DRAWN_TOGETHER, settled
from tissue.files.timing import Timing
from tissue.state.cells import Emt, Flags, emt_cells


class Scenario(NamedTuple):
    """Of which EMT cells are drawn; made from the parameters of a file by ``Parameters.scenario``."""

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
