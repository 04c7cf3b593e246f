"""How high and how wide a tissue is, in one look at its cells."""

from __future__ import annotations

import math

from tissue.kernels import kernel
from tissue.kernels.store import APICAL, BASAL, CELLS, Store
from tissue.model.cells import Floats


@kernel
def measure_extents(store: Store, extents: Floats) -> None:
    """Mean height of the apical layer and of the nuclei; extent in x of the apical layer, the basal layer, the nuclei.

    As ``height``, ``nucleus_height`` and ``widths`` of ``tissue.model.observables``; (5,).
    """
    cells, layers, n = store.cells, store.layers, store.sizes[CELLS]
    low, high, total = math.inf, -math.inf, 0.0
    for k in range(store.sizes[APICAL]):
        i = layers.apical[k]
        low, high, total = min(low, cells.ax[i]), max(high, cells.ax[i]), total + cells.ay[i]
    extents[0], extents[2] = total / store.sizes[APICAL], high - low
    low, high = math.inf, -math.inf
    for k in range(store.sizes[BASAL]):
        i = layers.basal[k]
        low, high = min(low, cells.bx[i]), max(high, cells.bx[i])
    extents[3] = high - low
    low, high, total = math.inf, -math.inf, 0.0
    for i in range(n):
        low, high, total = min(low, cells.x[i]), max(high, cells.x[i]), total + cells.y[i]
    extents[1], extents[4] = total / n, high - low
