"""The constrained equations (5.6) of index 1 without stabilisation: how they drift off the constraint.

The accelerations and multipliers of g'' = 0 are found at each state, and (X, U, y, v) integrated as if nothing else
were to keep. The errors of the steps add up in g', and this in g, which grows like t^2: only a chart of the drift needs
this. Where X_i is affine in y (Examples 5.2 and 5.3) or linear in F(y) (5.4), the constraint is a linear invariant,
which these schemes keep to rounding: the drift shows with WavyFibre.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.integrate import solve_ivp

from dincl import Status
from meanfield import Model, Motion, SolverWork, State
from meanfield.model.state import FullState
from meanfield.solvers.index_one import accelerations

Floats = NDArray[np.float64]
Rate = Callable[[float, Floats], Floats]


def solve_naive(model: Model, start: State, t: ArrayLike, tol: float) -> Motion:
    """Integrate X_i'' and y'' of (5.6a), (5.6b) and g'' = 0 by SciPy's DOP853 from 0 to the times t."""

    def advance(rate: Rate, z: Floats, before: float, time: float) -> Floats:
        found = solve_ivp(rate, (before, time), z, "DOP853", rtol=tol, atol=tol)
        if not found.success:
            raise RuntimeError(f"t = {found.t[-1]:g}: {found.message}")
        return np.asarray(found.y[:, -1])

    return _integrated(model, start, t, tol, advance)


def solve_naive_rk4(model: Model, start: State, t: ArrayLike, dt: float) -> Motion:
    """Integrate like ``solve_naive`` by the classical Runge-Kutta scheme, in equal steps of at most dt."""

    def advance(rate: Rate, z: Floats, before: float, time: float) -> Floats:
        count = int(np.ceil((time - before) / dt))
        h = (time - before) / count
        for _ in range(count):
            a = rate(0.0, z)
            b = rate(0.0, z + h / 2 * a)
            c = rate(0.0, z + h / 2 * b)
            z = z + h / 6 * (a + 2 * b + 2 * c + rate(0.0, z + h * c))
        return z

    return _integrated(model, start, t, dt, advance)


def _integrated(
    model: Model, start: State, t: ArrayLike, tol: float, advance: Callable[[Rate, Floats, float, float], Floats]
) -> Motion:
    """Return the motion at times t whose state z = (X, y, U, v) ``advance`` takes from time to time."""
    first = start.complete(model, tol)

    def rate(_: float, z: Floats) -> Floats:
        X, y, U, v = _split(first, z)
        found = accelerations(model, X, U, y, v)
        return np.concatenate([U.ravel(), v, found.X.ravel(), found.y])

    z, before, rows = np.concatenate([first.X.ravel(), first.y, first.U.ravel(), first.v]), 0.0, []
    kept = np.asarray(t, dtype=np.float64)
    for time in kept:
        z = advance(rate, z, before, float(time))
        before = float(time)
        rows.append(_split(first, z))
    X, y, U, v = (np.stack(parts) for parts in zip(*rows, strict=True))
    multipliers = np.stack([accelerations(model, *at).multipliers for at in zip(X, U, y, v, strict=True)])
    work = SolverWork(unknowns=z.size)
    return Motion(model, kept, y, v, Status.SUCCESS, "", work, X, U, multipliers, first.level, None)


def _split(start: FullState, z: Floats) -> tuple[Floats, ...]:
    """Split one vector into X, y, U, v."""
    X, y, U, v = np.split(z, np.cumsum([start.X.size, start.y.size, start.X.size]))
    return X.reshape(start.X.shape), y, U.reshape(start.X.shape), v
