"""Layers: chains of apical points apart from the layer, and the two ends of a ring, which are neighbours."""

from __future__ import annotations

from typing import Any

from dincl.compiled import inner
from tissue.kernels.lanes import either, load, positive_bits, spread, store
from tissue.state.cells import Cells, Floats, Integers


@inner
def chained_before(cells: Cells, i: int) -> int:
    """Return the cell before cell i in its chain, -1 if it is the first one, or in none."""
    if cells.chain[i] > 0:
        for j in range(i - 1, -1, -1):
            if cells.chain[j] == cells.chain[i]:
                return j
    return -1


@inner
def chained_behind(cells: Cells, n: int, i: int) -> int:
    """Return the cell behind it, -1 if it is the last one, or in none."""
    if cells.chain[i] > 0:
        for j in range(i + 1, n):
            if cells.chain[j] == cells.chain[i]:
                return j
    return -1


@inner
def at_ends(inside: Floats, values: Floats, n: int) -> tuple[Any, Any]:
    """Return the values of the first and of the last cell of a layer, in each tissue; 0 if the layer is empty."""
    none = spread(values, 0.0)
    return _move_end(inside, values, 0, n, 1, none), _move_end(inside, values, n - 1, -1, -1, none)


@inner
def move_ends(inside: Floats, values: Floats, n: int, first: Any, last: Any) -> None:
    """Add to the values of the first and of the last cell of a layer."""
    _move_end(inside, values, 0, n, 1, first)
    _move_end(inside, values, n - 1, -1, -1, last)


@inner
def _move_end(inside: Floats, values: Floats, begin: int, stop: int, step: int, change: Any) -> Any:
    """Walk until each tissue has met a cell of its layer, and add to the value of that cell: what it was, or 0."""
    found, missing, i = spread(values, 0.0), spread(values, 1.0), begin
    while i != stop and positive_bits(missing):
        inside_i, value = load(inside, i), load(values, i)
        here = inside_i * missing
        found = either(here, value, found)
        store(values, i, either(here, value + change, value))
        missing = either(inside_i, 0.0, missing)
        i += step
    return found


@inner
def find(layer: Integers, size: int, i: int) -> int:
    """Return the place of cell i in a layer of this size, -1 if it is not there."""
    for k in range(size):
        if layer[k] == i:
            return k
    return -1


@inner
def remove_from(layer: Integers, size: int, k: int) -> int:
    """Take the k-th cell out of a layer: those before and behind are neighbours from now on; return the new size."""
    for place in range(k, size - 1):
        layer[place] = layer[place + 1]
    return size - 1
