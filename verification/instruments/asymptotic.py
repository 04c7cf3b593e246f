"""The asymptotic range of measured errors: which of them the reference covers, and from which step size on they fall on
one straight line in (log h, log error).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.special import fdtri

EPS = float(np.finfo(np.float64).eps)
MIN_RANGE = 4  # the search for the asymptotic range never goes below this
REFUTE_LEVEL = 0.005  # chance, per test, to refute a range that is straight up to normal noise in log error
SLOPE_DRIFT = 0.05  # a change of slope that is not worth a shorter range: half of the 0.1 asked of an order
ROUNDING_REACH = 1000.0  # rounding of a whole run may add up to this many eps * scale
REFERENCE_REACH = 10.0  # a reference may be this much worse than stated, if the errors stop falling there
STALLED_SLOPE = 0.25  # near the floor, errors that fall more slowly than h^0.25 have stopped falling

Floats = NDArray[np.float64]


def resolution_of(h: Floats, error: Floats, floor: float, scale: float) -> float:
    """Return the size of what covers the error: as stated, or the largest error that stopped falling close above it."""
    reach = max(REFERENCE_REACH * floor, ROUNDING_REACH * EPS * scale)
    stalled = (error[1:] >= error[:-1] * (h[1:] / h[:-1]) ** STALLED_SLOPE) & (error[1:] <= reach)
    return float(np.max(error[1:][stalled], initial=max(floor, EPS * scale)))


def line(x: Floats, y: Floats) -> tuple[float, float, float]:
    """Fit a least squares line: slope, value at x = 0, sum of squared residuals."""
    centred = x - x.mean()
    slope = float(centred @ y / (centred @ centred))
    residual = y - y.mean() - slope * centred
    return slope, float(y.mean() - slope * x.mean()), float(residual @ residual)


def reference_shift(x: Floats, y: Floats, resolution: float) -> float:
    """Return sum_i |w_i| |log(1 - resolution / error_i)|, the largest change of the slope by such errors."""
    if resolution == 0.0:
        return 0.0
    centred = x - x.mean()
    return float(np.abs(centred) @ -np.log1p(-np.exp(np.log(resolution) - y)) / (centred @ centred))


def _refutes(narrow: float, wide: float, extra: int, freedom: int, level: float) -> bool:
    """Return whether ``extra`` parameters lower the sum of squares from narrow to wide by more than chance (F test)."""
    return (narrow - wide) * freedom > float(fdtri(extra, freedom, 1.0 - level)) * extra * wide


def _drifts(x: Floats, y: Floats, resolution: float) -> bool:
    """Return whether a next term c h is significant and changes the slope p + c h noticeably along the range."""
    h = np.exp(x - x[0])
    model = np.column_stack([np.ones_like(x), x - x[0], h])
    parameters, *_ = np.linalg.lstsq(model, y)
    if abs(parameters[2]) * (1.0 - h[-1]) <= SLOPE_DRIFT + reference_shift(x, y, resolution):
        return False
    residual = y - model @ parameters
    return _refutes(line(x, y)[2], float(residual @ residual), 1, x.size - 3, REFUTE_LEVEL)


def _coarse_part_off(x: Floats, y: Floats, resolution: float) -> bool:
    """Return whether the line through the finer points fails, for some cut, to predict the coarser ones."""
    slope, _, squares = line(x, y)
    cuts = range(1, x.size - MIN_RANGE + 1)
    for cut in cuts:
        fine_slope, _, fine_squares = line(x[cut:], y[cut:])
        noticeable = abs(fine_slope - slope) > SLOPE_DRIFT + reference_shift(x[cut:], y[cut:], resolution)
        if noticeable and _refutes(squares, fine_squares, cut, x.size - cut - 2, REFUTE_LEVEL / len(cuts)):
            return True
    return False


def asymptotic_start(x: Floats, y: Floats, resolution: float) -> int:
    """Return the index of the coarsest point of the longest fine end that is one straight line."""
    start = 0
    while x.size - start > MIN_RANGE:
        fine = x[start:], y[start:], resolution
        if not (_drifts(*fine) or _coarse_part_off(*fine)):
            break
        start += 1
    return start
