"""Reduced equations (5.11): Newton's law for y with effective mass and force, transport of the particles.

Where the moment equations close, a few points with the moments of a density move like it (Remark 5.20).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from dincl.checks import describe, flag, items, shaped
from dincl.errors import InvalidProblem
from meanfield.errors import NotClosed
from meanfield.model.reduction import Moments, Positions, Reduction, obstacle, points
from meanfield.model.state import State
from meanfield.solvers.arguments import check_model, particles_and_times, tolerance
from meanfield.solvers.integrate import integrate
from meanfield.solvers.result import Motion, delivered, multipliers

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from meanfield.model.model import Model

    Floats = NDArray[np.float64]

# A covariance may be negative by rounding, relative to the second moment.
MOMENT_ROUNDING = 1e-12


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
    weights: Floats | None,
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


@dataclass(frozen=True, eq=False, repr=False)
class MomentMotion(Motion):
    """Motion of 2 nx points of equal weight that have the moments rho (K, nx) and sigma (K, nx, nx) of the density."""

    @property
    def mean(self) -> Floats:
        """rho (K, nx)."""
        return np.asarray(self.X.mean(axis=1))

    @property
    def second(self) -> Floats:
        """sigma (K, nx, nx), not centred."""
        return np.asarray(self.X.swapaxes(1, 2) @ self.X / self.X.shape[1])

    def _size(self) -> str:
        return f"nx = {self.model.nx}"


def solve_moments(
    model: Model, moments0: Moments, y0: ArrayLike, v0: ArrayLike, t: ArrayLike, tol: float, *, throw: bool = True
) -> MomentMotion:
    """Solve for y and the first two moments, with Phi(x, y)[v] = A(y, v) x + b(y, v)::

        m_eff(rho, sigma, y) y'' = F_eff(rho, sigma, y, y')
        rho'   = A rho + b                                     (the blank of (5.69))
        sigma' = A sigma + sigma A^T + b rho^T + rho b^T

    The last two equations follow from (5.42b), multiplied by x and x x^T and integrated by parts: d/dt int h f dx =
    int (grad h . Phi[y']) f dx. They hold for every shape of f, hence for 2 nx points with the moments of the density,
    which are moved by the integrator of ``solve_ode``: all integrands are polynomials of degree two in x.

    Parameters
    ----------
    moments0
        mean (nx,) and second moment (nx, nx) of the initial density.
    y0, v0, t, tol, throw
        as for ``solve_ode``.

    Raises
    ------
    NotClosed
        if Phi, Omega or F1 is not affine in x, or K is not linear in x' - x: higher moments would be needed.
    InvalidProblem
        if an argument is invalid.
    SolveFailed
        if the run ends early.

    Source: Remark 5.20, (5.67)-(5.69).
    """
    check_model(model)
    raises = flag("throw", throw)
    if obstacle(model) is not None:
        raise NotClosed(f"the moment equations of the model do not close: {obstacle(model)}")
    X = points(_checked(model, moments0))
    start = State(X=X, y=shaped("y0", y0, (model.ny,)), v=shaped("v0", v0, (model.ny,)))
    motion = solve_weighted(model, start, None, t, tol, throw=False)
    return delivered(MomentMotion(**vars(motion)), raises)


def _checked(model: Model, moments: Moments) -> Moments:
    """Return moments as arrays; InvalidProblem unless a measure has these moments."""
    given = items("moments0", moments, object, "Moments(mean, second)")
    if len(given) != len(Moments._fields):
        raise InvalidProblem(f"moments0 = {describe(moments)}: must be Moments(mean, second)")
    mean = shaped("moments0.mean", given[0], (model.nx,))
    second = shaped("moments0.second", given[1], (model.nx, model.nx))
    least = np.linalg.eigvalsh(second - np.outer(mean, mean)).min()
    slack = MOMENT_ROUNDING * np.abs(second).max()
    if np.abs(second - second.T).max() > slack or least < -slack:
        raise InvalidProblem(
            f"moments0.second = {second.tolist()}: must be symmetric, and second - mean mean^T, of least eigenvalue "
            f"{least:.3g}, must be >= 0"
        )
    return Moments(mean, (second + second.T) / 2)
