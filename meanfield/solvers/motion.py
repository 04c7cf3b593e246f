"""What a solver returns: the motion at the kept times, and what shows that it is right."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from meanfield.forces.interaction import forces, pair_energy
from meanfield.forces.weights import each
from meanfield.model.state import State
from meanfield.solvers.particles import draw_particles
from meanfield.solvers.result import SolverResult

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from dincl.status import Status
    from meanfield.model.model import Model


class SolverWork(NamedTuple):
    """What a run cost: unknowns of the integrator, steps, evaluations of its right-hand side, Newton iterations."""

    unknowns: int
    steps: int = 0
    evaluations: int = 0
    newton: int = 0


@dataclass(frozen=True, eq=False, repr=False)
class Motion(SolverResult):
    """Particles and macroscopic component at K times.

    Parameters
    ----------
    t, y, v
        times (K,), macroscopic state and velocity (K, ny).
    X, U, multipliers
        positions, velocities and multipliers lambda_i of (5.6) of the particles, (K, N, nx).
    level, weights
        the constants c_i of the constraint (N, nx); weights (N,) of the particles that sum to 1, None: 1/N each.
    status, detail, work
        how the run ended, and what it cost. After a failure the times until then are there.
    """

    model: Model
    t: NDArray[np.float64]
    y: NDArray[np.float64]
    v: NDArray[np.float64]
    X: NDArray[np.float64]
    U: NDArray[np.float64]
    multipliers: NDArray[np.float64]
    level: NDArray[np.float64]
    weights: NDArray[np.float64] | None
    status: Status
    detail: str
    work: SolverWork

    def energy(self) -> NDArray[np.float64]:
        """Total energy (5.37), or (5.50) with weights, at each kept time, from X, U, y and v as they are::

        E = |y'|^2/2 + W0(y) + sum_i w_i (m/2 |X_i'|^2 + W1(X_i) + 1/2 sum_k w_k V(X_k - X_i))
        """
        return np.array([self._energy(k) for k in range(len(self.t))])

    def constraint_drift(self) -> NDArray[np.float64]:
        """Largest |g(X_i, y) - c_i| over the particles at each kept time."""
        found = [self.model.level(X, y) - self.level for X, y in zip(self.X, self.y, strict=True)]
        return np.array([np.abs(residual).max() for residual in found])

    def velocity_drift(self) -> NDArray[np.float64]:
        """Largest |dg/dX U_i + dg/dy v| over the particles at each kept time."""
        worst = []
        for X, U, y, v in zip(self.X, self.U, self.y, self.v, strict=True):
            gX, gy = self.model.jacobians(X, y)
            worst.append(np.abs((gX @ U[..., None])[..., 0] + gy @ v).max())
        return np.array(worst)

    def _size(self) -> str:
        return f"N = {self.X.shape[1]}, nx = {self.model.nx}, ny = {self.model.ny}"

    def _drifts(self) -> dict[str, NDArray[np.float64]]:
        return {"constraint_drift": self.constraint_drift(), "velocity_drift": self.velocity_drift()}

    def _pictures(self) -> list[Callable[[Any], None]]:
        return [partial(draw_particles, model=self.model, y=self.y, X=self.X)] if self._has_plane() else []

    def _has_plane(self) -> bool:
        return len(self.t) > 0 and self.model.nx in (1, 2)

    def state(self, k: int) -> State:
        """The state at the k-th kept time, for a run that goes on from there; InvalidProblem if there is none."""
        k = self._kept(k)
        return State(X=self.X[k], y=self.y[k], v=self.v[k], U=self.U[k], level=self.level)

    def _energy(self, k: int) -> float:
        model, X, U = self.model, self.X[k], self.U[k]
        w = each(self.weights, len(X))
        kinetic = (self.v[k] @ self.v[k] + model.m * (w @ (U**2).sum(axis=1))) / 2
        pairs = 0.0 if model.V is None else pair_energy(model, X, self.weights) / 2
        return float(kinetic + model.energy0(self.y[k]) + w @ model.energy1(X) + pairs)


def multipliers(
    model: Model,
    X: NDArray[np.float64],
    weights: NDArray[np.float64] | None,
    y: NDArray[np.float64],
    v: NDArray[np.float64],
    acceleration: NDArray[np.float64],
) -> NDArray[np.float64]:
    """lambda_i = (dg/dX)^{-T} (F1 + K - m Phi y'' - m Omega[y', y']) of shape (Q, nx).

    Source: (A.12); (A.14) prints Omega[y', y''].
    """
    gX, _ = model.jacobians(X, y)
    pull = 0.0 if model.V is None else forces(model, X, weights)
    inertia = model.m * (model.phi(X, y) @ acceleration + model.omega(X, y, v))
    right = model.F1(X) + pull - inertia
    return np.asarray(np.linalg.solve(gX.transpose(0, 2, 1), right[..., None])[..., 0])
