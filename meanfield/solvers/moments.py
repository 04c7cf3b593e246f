"""The moment equations, where they close: a handful of unknowns for any number of particles (Remark 5.20)."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from dincl.checks import describe, flag, items, shaped
from dincl.errors import InvalidProblem, StepFailure
from meanfield import plotting
from meanfield.density.weights import checked
from meanfield.errors import NotClosed, SolveFailed
from meanfield.forces.field import accelerated
from meanfield.forces.interaction import pair_energy
from meanfield.forces.weights import each
from meanfield.model.closure import closure, obstacle
from meanfield.solvers.arguments import model_given, times, tolerance
from meanfield.solvers.integrate import integrate
from meanfield.solvers.motion import SolverWork
from meanfield.solvers.result import SolverResult

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import ArrayLike, NDArray

    from dincl.status import Status
    from meanfield.model.closure import MomentClosure
    from meanfield.model.model import Model

# A second moment may be below that of a point mass by the rounding of numbers of its size, however small that is.
ROUNDING = 1e-12


class Moments(NamedTuple):
    """rho = int x f dx (nx,) and the second moment, which is no covariance, sigma = int x x^T f dx (nx, nx)."""

    mean: NDArray[np.float64]
    second: NDArray[np.float64]


@dataclass(frozen=True, eq=False, repr=False)
class MomentMotion(SolverResult):
    """y, y' (K, ny) and the moments rho (K, nx), sigma (K, nx, nx) at K times; how the run ended, and what it cost."""

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
        """Total energy (5.50) at each kept time, shape (K,): all its integrands are quadratic in x."""
        found = []
        for y, v, rho, sigma in zip(self.y, self.v, self.mean, self.second, strict=True):
            X, w = points(Moments(rho, sigma))
            U = self.model.phi(X, y) @ v
            kinetic = (v @ v + self.model.m * (w @ (U**2).sum(axis=1))) / 2
            potential = self.model.energy0(y) + w @ self.model.energy1(X) + pair_energy(self.model, X, w) / 2
            found.append(kinetic + potential)
        return np.array(found)

    def _measures(self) -> dict[str, NDArray[np.float64]]:
        deviation = self._deviation()
        columns = {f"mean{k + 1}": self.mean[:, k] for k in range(self.model.nx)}
        return columns | {f"deviation{k + 1}": deviation[:, k] for k in range(self.model.nx)}

    def _drifts(self) -> dict[str, NDArray[np.float64]]:
        return {}

    def _size(self) -> str:
        return f"nx = {self.model.nx}, ny = {self.model.ny}"

    def _pictures(self) -> list[Callable[[Any], None]]:
        return [partial(plotting.draw_bands, t=self.t, mean=self.mean, deviation=self._deviation())]

    def _deviation(self) -> NDArray[np.float64]:
        """Standard deviation of each coordinate, (K, nx)."""
        variance = np.einsum("kii->ki", self.second) - self.mean**2
        return np.asarray(np.sqrt(np.maximum(variance, 0.0)))


def points(moments: Moments) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """2 nx points of equal weight with given moments: the mean plus and minus sqrt(nx) times the axes of the spread."""
    mean, second = moments
    values, axes = np.linalg.eigh(second - np.outer(mean, mean))
    arms = (axes * np.sqrt(np.maximum(values, 0.0) * len(mean))).T
    return np.vstack([mean + arms, mean - arms]), np.full(2 * len(mean), 1 / (2 * len(mean)))


def sample_moments(X: ArrayLike, weights: ArrayLike | None) -> Moments:
    """The moments of particles (N, nx) of weights (N,) that sum to 1; None: 1/N each.

    Raises
    ------
    InvalidProblem
        if X is of another shape or not finite, or weights are negative or do not sum to 1.
    """
    at = shaped("X", X, (None, None))
    w = each(None if weights is None else checked("weights", weights, len(at)), len(at))
    return Moments(w @ at, (at * w[:, None]).T @ at)


