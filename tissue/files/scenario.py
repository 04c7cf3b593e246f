"""The EMT cells of a run: how many, and the chances of their events."""

from __future__ import annotations

from typing import NamedTuple

from numpy.random import Generator

from tissue.files.timing import Timing
from tissue.model.cells import Emt, Flags, emt_cells


class Scenario(NamedTuple):
    """Of which EMT cells are drawn; made from the parameters of a file by ``Parameters.scenario``."""

    cells: int  # N^EMT
    inm: float  # probability of interkinetic nuclear movement
    times: tuple[Timing, Timing, Timing, Timing]  # of [A], [B], [S], [P]


def drawn(scenario: Scenario, draws: Generator) -> tuple[Emt, Flags]:
    """EMT cells, and whether each has INM.

    All random numbers are drawn whether they are needed or not: runs of one seed and other scenarios have the same.
    """
    inm, *pairs = draws.random((1 + 2 * len(scenario.times), scenario.cells))
    whether, when = pairs[::2], pairs[1::2]
    times = [timing.times(*chances) for timing, *chances in zip(scenario.times, whether, when, strict=True)]
    return emt_cells(*times), inm < scenario.inm
