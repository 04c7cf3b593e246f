"""Chains of apical points apart from the layer: cells that have left it together, in the order of the cells."""

from __future__ import annotations

from dincl.compiled import inner
from tissue.state.cells import Cells


@inner
def chained_before(cells: Cells, i: int) -> int:
    """The cell before cell i in its chain, -1 if it is the first one, or in none."""
    if cells.chain[i] > 0:
        for j in range(i - 1, -1, -1):
            if cells.chain[j] == cells.chain[i]:
                return j
    return -1


@inner
def chained_behind(cells: Cells, n: int, i: int) -> int:
    """The cell behind it, -1 if it is the last one, or in none."""
    if cells.chain[i] > 0:
        for j in range(i + 1, n):
            if cells.chain[j] == cells.chain[i]:
                return j
    return -1
