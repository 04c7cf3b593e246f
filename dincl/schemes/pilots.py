"""Short runs of several methods on one problem, which predict what each of them costs for an error."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from dincl.drifts.counted import OutOfBudgetError
from dincl.errors import InvalidProblem
from dincl.norms import norms
from dincl.problem import with_counted_drift
from dincl.projection import ActiveSet, ProjectedCG
from dincl.schemes.catch_up import LinearisedCatchUp, MidpointCatchUp
from dincl.schemes.event_driven import MOST_PARTICLES, EventDriven
from dincl.schemes.pbd import PBD

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from dincl.problem import Problem
    from dincl.schemes.base import Scheme
    from dincl.trajectory import RunOutcome

# The first pilot run has so many steps; each further one of a method twice as many.
FIRST = 8
# A run has at most this many times as many steps as the one before it, from which its number was predicted.
FARTHEST = 4
# The predicted error is to be this much smaller than the one asked for.
SAFETY = 2.0
# Observed orders lie between this part of the order in smooth motion and all of it: events between two runs mislead.
LEAST_ORDER = 0.4
# Steps are predicted with at least this part of the order in smooth motion.
LIKELY_ORDER = 0.7
# Tolerance of a projection, relative to the error asked for.
PROJECTION = 1e-3
# The event-driven method is tried on this part of the run, for at most this part of the cost of the best other method.
PART, MOST_SHARE = 1 / 8, 0.2
# With more particles a dense active set costs more than conjugate gradients.
MOST_DENSE = 100
# More steps than these are too many, which so many runs may say.
MOST_STEPS, BELIEVED = 10**7, 5
# A run that fails is repeated with finer steps, so often at most.
MOST_RUNS = 6
# Methods whose code is loaded, with the dimension.
_WARM: set[tuple[str, int]] = set()


class Candidate(NamedTuple):
    """A method: ``make(setting)`` is its scheme, for dt or, with ``order`` 0, for the error itself."""

    label: str
    make: Callable[[float], Scheme]
    order: int


class Forecast(NamedTuple):
    """Setting and cost of a method for the error asked for.

    ``setting`` is dt or tol; ``error`` with ``low`` and ``high`` the predicted error [length]; ``seconds`` the CPU time
    of the run; ``why`` says why the method is out, "" if it is not.
    """

    label: str
    setting: float
    error: float
    low: float
    high: float
    seconds: float
    why: str = ""


def left_out(candidate: Candidate, setting: float, why: str) -> Forecast:
    """Return the forecast of a method that is out."""
    return Forecast(candidate.label, setting, math.nan, math.nan, math.nan, math.inf, why)


def candidates(problem: Problem, error: float) -> tuple[Candidate, ...]:
    """Return the methods that are worth a pilot run for this problem."""
    tol = PROJECTION * error
    projection = ActiveSet(tol) if len(problem.x0) <= MOST_DENSE else ProjectedCG(tol)
    return (
        Candidate("midpoint catch-up", lambda dt: MidpointCatchUp(dt, projection), 2),
        Candidate("linearised catch-up", lambda dt: LinearisedCatchUp(dt, projection), 1),
        Candidate("PBD", PBD, 1),
        Candidate("event-driven", EventDriven, 0),
    )


@dataclass
class Pilot:
    """The pilot runs of one method with equal steps: ``steps`` ascending, their states and CPU times."""

    problem: Problem
    candidate: Candidate
    times: NDArray[np.float64]
    error: float
    steps: list[int] = field(default_factory=list)
    outcomes: list[RunOutcome] = field(default_factory=list)
    seconds: list[float] = field(default_factory=list)
    why: str = ""

    def run(self, steps: int) -> RunOutcome | None:
        """Make the run with so many steps; None, and the reason in ``why``, if it fails."""
        began = time.process_time()
        try:
            outcome = self.candidate.make(float(self.times[-1]) / steps).run(self.problem, self.times)
        except InvalidProblem as refusal:
            self.why = str(refusal)
            return None
        seconds = time.process_time() - began
        if not outcome.status or len(outcome.t) < len(self.times):
            self.why = f"{outcome.status.name} with {steps} steps: {outcome.detail}"
            return None
        self.why = ""
        self.steps.append(steps)
        self.outcomes.append(outcome)
        self.seconds.append(seconds)
        return outcome

    def refine(self) -> None:
        """Make one of the first two runs, or one nearer to the prediction; repeat one that fails with finer steps."""
        steps = FIRST
        if len(self.steps) == 1:
            steps = 2 * self.steps[-1]
        elif self.steps:
            steps = min(round(float(self.times[-1]) / self.forecast().setting), FARTHEST * self.steps[-1])
        for _ in range(MOST_RUNS):
            if self.run(steps) is not None or "NOT" not in self.why:
                return
            steps *= 2

    def differences(self) -> list[float]:
        """Return max_i |X_i - Y_i| over all times of each run and the next one."""
        pairs = zip(self.outcomes, self.outcomes[1:], strict=False)
        return [float(norms((a.x - b.x).reshape(-1, a.x.shape[-1])).max()) for a, b in pairs]

    def estimate(self) -> tuple[float, float, float]:
        """Return the error of the finest run by Richardson's estimate, and the least and largest order it may have."""
        moved, top = self.differences(), float(self.candidate.order)
        ratios = [a / b for a, b in zip(self.steps[1:], self.steps, strict=False)]
        least = self.candidate.order * LEAST_ORDER
        if len(moved) > 1 and moved[-1] > 0:
            observed = math.log(max(moved[-2], 1e-300) / moved[-1]) / math.log(ratios[-1])
            least, top = min(max(observed, least), top), min(max(observed, least), top)
        low = max(moved[-1], moved[-2] / ratios[-1] ** (2 * self.candidate.order) if len(moved) > 1 else 0.0)
        return low / (ratios[-1] ** least - 1), least, top

    def is_done(self) -> bool:
        """Return whether the finest run has the error asked for."""
        return len(self.steps) > 1 and not self.why and SAFETY * self.estimate()[0] <= self.error

    def is_within_reach(self) -> bool:
        """Return whether the next run is the predicted one."""
        steps = round(float(self.times[-1]) / self.forecast().setting)
        return self.is_done() or (len(self.steps) > 2 and steps <= FARTHEST * self.steps[-1])

    def forecast(self) -> Forecast:
        """Predict the step for the error asked for, and the cost of what is left to run."""
        if self.why or len(self.steps) < 2:
            return left_out(self.candidate, math.nan, self.why)
        found, least, top = self.estimate()
        finest = self.steps[-1]
        if self.is_done():
            return self._forecast(finest, found, found / SAFETY, found * SAFETY, 0.0)
        order = max(least, LIKELY_ORDER * self.candidate.order)
        steps = math.ceil(finest * (found * SAFETY / self.error) ** (1 / order))
        if steps > MOST_STEPS and len(self.steps) < BELIEVED:
            steps = MOST_STEPS
        if steps > MOST_STEPS:
            return left_out(self.candidate, math.nan, f"needs {steps:.1e} steps, more than {MOST_STEPS:.0e}")
        rate = max((self.seconds[-1] - self.seconds[0]) / (finest - self.steps[0]), 0.5 * self.seconds[-1] / finest)
        ends = [found * (finest / steps) ** power for power in (top, least)]
        return self._forecast(steps, ends[1], ends[0] / SAFETY, ends[1] * SAFETY, self.seconds[0] + rate * steps)

    def _forecast(self, steps: int, error: float, low: float, high: float, seconds: float) -> Forecast:
        return Forecast(self.candidate.label, float(self.times[-1]) / steps, error, low, high, seconds)


