"""Explicit Runge-Kutta pairs with dense output: orders 3 (Bogacki, Shampine), 5 and 8 (Dormand, Prince).

A step of length h from x has the stages k_i = f(t + c_i h, x + h sum_j a_ij k_j). The last one that makes the step is
at its end, the first one of the next step; more stages may follow for the dense output.
"""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from dincl.compiled import inner

if TYPE_CHECKING:
    from dincl.compiled.arrays import Floats

EPS = float(np.finfo(float).eps)
# The least tolerance for the pairs of order 3 and 5, relative to the size of the problem and times the square of the
# number of particles: events of more particles are more frequent, so that steps are short, and the fewest stages win.
LOW, MIDDLE = 1e-5, 1e-8


class RungeKutta(NamedTuple):
    """A pair: ``stages`` rates make a step, and ``more`` of them its dense output with ``terms`` terms."""

    stages: int
    more: int
    terms: int
    order: float  # of the error estimate
    a: Floats
    c: Floats
    error: Floats  # (2, stages + 1): of the two estimates; the second is zero if there is but one
    dense: Floats  # (terms - 3, stages + 1 + more)


def pair_for(tol: float, count: int) -> RungeKutta:
    """Choose the pair for a tolerance relative to the size of a problem of ``count`` particles."""
    weighted = tol * count * count
    return _order_3() if weighted >= LOW else _order_5() if weighted >= MIDDLE else order_8()


@cache
def _order_3() -> RungeKutta:
    from scipy.integrate import RK23

    return _with_one_estimate(RK23, np.zeros((0, 4)))


@cache
def _order_5() -> RungeKutta:
    from scipy.integrate import RK45

    # Of its dense output, the part beyond the cubic through values and slopes is a multiple of theta^2 (1 - theta)^2.
    return _with_one_estimate(RK45, RK45.P[:, 3][None])


def _with_one_estimate(method: Any, dense: Floats) -> RungeKutta:
    """Make a pair with one estimate, and no stages that only the dense output needs."""
    stages = method.n_stages
    a = np.zeros((stages + 1, stages + 1))
    a[:stages, : method.A.shape[1]] = method.A
    a[stages, :stages] = method.B
    error = np.array([method.E, np.zeros(stages + 1)])
    order = float(method.error_estimator_order)
    return RungeKutta(stages, 0, 3 + len(dense), order, a, np.append(method.C, 1.0), error, np.ascontiguousarray(dense))


@cache
def order_8() -> RungeKutta:
    """Return the pair of order 8."""
    from scipy.integrate import DOP853

    stages, more = DOP853.n_stages, len(DOP853.C_EXTRA)
    a = np.zeros((stages + 1 + more, stages + 1 + more))
    a[:stages, :stages] = DOP853.A
    a[stages, :stages] = DOP853.B
    a[stages + 1 :] = DOP853.A_EXTRA
    c = np.concatenate((DOP853.C, [1.0], DOP853.C_EXTRA))
    order = float(DOP853.error_estimator_order)
    return RungeKutta(stages, more, 7, order, a, c, np.array([DOP853.E5, DOP853.E3]), DOP853.D.copy())


@inner
def stage_point(pair: RungeKutta, x: Floats, rate: Floats, h: float, i: int, point: Floats) -> None:
    """Write x + h sum_j a_ij k_j, the point of stage i, into ``point``."""
    for k in range(x.size):
        point[k] = 0.0
    for j in range(i):
        weight, earlier = h * pair.a[i, j], rate[j]
        if weight != 0.0:
            for k in range(x.size):
                point[k] += weight * earlier[k]
    for k in range(x.size):
        point[k] += x[k]


@inner
def allowed_error(tol: float, size: float, before: float, after: float) -> float:
    """Compute the allowed error of a coordinate in a step: the tolerance, or what rounding leaves."""
    return max(tol, EPS * (size + 2.0 * max(abs(before), abs(after))))


@inner
def error_ratio(pair: RungeKutta, x: Floats, after: Floats, rate: Floats, h: float, tol: float, size: float) -> float:
    """Estimate the error of a step over the allowed one, as the root of the mean square."""
    weight, count, n = pair.error, pair.stages + 1, x.size
    first, second = 0.0, 0.0
    for k in range(n):
        one, other = 0.0, 0.0
        for i in range(count):
            one += weight[0, i] * rate[i, k]
            other += weight[1, i] * rate[i, k]
        scale = allowed_error(tol, size, x[k], after[k])
        first += (one / scale) * (one / scale)
        second += (other / scale) * (other / scale)
    if first == 0.0:
        return 0.0
    return float(h * first / np.sqrt((first + 0.01 * second) * n))


@inner
def interpolate(pair: RungeKutta, x: Floats, after: Floats, rate: Floats, h: float, dense: Floats) -> None:
    """Write the dense output of a step, in the nested form of Hairer, Norsett and Wanner."""
    last, count, terms, weight = pair.stages, pair.stages + 1 + pair.more, pair.terms, pair.dense
    for k in range(x.size):
        change = after[k] - x[k]
        dense[0, k] = change
        dense[1, k] = h * rate[0, k] - change
        dense[2, k] = 2.0 * change - h * (rate[last, k] + rate[0, k])
        for j in range(terms - 3):
            total = 0.0
            for i in range(count):
                total += weight[j, i] * rate[i, k]
            dense[3 + j, k] = h * total


@inner
def dense_value(dense: Floats, terms: int, x: float, k: int, theta: float) -> tuple[float, float]:
    """Evaluate coordinate k at the part ``theta`` of the step, and its derivative with respect to theta."""
    value, slope = 0.0, 0.0
    for j in range(terms - 1, -1, -1):
        factor, sign = (theta, 1.0) if j % 2 == 0 else (1.0 - theta, -1.0)
        value += dense[j, k]
        slope = slope * factor + sign * value
        value *= factor
    return x + value, slope
