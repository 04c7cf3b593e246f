"""What solvers share: checks of arguments, and results with their energy and their violation of the constraint."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple, TypeVar

import numpy as np

from dincl import checks
from dincl.errors import FunctionFailed, InvalidProblem
from dincl.status import Status
from meanfield.density import Density
from meanfield.forces import forces, pair_energy
from meanfield.model.model import Model
from meanfield.model.state import State, level_and_orientation

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from dincl.compiled.arrays import Floats

# Range of tolerances: below, rounding exceeds the tolerance; above, results have no correct digit.
TIGHTEST, LOOSEST = 1e-13, 1e-1


def tolerance(value: Any) -> float:
    """Return a tolerance; InvalidProblem unless it is from 1e-13 to 0.1."""
    tol = checks.number("tol", value, positive=True)
    if not TIGHTEST <= tol <= LOOSEST:
        raise InvalidProblem(f"tol = {tol:g}: must be from {TIGHTEST:g} to {LOOSEST:g}")
    return tol


def checked_run(model: Model, start: State, t: ArrayLike) -> tuple[Floats, float, Floats]:
    """Return g(X_i, y) at the start (N, nx), the sign of det dg/dX, and the output times (K,); InvalidProblem."""
    checks.instance("model", model, Model, "a meanfield.Model")
    checks.instance("start", start, State, "a meanfield.State")
    times = _output_times(t)
    return *level_and_orientation(model, start), times


def checked_limit(
    model: Model, density: Density, y0: ArrayLike, v0: ArrayLike, t: ArrayLike
) -> tuple[Floats, Floats, Floats]:
    """Return y0, v0 (ny,) and the output times (K,) of a run from a density; InvalidProblem."""
    check_law(model, density)
    y, v = checks.shaped("y0", y0, (model.ny,)), checks.shaped("v0", v0, (model.ny,))
    return y, v, _output_times(t)


def check_law(model: Model, density: Density) -> None:
    """Raise InvalidProblem unless a model and the density of its particles have one dimension."""
    checks.instance("model", model, Model, "a meanfield.Model")
    checks.instance("density", density, Density, "a meanfield.Density")
    if density.nx != model.nx:
        raise InvalidProblem(f"density has nx = {density.nx}: must be {model.nx}, as in the model")


def _output_times(value: ArrayLike) -> Floats:
    t = checks.times("t", value)
    if t[-1] == 0:
        raise InvalidProblem(f"t = {checks.describe(value)}: must be increasing times >= 0, the last one > 0")
    return t


class SolveFailed(RuntimeError):
    """A run that ended early.

    ``result`` holds the output times reached, ``status`` says why the run ended and what to try, ``detail`` where.
    """

    def __init__(self, status: Status, detail: str, result: Any) -> None:
        super().__init__(f"{status.value} {detail}".rstrip())
        self.status = status
        self.detail = detail
        self.result = result

    def __reduce__(self) -> tuple[Any, ...]:
        # By default an exception is rebuilt from its message alone, which fails between processes.
        return type(self), (self.status, self.detail, self.result)


class SolverWork(NamedTuple):
    """Work of a run: unknowns of the integrator, steps, evaluations of its right-hand side, Newton iterations."""

    unknowns: int
    steps: int = 0
    evaluations: int = 0
    newton: int = 0


@dataclass(frozen=True, eq=False)
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
        constants c_i of the constraint (N, nx); weights (N,) of the particles, which sum to 1.
    """

    X: Floats
    U: Floats
    multipliers: Floats
    level: Floats
    weights: Floats

    def energy(self) -> Floats:
        """Compute the total energy (5.37), or (5.50) with weights, at each output time, from X, U, y and v::

        E = |y'|^2/2 + W0(y) + sum_i w_i (m/2 |X_i'|^2 + W1(X_i) + 1/2 sum_k w_k V(X_k - X_i))
        """
        states = zip(self.X, self.U, self.y, self.v, strict=True)
        return np.array([total_energy(self.model, X, self.weights, U, y, v) for X, U, y, v in states])

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

    def _size(self) -> str:
        return f"N = {self.X.shape[1]}, nx = {self.model.nx}"


def total_energy(model: Model, X: Floats, weights: Floats, U: Floats, y: Floats, v: Floats) -> float:
    """Compute the energy (5.37), or (5.50) with weights, of one state; FunctionFailed if it is not finite."""
    total = sum(with_potential(model, X, weights, U, v, model.energy0(y), model.energy1(X)))
    if not np.isfinite(total):
        raise FunctionFailed(Status.NON_FINITE, "The energy of the particles is not finite.")
    return total


def with_potential(
    model: Model, X: Floats, weights: Floats, U: Floats, v: Floats, W0: float, W1: Floats
) -> tuple[float, float]:
    """Compute the kinetic and the potential energy of one state from W0, and W1 of each particle."""
    kinetic = (v @ v + model.m * (weights @ np.einsum("qi,qi->q", U, U))) / 2
    pairs = 0.0 if model.V is None else pair_energy(model, X, weights) / 2
    return float(kinetic), float(W0 + weights @ W1 + pairs)


def multipliers(model: Model, X: Floats, weights: Floats, y: Floats, v: Floats, acceleration: Floats) -> Floats:
    """Compute lambda_i = (dg/dX)^{-T} (F1 + K - m Phi y'' - m Omega[y', y']) of shape (Q, nx).

    Source: (A.12); (A.14) prints Omega[y', y''].
    """
    gX, _ = model.jacobians(X, y)
    interaction = 0.0 if model.V is None else forces(model, X, weights)
    inertia = model.m * (model.phi(X, y) @ acceleration + model.omega(X, y, v))
    right = model.F1(X) + interaction - inertia
    return np.asarray(np.linalg.solve(gX.transpose(0, 2, 1), right[..., None])[..., 0])
