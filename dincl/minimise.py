"""Minimisers of an energy over a set: the Arrow-Hurwicz method, its damped form, and Uzawa's; ``minimise``."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray

from dincl.checks import bounded, flag, instance, integer, number
from dincl.constants import LARGEST
from dincl.constraints.selection import Candidates, Selection, transfer_multipliers
from dincl.errors import StepFailure
from dincl.matrices import combined, stacked
from dincl.norms import longest
from dincl.problem import Problem
from dincl.rows.base import RowsOfOneKind, StackedRows
from dincl.status import Status
from dincl.work import Work

if TYPE_CHECKING:
    from scipy.sparse import csr_array

Floats = NDArray[np.float64]
Slope = Callable[[Floats], Floats]
# Steps after which an iteration ends unless another limit is given.
LIMIT = 100_000
# Tolerance of the inner problem of Uzawa's method relative to the outer one, and its Newton steps at most.
INNER, MOST_STEPS = 0.1, 100
# Doublings and bisections of a step; 2^60 spans all lengths that matter.
MOST_LENGTHS = 60
# Greatest slope along a step at its end, relative to that at its beginning.
FLAT = 0.9
# Tolerance of Newton's equations relative to their right side, unless that is smaller itself.
FORCING = 0.1
# Relative spacing of difference quotients, which balances rounding and curvature.
QUOTIENT = math.sqrt(np.finfo(np.float64).eps)


@dataclass(frozen=True)
class Stop(ABC):
    """A rule that ends an iteration; ``limit`` of the minimiser ends it if the rule does not."""

    @abstractmethod
    def at(self, point: Point) -> bool:
        """Return whether a point with its multipliers meets the rule."""

    def after(self, before: Floats, x: Floats, dtau: float) -> bool:
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
        return max(point.residuals()) <= self.tol


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

    def after(self, before: Floats, x: Floats, dtau: float) -> bool:
        return float(np.linalg.norm(x - before)) <= dtau * self.eps * float(np.linalg.norm(before))


class Point(NamedTuple):
    """An iterate with everything that its step and its residual need.

    ``gaps`` (m,) are the g of the problem, ``values`` the g that the iteration works with, ``steepness`` the ratio of
    their gradients; ``multipliers`` belong to ``values``; ``jacobian`` has the rows where ``active``: multiplier > 0.
    """

    x: Floats
    gradient: Floats
    gaps: Floats
    values: Floats
    steepness: Floats
    multipliers: Floats
    active: NDArray[np.bool_]
    jacobian: csr_array

    def reaction(self, multipliers: Floats) -> Floats:
        """Sum multipliers_k grad g_k over the active rows, shape (N, d)."""
        return combined(self.jacobian, multipliers[self.active]).reshape(self.x.shape)

    def residuals(self) -> tuple[float, float, float]:
        """Compute stationarity, violation of the rows at hand, and complementarity as in ``Minimum``."""
        slope = float(np.abs(self.gradient - self.reaction(self.multipliers)).max())
        both = np.minimum(self.steepness * self.multipliers, self.gaps)
        return slope, float(np.max(-self.gaps, initial=0.0)), float(np.max(np.abs(both), initial=0.0))


class Iterate:
    """The present and the previous point (N, d), starting at x0, and multipliers (m,), starting at zero; all finite.

    It has the rows near x, among them all that have a multiplier; others have zero.

    Where distances are taken squared, a row g = sign (|X_i - X_j| - L) is replaced by sign (|X_i - X_j|^2 - L^2), which
    is >= 0 just where g is. The gradient is 2 |X_i - X_j| times as long; the multipliers of g are that many times
    larger.
    """

    def __init__(self, problem: Problem, minimiser: Minimiser) -> None:
        self.problem = problem
        self.work = Work(degrees_of_freedom=problem.x0.size)
        self.x = self.previous = problem.x0
        self._squared, self._ahead = minimiser.squared, minimiser.ahead
        self._candidates = Candidates(problem.constraints, self.work)
        self._list(self._candidates.select(0.0, self.x, 0.0), np.zeros(0))

    def _list(self, selection: Selection, multipliers: Floats) -> None:
        """Take the rows of a selection, and their multipliers; none: zero."""
        self._selection, self.blocks = selection, selection.at(0.0).blocks
        self.multipliers = multipliers if multipliers.size else np.zeros(len(selection))

    def gradient(self, x: Floats) -> Floats:
        """Evaluate grad W = -F(0, x), and count it."""
        self.work.drift_evaluations += 1
        return -self.problem.velocity(0.0, x)

    def point(self) -> Point:
        """Evaluate everything that belongs to the present x and multipliers."""
        gradient, active = self.gradient(self.x), self.multipliers > 0
        gaps, values, steepness = self.values(self.x)
        jacobian = self.jacobian(self.take(active), self.x)
        return Point(self.x, gradient, gaps, values, steepness, self.multipliers, active, jacobian)

    def set_multipliers(self, multipliers: Floats) -> None:
        """Take new multipliers (m,), in the order of the rows."""
        if not bounded(multipliers):
            raise StepFailure(Status.NON_FINITE, f"A multiplier exceeds {LARGEST:g}.")
        self.multipliers = multipliers

    def move(self, x: Floats) -> None:
        """Go to a new x, and list the rows near it; their multipliers change places with the rows."""
        if not bounded(x):
            raise StepFailure(Status.NON_FINITE, f"A coordinate is not a number, or exceeds {LARGEST:g} in magnitude.")
        self.previous, self.x = self.x, x
        radius = self._ahead * longest(x - self.previous)
        while (near := self._candidates.select(0.0, x, radius)) is not self._selection:
            held = self.multipliers > 0
            multipliers = transfer_multipliers(self._selection, self.multipliers, near)
            if np.count_nonzero(multipliers) == np.count_nonzero(held):
                self._list(near, multipliers)
                break
            radius = max(2 * radius, float(self.values(x)[0][held].max()))

    def values(self, x: Floats) -> tuple[Floats, Floats, Floats]:
        """Evaluate g, the values that the iteration works with, and the ratio of their gradients, each (m,)."""
        gaps, steepness = [block.values(x) for block in self.blocks], self.steepness(x)
        values = gaps
        if self._squared:
            each = zip(self.blocks, gaps, self._parts(steepness), strict=True)
            values = [block.squared_values(own, length) for block, own, length in each]
        return np.concatenate([np.zeros(0), *gaps]), np.concatenate([np.zeros(0), *values]), steepness

    def steepness(self, x: Floats) -> Floats:
        """Compute by how much the gradients of the values are longer than the gradients of g, shape (m,)."""
        if not self._squared:
            return np.ones(len(self.multipliers))
        return np.concatenate([np.zeros(0), *(block.squared_steepness(x) for block in self.blocks)])

    def take(self, keep: NDArray[np.bool_]) -> list[RowsOfOneKind]:
        """Select the rows where ``keep`` is true, block after block."""
        chosen = zip(self.blocks, self._parts(keep), strict=True)
        return [block.take(part) for block, part in chosen if part.any()]

    def jacobian(self, blocks: list[RowsOfOneKind], x: Floats) -> csr_array:
        """Evaluate the gradients at x of some of the rows, in the form that the iteration works with."""
        found = [block.squared_jacobian(x) if self._squared else block.jacobian(x) for block in blocks]
        return stacked(found, self.problem.x0.size)

    def _parts(self, values: NDArray[Any]) -> list[NDArray[Any]]:
        """Cut an array of all rows into those of the blocks."""
        return np.split(values, np.cumsum([len(block) for block in self.blocks]))[:-1]


class Minimiser(ABC):
    """A method that finds a local minimum of an energy over a set, an argument of ``minimise``.

    ``stop`` is the rule that ends it; it ends after ``limit`` steps in any case.
    """

    stop: Stop
    limit: int
    # Whether distances are taken squared, the length of a step in (3.24), and the moves of the present length that a
    # list of near rows lasts for.
    squared: bool = False
    dtau: float
    ahead: ClassVar[float] = 4.0

    @abstractmethod
    def advance(self, iterate: Iterate, point: Point) -> None:
        """Move the iterate on from its ``point``; StepFailure if that cannot be done."""

    def _check(self, *positive: str) -> None:
        """Raise InvalidProblem unless these fields are numbers > 0 and the others can be fields of a minimiser."""
        for name in positive:
            object.__setattr__(self, name, number(name, getattr(self, name), positive=True))
        instance("stop", self.stop, Stop, "Stationary(tol) or RelativeMove(eps)")
        integer("limit", self.limit, least=1)
        flag("squared", self.squared)


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
    dtau: float = field(default=1.0, init=False, repr=False)

    def __post_init__(self) -> None:
        self._check("alpha", "beta")

    def advance(self, iterate: Iterate, point: Point) -> None:
        iterate.move(point.x - self.alpha * (point.gradient - point.reaction(point.multipliers)))
        iterate.set_multipliers(np.maximum(0.0, iterate.multipliers - self.beta * iterate.values(iterate.x)[1]))


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
        self._check("alpha", "beta", "damping", "dtau")

    @classmethod
    def published(cls, limit: int = LIMIT) -> DampedArrowHurwicz:
        """Return the method with the parameters of Table 4 of chapter 3, distances squared."""
        return cls(1e-4, 0.25, 1e-3, 2.0, 1.0, RelativeMove(1e-6), limit, squared=True)

    def advance(self, iterate: Iterate, point: Point) -> None:
        a = self.damping * self.dtau / 2
        weights = point.multipliers * (self.alpha - self.gamma * point.values)
        p = self.dtau**2 * (self.alpha * point.gradient - point.reaction(weights))
        x = (2 * point.x - (1 - a) * iterate.previous - p) / (1 + a)
        # The rows may change with x, so the multipliers that belong to the present rows come first.
        iterate.set_multipliers(np.maximum(0.0, point.multipliers - self.dtau * self.beta * point.values))
        iterate.move(x)


@dataclass(frozen=True)
class Uzawa(Minimiser):
    """z_{k+1} = argmin_z W(z) - lambda_k . g(z),  lambda_{k+1} = max(0, lambda_k - step g(z_{k+1})).

    Section 1.1 of the appendix, for inequalities: there B x = g, here B x - g >= 0, hence the other sign of lambda and
    max(0, .). For W = x^T A x / 2 - f . x with A positive definite it converges for 0 < step < 2 / |B A^{-1} B^T|.
    It needs a minimum of the Lagrangian for each lambda: not so for energies that are linear, and distances are not
    squared, since W - lambda |X_i - X_j|^2 is soon unbounded below.

    The inner problem is solved by Newton's method with conjugate gradients, downhill from z_k. Where the Lagrangian
    is not convex this is a local minimum, which may jump or vanish when lambda changes.

    Parameters
    ----------
    step
        Step size > 0 of the ascent.
    stop
        ``Stationary(tol)``; the inner problem is solved to a tenth of tol.
    limit
        The largest number of steps.
    """

    step: float
    stop: Stationary
    limit: int = LIMIT
    dtau: float = field(default=1.0, init=False, repr=False)
    # Moves are long at first: rows are listed for where the point is, not for where it may go.
    ahead: ClassVar[float] = 0.0

    def __post_init__(self) -> None:
        instance("stop", self.stop, Stationary, "Stationary(tol)")
        self._check("step")

    def advance(self, iterate: Iterate, point: Point) -> None:
        blocks, weights = iterate.take(point.active), point.multipliers[point.active]

        def slope(flat: Floats) -> Floats:
            """Evaluate grad W - sum_k lambda_k grad g_k over the rows that have a multiplier."""
            x = flat.reshape(point.x.shape)
            return iterate.gradient(x).ravel() - combined(iterate.jacobian(blocks, x), weights)

        flat, steps = free_minimum(slope, point.x.ravel(), INNER * self.stop.tol)
        iterate.work.count_call("newton_cg", steps)
        iterate.move(flat.reshape(point.x.shape))
        iterate.set_multipliers(np.maximum(0.0, iterate.multipliers - self.step * iterate.values(iterate.x)[0]))


def free_minimum(slope: Slope, x: Floats, tol: float) -> tuple[Floats, int]:
    """Find a point near x (n,) where max |slope| <= tol, for slope = grad f, going downhill in f; count the steps.

    Newton's method with conjugate gradients, from gradients alone: a Problem does not define its energy. StepFailure
    where f is unbounded below or the steps do not end.
    """
    gradient = slope(x)
    for k in range(MOST_STEPS):
        if float(np.abs(gradient).max()) <= tol:
            return x, k
        x, gradient = _along(slope, x, gradient, _direction(slope, x, gradient))
    raise StepFailure(Status.NOT_CONVERGED, f"The Lagrangian was not minimised in {MOST_STEPS} Newton steps.")


def _direction(slope: Slope, x: Floats, gradient: Floats) -> Floats:
    """Solve H step = -gradient by conjugate gradients, which end early at a direction without curvature."""
    size = float(np.linalg.norm(gradient))
    scale = QUOTIENT * (1 + float(np.linalg.norm(x)))
    step, rest, d = np.zeros_like(x), -gradient, -gradient
    for _ in range(2 * x.size):
        length = scale / float(np.linalg.norm(d))
        bent = (slope(x + length * d) - gradient) / length
        curvature = float(d @ bent)
        if curvature <= 0:
            return step if step.any() else d
        before = float(rest @ rest)
        step = step + before / curvature * d
        rest = rest - before / curvature * bent
        if float(np.linalg.norm(rest)) <= min(FORCING, size) * size:
            break
        d = rest + float(rest @ rest) / before * d
    return step


def _along(slope: Slope, x: Floats, gradient: Floats, d: Floats) -> tuple[Floats, Floats]:
    """Double or bisect t until |slope . d| at x + t d is at most FLAT of its value at x; return x + t d and slope."""
    steep = -float(gradient @ d)
    short, t, far = 0.0, 1.0, math.inf
    for _ in range(MOST_LENGTHS):
        there = x + t * d
        if not bounded(there):
            break
        after = slope(there)
        along = float(after @ d)
        if abs(along) <= FLAT * steep:
            return there, after
        if along < 0:
            short, t = t, 2 * t if far == math.inf else (t + far) / 2
        else:
            far, t = t, (short + t) / 2
    raise StepFailure(Status.NOT_CONVERGED, "The Lagrangian has no minimum for the present multipliers.")


@dataclass(frozen=True, eq=False)
class Minimum:
    """A point x and multipliers >= 0 with, up to the residuals, grad W = J^T multipliers, g >= 0, multipliers . g = 0.

    Attributes
    ----------
    x
        Shape (N, d); after a failure the last iterate of finite numbers.
    rows, families, multipliers
        The rows near x, for each the index of its constraint in the problem, shape (m,), and its multiplier >= 0, shape
        (m,). Rows of the problem that are not among them have the multiplier zero.
    status, detail
        How the iteration ended, and the particulars in words ("" when its rule was met).
    iterations
        Steps made.
    stats
        The counted work.
    stationarity, violation, complementarity
        max |grad W - J^T multipliers|, max_k max(0, -g_k), max_k |min(multipliers_k, g_k)|, recomputed from the
        problem; infinite where they are not defined.
    """

    x: Floats
    rows: StackedRows
    families: NDArray[np.int64]
    multipliers: Floats
    status: Status
    detail: str
    iterations: int
    stats: Work
    problem: Problem
    minimiser: Minimiser
    stationarity: float
    violation: float
    complementarity: float

    @property
    def residual(self) -> float:
        """The largest of the three residuals."""
        return max(self.stationarity, self.violation, self.complementarity)

    def reactions(self) -> dict[tuple[int, str], float]:
        """Return the multipliers > 0, by the index of their constraint in the problem and the row in words."""
        d = self.x.shape[1]
        labels = [block.label(k, d) for block in self.rows.blocks for k in range(len(block))]
        found = zip(self.families.tolist(), labels, self.multipliers.tolist(), strict=True)
        return {(family, label): multiplier for family, label, multiplier in found if multiplier > 0}

    def __repr__(self) -> str:
        how = f"{self.status.name}, {type(self.minimiser).__name__}, {self.iterations} iterations"
        return f"Minimum({how}, residual = {self.residual:.2g})"


class MinimisationFailed(RuntimeError):
    """An iteration that did not meet its rule; ``minimum`` has its last point, with its Status."""

    def __init__(self, minimum: Minimum) -> None:
        super().__init__(f"{minimum.status.name}: {minimum.detail}")
        self.minimum = minimum


def minimise(problem: Problem, minimiser: Minimiser, *, throw: bool = True) -> Minimum:
    """Find a local minimum of W over S = {x : g(x) >= 0} near the start of the problem  (3.18), (3.19).

    Parameters
    ----------
    problem
        Its drift must be F(0, x) = -grad W(x); W itself is not needed. Sets that move are taken at t = 0.
    minimiser
        The method, e.g. ``DampedArrowHurwicz``.
    throw
        Whether an iteration that does not meet its rule raises; otherwise its Minimum is returned with the Status:
        NOT_CONVERGED at the limit of steps, NON_FINITE when it leaves the finite numbers, or why a step failed.

    Raises
    ------
    InvalidProblem
        For arguments of the wrong type.
    MinimisationFailed
        When the rule was not met and ``throw`` is true; ``minimum`` has the last point.
    """
    instance("problem", problem, Problem, "a dincl.Problem")
    instance("minimiser", minimiser, Minimiser, "a minimiser such as DampedArrowHurwicz")
    raises = flag("throw", throw)
    status, detail, cause = Status.SUCCESS, "", None
    # Numbers that overflow end the iteration with a Status of their own.
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        iterate, rule = Iterate(problem, minimiser), minimiser.stop
        try:
            for _ in range(minimiser.limit):
                point = iterate.point()
                if rule.at(point):
                    break
                minimiser.advance(iterate, point)
                iterate.work.steps += 1
                if rule.after(iterate.previous, iterate.x, minimiser.dtau):
                    break
            else:
                if not rule.at(iterate.point()):
                    status, detail = Status.NOT_CONVERGED, f"{rule} was not met."
        except StepFailure as failure:
            status, detail, cause = failure.status, failure.detail, failure
        found = _result(iterate, minimiser, status, detail)
    if raises and not status:
        raise MinimisationFailed(found) from cause
    return found


def _result(iterate: Iterate, minimiser: Minimiser, status: Status, detail: str) -> Minimum:
    """Compute the residuals anew."""
    problem, x, steps = iterate.problem, iterate.x, iterate.work.steps
    multipliers, violation = iterate.multipliers * iterate.steepness(x), problem.violation(0.0, x)
    try:
        stationarity, _, complementarity = iterate.point().residuals()
    except StepFailure:
        stationarity = complementarity = math.inf
    if not status:
        residual = max(stationarity, violation, complementarity)
        detail = f"{detail} After {steps} of at most {minimiser.limit} steps the residual is {residual:.2g}."
    rows, work = StackedRows(iterate.blocks, x.size), iterate.work
    families = np.repeat(np.arange(len(rows.blocks)), [len(block) for block in rows.blocks])
    parts = (x, rows, families, multipliers, status, detail, steps, work, problem, minimiser)
    return Minimum(*parts, stationarity, violation, complementarity)
