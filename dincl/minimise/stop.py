"""When an iteration is at its end."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from dincl.checks import number

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from dincl.minimise.iteration_rows import Point


@dataclass(frozen=True)
class Stop(ABC):
    """A rule that ends an iteration; ``limit`` of the minimiser ends it if the rule does not."""

    def at(self, point: Point) -> bool:
        """Whether a point with its multipliers is good enough."""
        return False

    def after(self, before: NDArray[np.float64], x: NDArray[np.float64], dtau: float) -> bool:
        """Whether the step from ``before`` to x, of length ``dtau``, is short enough."""
        return False

    @abstractmethod
    def words(self) -> str:
        """What was asked for, for messages."""


@dataclass(frozen=True)
class Stationary(Stop):
    """max(|grad W - J^T lambda|, max(0, -g), |min(lambda, g)|) <= tol, maxima over all entries.

    The first-order conditions of the minimum, at no cost: the next step needs the same numbers. Distances enter as
    |X_i - X_j| - L, whichever form the minimiser works with.

    Parameters
    ----------
    tol
        Greatest residual > 0 [each in its units].
    """

    tol: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "tol", number("tol", self.tol, positive=True))

    def at(self, point: Point) -> bool:
        return point.residual() <= self.tol

    def words(self) -> str:
        return f"a residual of {self.tol:.2g}"


@dataclass(frozen=True)
class RelativeMove(Stop):
    """|z_{n+1} - z_n| / dtau <= eps |z_n|, Euclidean norms of all coordinates  (3.24).

    It looks at the last move, not at the minimum. The move is a step size times the gradient, and so the gradient that
    it leaves is eps |z| over that step size: for ``DampedArrowHurwicz`` without constraints and with c = 2/dtau it is
    2 eps |z| / (alpha dtau) (Remark 3.6, which prints eps/alpha). It depends on the origin of the coordinates.

    Parameters
    ----------
    eps
        Greatest move of a step relative to the coordinates, > 0 [1 / units of dtau].
    """

    eps: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "eps", number("eps", self.eps, positive=True))

    def after(self, before: NDArray[np.float64], x: NDArray[np.float64], dtau: float) -> bool:
        return float(np.linalg.norm(x - before)) <= dtau * self.eps * float(np.linalg.norm(before))

    def words(self) -> str:
        return f"a relative move of {self.eps:.2g}"
