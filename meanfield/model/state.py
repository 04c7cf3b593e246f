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

    The velocities of the particles are Phi(X, y) v, as the constraint requires.

    Raises
    ------
    InvalidProblem
        if an array is not finite or the shapes do not match.
    """

    X: ArrayLike
    y: ArrayLike
    v: ArrayLike

    def __post_init__(self) -> None:
        X = shaped("X", self.X, ("N", "nx"))
        y = shaped("y", self.y, ("ny",))
        object.__setattr__(self, "X", X)
        object.__setattr__(self, "y", y)
        object.__setattr__(self, "v", shaped("v", self.v, y.shape))

    def complete(self, model: Model) -> FullState:
        """Return the state with U = Phi v and level = g(X, y).

        Raises
        ------
        InvalidProblem
            if the dimensions are not the model's, g is not finite or dg/dX has no full rank.
        """
        X, y, v = np.asarray(self.X), np.asarray(self.y), np.asarray(self.v)
        if X.shape[1] != model.nx or y.shape != (model.ny,):
            raise InvalidProblem(
                f"a state with X {X.shape} and y {y.shape}: must have X of shape (N, {model.nx}) and y ({model.ny},)"
            )
        try:
            return FullState(X, y, v, np.asarray(model.phi(X, y) @ v), model.level(X, y))
        except StepFailure as error:
            raise InvalidProblem(f"y = {describe(y)}: dg/dX must have full rank there (5.5); {error.detail}") from error


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
