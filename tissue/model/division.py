"""Division of cells (section 2.2.5 of chapter 3)."""

from __future__ import annotations

from numpy.random import Generator

from dincl.compiled import inner
from tissue.kernels import kernel
from tissue.kernels.rules import Rules, call_split, call_splits
from tissue.model.cycle import draw_cycle
from tissue.state.cells import Cells
from tissue.state.numbers import Numbers, numbers_of
from tissue.state.running import CELLS, TissueState
from tissue.state.space import SPATIAL


@inner
def count_due(state: TissueState, t: float) -> int:
    """Return how many cells end their cycle by time t: as many may be added."""
    cells = state.cells
    count = 0
    for i in range(state.sizes[CELLS]):
        count += is_due(cells, i, t)
    return count


@inner
def is_due(cells: Cells, i: int, t: float) -> bool:
    """Return whether cell i ends its cycle by time t."""
    due: bool = t - cells.birth[i] >= cells.cycle[i]
    return due


@kernel
def divide(state: TissueState, t: float, numbers: Numbers, rules: Rules, draws: Generator) -> None:
    """End the cycle of each cell that is old enough: it begins a new one, alone or with a second daughter beside it.

    What is drawn for daughters is kept in ``TissueState.daughters``, from which the rule ``split`` makes all of them at
    once.
    """
    cells, splits = state.cells, 0
    for i in range(state.sizes[CELLS]):
        if is_due(cells, i, t):
            own = numbers_of(numbers, cells.kind[i])
            two = cells.divides[i] and call_splits(rules.splits, state, i, draws.random(), own) != 0
            cells.birth[i] = t
            cells.cycle[i] = draw_cycle(own, draws)
            if two:
                if state.space.dimension == SPATIAL:  # in a slice there is one direction
                    state.daughters.turn[i] = draws.random()
                state.daughters.cycle[i] = draw_cycle(own, draws)
                splits += 1
    if splits > 0:
        call_split(state.space.rules.split, state, splits, numbers, rules)
