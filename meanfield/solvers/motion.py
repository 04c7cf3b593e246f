"""Motion of particles and macroscopic component: the result of a solver, its energy and its constraint violation."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from dincl.errors import StepFailure
from meanfield import plotting
from meanfield.forces.interaction import forces, pair_energy
from meanfield.model.state import State
from meanfield.solvers.result import SolverResult
from meanfield.weights import full_weights

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from dincl.status import Status
    from meanfield.model.model import Model

# Points per axis on which level lines of g are drawn, and the margin around the particles relative to their extent.
LEVEL_POINTS, LEVEL_MARGIN = 81, 0.12


class SolverWork(NamedTuple):
    """Work of a run: unknowns of the integrator, steps, evaluations of its right-hand side, Newton iterations."""

    unknowns: int
    steps: int = 0
    evaluations: int = 0
    newton: int = 0


@dataclass(frozen=True, eq=False, repr=False)
class Motion(SolverResult):
    """Motion of the particles and the macroscopic component at K output times.

    Parameters
    ----------
    t, y, v
        output times (K,), macroscopic state and velocity (K, ny).
    X, U, multipliers
        positions, velocities and multipliers lambda_i of (5.6) of the particles, (K, N, nx).
    level, weights
        constants c_i of the constraint (N, nx); weights (N,) of the particles, which sum to 1, None: 1/N each.
    status, detail, work
        how the run ended, and its work. After a failure, t has the output times reached.
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
        """Compute the total energy (5.37), or (5.50) with weights, at each output time, from X, U, y and v::

        E = |y'|^2/2 + W0(y) + sum_i w_i (m/2 |X_i'|^2 + W1(X_i) + 1/2 sum_k w_k V(X_k - X_i))
        """
        states = zip(self.X, self.U, self.y, self.v, strict=True)
        return np.array([sum(energies(self.model, X, self.weights, U, y, v)) for X, U, y, v in states])

    def constraint_drift(self) -> NDArray[np.float64]:
        """Compute the largest |g(X_i, y) - c_i| over the particles at each output time, (K,)."""
        found = [self.model.level(X, y) - self.level for X, y in zip(self.X, self.y, strict=True)]
        return np.array([np.abs(residual).max() for residual in found])

    def velocity_drift(self) -> NDArray[np.float64]:
        """Compute the largest |dg/dX U_i + dg/dy v| over the particles at each output time, (K,)."""
        worst = []
        for X, U, y, v in zip(self.X, self.U, self.y, self.v, strict=True):
            gX, gy = self.model.jacobians(X, y)
            worst.append(np.abs((gX @ U[..., None])[..., 0] + gy @ v).max())
        return np.array(worst)

    def _size(self) -> str:
        return f"N = {self.X.shape[1]}, nx = {self.model.nx}, ny = {self.model.ny}"

    def _drifts(self) -> dict[str, NDArray[np.float64]]:
        return {"constraint_drift": self.constraint_drift(), "velocity_drift": self.velocity_drift()}

    def _plots(self) -> list[Callable[[Any], None]]:
        return [partial(draw_particles, model=self.model, y=self.y, X=self.X)] if self._has_plane() else []

    def _has_plane(self) -> bool:
        return len(self.t) > 0 and self.model.nx in (1, 2)

    def state(self, k: int) -> State:
        """Return the state at the output time k, from which another run can start; InvalidProblem if there is none."""
        k = self._output_index(k)
        return State(X=self.X[k], y=self.y[k], v=self.v[k], U=self.U[k], level=self.level)


def energies(
    model: Model,
    X: NDArray[np.float64],
    weights: NDArray[np.float64] | None,
    U: NDArray[np.float64],
    y: NDArray[np.float64],
    v: NDArray[np.float64],
) -> tuple[float, float]:
    """Compute the kinetic and the potential energy of one state, whose sum is (5.37), or (5.50) with weights."""
    w = full_weights(weights, len(X))
    kinetic = (v @ v + model.m * (w @ (U**2).sum(axis=1))) / 2
    pairs = 0.0 if model.V is None else pair_energy(model, X, weights) / 2
    return float(kinetic), float(model.energy0(y) + w @ model.energy1(X) + pairs)


def multipliers(
    model: Model,
    X: NDArray[np.float64],
    weights: NDArray[np.float64] | None,
    y: NDArray[np.float64],
    v: NDArray[np.float64],
    acceleration: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Compute lambda_i = (dg/dX)^{-T} (F1 + K - m Phi y'' - m Omega[y', y']) of shape (Q, nx).

    Source: (A.12); (A.14) prints Omega[y', y''].
    """
    gX, _ = model.jacobians(X, y)
    interaction = 0.0 if model.V is None else forces(model, X, weights)
    inertia = model.m * (model.phi(X, y) @ acceleration + model.omega(X, y, v))
    right = model.F1(X) + interaction - inertia
    return np.asarray(np.linalg.solve(gX.transpose(0, 2, 1), right[..., None])[..., 0])


def draw_particles(ax: Any, model: Model, y: NDArray[np.float64], X: NDArray[np.float64]) -> None:
    """Draw the paths of particles X (K, N, nx) and level lines of g, for nx = 1, 2.

    For nx = 1 the axes are y[0] and X; level lines are drawn if y has one component, and each particle stays on its
    line. For nx = 2 the axes are those of the particles, and level lines are those of g at the last y.
    """
    if model.nx == 2:
        plotting.draw_paths(ax, X[..., 0], X[..., 1], "Particles, and g at the last y")
        plane = _axis(X[..., 0]), _axis(X[..., 1])
        points = np.stack(np.meshgrid(*plane), axis=-1).reshape(-1, 2)
        values = _levels(model, points, y[-1])
        plotting.draw_levels(ax, plane, [v.reshape(LEVEL_POINTS, LEVEL_POINTS) for v in values.T], ("$X_1$", "$X_2$"))
        ax.set_aspect("equal")
        return
    states = np.repeat(y[:, :1], X.shape[1], axis=1)
    plotting.draw_paths(ax, states, X[..., 0], "Particles, each on its level of g")
    plane = _axis(states), _axis(X[..., 0])
    levels = []
    if model.ny == 1:
        columns = [_levels(model, plane[1][:, None], np.array([value])) for value in plane[0]]
        levels = [np.concatenate(columns, axis=1)]
    plotting.draw_levels(ax, plane, levels, ("y" if model.ny == 1 else "$y_1$", "X"))


def _axis(values: NDArray[np.float64]) -> NDArray[np.float64]:
    low, high = float(values.min()), float(values.max())
    margin = LEVEL_MARGIN * ((high - low) or 1.0)
    return np.linspace(low - margin, high + margin, LEVEL_POINTS)


def _levels(model: Model, x: NDArray[np.float64], y: NDArray[np.float64]) -> NDArray[np.float64]:
    """Compute g at points; NaN at all points if one value is not finite."""
    try:
        return model.level(x, y)
    except StepFailure:
        return np.full((len(x), model.nx), np.nan)
