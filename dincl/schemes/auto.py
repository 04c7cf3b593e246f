"""A scheme that is chosen for the problem: the cheapest one for an error."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, fields, replace
from typing import TYPE_CHECKING

import numpy as np

from dincl.checks import number
from dincl.errors import StepFailure
from dincl.norms import norms
from dincl.schemes.base import Scheme
from dincl.schemes.event_driven import not_begun
from dincl.schemes.pilots import (
    MOST_SHARE,
    SAFETY,
    Candidate,
    Forecast,
    Pilot,
    candidates,
    event_driven,
    left_out,
    warm_up,
)
from dincl.schemes.resolution import resolving_step
from dincl.status import Status
from dincl.work import Work

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from dincl.problem import Problem
    from dincl.trajectory import RunOutcome

# Stated at least, relative to the largest error of a run; and for rounding, relative to the largest coordinate.
LEAST_SHARE, ROUNDING = 0.1, 16 * float(np.finfo(float).eps)
# Why a method that takes the error itself has no forecast yet.
NOT_TRIED = "not tried: another method had reached the error"
# Runs in all, after the first two of each method.
MOST_ROUNDS = 40


@dataclass(frozen=True)
class Auto(Scheme):
    """The cheapest method for an error, found by short runs of PBD, catch-up, midpoint catch-up and ``EventDriven``.

    Each method is run with few steps. The difference of two runs gives its error and its order (Richardson), the CPU
    time of a step its cost. The method whose predicted run is the cheapest is taken; its error is estimated again from
    its result, and the run repeated with smaller steps if it is too large.

    Parameters
    ----------
    error
        Greatest estimated error of a state at an output time, max_i |X_i - exact| [length].

    ``Trajectory.scheme`` is the scheme that was taken, ``Trajectory.error`` the estimate, ``Trajectory.stats`` the work
    of all runs. Ends NOT_CONVERGED, with the states and their estimate, where no method reaches the error.
    """

    error: float = field()

    def __post_init__(self) -> None:
        object.__setattr__(self, "error", number("error", self.error, positive=True))

    def run(self, problem: Problem, times: NDArray[np.float64]) -> RunOutcome:
        """Choose a method, and run it."""
        try:
            return Choice(problem, times, self.error, candidates(problem, self.error)).run()
        except StepFailure as failure:
            return not_begun(problem, Work(degrees_of_freedom=problem.x0.size), failure)


class Choice:
    """The choice among methods for one problem, by pilot runs that become finer while no other method is cheaper."""

    def __init__(
        self, problem: Problem, times: NDArray[np.float64], error: float, methods: Sequence[Candidate]
    ) -> None:
        self._problem, self._times, self._error = problem, times, error
        longest = resolving_step(problem, times, error)
        self.pilots = [Pilot(problem, method, times, error, longest) for method in methods if method.order]
        # Of each method that takes the error itself: its forecast, and the seconds that it was tried for.
        self._events = [(method, left_out(method, error, NOT_TRIED), 0.0) for method in methods if not method.order]

    def begin(self, share: float | None = None) -> None:
        """Make the first two runs of each method, on request for at most a share of the predicted cost of the best one.

        The first method, whose steps are the cheapest, is begun in any case.
        """
        for pilot in self.pilots:
            limit = math.inf if share is None else share * self.forecasts[0].seconds
            if (pilot.unfinished or not (pilot.steps or pilot.why)) and limit > 2 * pilot.tried:
                warm_up(self._problem, pilot.candidate, self._times, self._error)
                pilot.begin(limit)

    @property
    def forecasts(self) -> list[Forecast]:
        """The forecast of each method, the cheapest first."""
        found = [*(one for _, one, _ in self._events), *(pilot.forecast() for pilot in self.pilots)]
        return sorted(found, key=lambda one: one.seconds)

    def refine(self) -> None:
        """Refine until the next run would be the one of the best method."""
        self.begin()
        for _ in range(MOST_ROUNDS):
            self.try_events()
            best = self.forecasts[0]
            pilot = next((one for one in self.pilots if one.candidate.label == best.label), None)
            if pilot is None or pilot.why or pilot.is_within_reach():
                return
            pilot.refine()

    def run(self) -> RunOutcome:
        """Run the best method, and return its result with its estimated error."""
        for _ in range(MOST_ROUNDS):
            self.begin(MOST_SHARE)
            self.try_events()
            best = self.forecasts[0]
            if not np.isfinite(best.seconds):
                raise StepFailure(Status.NOT_CONVERGED, f"No method reaches the error: {best.label}: {best.why}")
            for k, (method, forecast, _) in enumerate(self._events):
                if forecast is best:
                    outcome = method.make(self._error).run(self._problem, self._times)
                    if outcome.status:
                        return self._completed(outcome, outcome.error, method.make(self._error))
                    failed = best._replace(seconds=np.inf, why=f"{outcome.status.name}: {outcome.detail}")
                    self._events[k] = (method, failed, np.inf)
            for pilot in self.pilots:
                if pilot.candidate.label != best.label:
                    continue
                if pilot.is_done():
                    scheme = pilot.candidate.make(float(self._times[-1]) / pilot.steps[-1])
                    return self._completed(pilot.outcomes[-1], _errors(pilot), scheme)
                pilot.refine()
        raise StepFailure(Status.NOT_CONVERGED, f"No method reached the error in {MOST_ROUNDS} runs.")

    def try_events(self) -> None:
        """Try event-driven methods on a part of the run, for a share of what the best other method costs."""
        limit = MOST_SHARE * min([pilot.forecast().seconds for pilot in self.pilots], default=np.inf)
        for k, (method, forecast, tried) in enumerate(self._events):
            if not np.isfinite(forecast.seconds) and limit > 2 * tried:
                warm_up(self._problem, method, self._times, self._error)
                self._events[k] = (method, event_driven(self._problem, method, self._times, self._error, limit), limit)

    def _completed(self, outcome: RunOutcome, error: NDArray[np.float64] | None, scheme: Scheme) -> RunOutcome:
        work = Work(degrees_of_freedom=outcome.stats.degrees_of_freedom)
        runs = [one for pilot in self.pilots for one in pilot.outcomes]
        for one in [*runs, *([] if any(outcome.stats is run.stats for run in runs) else [outcome])]:
            for part in fields(work)[1:]:
                setattr(work, part.name, getattr(work, part.name) + getattr(one.stats, part.name))
        return replace(outcome, error=error, stats=work, scheme=scheme)


def _errors(pilot: Pilot) -> NDArray[np.float64]:
    """Return the estimated errors of the finest run at all times, the largest one scaled to Richardson's estimate.

    At each time counts the largest difference until then: a single one may be small by chance.
    """
    fine, coarse = pilot.outcomes[-1].x, pilot.outcomes[-2].x
    moved = norms((fine - coarse).reshape(-1, fine.shape[-1])).reshape(len(fine), -1).max(axis=1)
    moved = np.maximum.accumulate(moved)
    found = SAFETY * pilot.estimate()[0]
    scaled = moved * (found / max(float(moved.max()), 1e-300))
    errors: NDArray[np.float64] = np.maximum(scaled, LEAST_SHARE * found) + ROUNDING * float(np.abs(fine).max())
    return errors
