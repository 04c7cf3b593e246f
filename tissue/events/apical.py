"""[A]: loss of apical adhesion (section 2.2.1 of chapter 4)."""

from __future__ import annotations

import math

from dincl.compile import inner
from tissue.events.layer import find, remove
from tissue.kernels.store import APICAL, Store
from tissue.model.numbers import Numbers


@inner
def begin(store: Store, i: int, numbers: Numbers) -> None:
    """The apical point of cell i leaves the layer, and a new junction joins its neighbours.

    The rest length of this junction is the sum of the two it stands for, or the present distance; the thesis has none.
    """
    cells, layer, sizes = store.cells, store.layers.apical, store.sizes
    k = find(layer, sizes[APICAL], i)
    if k < 0:
        return
    if 0 < k < sizes[APICAL] - 1:
        left, right = layer[k - 1], layer[k + 1]
        if numbers.bridge_present:
            cells.rest_aa[left] = math.hypot(cells.ax[right] - cells.ax[left], cells.ay[right] - cells.ay[left])
        else:
            cells.rest_aa[left] += cells.rest_aa[i]
    sizes[APICAL] = remove(layer, sizes[APICAL], k)
    cells.stiff_ax[i] = numbers.alpha_ax * numbers.freed_stiffness


@inner
def last(store: Store, i: int, rest: float, numbers: Numbers) -> None:
    """For each dt after: the spring relaxes from its length ``rest`` before towards 0, and (3.2) holds no more."""
    store.cells.rest_ax[i] = rest * math.exp(-numbers.rate_ax * numbers.dt)
