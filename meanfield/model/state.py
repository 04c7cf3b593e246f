"""States from which runs start."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from dincl.checks import describe, shaped
from dincl.errors import InvalidProblem, StepFailure
from dincl.status import Status

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from dincl.compiled.arrays import Floats
    from meanfield.model.model import Model


@dataclass(frozen=True, eq=False)
class State:
    """Positions X (N, nx), macroscopic state y (ny,) and its velocity v (ny,); (5.7).

    The particles have the velocities Phi(X, y) v and the constants c_i = g(X_i, y), as the constraint requires.

    Raises
    ------
    InvalidProblem
        if an array is not finite or the shapes do not match.
    """

    X: ArrayLike
    y: ArrayLike
    v: ArrayLike

    def __post_init__(self) -> None:
        y = shaped("y", self.y, ("ny",))
        for name, value, shape in (("X", self.X, ("N", "nx")), ("y", y, y.shape), ("v", self.v, y.shape)):
            object.__setattr__(self, name, shaped(name, value, shape))


def level_and_orientation(model: Model, start: State) -> tuple[Floats, float]:
    """Return g(X_i, y) of shape (N, nx), and the common sign of det dg/dX of all particles.

    Raises
    ------
    InvalidProblem
        if the dimensions are not the model's, g is not finite, dg/dX has no full rank, or the signs differ.
    """
    X, y = np.asarray(start.X), np.asarray(start.y)
    if X.shape[1] != model.nx or y.shape != (model.ny,):
        raise InvalidProblem(
            f"a state with X {X.shape} and y {y.shape}: must have X of shape (N, {model.nx}) and y ({model.ny},)"
        )
    try:
        level, (gX, _) = model.level(X, y), model.jacobians(X, y)
    except StepFailure as error:
        raise InvalidProblem(f"y = {describe(y)}: dg/dX must have full rank there (5.5); {error.detail}") from error
    signs = np.sign(np.linalg.det(gX))
    if abs(signs.mean()) != 1:
        raise InvalidProblem(
            f"det dg/dX has {int((signs > 0).sum())} positive and {int((signs <= 0).sum())} other values at the start: "
            f"must be of one sign (5.5). {Status.SINGULAR.value}"
        )
    return level, float(signs[0])