def warm_up(problem: Problem, candidate: Candidate, times: NDArray[np.float64], error: float) -> None:
    """Make one step of a method, once in a process: to load compiled code belongs to no cost."""
    name = (candidate.label, problem.x0.shape[1])
    if name in _WARM:
        return
    _WARM.add(name)
    scheme = candidate.make(1e-6 * float(times[-1]) if candidate.order else error)
    scheme.run(problem, 1e-6 * times[-1:])


def event_driven(
    problem: Problem, candidate: Candidate, times: NDArray[np.float64], error: float, limit: float
) -> Forecast:
    """Predict the cost of the event-driven method from the first part of the run, made for at most so many seconds."""
    if len(problem.x0) > MOST_PARTICLES:
        return left_out(candidate, error, f"serves at most {MOST_PARTICLES} particles")
    began = time.process_time()
    limited, _ = with_counted_drift(problem, lambda _: time.process_time() - began > limit)
    try:
        outcome = candidate.make(error).run(limited, PART * times[-1:])
    except OutOfBudgetError:
        return left_out(candidate, error, f"takes more than {limit / PART:.2g} s")
    seconds = time.process_time() - began
    if not outcome.status:
        return left_out(candidate, error, f"{outcome.status.name}: {outcome.detail}")
    return Forecast(candidate.label, error, error, 0.0, error, seconds / PART)
