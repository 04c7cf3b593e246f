"""Heights above the basal layer, and whether the lumen of a tube is closed."""

from __future__ import annotations

from dincl.compiled import inner
from tissue.kernels.curve import height_of
from tissue.model.scale import Point, junctions_cross
from tissue.state.cells import Cells
from tissue.state.running import APICAL, ON_LINE, Kind, TissueState
from tissue.state.surface import PLANE, height


@inner
def height_above(state: TissueState, x: float, y: float, z: float, kind: Kind) -> float:
    """Return the distance of a point from the basal layer, along its normal; below 0 on the side without tissue."""
    if len(kind) == ON_LINE:
        return y
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
    if not state.curve.hollow or size < 8:
        return False
    cells, layer, longest = state.cells, state.layers.apical, 0.0
    for k in range(size):
        i, j = layer[k], layer[(k + 1) % size]
        longest = max(longest, abs(cells.ax[j] - cells.ax[i]), abs(cells.ay[j] - cells.ay[i]))
    for k in range(size):
        i, m, end = layer[k], k + size // 4, min(size, k + size - size // 4 + 1)
        while m < end:
            j = layer[m]
            away = max(abs(cells.ax[j] - cells.ax[i]), abs(cells.ay[j] - cells.ay[i]))
            if away < 2 * longest:
                if junctions_cross(
                    _apical(cells, i),
                    _apical(cells, layer[(k + 1) % size]),
                    _apical(cells, j),
                    _apical(cells, layer[(m + 1) % size]),
                ):
                    return True
                m += 1
            else:  # as many junctions farther on none is near
                m += max(1, int(away / longest) - 2)
    return False


@inner
def _apical(cells: Cells, i: int) -> Point:
    return cells.ax[i], cells.ay[i], 0.0
