"""Moment equations of models for which they close: a few unknowns for any number of particles (Remark 5.20)."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from dincl.checks import describe, flag, items, shaped
from dincl.errors import InvalidProblem, StepFailure
from meanfield import plotting
from meanfield.errors import NotClosed, SolveFailed
from meanfield.forces.field import solve_mass
from meanfield.model.closure import closure, obstacle
from meanfield.solvers.arguments import check_model, output_times, tolerance
from meanfield.solvers.integrate import integrate
from meanfield.solvers.motion import SolverWork, energies
from meanfield.solvers.result import SolverResult
from meanfield.weights import checked_weights, full_weights

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import ArrayLike, NDArray

    from dincl.status import Status
    from meanfield.model.closure import MomentClosure
    from meanfield.model.model import Model

# A covariance may be negative by rounding, relative to the second moment.
MOMENT_ROUNDING = 1e-12


class Moments(NamedTuple):
    """Mean rho = int x f dx (nx,) and second moment sigma = int x x^T f dx (nx, nx), not centred."""

    mean: NDArray[np.float64]
    second: NDArray[np.float64]


@dataclass(frozen=True, eq=False, repr=False)
class MomentMotion(SolverResult):
    """Macroscopic state y, y' (K, ny) and moments rho (K, nx), sigma (K, nx, nx) at K output times, status and work."""

    model: Model
    t: NDArray[np.float64]
    y: NDArray[np.float64]
    v: NDArray[np.float64]
    mean: NDArray[np.float64]
    second: NDArray[np.float64]
    status: Status
    detail: str
    work: SolverWork

    def energy(self) -> NDArray[np.float64]:
        """Compute the total energy (5.50) at each output time, shape (K,); its integrands are quadratic in x."""
        found = []
        for y, v, rho, sigma in zip(self.y, self.v, self.mean, self.second, strict=True):
            X, w = points(Moments(rho, sigma))
            found.append(sum(energies(self.model, X, w, self.model.phi(X, y) @ v, y, v)))
        return np.array(found)

    def _measures(self) -> dict[str, NDArray[np.float64]]:
        deviation = self._deviation()
        columns = {f"mean{k + 1}": self.mean[:, k] for k in range(self.model.nx)}
        return columns | {f"deviation{k + 1}": deviation[:, k] for k in range(self.model.nx)}

    def _drifts(self) -> dict[str, NDArray[np.float64]]:
        return {}

    def _size(self) -> str:
        return f"nx = {self.model.nx}, ny = {self.model.ny}"

    def _plots(self) -> list[Callable[[Any], None]]:
        return [partial(plotting.draw_bands, t=self.t, mean=self.mean, deviation=self._deviation())]

    def _deviation(self) -> NDArray[np.float64]:
        """Compute the standard deviation of each coordinate, (K, nx)."""
        variance = np.einsum("kii->ki", self.second) - self.mean**2
        return np.asarray(np.sqrt(np.maximum(variance, 0.0)))


