"""The function ``solve``."""

from __future__ import annotations

import warnings
from contextlib import suppress
from typing import TYPE_CHECKING

import numpy as np

from dincl import checks
from dincl.checks import array, describe, flag, function, instance, number
from dincl.constraints.selection import gradient_lengths, select
from dincl.errors import InvalidProblem, StepFailure
from dincl.problem import Problem, at_end, check_start
from dincl.schemes.base import WHOLE, Scheme, Span, Watch
from dincl.trajectory import RunOutcome, StepFailed, Trajectory

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from dincl.schemes.base import Until


# A run with equalities may end outside of a set by this part of a length, or of the largest coordinate, unwarned.
OFF = 0.1


def solve(
    problem: Problem | Trajectory,
    scheme: Scheme,
    t: ArrayLike,
    *,
    t0: float | None = None,
    breaks: ArrayLike | None = None,
    until: Until | None = None,
    throw: bool = True,
) -> Trajectory:
    """Approximate x' in F(t, x) - N(S, x), x(t0) = x0, by ``scheme``.

    Parameters
    ----------
    problem, scheme
        The inclusion and the numerical method. A Trajectory in place of a problem is continued from its last state,
        with the velocity of second-order schemes; multi-step schemes begin anew. Equal steps of a run in two parts are
        those of one run, to rounding, if dt divides both parts.
    t
        Output times, shape (K,), K >= 1, >= t0, increasing; the last one ends the run. Time steps are the fewest equal
        ones of at most ``scheme.dt`` that end there; an output time between two steps is interpolated (1.48).
    t0
        Time of the start, >= 0, at which x0 is feasible, too; None: 0, or the end of a Trajectory [time].
    breaks
        Times from t0 to the last of ``t``, increasing, shape (B,), at which the drift or a set jumps or has a kink
        [time]. Steps end there, and none reaches across: between two breaks there are the fewest equal steps of at most
        ``scheme.dt``. Breaks that are not named are looked for by ``EventDriven``, ``AdaptiveCatchUp`` and ``Auto``.
    until
        (t, x) -> a number. The run ends where it first changes its sign, or is zero; its sign at the start counts, or
        the first one that is not zero. It is evaluated once after each step; a sign that changes twice in a step is not
        seen. The time is located to rounding, on the straight line of the step or on the dense output, and is the last
        one of the Trajectory, whose status is then STOPPED.
    throw
        Whether a run that fails raises; otherwise its Trajectory is returned with the Status.

    Raises
    ------
    InvalidProblem
        For times that are not increasing, or a scheme that does not fit the problem.
    StepFailed
        When a step fails and ``throw`` is true; ``trajectory`` has everything until then. Its cause is the failure of
        the step: a FunctionFailed if a function of the user failed, whose cause is the error that the function raised.

    Warns
    -----
    UserWarning
        If a run with equalities, but without a stated error, ends outside of a set by a tenth of a length: PBD and
        steps that linearise do not see that sets contradict each other.
    """
    velocity, start = None, 0.0
    if isinstance(problem, Trajectory):
        velocity, start, problem = problem.velocity, float(problem.t[-1]), at_end(problem.problem, problem.final)
        if t0 is not None:
            raise InvalidProblem(f"t0 = {describe(t0)}: must be None where a Trajectory is continued, from its end")
    instance("problem", problem, Problem, "a dincl.Problem, or a Trajectory to continue")
    instance("scheme", scheme, Scheme, "a scheme such as PBD(dt=1e-3)")
    raises = flag("throw", throw)
    if t0 is not None and (start := number("t0", t0, non_negative=True)) > 0.0:
        check_start(problem, start)
    times = checks.times("t", t, start)
    named = () if breaks is None else _breaks(breaks, start, float(times[-1]))
    if until is not None:
        try:
            Watch(function("until", until, "a callable (t, x) -> number"), start, problem.x0)
        except StepFailure as failure:
            raise InvalidProblem(f"until: {failure.detail}") from failure
    outcome = _run(problem, scheme, times, Span(start, named, until, velocity))
    if not isinstance(outcome, RunOutcome):
        raise InvalidProblem(f"scheme: {type(scheme).__name__}.run returned {describe(outcome)}: must be a RunOutcome")
    parts = vars(outcome) | {"failure": None, "scheme": outcome.scheme or scheme}
    trajectory = Trajectory(problem=problem, t0=start, **parts)
    if raises and not trajectory.status:
        raise StepFailed(trajectory) from outcome.failure
    equalities = any(getattr(one, "equality", False) for one in problem.constraints)
    if trajectory.status and trajectory.error is None and equalities:
        _warn_if_outside(trajectory)
    return trajectory


def _warn_if_outside(path: Trajectory) -> None:
    """Warn of the sets of which a row is off at the end by more than OFF."""
    t, x = float(path.t[-1]), path.final
    for index, one in enumerate(path.problem.constraints):
        with suppress(StepFailure):
            (rows,) = select((one,), t, x, 0.0).at(t).blocks
            gaps = np.maximum(-rows.values(x), 0.0) / gradient_lengths(rows, x)  # an equality is two opposite rows
            parts = gaps / getattr(rows, "length", max(float(np.abs(x).max()), 1e-300))
            if parts.max(initial=0.0) > OFF:
                k = int(parts.argmax())
                warnings.warn(
                    f"{rows.label(k, x.shape[1])} is off by {gaps[k]:.2g} at t = {t:.6g} (constraints[{index}], "
                    f"{type(one).__name__}): the sets cannot be met together, or steps are too long; path.violation() "
                    "tells since when.",
                    stacklevel=3,
                )


def _breaks(value: ArrayLike, start: float, end: float) -> tuple[float, ...]:
    """Return times of breaks between start and end; one at either of them, or at another to rounding, needs no step."""
    found = np.atleast_1d(array("breaks", value))
    outside = found.size and (found.min() < start or found.max() > end)
    if found.ndim > 1 or outside or (np.diff(found) <= 0).any():
        raise InvalidProblem(f"breaks = {describe(value)}: must be increasing times from {start:.10g} to {end:.10g}")
    rounding, kept = 8.0 * float(np.finfo(float).eps) * end, [start]
    for t in found.tolist():
        if kept[-1] + rounding < t < end - rounding:
            kept.append(t)
    return tuple(kept[1:])


def _run(problem: Problem, scheme: Scheme, times: NDArray[np.float64], span: Span) -> RunOutcome:
    """Run a scheme, in scaled coordinates if there are mobilities; with a span only where its ``run`` needs it."""
    if problem.mobility is None:
        whole = span[:3] == WHOLE[:3] and span.velocity is None
        return scheme.run(problem, times) if whole else scheme.run(problem, times, span)
    from dincl.mobility import in_scaled_coordinates, scaled_span, unscaled

    scaled, scaling = in_scaled_coordinates(problem)
    return unscaled(_run(scaled, scheme, times, scaled_span(span, scaling)), scaling)
