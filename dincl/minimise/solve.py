"""The function ``minimise`` and its result: the point, its multipliers, and residuals recomputed from the problem."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from dincl.checks import flag, instance
from dincl.errors import StepFailure
from dincl.matrices import combined
from dincl.minimise.iterate import parts
from dincl.minimise.methods import Minimiser
from dincl.problem import Problem
from dincl.rows.base import StackedRows
from dincl.status import Status

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from dincl.minimise.iterate import Iterate
    from dincl.work import Work


@dataclass(frozen=True, eq=False, repr=False)
class Minimum:
    """A point x and multipliers >= 0 with, up to the residuals, grad W = J^T multipliers, g >= 0, multipliers . g = 0.

    Attributes
    ----------
    x
        Shape (N, d); after a failure the last iterate of finite numbers.
    rows, families, multipliers
        The rows in the last iterate, for each the index of its constraint in the problem, shape (m,), and its
        multiplier >= 0, shape (m,). Rows of the problem that are not among them have the multiplier zero.
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
        iterate = minimiser.start(problem)
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
        if rule.after(iterate.previous, iterate.x, iterate.dtau):
            return True
    return rule.at(iterate.point())


def _result(iterate: Iterate, minimiser: Minimiser, status: Status, detail: str) -> Minimum:
    """Recompute the residuals from the problem; rows that are not in the iterate have no multipliers."""
    problem, x, steps = iterate.problem, iterate.x, iterate.work.steps
    rows = StackedRows(tuple(iterate.blocks), x.size)
    multipliers = iterate.multipliers * iterate.steepness(x)
    stationarity, complementarity, violation = math.inf, math.inf, problem.violation(0.0, x)
    try:
        gradient, reaction = -problem.velocity(0.0, x).ravel(), np.zeros(x.size)
        # Rows without a multiplier need no gradient.
        for block, own in zip(rows.blocks, parts(multipliers, [len(block) for block in rows.blocks]), strict=True):
            reaction += combined(block.take(own > 0).jacobian(x), own[own > 0])
        gaps = rows.values(x)
        stationarity = float(np.abs(gradient - reaction).max())
        complementarity = float(np.max(np.abs(np.minimum(multipliers, gaps)), initial=0.0))
    except StepFailure:
        pass
    if not status:
        residual = max(stationarity, violation, complementarity)
        detail = f"{detail} After {steps} of at most {minimiser.limit} steps the residual is {residual:.2g}."
    return Minimum(
        x=x,
        rows=rows,
        families=iterate.families,
        multipliers=multipliers,
        status=status,
        detail=detail,
        iterations=steps,
        stats=iterate.work,
        problem=problem,
        minimiser=minimiser,
        stationarity=stationarity,
        violation=violation,
        complementarity=complementarity,
    )
