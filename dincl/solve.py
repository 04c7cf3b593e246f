"""The function ``solve``."""

from __future__ import annotations

from dataclasses import fields
from typing import TYPE_CHECKING

from dincl import checks
from dincl.checks import describe, flag, instance
from dincl.errors import InvalidProblem
from dincl.problem import Problem
from dincl.schemes.base import Scheme
from dincl.trajectory import RunOutcome, StepFailed, Trajectory

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import ArrayLike, NDArray


def solve(problem: Problem, scheme: Scheme, t: ArrayLike, *, throw: bool = True) -> Trajectory:
    """Approximate x' in F(t, x) - N(S, x), x(0) = x0, by ``scheme``.

    Parameters
    ----------
    problem, scheme
        The inclusion and the numerical method.
    t
        Output times, shape (K,), K >= 1, >= 0, increasing; the last one ends the run. Time steps are the fewest equal
        ones of at most ``scheme.dt`` that end there; an output time between two steps is interpolated (1.48).
    throw
        Whether a run that fails raises; otherwise its Trajectory is returned with the Status.

    Raises
    ------
    InvalidProblem
        For times that are not increasing, or a scheme that does not fit the problem.
    StepFailed
        When a step fails and ``throw`` is true; ``trajectory`` has everything until then. Its cause is the failure of
        the step: a FunctionFailed if a function of the user failed, whose cause is the error that the function raised.
    """
    instance("problem", problem, Problem, "a dincl.Problem")
    instance("scheme", scheme, Scheme, "a scheme such as PBD(dt=1e-3)")
    raises = flag("throw", throw)
    times = checks.times("t", t)
    outcome = _run(problem, scheme, times)
    if not isinstance(outcome, RunOutcome):
        raise InvalidProblem(f"scheme: {type(scheme).__name__}.run returned {describe(outcome)}: must be a RunOutcome")
    names = {part.name for part in fields(outcome)} - {"failure", "scheme"}
    parts = {name: getattr(outcome, name) for name in names}
    trajectory = Trajectory(problem=problem, scheme=outcome.scheme or scheme, **parts)
    if raises and not trajectory.status:
        raise StepFailed(trajectory) from outcome.failure
    return trajectory


def _run(problem: Problem, scheme: Scheme, times: NDArray[np.float64]) -> RunOutcome:
    """Run a scheme, in scaled coordinates if there are mobilities."""
    if problem.mobility is None:
        return scheme.run(problem, times)
    from dincl.mobility import in_scaled_coordinates, unscaled

    scaled, scaling = in_scaled_coordinates(problem)
    return unscaled(scheme.run(scaled, times), scaling)
