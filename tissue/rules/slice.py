"""How a cell leaves a layer: its neighbours close the gap."""

from __future__ import annotations

from dincl.compiled import inner
from tissue.kernels.layers import chained_before, chained_behind
from tissue.kernels.rules import call_leave
from tissue.state.cells import Integers
from tissue.state.space import SPATIAL
from tissue.state.store import APICAL, CELLS, Store


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


@inner
def leave_apical(store: Store, i: int) -> tuple[bool, int, int]:
    """Take cell i out of the apical layer, or of its chain: whether it was in one, and its neighbours, -1 for none.

    In a ring the last cell and the first one are neighbours. In three dimensions its network closes the gap by itself,
    and there are no chains.
    """
    layer, sizes = store.layers.apical, store.sizes
    k, n = find(layer, sizes[APICAL], i), sizes[APICAL]
    if store.space.dimension == SPATIAL:
        if k >= 0:
            sizes[APICAL] = remove(layer, n, k)
            call_leave(store.space.rules.leave_apical, store, i)
        return k >= 0, -1, -1
    if k >= 0:
        ring = store.curve.ring > 0.0 and n > 2
        left = layer[k - 1] if k > 0 else layer[n - 1] if ring else -1
        right = layer[k + 1] if k < n - 1 else layer[0] if ring else -1
        sizes[APICAL] = remove(layer, n, k)
        return True, left, right
    inside, left, right = (
        store.cells.chain[i] > 0,
        chained_before(store.cells, i),
        chained_behind(store.cells, sizes[CELLS], i),
    )
    store.cells.chain[i] = 0
    return inside, left, right
