"""States from which runs start."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from dincl.checks import describe, shaped
from dincl.errors import InvalidProblem, StepFailure
from dincl.status import Status

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from meanfield.model.model import Model

# The final state of a run, from which another run restarts, misses the constraint by up to SLACK times its tolerance
# and by rounding, relative to its size.
SLACK = 10.0
START_ROUNDING = 1e-13


class FullState(NamedTuple):
    """State of a model: X (N, nx), y, v (ny,), particle velocities U (N, nx) and constants c_i = level (N, nx)."""

    X: NDArray[np.float64]
    y: NDArray[np.float64]
    v: NDArray[np.float64]
    U: NDArray[np.float64]
    level: NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class State:
    """Positions X (N, nx), macroscopic state y (ny,) and its velocity v (ny,); (5.7).

    Parameters
    ----------
    U
        velocities of the particles (N, nx); None: Phi(X, y) v, as the constraint requires.
    level
        constants c_i of the constraint g(X_i, y) = c_i, (N, nx); None: g(X_i, y) at this state. A restart passes U and
        level on, so that the constraint does not drift from run to run.

    Raises
    ------
    InvalidProblem
        if an array is not finite or the shapes do not match.
    """

    X: ArrayLike
    y: ArrayLike
    v: ArrayLike
    U: ArrayLike | None = None
    level: ArrayLike | None = None

    def __post_init__(self) -> None:
        X = shaped("X", self.X, ("N", "nx"))
        y = shaped("y", self.y, ("ny",))
        object.__setattr__(self, "X", X)
        object.__setattr__(self, "y", y)
        object.__setattr__(self, "v", shaped("v", self.v, y.shape))
        for name in ("U", "level"):
            given = getattr(self, name)
            object.__setattr__(self, name, None if given is None else shaped(name, given, X.shape))

    def complete(self, model: Model, tol: float) -> FullState:
        """Fill in U and level and check the state against the model.

        Raises
        ------
        InvalidProblem
            if the dimensions are not the model's, g is not finite or dg/dX has no full rank, or the constraint or its
            derivative in time is violated by more than ``10 tol``.
        """
        X, y, v = np.asarray(self.X), np.asarray(self.y), np.asarray(self.v)
        if X.shape[1] != model.nx or y.shape != (model.ny,):
            raise InvalidProblem(
                f"a state with X {X.shape} and y {y.shape}: must have X of shape (N, {model.nx}) and y ({model.ny},)"
            )
        try:
            phi, values = model.phi(X, y), model.level(X, y)
        except StepFailure as error:
            raise InvalidProblem(f"y = {describe(y)}: dg/dX must have full rank there (5.5); {error.detail}") from error
        level = values if self.level is None else np.asarray(self.level)
        required = np.asarray(phi @ v)
        U = required if self.U is None else np.asarray(self.U)
        _check_residual("g(X, y) - level", values - level, level, tol)
        _check_residual("U - Phi v", U - required, required, tol)
        return FullState(X, y, v, U, level)


def _check_residual(name: str, residual: NDArray[np.float64], size: NDArray[np.float64], tol: float) -> None:
    """Check that the residual of a constraint vanishes to tolerance."""
    allowed = SLACK * tol + START_ROUNDING * float(np.abs(size).max(initial=1.0))
    worst = float(np.abs(residual).max())
    if worst > allowed:
        particle = int(np.abs(residual).max(axis=1).argmax())
        raise InvalidProblem(
            f"{name} = {worst:.3g} for particle {particle}: the start must satisfy the constraint to {allowed:.3g}; "
            "without U and level, both follow from X, y and v"
        )


def orientation_at(model: Model, start: FullState) -> float:
    """Return the common sign of det dg/dX of all particles.

    Raises
    ------
    InvalidProblem
        if the signs differ, or dg/dX is singular for a particle.
    """
    gX, _ = model.jacobians(start.X, start.y)
    signs = np.sign(np.linalg.det(gX))
    if abs(signs.mean()) != 1:
        raise InvalidProblem(
            f"det dg/dX has {int((signs > 0).sum())} positive and {int((signs <= 0).sum())} other values at the start: "
            f"must be of one sign (5.5). {Status.SINGULAR.value}"
        )
    return float(signs[0])
