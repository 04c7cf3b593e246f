"""Results of the solvers: the motion, its energy, its violation of the constraint."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple, TypeVar

import numpy as np

from dincl.checks import describe, integer
from dincl.errors import InvalidProblem
from meanfield.errors import SolveFailed
from meanfield.forces import forces, full_weights, pair_energy
from meanfield.model.state import State

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from dincl.status import Status
    from meanfield.model.model import Model

    Floats = NDArray[np.float64]


class SolverWork(NamedTuple):
    """Work of a run: unknowns of the integrator, steps, evaluations of its right-hand side, Newton iterations."""

    unknowns: int
    steps: int = 0
    evaluations: int = 0
    newton: int = 0


@dataclass(frozen=True, eq=False, repr=False)
class SolverResult(ABC):
    """Result at the K output times that were reached.

    Parameters
    ----------
    t, y, v
        output times (K,), macroscopic state and velocity (K, ny).
    status, detail, work
        how the run ended, and its work.
    """

    model: Model
    t: Floats
    y: Floats
    v: Floats
    status: Status
    detail: str
    work: SolverWork

    @abstractmethod
    def energy(self) -> Floats:
        """Compute the total energy at each output time, (K,); FunctionFailed if a value is not finite."""

    def __repr__(self) -> str:
        outputs = f"{len(self.t)} output times" + (f" to t = {self.t[-1]:g}" if len(self.t) else "")
        return f"{type(self).__name__}({self.status.name}, {outputs}, {self._size()}, ny = {self.model.ny})"

    def _output_index(self, k: Any) -> int:
        """Check an index of an output time, which may count from the end; InvalidProblem if it is out of range."""
        count = len(self.t)
        if count == 0:
            raise InvalidProblem(f"k = {describe(k)}: the run ended before its first output time")
        return integer("k", k, least=-count, most=count - 1)

    @abstractmethod
    def _size(self) -> str:
        """Return the size of the system for ``repr``."""


Result = TypeVar("Result", bound=SolverResult)


def delivered(result: Result, throw: bool) -> Result:
    """Return a result; SolveFailed, which carries it, if the run failed and ``throw`` is set."""
    if throw and not result.status:
        raise SolveFailed(result.status, result.detail, result)
    return result


@dataclass(frozen=True, eq=False, repr=False)
class Motion(SolverResult):
    """Motion of the particles and the macroscopic component at K output times.

    Parameters
    ----------
    X, U, multipliers
        positions, velocities and multipliers lambda_i of (5.6) of the particles, (K, N, nx).
    level, weights
        constants c_i of the constraint (N, nx); weights (N,) of the particles, which sum to 1, None: 1/N each.
    """

    X: Floats
    U: Floats
    multipliers: Floats
    level: Floats
    weights: Floats | None

    def energy(self) -> Floats:
        """Compute the total energy (5.37), or (5.50) with weights, at each output time, from X, U, y and v::

        E = |y'|^2/2 + W0(y) + sum_i w_i (m/2 |X_i'|^2 + W1(X_i) + 1/2 sum_k w_k V(X_k - X_i))
        """
        states = zip(self.X, self.U, self.y, self.v, strict=True)
        return np.array([sum(energies(self.model, X, self.weights, U, y, v)) for X, U, y, v in states])

    def constraint_drift(self) -> Floats:
        """Compute the largest |g(X_i, y) - c_i| over the particles at each output time, (K,)."""
        found = [self.model.level(X, y) - self.level for X, y in zip(self.X, self.y, strict=True)]
        return np.array([np.abs(residual).max() for residual in found])

    def velocity_drift(self) -> Floats:
        """Compute the largest |dg/dX U_i + dg/dy v| over the particles at each output time, (K,)."""
        worst = []
        for X, U, y, v in zip(self.X, self.U, self.y, self.v, strict=True):
            gX, gy = self.model.jacobians(X, y)
            worst.append(np.abs((gX @ U[..., None])[..., 0] + gy @ v).max())
        return np.array(worst)

    def state(self, k: int) -> State:
        """Return the state at the output time k, from which another run can start; InvalidProblem if there is none."""
        k = self._output_index(k)
        return State(X=self.X[k], y=self.y[k], v=self.v[k], U=self.U[k], level=self.level)

    def _size(self) -> str:
        return f"N = {self.X.shape[1]}, nx = {self.model.nx}"


def energies(model: Model, X: Floats, weights: Floats | None, U: Floats, y: Floats, v: Floats) -> tuple[float, float]:
    """Compute the kinetic and the potential energy of one state, whose sum is (5.37), or (5.50) with weights."""
    return with_potential(model, X, weights, U, v, model.energy0(y), model.energy1(X))


def with_potential(
    model: Model, X: Floats, weights: Floats | None, U: Floats, v: Floats, W0: float, W1: Floats
) -> tuple[float, float]:
    """Compute the energies of one state from W0, and W1 of each particle."""
    w = full_weights(weights, len(X))
    kinetic = (v @ v + model.m * (w @ np.einsum("qi,qi->q", U, U))) / 2
    pairs = 0.0 if model.V is None else pair_energy(model, X, weights) / 2
    return float(kinetic), float(W0 + w @ W1 + pairs)


def multipliers(model: Model, X: Floats, weights: Floats | None, y: Floats, v: Floats, acceleration: Floats) -> Floats:
    """Compute lambda_i = (dg/dX)^{-T} (F1 + K - m Phi y'' - m Omega[y', y']) of shape (Q, nx).

    Source: (A.12); (A.14) prints Omega[y', y''].
    """
    gX, _ = model.jacobians(X, y)
    interaction = 0.0 if model.V is None else forces(model, X, weights)
    inertia = model.m * (model.phi(X, y) @ acceleration + model.omega(X, y, v))
    right = model.F1(X) + interaction - inertia
    return np.asarray(np.linalg.solve(gX.transpose(0, 2, 1), right[..., None])[..., 0])
