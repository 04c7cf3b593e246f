"""Heights above the basal layer; how high and how wide a tissue is, and whether its lumen is closed."""

from __future__ import annotations

import math

from dincl.compiled import inner
from tissue.kernels import kernel
from tissue.kernels.curve import height_of
from tissue.state.cells import Cells, Floats
from tissue.state.running import APICAL, BASAL, CELLS, TissueState
from tissue.state.surface import PLANE, height


@inner
def height_above(state: TissueState, x: float, y: float, z: float) -> float:
    """Return the distance of a point from the basal layer, along its normal; below 0 on the side without tissue."""
    if state.space.surface.bends != PLANE:
        return height(state.space.surface, x, y, z)
    return height_of(state.curve, x, y)


@inner
def is_closed(state: TissueState) -> bool:
    """Return whether the lumen of a tube is: opposite parts of the apical layer cross.

    These are junctions with a quarter of all junctions between them on both sides. Near ones may cross for a while: the
    layer folds in crowds, above a line, too.
    """
    size = state.sizes[APICAL]
    if state.space.torn[0]:
        return True
    if not state.curve.hollow or size < 8:
        return False
    cells, layer, longest = state.cells, state.layers.apical, 0.0
    for k in range(size):
        i, j = layer[k], layer[(k + 1) % size]
        longest = max(longest, abs(cells.ax[j] - cells.ax[i]), abs(cells.ay[j] - cells.ay[i]))
    for k in range(size):
        i = layer[k]
        for m in range(k + size // 4, min(size, k + size - size // 4 + 1)):
            j = layer[m]
            near = abs(cells.ax[j] - cells.ax[i]) < 2 * longest and abs(cells.ay[j] - cells.ay[i]) < 2 * longest
            if near and _cross(state.cells, i, layer[(k + 1) % size], j, layer[(m + 1) % size]):
                return True
    return False


@inner
def _cross(cells: Cells, i: int, next_i: int, j: int, next_j: int) -> bool:
    """Return whether two junctions cross: the ends of each lie on different sides of the other."""
    one = _side(cells, i, next_i, j) * _side(cells, i, next_i, next_j)
    return one < 0.0 and _side(cells, j, next_j, i) * _side(cells, j, next_j, next_i) < 0.0


@inner
def _side(cells: Cells, i: int, j: int, k: int) -> float:
    """Compute on which side of the line from A_i to A_j the point A_k is: a number with this sign."""
    along_x, along_y = cells.ax[j] - cells.ax[i], cells.ay[j] - cells.ay[i]
    side: float = along_x * (cells.ay[k] - cells.ay[i]) - along_y * (cells.ax[k] - cells.ax[i])
    return side


@kernel
def measure_extents(state: TissueState, extents: Floats) -> None:
    """Mean height of the apical layer and of the nuclei; extent in x of the apical layer, the basal layer, the nuclei.

    As ``height``, ``nucleus_height`` and ``widths`` of ``tissue.frames.observables``; (5,).
    """
    cells, layers, n = state.cells, state.layers, state.sizes[CELLS]
    low, high, total = math.inf, -math.inf, 0.0
    for k in range(state.sizes[APICAL]):
        i = layers.apical[k]
        height = height_above(state, cells.ax[i], cells.ay[i], cells.az[i])
        low, high, total = min(low, cells.ax[i]), max(high, cells.ax[i]), total + height
    extents[0], extents[2] = total / state.sizes[APICAL], high - low
    low, high = math.inf, -math.inf
    for k in range(state.sizes[BASAL]):
        i = layers.basal[k]
        low, high = min(low, cells.bx[i]), max(high, cells.bx[i])
    extents[3] = high - low
    low, high, total = math.inf, -math.inf, 0.0
    for i in range(n):
        height = height_above(state, cells.x[i], cells.y[i], cells.z[i])
        low, high, total = min(low, cells.x[i]), max(high, cells.x[i]), total + height
    extents[1], extents[4] = total / n, high - low
