"""The basal layer as a curve, for kernels: points, tangents, heights; see ``tissue.state.basal_curve``."""

from __future__ import annotations

import math
from typing import Any

from dincl.compiled import inner
from tissue.kernels.lanes import floored, fma, gather, maximum
from tissue.state.basal_curve import NEWTON, CurveNumbers
from tissue.state.cells import Floats


@inner
def evaluate(curve: CurveNumbers, s: Any) -> tuple[Any, Any, Any, Any]:
    """gamma(s) and gamma'(s) of a bent curve, for one arclength or eight."""
    v, begin = (s + curve.origin) * curve.per_length, 0.0 * s
    # What is not a number becomes 0, so that no place outside of the table is read.
    inside = maximum(v - curve.pieces * floored(v / curve.pieces), begin) if curve.around else maximum(v, begin)
    inside = 0.0 - maximum(0.0 - inside, begin - curve.pieces)
    piece = 0.0 - maximum(0.0 - floored(inside), begin - (curve.pieces - 1.0))
    u, place = inside - piece, 12.0 * piece
    x, along_x = _polynomial(curve.table, place, 0, u)
    y, along_y = _polynomial(curve.table, place, 6, u)
    if not curve.around:  # straight on along the tangent
        x, y = fma(v - inside, along_x, x), fma(v - inside, along_y, y)
    return x, y, along_x * curve.per_length, along_y * curve.per_length


@inner
def _polynomial(table: Floats, place: Any, k: int, u: Any) -> tuple[Any, Any]:
    """Return the polynomial at this place and its derivative (Horner)."""
    value, slope = gather(table, place, k + 5), 0.0 * u
    for power in range(4, -1, -1):
        slope = fma(slope, u, value)
        value = fma(value, u, gather(table, place, k + power))
    return value, slope


@inner
def height_of(curve: CurveNumbers, x: float, y: float) -> float:
    """Return the distance of a point from the curve, along its normal; below 0 on the side without tissue."""
    if not curve.bent:
        return y
    at_x, at_y, along_x, along_y = evaluate(curve, foot_of(curve, x, y))
    height: float = (y - at_y) * along_x - (x - at_x) * along_y
    return height


@inner
def foot_of(curve: CurveNumbers, x: float, y: float) -> float:
    """Return the arclength of the point of a bent curve that is nearest to a point: from the nearest piece by
    Newton.
    """
    nearest, node = math.inf, 0
    for k in range(int(curve.pieces)):
        dx, dy = x - curve.table[12 * k], y - curve.table[12 * k + 6]
        if dx * dx + dy * dy < nearest:
            nearest, node = dx * dx + dy * dy, k
    s = node / curve.per_length - curve.origin
    step = 1e-4 / curve.per_length
    for _ in range(NEWTON):
        at_x, at_y, along_x, along_y = evaluate(curve, s)
        _, _, next_x, next_y = evaluate(curve, s + step)
        dx, dy = x - at_x, y - at_y
        slope = along_x * along_x + along_y * along_y - (dx * (next_x - along_x) + dy * (next_y - along_y)) / step
        s += (dx * along_x + dy * along_y) / max(slope, 0.1)
    return s
