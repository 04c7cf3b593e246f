"""Zeros and poles of det dg/dX that a motion passes without a change of sign, seen between two of its states.

Where a motion touches a zero of det dg/dX, as X = 0 for g = X^3 - y, |det| falls to zero and rises again inside of a
step. So each step must resolve the dips of |det|, and of 1/|det|: a dip of a particle is resolved if |det| stays above
``RESOLVED_DIP`` times the larger of its values around the dip. A motion that only comes near zero is resolved by some
shorter step; a zero is resolved by none, which locates it.
"""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from meanfield.model.symbolic import is_affine

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from dincl.compiled.arrays import Floats
    from meanfield.model.model import Model

# Least ratio of |det| in a dip to the larger value at its sides: a parabola falls to it over 3/4 of its side's length.
RESOLVED_DIP = 0.25
# Parts of a step between whose ends dips are looked for, and points of the cubic in each part.
PARTS, POINTS = 4, 9


class End(NamedTuple):
    """One end of a step: (y, X) as an array (ny + Q nx,), its rate, det dg/dX of the particles (Q,), and its rate."""

    values: Floats
    rates: Floats
    determinant: Floats
    turning: Floats


def end_of_step(model: Model, X: Floats, y: Floats, U: Floats, v: Floats) -> tuple[End | None, float, Floats]:
    """Return one end of a step, None where the determinant is not finite; W0, and W1 of each particle.

    If dg/dX depends on y alone, one particle stands for all.
    """
    determinant, turning, W1, W0 = model.watched(X, y, U, v)
    if not np.isfinite(determinant + turning).all():
        return None, W0, W1
    few = slice(1 if _is_affine_in_X(model) else None)
    values, rates = np.concatenate([y, X[few].ravel()]), np.concatenate([v, U[few].ravel()])
    return End(values, rates, determinant[few], turning[few]), W0, W1


@lru_cache(maxsize=256)
def _is_affine_in_X(model: Model) -> bool:
    return is_affine(model.expressions.level, model.expressions.X)


def unresolved_dip(model: Model, before: End | None, after: End | None, h: float) -> float | None:
    """Return the place in a step, 0 to 1, of the first dip of |det| or 1/|det| that it does not resolve; None if none.

    Between its ends, h apart, the particles follow the cubic that meets both ends.
    """
    if before is None or after is None:
        return 0.5
    close = _may_dip(before, after, h)
    if not close.any():
        return None
    ny, nx = model.ny, model.nx
    chosen = np.concatenate([np.ones(ny, dtype=bool), np.repeat(close, nx)])
    z, rate, end, end_rate = (part[chosen] for part in (before.values, h * before.rates, after.values, h * after.rates))
    s = np.linspace(0, 1, PARTS + 1)[1:-1, None]
    path, speed = _cubic(s, z, rate, end, end_rate), _cubic_slope(s, z, rate, end, end_rate) / h
    inside = []
    for at, by in zip(path, speed, strict=True):
        found, _, _ = end_of_step(model, at[ny:].reshape(-1, nx), at[:ny], by[ny:].reshape(-1, nx), by[:ny])
        if found is None:
            return 0.5
        inside.append((found.determinant, found.turning))
    first, last = ((one.determinant[close], one.turning[close]) for one in (before, after))
    det, slope = np.array([first, *inside, last]).swapaxes(0, 1)
    with np.errstate(all="ignore"):
        places = [_first(det, h / PARTS * slope), _first(1 / det, -h / PARTS * slope / det**2)]
    return min((place for place in places if place is not None), default=None)


def _may_dip(before: End, after: End, h: float) -> NDArray[np.bool_]:
    """Return the particles (Q,) whose determinant may fall or rise by a factor of two inside of a step.

    A cubic leaves the range of its ends by at most 4/27 of the sum of its slopes.
    """
    sign = np.sign(before.determinant)
    a, b = sign * before.determinant, sign * after.determinant
    beyond = 4 / 27 * h * (np.abs(before.turning) + np.abs(after.turning))
    low, high = np.minimum(a, b), np.maximum(a, b)
    return ~((low - beyond >= high / 2) & (high + beyond <= 2 * low))


def _first(values: Floats, slopes: Floats) -> float | None:
    """Return the place of the first unresolved dip of |values| (PARTS + 1, Q); ``slopes`` are per part."""
    sign = np.sign(values[0])
    a, b, down, up = (sign * part for part in (values[:-1], values[1:], slopes[:-1], slopes[1:]))
    dips = ~((a > 0) & (b > 0)) | ((down <= 0) & (up >= 0))
    if not dips.any():
        return None
    part = np.nonzero(dips)[0]
    s = np.linspace(0, 1, POINTS)[:, None]
    inside = _cubic(s, a[dips], down[dips], b[dips], up[dips])
    unresolved = ~(inside.min(axis=0) >= RESOLVED_DIP * np.maximum(a, b)[dips])
    if not unresolved.any():
        return None
    k = int(np.flatnonzero(unresolved)[0])
    return float((part[k] + s[int(np.argmin(inside[:, k])), 0]) / PARTS)


def _cubic(s: Floats, a: Floats, slope_a: Floats, b: Floats, slope_b: Floats) -> Floats:
    """Evaluate the cubic with values a, b and slopes at 0 and 1."""
    d, r = b - a, 1 - s
    return np.asarray(a + s * (d + r * (r * (slope_a - d) - s * (slope_b - d))))


def _cubic_slope(s: Floats, a: Floats, slope_a: Floats, b: Floats, slope_b: Floats) -> Floats:
    d, p, q = b - a, slope_a - (b - a), slope_b - (b - a)
    r = 1 - s
    return np.asarray(d + (r - s) * (r * p - s * q) + s * r * (-p - q))
