"""The constrained equations (5.6) of index 1 without stabilisation: how they drift off the constraint.

The accelerations and multipliers of g'' = 0 are found at each state, and (X, U, y, v) integrated as if nothing else
were to keep. The errors of the steps add up in g', and this in g, which grows like t^2: only a chart of the drift needs
this. Where X_i is affine in y (Examples 5.2 and 5.3) or linear in F(y) (5.4), the constraint is a linear invariant,
which these schemes keep to rounding: the drift shows with WavyFibre.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from dincl import Status
from dincl.checks import number
from meanfield import Motion, SolverWork
from meanfield.solvers.arguments import output_times, tolerance
from meanfield.solvers.index_one import accelerations

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import ArrayLike, NDArray

    from meanfield import Model, State
    from meanfield.model.state import FullState


def solve_naive(model: Model, start: State, t: ArrayLike, tol: float) -> Motion:
    """Integrate X_i'' and y'' of (5.6a), (5.6b) and g'' = 0 by SciPy's DOP853.

    Parameters
    ----------
    t
        times to keep, >= 0 and increasing; the run starts at 0 and ends at the last one.
    tol
        relative and absolute tolerance of a step.

    Returns
    -------
    Motion
        whose ``constraint_drift`` and ``velocity_drift`` are to be looked at.

    Raises
    ------
    InvalidModel
        if t, tol or the start cannot be right.
    StepFailure
        if dg/dX is singular or a force not finite on the way.
    """
    from scipy.integrate import solve_ivp

    kept, tol = output_times(t), tolerance(tol)
    first = start.complete(model, tol)
    derivative, z = _derivative(model, first), _packed(first)
    rows: list[NDArray[np.float64]] = []
    before, evaluations = 0.0, 0
    for time in kept:
        found = solve_ivp(derivative, (before, time), z, "DOP853", rtol=tol, atol=tol)
        if not found.success:
            return _motion(model, first, kept, rows, Status.STEP_TOO_SMALL, evaluations)
        z, before = found.y[:, -1], time
        rows.append(z)
        evaluations += found.nfev
    return _motion(model, first, kept, rows, Status.SUCCESS, evaluations)


def solve_naive_rk4(model: Model, start: State, t: ArrayLike, dt: float) -> Motion:
    """Integrate like ``solve_naive`` by the classical Runge-Kutta scheme, in equal steps of at most dt."""
    kept, dt = output_times(t), number("dt", dt, positive=True)
    first = start.complete(model, dt)
    derivative = _derivative(model, first)
    z, before, rows, steps = _packed(first), 0.0, [], 0
    for time in kept:
        count = int(np.ceil((time - before) / dt))
        for _ in range(count):
            z = _stepped(derivative, z, (time - before) / count)
        rows.append(z)
        steps += count
        before = time
    return _motion(model, first, kept, rows, Status.SUCCESS, 4 * steps)


def _stepped(
    derivative: Callable[[float, NDArray[np.float64]], NDArray[np.float64]], z: NDArray[np.float64], h: float
) -> NDArray[np.float64]:
    a = derivative(0.0, z)
    b = derivative(0.0, z + h / 2 * a)
    c = derivative(0.0, z + h / 2 * b)
    d = derivative(0.0, z + h * c)
    return z + h / 6 * (a + 2 * b + 2 * c + d)


def _packed(start: FullState) -> NDArray[np.float64]:
    return np.concatenate([start.X.ravel(), start.y, start.U.ravel(), start.v])


def _split(start: FullState, z: NDArray[np.float64]) -> tuple[NDArray[np.float64], ...]:
    """Split one vector into X, y, U, v."""
    ends = np.cumsum([start.X.size, start.y.size, start.X.size])
    X, y, U, v = np.split(z, ends)
    return X.reshape(start.X.shape), y, U.reshape(start.X.shape), v


def _derivative(model: Model, start: FullState) -> Callable[[float, NDArray[np.float64]], NDArray[np.float64]]:
    def derivative(_: float, z: NDArray[np.float64]) -> NDArray[np.float64]:
        X, y, U, v = _split(start, z)
        found = accelerations(model, X, U, y, v)
        return np.concatenate([U.ravel(), v, found.X.ravel(), found.y])

    return derivative


def _motion(
    model: Model,
    start: FullState,
    kept: NDArray[np.float64],
    rows: list[NDArray[np.float64]],
    status: Status,
    evaluations: int,
) -> Motion:
    states = [_split(start, z) for z in rows]
    shape, size = (len(rows), *start.X.shape), (len(rows), model.ny)
    X, y, U, v = (np.reshape([state[k] for state in states], to) for k, to in enumerate((shape, size, shape, size)))
    multipliers = np.reshape([accelerations(model, x, u, a, b).multipliers for x, a, u, b in states], shape)
    work = SolverWork(unknowns=2 * (start.X.size + model.ny), evaluations=evaluations)
    return Motion(model, kept[: len(rows)], y, v, X, U, multipliers, start.level, None, status, "", work)
