"""The function ``minimise``, its iteration and its result: the point, its multipliers, and residuals."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from dincl.checks import bounded, flag, instance
from dincl.constants import LARGEST
from dincl.constraints.selection import Candidates, transfer_multipliers
from dincl.errors import StepFailure
from dincl.matrices import combined, stacked
from dincl.minimise.methods import Minimiser
from dincl.norms import longest
from dincl.problem import Problem
from dincl.rows.base import StackedRows
from dincl.status import Status
from dincl.work import Work

if TYPE_CHECKING:
    from numpy.typing import NDArray
    from scipy.sparse import csr_array

    from dincl.constraints.selection import Selection
    from dincl.rows.base import RowsOfOneKind


@dataclass(frozen=True, eq=False, repr=False)
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

    x: NDArray[np.float64]
    rows: StackedRows
    families: NDArray[np.int64]
    multipliers: NDArray[np.float64]
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
        iterate = Iterate(problem, minimiser)
        try:
            if not _converged(iterate, minimiser):
                status, detail = Status.NOT_CONVERGED, f"{minimiser.stop} was not met."
        except StepFailure as failure:
            status, detail, cause = failure.status, failure.detail, failure
        found = _result(iterate, minimiser, status, detail)
    if raises and not status:
        raise MinimisationFailed(found) from cause
    return found


def _converged(iterate: Iterate, minimiser: Minimiser) -> bool:
    """Make steps until the rule is met, or the limit."""
    rule = minimiser.stop
    for _ in range(minimiser.limit):
        point = iterate.point()
        if rule.at(point):
            return True
        minimiser.advance(iterate, point)
        iterate.work.steps += 1
        if rule.after(iterate.previous, iterate.x, minimiser.dtau):
            return True
    return rule.at(iterate.point())


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
    parts_of = (x, rows, iterate.families, multipliers, status, detail, steps, work, problem, minimiser)
    return Minimum(*parts_of, stationarity, violation, complementarity)


class Point(NamedTuple):
    """An iterate with everything that its step and its residual need.

    ``gaps`` (m,) are the g of the problem, ``values`` the g that the iteration works with, ``steepness`` the ratio of
    their gradients; ``multipliers`` belong to ``values``; ``jacobian`` has the rows where ``active``: multiplier > 0.
    """

    x: NDArray[np.float64]
    gradient: NDArray[np.float64]
    gaps: NDArray[np.float64]
    values: NDArray[np.float64]
    steepness: NDArray[np.float64]
    multipliers: NDArray[np.float64]
    active: NDArray[np.bool_]
    jacobian: csr_array

    def reaction(self, multipliers: NDArray[np.float64]) -> NDArray[np.float64]:
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

    def _list(self, selection: Selection, multipliers: NDArray[np.float64]) -> None:
        """Take the rows of a selection, and their multipliers; none: zero."""
        self._selection, self.blocks = selection, selection.at(0.0).blocks
        self.multipliers = multipliers if multipliers.size else np.zeros(len(selection))

    @property
    def families(self) -> NDArray[np.int64]:
        """For each row the index of its constraint, shape (m,)."""
        return np.repeat(np.arange(len(self.blocks)), [len(block) for block in self.blocks])

    def gradient(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
        """Evaluate grad W = -F(0, x), and count it."""
        self.work.drift_evaluations += 1
        return -self.problem.velocity(0.0, x)

    def point(self) -> Point:
        """Evaluate everything that belongs to the present x and multipliers."""
        gradient, active = self.gradient(self.x), self.multipliers > 0
        gaps, values, steepness = self.values(self.x)
        jacobian = self.jacobian(self.take(active), self.x)
        return Point(self.x, gradient, gaps, values, steepness, self.multipliers, active, jacobian)

    def set_multipliers(self, multipliers: NDArray[np.float64]) -> None:
        """Take new multipliers (m,), in the order of the rows."""
        if not bounded(multipliers):
            raise StepFailure(Status.NON_FINITE, f"A multiplier exceeds {LARGEST:g}.")
        self.multipliers = multipliers

    def move(self, x: NDArray[np.float64]) -> None:
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

    def values(self, x: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
        """Evaluate g, the values that the iteration works with, and the ratio of their gradients, each (m,)."""
        gaps, steepness = [block.values(x) for block in self.blocks], self.steepness(x)
        values = gaps
        if self._squared:
            each = zip(self.blocks, gaps, self._parts(steepness), strict=True)
            values = [block.squared_values(own, length) for block, own, length in each]
        return np.concatenate([np.zeros(0), *gaps]), np.concatenate([np.zeros(0), *values]), steepness

    def steepness(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
        """Compute by how much the gradients of the values are longer than the gradients of g, shape (m,)."""
        if not self._squared:
            return np.ones(len(self.multipliers))
        return np.concatenate([np.zeros(0), *(block.squared_steepness(x) for block in self.blocks)])

    def take(self, keep: NDArray[np.bool_]) -> list[RowsOfOneKind]:
        """Select the rows where ``keep`` is true, block after block."""
        chosen = zip(self.blocks, self._parts(keep), strict=True)
        return [block.take(part) for block, part in chosen if part.any()]

    def jacobian(self, blocks: list[RowsOfOneKind], x: NDArray[np.float64]) -> csr_array:
        """Evaluate the gradients at x of some of the rows, in the form that the iteration works with."""
        found = [block.squared_jacobian(x) if self._squared else block.jacobian(x) for block in blocks]
        return stacked(found, self.problem.x0.size)

    def _parts(self, values: NDArray[Any]) -> list[NDArray[Any]]:
        """Cut an array of all rows into those of the blocks."""
        return np.split(values, np.cumsum([len(block) for block in self.blocks]))[:-1]
