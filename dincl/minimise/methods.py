"""Minimisers, the rules that end them, and the two that take a step in the point and one in the multipliers."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from dincl.checks import describe, integer, number
from dincl.errors import InvalidProblem
from dincl.minimise.iterate import Iterate

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from dincl.minimise.iterate import Point
    from dincl.problem import Problem

# Steps after which an iteration ends unless another limit is given.
LIMIT = 100_000
# Methods of small steps list near rows for this many steps of the present length.
AHEAD = 4.0


@dataclass(frozen=True)
class Stop(ABC):
    """A rule that ends an iteration; ``limit`` of the minimiser ends it if the rule does not."""

    @abstractmethod
    def at(self, point: Point) -> bool:
        """Return whether a point with its multipliers meets the rule."""

    def after(self, before: NDArray[np.float64], x: NDArray[np.float64], dtau: float) -> bool:
        """Return whether the step from ``before`` to x, of length ``dtau``, meets the rule."""
        return False


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


@dataclass(frozen=True)
class RelativeMove(Stop):
    """|z_{n+1} - z_n| / dtau <= eps |z_n|, Euclidean norms of all coordinates  (3.24).

    It tests the last move, not the minimum. The move is a step size times the gradient, and so the gradient that
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

    def at(self, point: Point) -> bool:
        return False

    def after(self, before: NDArray[np.float64], x: NDArray[np.float64], dtau: float) -> bool:
        return float(np.linalg.norm(x - before)) <= dtau * self.eps * float(np.linalg.norm(before))


class Minimiser(ABC):
    """A method that finds a local minimum of an energy over a set, an argument of ``minimise``.

    ``stop`` is the rule that ends it; it ends after ``limit`` steps in any case.
    """

    stop: Stop
    limit: int

    @abstractmethod
    def start(self, problem: Problem) -> Iterate:
        """Return the first iterate: x0 of the problem, with multipliers zero."""

    @abstractmethod
    def advance(self, iterate: Iterate, point: Point) -> None:
        """Move the iterate on from its ``point``; StepFailure if that cannot be done."""

    def _check(self, *, positive: tuple[str, ...], squared: bool) -> None:
        """Raise InvalidProblem unless these fields are numbers > 0 and the others can be fields of a minimiser."""
        for name in positive:
            object.__setattr__(self, name, number(name, getattr(self, name), positive=True))
        if not isinstance(self.stop, Stop):
            raise InvalidProblem(f"stop = {describe(self.stop)}: must be Stationary(tol) or RelativeMove(eps)")
        integer("limit", self.limit, least=1)
        if not isinstance(squared, bool):
            raise InvalidProblem(f"squared = {describe(squared)}: must be True or False")


@dataclass(frozen=True)
class ArrowHurwicz(Minimiser):
    """z_{n+1} = z_n - alpha (grad W(z_n) - J(z_n)^T lambda_n),  lambda_{n+1} = max(0, lambda_n - beta g(z_{n+1})).

    Method 3.3 with the signs that the optimality conditions require: as printed, the multiplier of a violated row stays
    zero. With equality constraints it is the nonlinear Uzawa method of section 1.2 of the appendix.

    Near a minimum where the Hessian of the Lagrangian is H, it converges when all pairs (h, j) of eigenvalues of H and
    J^T J with a common eigenvector obey alpha h > 0 and alpha (2 h + beta j) < 4. It does not where h = 0, as for a
    weight on a floor, which oscillates for ever, nor where H is not positive in the directions of the constraints, as
    happens for discs when their distances are squared.

    Parameters
    ----------
    alpha, beta
        Step sizes > 0 of the descent in z and the ascent in lambda.
    stop
        ``Stationary(tol)`` or ``RelativeMove(eps)``.
    limit
        The largest number of steps.
    squared
        Take distances as |X_i - X_j|^2 - L^2 [length^2], as chapter 3 does, in place of |X_i - X_j| - L; the units of
        beta and lambda change accordingly. Other rows stay as they are.
    """

    alpha: float
    beta: float
    stop: Stop
    limit: int = LIMIT
    squared: bool = False

    def __post_init__(self) -> None:
        self._check(positive=("alpha", "beta"), squared=self.squared)

    def start(self, problem: Problem) -> Iterate:
        return Iterate(problem, squared=self.squared, ahead=AHEAD)

    def advance(self, iterate: Iterate, point: Point) -> None:
        iterate.move(point.x - self.alpha * (point.gradient - point.reaction(point.multipliers)))
        _, values, _ = iterate.values(iterate.x)
        iterate.set_multipliers(np.maximum(0.0, iterate.multipliers - self.beta * values))


@dataclass(frozen=True)
class DampedArrowHurwicz(Minimiser):
    """z_{n+1} = (2 z_n - (1 - a) z_{n-1} - dtau^2 p_n) / (1 + a),  lambda_{n+1} = max(0, lambda_n - dtau beta g(z_n)),

    with a = c dtau/2 and p_n = alpha (grad W - J^T lambda_n) + gamma J^T (lambda_n g), all at z_n: Method 3.4, (3.25)
    with max in the place of min. It discretises z'' = -c z' - p, lambda' = -beta g  (3.23), (3.22).

    For c dtau = 2 it is z_{n+1} = z_n - dtau^2 p_n / 2; (3.26) omits the 1/2. Without constraints it converges for
    dtau^2 alpha |D^2 W| < 4, whatever c. At a constraint with multiplier lambda* and curvature h, where the gradient
    has length 1, the system in continuous time is stable just for c (alpha h + gamma lambda*) > alpha beta, and the
    iteration with c dtau = 2 for dtau beta alpha < alpha h + gamma lambda*  (and steps short enough). So a weight on a
    floor comes to rest only if it is heavy enough.

    Parameters
    ----------
    alpha, beta, gamma
        Weights of the descent, of the ascent in lambda, both > 0, and of the term that damps the constraints, >= 0.
    damping, dtau
        c > 0 [1 / units of dtau] and the step dtau > 0.
    stop
        ``RelativeMove(eps)`` is (3.24); ``Stationary(tol)`` requires the minimum itself.
    limit
        The largest number of steps.
    squared
        As in ArrowHurwicz.
    """

    alpha: float
    beta: float
    gamma: float
    damping: float
    dtau: float
    stop: Stop
    limit: int = LIMIT
    squared: bool = False

    def __post_init__(self) -> None:
        object.__setattr__(self, "gamma", number("gamma", self.gamma, non_negative=True))
        self._check(positive=("alpha", "beta", "damping", "dtau"), squared=self.squared)

    @classmethod
    def published(cls, limit: int = LIMIT) -> DampedArrowHurwicz:
        """Return the method with the parameters of Table 4 of chapter 3, distances squared."""
        return cls(1e-4, 0.25, 1e-3, 2.0, 1.0, RelativeMove(1e-6), limit, squared=True)

    def start(self, problem: Problem) -> Iterate:
        return Iterate(problem, squared=self.squared, ahead=AHEAD, dtau=self.dtau)

    def advance(self, iterate: Iterate, point: Point) -> None:
        a = self.damping * self.dtau / 2
        weights = point.multipliers * (self.alpha - self.gamma * point.values)
        p = self.dtau**2 * (self.alpha * point.gradient - point.reaction(weights))
        x = (2 * point.x - (1 - a) * iterate.previous - p) / (1 + a)
        # The rows may change with x, so the multipliers that belong to the present rows come first.
        iterate.set_multipliers(np.maximum(0.0, point.multipliers - self.dtau * self.beta * point.values))
        iterate.move(x)
