"""Reduced equations (5.11): Newton's law for y with effective mass and force, transport of the particles."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

import numpy as np

from dincl import checks
from meanfield.errors import SolveFailed
from meanfield.forces.field import field
from meanfield.model.model import Model
from meanfield.model.state import FullState, State, orientation_at
from meanfield.solvers.arguments import check_state, output_times, tolerance
from meanfield.solvers.integrate import OdeSolution, OdeSystem, integrate
from meanfield.solvers.motion import Motion, SolverWork, energies, multipliers
from meanfield.solvers.reduction import Reduction

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray


def solve_ode(model: Model | Reduction, start: State, t: ArrayLike, tol: float, *, throw: bool = True) -> Motion:
    """Solve m_eff y'' = F_eff, X_i' = Phi(X_i, y) y' with DOP853 (order 8, adaptive steps).

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
    checks.instance("model", whole, Model, "a meanfield.Model, or reduce() of one")
    check_state(start)
    times, tol, raises = output_times(t), tolerance(tol), checks.flag("throw", throw)
    first = start.complete(whole, tol)
    system: _ParticleSystem = (
        model.system(first, weights) if isinstance(model, Reduction) else _TransportSystem(model, first, weights)
    )
    result = integrate(system, times, tol, most_steps)
    motion = _motion(whole, first, weights, times, system, result)
    if raises and not motion.status:
        raise SolveFailed(motion.status, motion.detail, motion)
    return motion


class _ParticleSystem(OdeSystem, Protocol):
    """System whose unknowns determine the positions of the particles."""

    def positions(self, z: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return X of shape (N, nx) at z."""
        ...


class _TransportSystem:
    """System of the unknowns (y, v, X_1, ..., X_N)."""

    def __init__(self, model: Model, start: FullState, weights: NDArray[np.float64] | None) -> None:
        self.model, self._weights, self._shape = model, weights, start.X.shape
        self.start = np.concatenate([start.y, start.v, start.X.ravel()])
        self.orientation = orientation_at(model, start)
        # Each component of y and v weighs as much as all particles together.
        self.error_weights = np.ones(self.start.size)
        self.error_weights[: 2 * model.ny] = start.X.size

    def derivative(self, z: NDArray[np.float64]) -> tuple[NDArray[np.float64], float]:
        """Compute z' and the orientation at z; NaN where they are undefined."""
        y, v, X = self._split(z)
        found = field(self.model, X, self._weights, y, v)
        return np.concatenate([v, found.acceleration(), found.U.ravel()]), found.orientation

    def positions(self, z: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return X of shape (N, nx) at z."""
        return self._split(z)[2]

    def path(
        self, z: NDArray[np.float64], rate: NDArray[np.float64]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return y and X as one array, and its rate."""
        ny = self.model.ny
        return np.delete(z, np.s_[ny : 2 * ny]), np.delete(rate, np.s_[ny : 2 * ny])

    def energies(self, z: NDArray[np.float64], rate: NDArray[np.float64]) -> tuple[float, float]:
        """Compute the kinetic and the potential energy at z."""
        y, v, X = self._split(z)
        return energies(self.model, X, self._weights, self._split(rate)[2], y, v)

    def _split(self, z: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
        ny = self.model.ny
        return z[:ny], z[ny : 2 * ny], z[2 * ny :].reshape(self._shape)


def _motion(
    model: Model,
    start: FullState,
    weights: NDArray[np.float64] | None,
    times: NDArray[np.float64],
    system: _ParticleSystem,
    result: OdeSolution,
) -> Motion:
    """Compute the particles, their velocities and multipliers at the output times reached."""
    ny = model.ny
    y, v = result.z[:, :ny], result.z[:, ny : 2 * ny]
    X = np.array([system.positions(z) for z in result.z]).reshape(-1, *start.X.shape)
    U, lambdas = np.empty_like(X), np.empty_like(X)
    for k, a in enumerate(result.derivatives[:, ny : 2 * ny]):
        U[k] = model.phi(X[k], y[k]) @ v[k]
        lambdas[k] = multipliers(model, X[k], weights, y[k], v[k], a)
    work = SolverWork(system.start.size, result.steps, result.evaluations)
    reached = times[: len(y)]
    return Motion(model, reached, y, v, X, U, lambdas, start.level, weights, result.status, result.detail, work)