def solve_moments(
    model: Model, moments0: Moments, y0: ArrayLike, v0: ArrayLike, t: ArrayLike, tol: float, *, throw: bool = True
) -> MomentMotion:
    """Solve for y and the first two moments, with Phi(x, y)[v] = A(y, v) x + b(y, v), by DOP853::

        m_eff(rho, sigma, y) y'' = F_eff(rho, sigma, y, y')
        rho'   = A rho + b                                     (the blank of (5.69))
        sigma' = A sigma + sigma A^T + b rho^T + rho b^T

    They follow from (5.42b) by multiplying with x and x x^T and integrating by parts: d/dt int h f dx = int (grad h .
    Phi[y']) f dx. They hold without assuming a shape of f.

    Parameters
    ----------
    moments0
        mean (nx,) and second moment (nx, nx) of the initial density.
    y0, v0, t, tol, throw
        as for ``solve_ode``.

    Raises
    ------
    NotClosed
        if Phi, Omega or F1 is not affine in x, or K not linear in x' - x: higher moments would be needed.
    InvalidProblem
        if an argument cannot be right.
    SolveFailed
        if the run ends early.

    Source: Remark 5.20, (5.67)-(5.69).
    """
    model_given(model)
    raises = flag("throw", throw)
    closed = closure(model)
    if closed is None:
        raise NotClosed(f"the moment equations of the model do not close: {obstacle(model)}")
    kept, tol = times(t), tolerance(tol)
    unknowns = _Unknowns(model, closed, _checked(model, moments0), y0, v0)
    result = integrate(unknowns, kept, tol)
    parts = [unknowns.split(z) for z in result.z]
    y, v, mean, second = (
        np.array([part[k] for part in parts]).reshape(len(parts), *shape) for k, shape in enumerate(unknowns.shapes)
    )
    work = SolverWork(unknowns.start.size, result.steps, result.evaluations)
    motion = MomentMotion(model, kept[: len(y)], y, v, mean, second, result.status, result.detail, work)
    if raises and not motion.status:
        raise SolveFailed(motion.status, motion.detail, motion)
    return motion


def _checked(model: Model, moments: Moments) -> Moments:
    """Moments that some density has."""
    given = items("moments0", moments, object, "Moments(mean, second)")
    if len(given) != len(Moments._fields):
        raise InvalidProblem(f"moments0 = {describe(moments)}: must be Moments(mean, second)")
    mean = shaped("moments0.mean", given[0], (model.nx,))
    second = shaped("moments0.second", given[1], (model.nx, model.nx))
    least = np.linalg.eigvalsh(second - np.outer(mean, mean)).min()
    slack = ROUNDING * np.abs(second).max()
    if np.abs(second - second.T).max() > slack or least < -slack:
        raise InvalidProblem(
            f"moments0.second = {second.tolist()}: must be symmetric, and second - mean mean^T, of least eigenvalue "
            f"{least:.3g}, must be >= 0"
        )
    return Moments(mean, (second + second.T) / 2)


class _Unknowns:
    """The unknowns y, v, rho and the upper half of sigma."""

    def __init__(self, model: Model, closed: MomentClosure, moments: Moments, y0: ArrayLike, v0: ArrayLike) -> None:
        self._model, self._closed = model, closed
        self._upper = np.triu_indices(model.nx)
        self.shapes = ((model.ny,), (model.ny,), (model.nx,), (model.nx, model.nx))
        y, v = shaped("y0", y0, (model.ny,)), shaped("v0", v0, (model.ny,))
        self.start = np.concatenate([y, v, moments.mean, moments.second[self._upper]])
        self.shares = np.ones(self.start.size)
        derivative, self.orientation = self.derivative(self.start)
        if not np.isfinite(derivative).all():
            raise InvalidProblem(f"y0 = {describe(y)}: must be where dg/dX has full rank (5.5)")

    def derivative(self, z: NDArray[np.float64]) -> tuple[NDArray[np.float64], float]:
        """z' and the orientation at z; NaN where there is none."""
        y, v, rho, sigma = self.split(z)
        n, ny = self._model.nx, self._model.ny
        with np.errstate(all="ignore"):
            shares = np.array(self._closed.shares(rho, sigma.ravel(), y, v))
            flow = np.array(self._closed.flow(y, v))
            A, b = flow[: n * n].reshape(n, n).T, flow[n * n :]
            turned = A @ sigma + np.outer(b, rho)
            change = [A @ rho + b, (turned + turned.T)[self._upper]]
            mass = np.eye(ny) + shares[: ny * ny].reshape(ny, ny)
            force = shares[ny * ny :]
        if not (np.isfinite(shares).all() and np.isfinite(flow).all()):
            return np.full_like(z, np.nan), np.nan
        a = accelerated(mass, self._model.F0(y) + force)
        return np.concatenate([v, a, *change]), self._oriented(rho, y)

    def split(
        self, z: NDArray[np.float64]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
        """y, v, rho and sigma."""
        n, ny = self._model.nx, self._model.ny
        sigma = np.empty((n, n))
        sigma[self._upper] = z[2 * ny + n :]
        sigma.T[self._upper] = z[2 * ny + n :]
        return z[:ny], z[ny : 2 * ny], z[2 * ny : 2 * ny + n], sigma

    def _oriented(self, rho: NDArray[np.float64], y: NDArray[np.float64]) -> float:
        try:
            return float(np.sign(np.linalg.det(self._model.jacobians(rho[None, :], y)[0][0])))
        except StepFailure:
            return np.nan
