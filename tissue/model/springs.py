"""The springs of the cytoskeleton, from the nucleus to the apical and to the basal point (3.9), (3.10).

W = alpha (d - l)^2 / l^p,  d the distance, l = 1 + eta,  with p = ``power``
"""

from __future__ import annotations

import math
from typing import Any

from dincl.compiled import inner
from tissue.kernels.lanes import fma
from tissue.state.cells import Cells


@inner
def apical_length(cells: Cells, i: int) -> float:
    """Compute |X_i - A_i|."""
    return _length(cells.x[i] - cells.ax[i], cells.y[i] - cells.ay[i], cells.z[i] - cells.az[i])


@inner
def basal_length(cells: Cells, i: int) -> float:
    """Compute |X_i - B_i|."""
    return _length(cells.x[i] - cells.bx[i], cells.y[i] - cells.by[i], cells.z[i] - cells.bz[i])


@inner
def cell_length(cells: Cells, i: int) -> float:
    """|A_i - B_i|."""
    return _length(cells.ax[i] - cells.bx[i], cells.ay[i] - cells.by[i], cells.az[i] - cells.bz[i])


@inner
def _length(dx: float, dy: float, dz: float) -> float:
    """Return the length of a vector, which in the plane has no third coordinate."""
    in_plane = math.hypot(dx, dy)
    return in_plane if dz == 0.0 else math.hypot(in_plane, dz)


@inner
def coefficient(scale: float, alpha: float, rest: float, power: int) -> float:
    """Compute k of a displacement -k (1 - l/d) (X - A), which is -``scale`` grad W."""
    return 2.0 * scale * alpha / (rest * rest if power == 2 else rest)


@inner
def stretched(k: Any, rest: Any, inverse: Any, further: Any) -> Any:
    """``further`` + k (l/d - 1), from 1/d: the displacement of the end of a spring, over the arrow to it."""
    return fma(k, fma(rest, inverse, -1.0), further)
