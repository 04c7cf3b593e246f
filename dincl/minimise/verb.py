"""The user's verb: minimise the energy of a problem over its set."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from dincl.checks import describe, flag
from dincl.errors import InvalidProblem, StepFailure
from dincl.minimise.base import Minimiser
from dincl.minimise.result import MinimisationFailed, Minimum, residuals
from dincl.problem import Problem
from dincl.rows.together import RowsTogether
from dincl.status import Status

if TYPE_CHECKING:
    from dincl.minimise.base import Iteration


def minimise(problem: Problem, minimiser: Minimiser, *, throw: bool = True) -> Minimum:
    """A local minimum of W over S = {x : g(x) >= 0} near the start of the problem  (3.18), (3.19).

    Parameters
    ----------
    problem
        Its drift must be F(0, x) = -grad W(x); W itself is not needed. Sets that move are taken at t = 0.
    minimiser
        How, e.g. ``DampedArrowHurwicz``.
    throw
        Whether an iteration that does not meet its rule raises; otherwise its Minimum comes back with the Status:
        NOT_CONVERGED at the limit of steps, NON_FINITE when it leaves the finite numbers, or why a step failed.

    Raises
    ------
    InvalidProblem
        For arguments of the wrong type.
    MinimisationFailed
        When the rule was not met and ``throw`` is true; ``minimum`` holds the last point.
    """
    if not isinstance(problem, Problem):
        raise InvalidProblem(f"problem = {describe(problem)}: must be a dincl.Problem")
    if not isinstance(minimiser, Minimiser):
        raise InvalidProblem(f"minimiser = {describe(minimiser)}: must be a minimiser such as DampedArrowHurwicz")
    raises = flag("throw", throw)
    # Numbers that overflow end the iteration with a Status of their own.
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        found, cause = _run(problem, minimiser)
    if raises and not found.status:
        raise MinimisationFailed(found) from cause
    return found


def _run(problem: Problem, minimiser: Minimiser) -> tuple[Minimum, StepFailure | None]:
    """The result, and the failure of a step if there was one."""
    status, detail, cause = Status.SUCCESS, "", None
    iteration = minimiser.start(problem)
    try:
        if not _converged(iteration, minimiser):
            status = Status.NOT_CONVERGED
            detail = f"Asked for was {minimiser.stop.words()}."
    except StepFailure as failure:
        status, detail, cause = failure.status, failure.detail, failure
    return _result(iteration, minimiser, status, detail), cause


def _converged(iteration: Iteration, minimiser: Minimiser) -> bool:
    """Make steps until the rule is met, or the limit."""
    rule = minimiser.stop
    for _ in range(minimiser.limit):
        point = iteration.point()
        if rule.at(point):
            return True
        iteration.step(point)
        iteration.work.steps += 1
        if rule.after(point.x, iteration.x, iteration.dtau):
            return True
    return rule.at(iteration.point())


def _result(iteration: Iteration, minimiser: Minimiser, status: Status, detail: str) -> Minimum:
    held, x, steps = iteration.rows, iteration.x, iteration.work.steps
    rows = RowsTogether(tuple(held.blocks), x.size)
    multipliers = held.multipliers * held.steepness(x)
    stationarity, violation, complementarity = residuals(iteration.problem, x, rows, multipliers)
    if not status:
        left = max(stationarity, violation, complementarity)
        detail = f"{detail} After {steps} of at most {minimiser.limit} steps the residual is {left:.2g}."
    return Minimum(
        x=x,
        rows=rows,
        families=held.families,
        multipliers=multipliers,
        status=status,
        detail=detail,
        iterations=steps,
        stats=iteration.work,
        problem=iteration.problem,
        minimiser=minimiser,
        stationarity=stationarity,
        violation=violation,
        complementarity=complementarity,
    )
