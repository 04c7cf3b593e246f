"""Reduced equations (5.11): Newton's law for y with effective mass and force, transport of the particles."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from dincl.checks import flag
from meanfield.errors import NotClosed
from meanfield.model.reduction import Positions, Reduction
from meanfield.solvers.arguments import particles_and_times, tolerance
from meanfield.solvers.integrate import integrate
from meanfield.solvers.result import Motion, delivered, multipliers

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from meanfield.model.model import Model
    from meanfield.model.state import State


def solve_ode(model: Model | Reduction, start: State, t: ArrayLike, tol: float, *, throw: bool = True) -> Motion:
    """Solve m_eff y'' = F_eff, X_i' = Phi(X_i, y) y' with DOP853 (order 8, adaptive steps).

    Where |det dg/dX| or its inverse falls and rises again, steps are shortened until they resolve it, so that a motion
    may come near a singularity. It ends SINGULAR at a zero or pole of det dg/dX, with or without a change of its sign:
    at one that steps of 1e-10 of the run do not resolve, or where steps vanish, or change the energy by more than ten
    times the tolerance, while |det dg/dX| is below 1/20 of its value at the start or above 20 times it.

    Parameters
    ----------
    model
        a Model, whose particles are integrated: 2 ny + N nx unknowns; or ``reduce(model)``, whose particles follow from
        y in closed form: 2 ny unknowns.
    t
        output times, >= 0 and increasing; the run starts at 0 and ends at the last one.
    tol
        local error of a step, relative to 1 + |value|: for y and v each, for the particles in the mean square.
    throw
        raise SolveFailed on failure; otherwise return the output times reached, with their Status.

    Returns
    -------
    Motion
        its multipliers are computed by (A.12).

    Raises
    ------
    InvalidProblem
        if t, tol or the start is invalid.
    NotClosed
        if the particles of a reduction do not follow from y.
    SolveFailed
        if dg/dX loses its rank, the step becomes too small or a value is not finite.

    Source: (5.11)-(5.17), Proposition 5.1.
    """
    return solve_weighted(model, start, None, t, tol, throw=throw)


def solve_weighted(
    model: Model | Reduction,
    start: State,
    weights: NDArray[np.float64] | None,
    t: ArrayLike,
    tol: float,
    *,
    throw: bool = True,
    most_steps: int | None = None,
) -> Motion:
    """Solve as ``solve_ode``, for particles with weights (N,) that sum to 1: the flow (5.40) of a measure of points.

    ``most_steps`` limits the steps of the integrator; None: as in ``solve_ode``.
    """
    whole = model.model if isinstance(model, Reduction) else model
    tol, raises = tolerance(tol), flag("throw", throw)
    if isinstance(model, Reduction) and model.positions is Positions.FLOW:
        raise NotClosed(f"no reduction holds: {model.positions.value} Pass the model to solve_ode.")
    first, times = particles_and_times(whole, start, t, tol)
    found = integrate(whole, first, weights, times, tol, closed=whole is not model, most=most_steps)
    states = zip(found.X, found.y, found.v, found.a, strict=True)
    lambdas = [multipliers(whole, X, weights, y, v, a) for X, y, v, a in states]
    motion = Motion(
        model=whole,
        t=times[: len(found.y)],
        y=found.y,
        v=found.v,
        status=found.status,
        detail=found.detail,
        work=found.work,
        X=found.X,
        U=found.U,
        multipliers=np.array(lambdas).reshape(found.X.shape),
        level=first.level,
        weights=weights,
    )
    return delivered(motion, raises)
