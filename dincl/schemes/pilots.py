"""Short runs of several methods on one problem, which predict what each of them costs for an error."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from contextlib import suppress
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
from dincl.schemes.resolution import FALLS, distance_outside, stable_step
from dincl.status import Status

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from dincl.problem import Problem
    from dincl.schemes.base import Scheme
    from dincl.trajectory import RunOutcome

# The first pilot run has so many steps; each further one of a method twice as many.
FIRST = 8
# A run has at most this many times as many steps as the one before it, from which its number was predicted.
FARTHEST = 4
# ... and at least so many: the difference of two runs that are nearer to each other says little.
NEAREST = 1.4
# An error is estimated from so many runs at least, and from this many differences at most.
LEAST_RUNS, MOST_DIFFERENCES = 4, 3
# On random scenes the error was below this many times its estimate in 95 of 100 cases (``Pilot.estimate``).
SAFETY = 1.6
# In 90 of 100 it was more than the estimate divided by this.
TYPICAL = 8.0
# The estimate falls with an order between this part of the order in smooth motion and all of it.
LEAST_ORDER = 0.7
# The predicted run aims at this part of the error asked for, so that it seldom has to be repeated.
AIM = 0.85
# Tolerance of a projection, relative to the error asked for.
PROJECTION = 1e-3
# The event-driven method is tried on this part of the run; each further method for at most this part of the predicted
# cost of the best one.
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


def limited(problem: Problem, seconds: float) -> Problem:
    """Return the problem with a drift that raises OutOfBudgetError after so many seconds of CPU time from now."""
    began = time.process_time()
    return with_counted_drift(problem, lambda _: time.process_time() - began > seconds)[0]


def left_out(candidate: Candidate, setting: float, why: str) -> Forecast:
    """Return the forecast of a method that is out."""
    return Forecast(candidate.label, setting, math.nan, math.nan, math.nan, math.inf, why)


def candidates(problem: Problem, error: float) -> tuple[Candidate, ...]:
    """Return the methods that are worth a pilot run for this problem, those with the cheapest steps first."""
    tol = PROJECTION * error
    projection = ActiveSet(tol) if len(problem.x0) <= MOST_DENSE else ProjectedCG(tol)
    return (
        Candidate("PBD", PBD, 1),
        Candidate("linearised catch-up", lambda dt: LinearisedCatchUp(dt, projection), 1),
        Candidate("midpoint catch-up", lambda dt: MidpointCatchUp(dt, projection), 2),
        Candidate("event-driven", EventDriven, 0),
    )


@dataclass(eq=False)
class Pilot:
    """The pilot runs of one method with equal steps: ``steps`` ascending, their states and CPU times.

    ``longest`` is the longest step that resolves all functions of time, ``tried`` the CPU time that the first two runs
    may take, ``unfinished`` whether they took longer.
    """

    problem: Problem
    candidate: Candidate
    times: NDArray[np.float64]
    error: float
    longest: float = math.inf
    steps: list[int] = field(default_factory=list)
    outcomes: list[RunOutcome] = field(default_factory=list)
    seconds: list[float] = field(default_factory=list)
    outside: list[float] = field(default_factory=list)  # of each run: ``distance_outside``
    why: str = ""
    final: bool = False  # whether finer steps cannot mend the failure in ``why``
    tried: float = 0.0
    unfinished: bool = False
    stable: float = math.inf  # of the finest run: ``stable_step``, once there are runs enough to believe one

    def run(self, steps: int) -> RunOutcome | None:
        """Make the run with so many steps; None, and the reason in ``why``, if it fails."""
        began = time.process_time()
        try:
            outcome = self.candidate.make(float(self.times[-1]) / steps).run(self.problem, self.times)
        except InvalidProblem as refusal:
            self.why, self.final = str(refusal), True
            return None
        seconds = time.process_time() - began
        if not outcome.status or len(outcome.t) < len(self.times):
            self.why = f"{outcome.status.name} with {steps} steps: {outcome.detail}"
            self.final = outcome.status is Status.DRIFT_FAILED
            return None
        outside = distance_outside(self.problem, outcome.t, outcome.x)
        if not math.isfinite(outside):
            self.why = f"a constraint is not defined at its states with {steps} steps, as where two centres coincide"
            return None
        self.why = ""
        self.steps.append(steps)
        self.outcomes.append(outcome)
        self.seconds.append(seconds)
        self.outside.append(outside)
        if len(self.steps) >= LEAST_RUNS - 1:
            self.stable = stable_step(self.problem, outcome.t, outcome.x)
        if self.is_contradicted():
            self.final = True
            self.why = (
                f"its states are {self.outside[-1]:.2g} outside of the set with {steps} steps, "
                f"{self.outside[-2]:.2g} with {self.steps[-2]}: the set may be empty, or jump"
            )
            return None
        return outcome

    def begin(self, limit: float) -> None:
        """Make the first two runs, for at most so many seconds of CPU time in all."""
        whole, self.tried = self.problem, limit
        self.problem = limited(whole, limit)
        try:
            for _ in range(2 - len(self.steps)):
                self.refine()
            self.unfinished = False
        except OutOfBudgetError:
            self.unfinished, self.why = True, f"takes more than {limit:.2g} s for {FIRST} and {2 * FIRST} steps"
        finally:
            self.problem = whole

    def refine(self) -> None:
        """Make one of the first runs, or one nearer to the prediction; repeat one that fails with finer steps."""
        steps = FIRST
        if 0 < len(self.steps) < LEAST_RUNS - 1:
            steps = 2 * self.steps[-1]
        elif self.steps:
            steps = min(round(float(self.times[-1]) / self.forecast().setting), FARTHEST * self.steps[-1])
        for _ in range(MOST_RUNS):
            if self.run(steps) is not None or self.final:
                return
            steps *= 2

    def differences(self) -> list[float]:
        """Return max_i |X_i - Y_i| over all times of each run and the next one."""
        pairs = zip(self.outcomes, self.outcomes[1:], strict=False)
        return [float(norms((a.x - b.x).reshape(-1, a.x.shape[-1])).max()) for a, b in pairs]

    def estimate(self) -> tuple[float, float]:
        """Return the estimated error of the finest run, and the observed order.

        A run with r n steps that differs from the one with n by m has an error of m / (r - 1) if the order is one, and
        less if it is higher. Events come at any part of a step, so that a single difference can be small by chance: of
        the last differences, scaled to the finest run with the order in smooth motion, the largest counts. The error
        is at least the distance of the states from the set.
        """
        order, moved = self.candidate.order, self.differences()[-MOST_DIFFERENCES:]
        steps = self.steps[-len(moved) - 1 :]
        scaled = [
            m / (fine / coarse - 1) * (fine / steps[-1]) ** order
            for m, coarse, fine in zip(moved, steps, steps[1:], strict=False)
        ]
        observed = float(order)
        if len(moved) > 1 and min(moved[0], moved[-1]) > 0:
            first, last = (m / (b / a - 1) for m, a, b in ((moved[0], *steps[:2]), (moved[-1], *steps[-2:])))
            observed = math.log(first / last) / math.log(steps[-1] / steps[1])
        return max(*scaled, self.outside[-1] / SAFETY), min(max(observed, LEAST_ORDER * order), float(order))

    def is_done(self) -> bool:
        """Return whether the finest run has the error asked for."""
        if len(self.steps) < LEAST_RUNS or self.why or SAFETY * self.estimate()[0] > self.error:
            return False
        return self.steps[-1] >= self.least_steps()

    def least_steps(self) -> int:
        """Return how many steps resolve functions of time, and are stable at the states of the finest run."""
        return math.ceil(float(self.times[-1]) / min(self.longest, self.stable))

    def is_contradicted(self) -> bool:
        """Return whether the runs agree better with each other than with the set, and finer steps do not mend it."""
        if len(self.steps) < LEAST_RUNS - 1:
            return False
        return self.outside[-1] > max(self.error, SAFETY * self.differences()[-1], FALLS * self.outside[-2])

    def is_within_reach(self) -> bool:
        """Return whether the next run is the predicted one."""
        steps = round(float(self.times[-1]) / self.forecast().setting)
        return self.is_done() or (len(self.steps) > 2 and steps <= FARTHEST * self.steps[-1])

    def forecast(self) -> Forecast:
        """Predict the step for the error asked for, and the cost of what is left to run."""
        if self.why or len(self.steps) < 2:
            return left_out(self.candidate, math.nan, self.why)
        (found, order), finest = self.estimate(), self.steps[-1]
        if self.is_done():
            return self._forecast(finest, found, 0.0)
        # No further than to too many steps, of which the number may overflow.
        finer = min(found * SAFETY / (AIM * self.error), float(MOST_STEPS) ** order) ** (1 / order)
        steps = max(
            math.ceil(finest * finer),
            math.ceil(NEAREST * finest),
            self.least_steps(),
        )
        if steps > MOST_STEPS and len(self.steps) < BELIEVED:
            steps = MOST_STEPS
        if steps > MOST_STEPS:
            return left_out(self.candidate, math.nan, f"needs {steps:.1e} steps, more than {MOST_STEPS:.0e}")
        rate = max((self.seconds[-1] - self.seconds[0]) / (finest - self.steps[0]), 0.5 * self.seconds[-1] / finest)
        return self._forecast(steps, found * (finest / steps) ** order, self.seconds[0] + rate * steps)

    def _forecast(self, steps: int, error: float, seconds: float) -> Forecast:
        setting = float(self.times[-1]) / steps
        return Forecast(self.candidate.label, setting, error, error / TYPICAL, SAFETY * error, seconds)


def warm_up(problem: Problem, candidate: Candidate, times: NDArray[np.float64], error: float) -> None:
    """Make one step of a method, once in a process: to load compiled code belongs to no cost."""
    name = (candidate.label, problem.x0.shape[1])
    if name in _WARM:
        return
    _WARM.add(name)
    with suppress(InvalidProblem):  # the first run says why
        scheme = candidate.make(1e-6 * float(times[-1]) if candidate.order else error)
        scheme.run(problem, 1e-6 * times[-1:])


def event_driven(
    problem: Problem, candidate: Candidate, times: NDArray[np.float64], error: float, limit: float
) -> Forecast:
    """Predict the cost of the event-driven method from the first part of the run, made for at most so many seconds."""
    if len(problem.x0) > MOST_PARTICLES:
        return left_out(candidate, error, f"serves at most {MOST_PARTICLES} particles")
    began = time.process_time()
    try:
        outcome = candidate.make(error).run(limited(problem, limit), PART * times[-1:])
    except InvalidProblem as refusal:
        return left_out(candidate, error, str(refusal))
    except OutOfBudgetError:
        return left_out(candidate, error, f"takes more than {limit / PART:.2g} s")
    seconds = time.process_time() - began
    if not outcome.status:
        return left_out(candidate, error, f"{outcome.status.name}: {outcome.detail}")
    return Forecast(candidate.label, error, error, 0.0, error, seconds / PART)
