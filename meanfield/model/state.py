"""Where a motion starts."""

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

# A restart may be off by what the run before was allowed to leave, and by the rounding of numbers of its size.
SLACK = 10.0
ROUNDING = 1e-13


class FullState(NamedTuple):
    """A state that suits a model: X (N, nx), y, v (ny,), particle velocities U and constants c_i = level (N, nx)."""

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
        velocities of the particles (N, nx); None: those that the constraint asks for, Phi(X, y) v.
    level
        the constants g(X_i, y) is to keep, (N, nx); None: those of X and y. A restart passes both on, so that the
        constraint does not wander from one run to the next.

    Raises
    ------
    InvalidProblem
        if an array is not finite or the shapes do not fit together.
    """

    X: ArrayLike
    y: ArrayLike
    v: ArrayLike
    U: ArrayLike | None = None
    level: ArrayLike | None = None

    def __post_init__(self) -> None:
        X = shaped("X", self.X, (None, None))
        y = shaped("y", self.y, (None,))
        object.__setattr__(self, "X", X)
        object.__setattr__(self, "y", y)
        object.__setattr__(self, "v", shaped("v", self.v, y.shape))
        for name in ("U", "level"):
            given = getattr(self, name)
            object.__setattr__(self, name, None if given is None else shaped(name, given, X.shape))

    def checked(self, model: Model, tol: float) -> FullState:
        """The state with all that follows from it.

        Raises
        ------
        InvalidProblem
            if the dimensions are not the model's, g has no finite value or no full rank there, or the state is off the
            constraint or its velocity form by more than ``10 tol``.
        """
        X, y, v = np.asarray(self.X), np.asarray(self.y), np.asarray(self.v)
        if X.shape[1] != model.nx or y.shape != (model.ny,):
            raise InvalidProblem(
                f"a state with X {X.shape} and y {y.shape}: must have X of shape (N, {model.nx}) and y ({model.ny},)"
            )
        try:
            phi, found = model.phi(X, y), model.level(X, y)
        except StepFailure as error:
            raise InvalidProblem(
                f"y = {describe(y)}: must be where dg/dX has full rank (5.5); {error.detail}"
            ) from error
        level = found if self.level is None else np.asarray(self.level)
        needed = np.asarray(phi @ v)
        U = needed if self.U is None else np.asarray(self.U)
        _on("g(X, y) - level", found - level, level, tol)
        _on("U - Phi v", U - needed, needed, tol)
        return FullState(X, y, v, U, level)


def _on(name: str, residual: NDArray[np.float64], size: NDArray[np.float64], tol: float) -> None:
    """A residual of a constraint that vanishes to tolerance."""
    allowed = SLACK * tol + ROUNDING * float(np.abs(size).max(initial=1.0))
    worst = float(np.abs(residual).max())
    if worst > allowed:
        particle = int(np.abs(residual).max(axis=1).argmax())
        raise InvalidProblem(
            f"{name} = {worst:.3g} for particle {particle}: the start must be on the constraint, to {allowed:.3g}; "
            "leave U and level out to take those that X, y and v give"
        )


def oriented(model: Model, start: FullState) -> float:
    """The common sign of det dg/dX at a start.

    Raises
    ------
    InvalidProblem
        if the particles lie on both sides of a singular dg/dX.
    """
    gX, _ = model.jacobians(start.X, start.y)
    signs = np.sign(np.linalg.det(gX))
    if abs(signs.mean()) != 1:
        raise InvalidProblem(
            f"det dg/dX has {int((signs > 0).sum())} positive and {int((signs <= 0).sum())} other values at the start: "
            f"must be of one sign (5.5). {Status.SINGULAR.value}"
        )
    return float(signs[0])