def points(moments: Moments) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Construct 2 nx points of equal weight with given moments: mean plus and minus sqrt(nx) principal deviations."""
    mean, second = moments
    values, axes = np.linalg.eigh(second - np.outer(mean, mean))
    arms = (axes * np.sqrt(np.maximum(values, 0.0) * len(mean))).T
    return np.vstack([mean + arms, mean - arms]), np.full(2 * len(mean), 1 / (2 * len(mean)))


def sample_moments(X: ArrayLike, weights: ArrayLike | None) -> Moments:
    """Compute the moments of particles (N, nx) with weights (N,) that sum to 1; None: 1/N each.

    Raises
    ------
    InvalidProblem
        if X has another shape or is not finite, or weights are negative or do not sum to 1.
    """
    x = shaped("X", X, (None, None))
    w = full_weights(None if weights is None else checked_weights("weights", weights, len(x)), len(x))
    return Moments(w @ x, (x * w[:, None]).T @ x)


def solve_moments(
    model: Model, moments0: Moments, y0: ArrayLike, v0: ArrayLike, t: ArrayLike, tol: float, *, throw: bool = True
) -> MomentMotion:
    """Solve for y and the first two moments, with Phi(x, y)[v] = A(y, v) x + b(y, v), by DOP853::

        m_eff(rho, sigma, y) y'' = F_eff(rho, sigma, y, y')
        rho'   = A rho + b                                     (the blank of (5.69))
        sigma' = A sigma + sigma A^T + b rho^T + rho b^T

    The last two equations follow from (5.42b), multiplied by x and x x^T and integrated by parts: d/dt int h f dx =
    int (grad h . Phi[y']) f dx. They hold for every shape of f.

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
    closed = closure(model)
    if closed is None:
        raise NotClosed(f"the moment equations of the model do not close: {obstacle(model)}")
    times, tol = output_times(t), tolerance(tol)
    system = _MomentSystem(model, closed, _checked(model, moments0), y0, v0)
    result = integrate(system, times, tol)
    parts = [system.split(z) for z in result.z]
    y, v, mean, second = (
        np.array([part[k] for part in parts]).reshape(len(parts), *shape) for k, shape in enumerate(system.shapes)
    )
    work = SolverWork(system.start.size, result.steps, result.evaluations)
    motion = MomentMotion(model, times[: len(y)], y, v, mean, second, result.status, result.detail, work)
    if raises and not motion.status:
        raise SolveFailed(motion.status, motion.detail, motion)
    return motion


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


class _MomentSystem:
    """System of the unknowns y, v, rho and the upper half of sigma."""

    def __init__(self, model: Model, closed: MomentClosure, moments: Moments, y0: ArrayLike, v0: ArrayLike) -> None:
        self.model, self._closed = model, closed
        self._upper = np.triu_indices(model.nx)
        self.shapes = ((model.ny,), (model.ny,), (model.nx,), (model.nx, model.nx))
        y, v = shaped("y0", y0, (model.ny,)), shaped("v0", v0, (model.ny,))
        self.start = np.concatenate([y, v, moments.mean, moments.second[self._upper]])
        self.error_weights = np.ones(self.start.size)
        derivative, self.orientation = self.derivative(self.start)
        if not np.isfinite(derivative).all():
            raise InvalidProblem(f"y0 = {describe(y)}: dg/dX must have full rank there (5.5)")

    def derivative(self, z: NDArray[np.float64]) -> tuple[NDArray[np.float64], float]:
        """Compute z' and the orientation at z; NaN where they are undefined."""
        y, v, rho, sigma = self.split(z)
        n, ny = self.model.nx, self.model.ny
        with np.errstate(all="ignore"):
            integrals = np.array(self._closed.integrals(rho, sigma.ravel(), y, v))
            flow = np.array(self._closed.flow(y, v))
            A, b = flow[: n * n].reshape(n, n).T, flow[n * n :]
            half = A @ sigma + np.outer(b, rho)
            rates = [A @ rho + b, (half + half.T)[self._upper]]
            mass = np.eye(ny) + integrals[: ny * ny].reshape(ny, ny)
            force = integrals[ny * ny :]
        if not (np.isfinite(integrals).all() and np.isfinite(flow).all()):
            return np.full_like(z, np.nan), np.nan
        a = solve_mass(mass, self.model.F0(y) + force)
        return np.concatenate([v, a, *rates]), self._orientation(rho, y)

    def path(
        self, z: NDArray[np.float64], rate: NDArray[np.float64]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return (y, rho) and its rate: dg/dX of a model whose moments close depends on y alone."""
        kept = np.r_[: self.model.ny, 2 * self.model.ny : 2 * self.model.ny + self.model.nx]
        return z[kept], rate[kept]

    def energies(self, z: NDArray[np.float64], rate: NDArray[np.float64]) -> tuple[float, float]:
        """Compute the kinetic and the potential energy at z."""
        y, v, rho, sigma = self.split(z)
        X, w = points(Moments(rho, sigma))
        return energies(self.model, X, w, self.model.phi(X, y) @ v, y, v)

    def split(
        self, z: NDArray[np.float64]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
        """Split z into y, v, rho and sigma."""
        n, ny = self.model.nx, self.model.ny
        sigma = np.empty((n, n))
        sigma[self._upper] = z[2 * ny + n :]
        sigma.T[self._upper] = z[2 * ny + n :]
        return z[:ny], z[ny : 2 * ny], z[2 * ny : 2 * ny + n], sigma

    def _orientation(self, rho: NDArray[np.float64], y: NDArray[np.float64]) -> float:
        try:
            return float(np.sign(np.linalg.det(self.model.jacobians(rho[None, :], y)[0][0])))
        except StepFailure:
            return np.nan
