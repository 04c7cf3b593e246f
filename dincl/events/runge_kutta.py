"""The Runge-Kutta pairs of the event-driven method."""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np

from dincl.events.arrays import RungeKutta

if TYPE_CHECKING:
    from numpy.typing import NDArray

# The least tolerance, relative to the size of the problem, for which a pair is taken: for loose ones a step between two
# events is enough, and the fewest stages win.
LOW, MIDDLE = 1e-6, 1e-8
# With many particles events are so frequent that steps between them are short, and order 5 is enough for any tolerance.
LOW_OF_MANY = 1e-9


def pair_for(tol: float, many: bool) -> RungeKutta:
    """The pair for a relative tolerance: of order 3 (Bogacki, Shampine), 5 or 8 (Dormand, Prince)."""
    if many:
        return _order_3() if tol >= LOW_OF_MANY else _order_5()
    return _order_3() if tol >= LOW else _order_5() if tol >= MIDDLE else _order_8()


@cache
def _order_3() -> RungeKutta:
    from scipy.integrate import RK23

    return _pair(RK23, np.zeros((0, 4)))


@cache
def _order_5() -> RungeKutta:
    from scipy.integrate import RK45

    # Of its dense output, the part beyond the cubic through values and slopes is a multiple of theta^2 (1 - theta)^2.
    return _pair(RK45, RK45.P[:, 3][None])


def _pair(method: Any, dense: NDArray[np.float64]) -> RungeKutta:
    """A pair with one estimate, and no stages that only the dense output needs."""
    stages = method.n_stages
    a = np.zeros((stages + 1, stages + 1))
    a[:stages, : method.A.shape[1]] = method.A
    a[stages, :stages] = method.B
    error = np.array([method.E, np.zeros(stages + 1)])
    order = float(method.error_estimator_order)
    return RungeKutta(stages, 0, 3 + len(dense), order, a, np.append(method.C, 1.0), error, np.ascontiguousarray(dense))


@cache
def _order_8() -> RungeKutta:
    from scipy.integrate import DOP853

    stages, more = DOP853.n_stages, len(DOP853.C_EXTRA)
    a = np.zeros((stages + 1 + more, stages + 1 + more))
    a[:stages, :stages] = DOP853.A
    a[stages, :stages] = DOP853.B
    a[stages + 1 :] = DOP853.A_EXTRA
    c = np.concatenate((DOP853.C, [1.0], DOP853.C_EXTRA))
    order = float(DOP853.error_estimator_order)
    return RungeKutta(stages, more, 7, order, a, c, np.array([DOP853.E5, DOP853.E3]), DOP853.D.copy())
