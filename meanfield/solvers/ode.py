"""The reduced equations (5.11): y by Newton's law with effective mass and force, the particles by transport."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

import numpy as np

from dincl import checks
from meanfield.errors import SolveFailed
from meanfield.forces.field import field
from meanfield.model.model import Model
from meanfield.model.state import FullState, State, oriented
from meanfield.solvers.arguments import state_given, times, tolerance
from meanfield.solvers.integrate import Integrand, Integrated, integrate
from meanfield.solvers.motion import Motion, SolverWork, multipliers
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
        times to keep, >= 0 and increasing; the run starts at 0 and ends at the last one.
    tol
        local error of a step, relative to 1 + |value|: for y and v each, for the particles in the mean square.
    throw
        raise SolveFailed on failure; else return the motion until then, with its Status.

    Returns
    -------
    Motion
        whose multipliers are recovered from (A.12).

    Raises
    ------
    InvalidProblem
        if t, tol or the start cannot be right.
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
    """As ``solve_ode``, for particles of given weights (N,) that sum to 1: the flow (5.40) of a measure of points.

    ``most_steps`` are those that the integrator may make; None: as many as in ``solve_ode``.
    """
    whole = model.model if isinstance(model, Reduction) else model
    checks.instance("model", whole, Model, "a meanfield.Model, or reduce() of one")
    state_given(start)
    kept, tol, raises = times(t), tolerance(tol), checks.flag("throw", throw)
    first = start.checked(whole, tol)
    unknowns: _Unknowns = (
        model.unknowns(first, weights) if isinstance(model, Reduction) else _Transported(model, first, weights)
    )
    result = integrate(unknowns, kept, tol, most_steps)
    motion = _motion(whole, first, weights, kept, unknowns, result)
    if raises and not motion.status:
        raise SolveFailed(motion.status, motion.detail, motion)
    return motion


class _Unknowns(Integrand, Protocol):
    """An integrand whose unknowns give the particles."""

    def positions(self, z: NDArray[np.float64]) -> NDArray[np.float64]:
        """X of shape (N, nx)."""
        ...


class _Transported:
    """The unknowns (y, v, X_1, ..., X_N)."""

    def __init__(self, model: Model, start: FullState, weights: NDArray[np.float64] | None) -> None:
        self._model, self._weights, self._shape = model, weights, start.X.shape
        self.start = np.concatenate([start.y, start.v, start.X.ravel()])
        self.orientation = oriented(model, start)
        # Each of y and v counts as much as the mean of all particles.
        self.shares = np.ones(self.start.size)
        self.shares[: 2 * model.ny] = start.X.size

    def derivative(self, z: NDArray[np.float64]) -> tuple[NDArray[np.float64], float]:
        """z' and the orientation at z; NaN where there is none."""
        y, v, X = self._split(z)
        found = field(self._model, X, self._weights, y, v)
        return np.concatenate([v, found.acceleration(), found.U.ravel()]), found.orientation

    def positions(self, z: NDArray[np.float64]) -> NDArray[np.float64]:
        """X of shape (N, nx) at z."""
        return self._split(z)[2]

    def _split(self, z: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
        ny = self._model.ny
        return z[:ny], z[ny : 2 * ny], z[2 * ny :].reshape(self._shape)


def _motion(
    model: Model,
    start: FullState,
    weights: NDArray[np.float64] | None,
    kept: NDArray[np.float64],
    unknowns: _Unknowns,
    result: Integrated,
) -> Motion:
    """The particles, their velocities and multipliers at the kept times that were reached."""
    ny = model.ny
    y, v = result.z[:, :ny], result.z[:, ny : 2 * ny]
    X = np.array([unknowns.positions(z) for z in result.z]).reshape(-1, *start.X.shape)
    U, forces = np.empty_like(X), np.empty_like(X)
    for k, a in enumerate(result.derivatives[:, ny : 2 * ny]):
        U[k] = model.phi(X[k], y[k]) @ v[k]
        forces[k] = multipliers(model, X[k], weights, y[k], v[k], a)
    work = SolverWork(unknowns.start.size, result.steps, result.evaluations)
    reached = kept[: len(y)]
    return Motion(model, reached, y, v, X, U, forces, start.level, weights, result.status, result.detail, work)
