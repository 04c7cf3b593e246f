"""The user's verb: solve a problem by a scheme and keep the states asked for."""

from __future__ import annotations

from dataclasses import fields
from typing import TYPE_CHECKING

import numpy as np

from dincl.checks import array, describe, flag
from dincl.errors import InvalidProblem
from dincl.problem import Problem
from dincl.schemes.base import Scheme
from dincl.trajectory import RunOutcome, StepFailed, Trajectory

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray


def solve(problem: Problem, scheme: Scheme, t: ArrayLike, *, throw: bool = True) -> Trajectory:
    """Approximate x' in F(t, x) - N(S, x), x(0) = x0, by ``scheme``.

    Parameters
    ----------
    problem, scheme
        What to solve, and how.
    t
        Times to keep, shape (K,), K >= 1, >= 0, increasing; the last one ends the run. Time steps are the fewest equal
        ones of at most ``scheme.dt`` that end there; a kept time between two steps is interpolated (1.48).
    throw
        Whether a run that fails raises; otherwise its Trajectory comes back with the Status.

    Raises
    ------
    InvalidProblem
        For times that are not increasing, or a scheme that cannot serve the problem.
    StepFailed
        When a step fails and ``throw`` is true; ``trajectory`` holds all until then. Its cause is the failure of the
        step: a FunctionFailed if a function of the user failed, and the cause of that is what the function raised.
    """
    if not isinstance(problem, Problem):
        raise InvalidProblem(f"problem = {describe(problem)}: must be a dincl.Problem")
    if not isinstance(scheme, Scheme):
        raise InvalidProblem(f"scheme = {describe(scheme)}: must be a scheme such as PBD(dt=1e-3)")
    raises = flag("throw", throw)
    outcome = scheme.run(problem, _times(t))
    if not isinstance(outcome, RunOutcome):
        raise InvalidProblem(f"scheme: {type(scheme).__name__}.run returned {describe(outcome)}: must be a RunOutcome")
    parts = {part.name: getattr(outcome, part.name) for part in fields(outcome) if part.name != "failure"}
    trajectory = Trajectory(problem=problem, scheme=scheme, **parts)
    if raises and not trajectory.status:
        raise StepFailed(trajectory) from outcome.failure
    return trajectory


def _times(t: ArrayLike) -> NDArray[np.float64]:
    times = np.atleast_1d(array("t", t))
    if times.ndim != 1 or times.size == 0 or times[0] < 0 or (np.diff(times) <= 0).any():
        raise InvalidProblem(f"t = {describe(t)}: must be one or more increasing times >= 0")
    return times
