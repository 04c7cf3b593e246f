"""How a cell leaves a layer: its neighbours close the gap."""

from __future__ import annotations

from dincl.compile import inner
from tissue.model.cells import Integers


@inner
def find(layer: Integers, size: int, i: int) -> int:
    """The place of cell i in a layer of this size, -1 if it is not there."""
    for k in range(size):
        if layer[k] == i:
            return k
    return -1


@inner
def remove(layer: Integers, size: int, k: int) -> int:
    """Take the k-th cell out of a layer: those before and behind are neighbours from now on. The new size."""
    for place in range(k, size - 1):
        layer[place] = layer[place + 1]
    return size - 1
