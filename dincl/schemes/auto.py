"""To a stated error: passes of adaptive steps until their differences are small, or events where these are cheaper."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, fields, replace
from itertools import pairwise
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from dincl.checks import number
from dincl.drifts.base import OutOfBudgetError
from dincl.errors import InvalidProblem, StepFailure
from dincl.norms import norms
from dincl.problem import with_counted_drift
from dincl.schemes.adaptive import MOST_STEPS, AdaptiveCatchUp, AdaptiveRuns, speed_at_end, stretches
from dincl.schemes.base import WHOLE, Scheme, Span
from dincl.schemes.event_driven import MOST_PARTICLES, EventDriven, not_begun
from dincl.status import Status
from dincl.system.time_scales import time_scales
from dincl.work import Work

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from dincl.problem import Problem
    from dincl.trajectory import RunOutcome

    Floats = NDArray[np.float64]

# Tolerance of the first pass relative to the error asked for, and of a pass relative to the one before.
FIRST, FINER = 12.0, 1 / 4
# Greatest step of the first pass relative to the run, or to the part of it that one polynomial resolves in time. It
# falls as lengths of steps do, so that passes differ whose steps are all as long as they may be.
LONGEST = 1 / 4
# Statuses of a pass that a function of the user ended, and all that no finer pass mends.
USER = (Status.DRIFT_FAILED, Status.CONSTRAINT_FAILED, Status.FUNCTION_FAILED)
FINAL = (*USER, Status.TOO_MANY_STEPS)
# Least number of passes before an error is stated, and greatest numbers of passes and of failed ones.
LEAST, MOST, MOST_FAILED = 3, 12, 3
# Range of the order of the error in the length of steps: it is two, but not at all contacts.
ORDERS = (1.0, 1.5)
# Stated error relative to its estimate. On 57 random scenes of the generator of version 0.9 with 1 to 145 particles no
# error was more than half of the stated one.
SAFETY = 2.5
# Tolerance of a projection, relative to the error asked for.
PROJECTION = 1e-4
# Rounding error of a run, relative to the largest coordinate.
ROUNDING = 16 * float(np.finfo(float).eps)
# Calls in a trial of EventDriven relative to those of further passes, since one call costs it more, and growth of that
# number before the next trial.
TRIAL, AGAIN = 0.15, 4.0
# Costs of EventDriven in evaluations of the drift: its beginning, a call of Python, and each pair of particles in a
# call, since it looks at all pairs.
BEGIN, CALL, PAIR = 300, 10.0, 5e-3


@dataclass(frozen=True)
class Auto(Scheme):
    r"""Passes of ``AdaptiveCatchUp`` to an error, or ``EventDriven`` where that needs less work.

    Each pass has a quarter of the tolerance tau of the one before, so its steps are shorter by r = 2. With the order p
    that the last differences show, between 1 and 3/2, the error of its states x_k is about |x_k - x_{k-1}| / (r^p - 1).
    The larger one of this and of the same for the pass before, scaled to x_k, times a safety, is the error stated. It
    is no less than tau or the distance of x_k from the set, plus what is not resolved of sets that depend on time.
    Passes end once it is at most the error asked for. In between ``EventDriven`` is tried, for a part of the
    evaluations of the drift that further passes would make. Work is counted and never timed: every machine takes the
    same scheme.

    Parameters
    ----------
    error
        Greatest stated error of a state at an output time, max_i |X_i - exact| [length].

    ``Trajectory.scheme`` is the scheme of the last pass, ``Trajectory.error`` its stated error, ``Trajectory.stats``
    the work of all passes and trials. Ends NOT_CONVERGED, with states and the error stated for them, where passes do
    not come to agree, and as its last pass did where passes fail.
    """

    error: float = field()

    def __post_init__(self) -> None:
        object.__setattr__(self, "error", number("error", self.error, positive=True))

    def run(self, problem: Problem, times: Floats, span: Span = WHOLE) -> RunOutcome:
        """Make passes until the error is reached."""
        try:
            return _Passes(problem, times, self.error, span).run()
        except StepFailure as failure:
            return not_begun(problem, Work(degrees_of_freedom=problem.x0.size), failure, span.t0)


class _Pass(NamedTuple):
    tau: float
    outcome: RunOutcome


class _Passes:
    """The passes of one problem, whose adaptive steps are bound once."""

    def __init__(self, problem: Problem, times: Floats, error: float, span: Span) -> None:
        self._problem, self._times, self._error, self._span = problem, times, error, span
        self._scales = time_scales(problem, times, error, span.t0, span.breaks)
        self._work = Work(degrees_of_freedom=problem.x0.size, drift_evaluations=self._scales.evaluations)
        self._runs = AdaptiveRuns(problem, PROJECTION * error, self._scales)
        self._made: list[_Pass] = []
        # Calls for which EventDriven was tried; infinite where it does not serve.
        self._tried = 0.0

    def run(self) -> RunOutcome:
        """Make passes, and try EventDriven between them."""
        tau, failures, detail = FIRST * self._error, 0, ""
        if self._times[-1] == self._span.t0:
            return self._completed(self._pass(tau), np.zeros(len(self._times)), AdaptiveCatchUp(tau))
        for _ in range(MOST):
            last = self._pass(tau)
            if last.status:
                # What stopped at another side of an output time is not compared.
                self._made = [one for one in self._made if len(one.outcome.t) == len(last.t)]
                self._made.append(_Pass(tau, last))
                stated = self._stated()
                if stated.max() <= self._error and len(self._made) >= LEAST:
                    return self._completed(last, stated, AdaptiveCatchUp(tau))
                if self._scales.rest > self._error:
                    detail = f" {self._scales.detail}"
                    break
            else:
                failures, detail = failures + 1, f" A finer pass ended {last.status.name}: {last.detail}"
                if failures > MOST_FAILED or last.status in FINAL:
                    break
            if self._work.steps > MOST_STEPS:
                break
            found = self._events(TRIAL * 2 * _calls(last.stats) * math.sqrt(tau / self._final(tau)))
            if found is not None:
                return found
            tau *= FINER
        if last.status not in USER and self._scales.rest <= self._error:
            found = self._events(math.inf)
            if found is not None:
                return found
        if not self._made:
            return self._completed(last, None, AdaptiveCatchUp(tau))
        detail = f"The stated error is {stated.max():.2g}, asked for was {self._error:.2g}.{detail}"
        best = replace(self._made[-1].outcome, status=Status.NOT_CONVERGED, detail=detail)
        return self._completed(best, stated, AdaptiveCatchUp(self._made[-1].tau))

    def _final(self, tau: float) -> float:
        """Predict the tolerance of the last pass, from the last difference, when one with ``tau`` was made."""
        wanted = min(self._error, FINER * tau)
        if len(self._made) > 1 and self._made[-1].tau == tau:
            _, found, _ = self._estimates()
            wanted = min(wanted, tau * (self._error / max(found.max(), self._error)) ** (2 / ORDERS[1]))
        return wanted

    def _pass(self, tau: float) -> RunOutcome:
        """Make the pass of a tolerance; each of its steps is sqrt(tau) times as long as with tau = 1."""
        part = LONGEST * math.sqrt(tau / (FIRST * self._error))
        made = self._runs.run(self._times, tau, stretches(self._scales, self._times, part), self._span.until)
        self._add(made.stats)
        return made

    def _estimates(self) -> tuple[Floats, Floats, float]:
        """Return the error of the last pass from the last difference but one and from the last, and the order.

        At each time counts the largest difference until then: a single one may be small by chance.
        """
        three = self._made[-3:]
        ratios = [math.sqrt(a.tau / b.tau) for a, b in pairwise(three)]  # of the length of steps
        moved = [np.maximum.accumulate(_apart(a.outcome, b.outcome)) for a, b in pairwise(three)]
        order = ORDERS[1]
        if len(moved) > 1 and min(moved[0][-1], moved[1][-1]) > 0.0:
            order = float(np.clip(math.log(moved[0][-1] / moved[1][-1]) / math.log(ratios[1]), *ORDERS))
        found = [SAFETY * one / (ratio**order - 1) for one, ratio in zip(moved, ratios, strict=True)]
        return found[0] / ratios[-1] ** order, found[-1], order

    def _stated(self) -> Floats:
        """Return the stated error of the last pass at all times; infinite if it is the first one."""
        tau, outcome = self._made[-1]
        if len(self._made) == 1:
            return np.full(len(outcome.t), math.inf)
        before, found, _ = self._estimates()
        rounding = ROUNDING * float(np.abs(outcome.x).max())
        stated = np.maximum(np.maximum(before, found), tau) + self._scales.rest + rounding
        if stated.max() <= self._error:
            stated = np.maximum(stated, distance_outside(self._problem, outcome.t, outcome.x))
        return stated

    def _events(self, calls: float) -> RunOutcome | None:
        """Return the run of EventDriven, if it makes at most so many calls and reaches the error."""
        count = len(self._problem.x0)
        of_call = CALL + count**2 * PAIR
        by_python = any(one.timed for one in self._problem.constraints)
        new = calls - self._scales.evaluations - BEGIN * (of_call if by_python else 1.0)
        if count > MOST_PARTICLES or new <= AGAIN * self._tried:
            return None
        budget = _Budget(calls, of_call)
        limited, drift = with_counted_drift(self._problem, budget)
        self._tried = new
        try:
            found = EventDriven(self._error).run(limited, self._times, self._span)
        except OutOfBudgetError:
            self._work.drift_evaluations += drift.evaluations
            return None
        except InvalidProblem:
            self._tried = math.inf
            return None
        budget.most = math.inf
        self._add(found.stats)
        if not found.status:
            self._tried = math.inf
            return None
        return self._completed(found, found.error, EventDriven(self._error))

    def _add(self, made: Work) -> None:
        for part in fields(made)[1:]:
            value = getattr(made, part.name)
            if part.name == "back_ends":
                value = tuple(name for name in value if name not in self._work.back_ends)
            setattr(self._work, part.name, getattr(self._work, part.name) + value)

    def _completed(self, outcome: RunOutcome, error: Floats | None, scheme: Scheme) -> RunOutcome:
        return replace(outcome, error=error, stats=self._work, scheme=scheme)


@dataclass
class _Budget:
    """Budget of a run: ``most`` evaluations of the drift, or calls of Python, each worth ``of_call`` of them."""

    most: float
    of_call: float
    calls: int = 0

    def __call__(self, evaluations: int) -> bool:
        self.calls += 1
        return max(evaluations, self.of_call * self.calls) > self.most


def _calls(work: Work) -> int:
    """Return how many evaluations of the drift and calls of Python a run made."""
    return work.drift_evaluations + work.callbacks


def _apart(one: RunOutcome, other: RunOutcome) -> Floats:
    """Return max_i |X_i - Y_i| at each time, (K,); where ``until`` ended runs, from stop to stop, and at one time."""
    x, y = one.x, other.x
    found: Floats = norms((x - y).reshape(-1, x.shape[-1])).reshape(len(x), -1).max(axis=1)
    if one.status is Status.STOPPED:
        found[-1] += abs(one.t[-1] - other.t[-1]) * speed_at_end(other)
    return found


def distance_outside(problem: Problem, times: Floats, x: Floats) -> float:
    """Return a lower bound of max_i |X_i - exact| over all times, to first order: a solution stays in the set.

    It is max_k (-g_k) / sum_i |grad_i g_k|, and max_k (-g_k) of rows that no particle can mend.
    """
    largest = 0.0
    for t, state in zip(times, x, strict=True):
        try:
            rows = problem.rows_within(float(t), state, 0.0)
            depth = np.maximum(-rows.values(state), 0.0)
            jacobian = rows.jacobian(state).tocoo()
        except StepFailure:
            return math.inf
        if depth.any():
            particles = jacobian.row * len(state) + jacobian.col // state.shape[1]
            pairs, place = np.unique(particles, return_inverse=True)  # of a row and a particle
            gradients = np.sqrt(np.bincount(place, jacobian.data**2))
            slopes = np.bincount(pairs // len(state), gradients, len(depth))
            largest = max(largest, float((depth / np.where(slopes > 0, slopes, 1.0)).max()))
    return largest
