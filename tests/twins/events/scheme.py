"""The event-driven method in plain Python, with other libraries: SciPy integrates, DAQP decides, QR holds."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from dincl.checks import number
from dincl.errors import StepFailure
from dincl.norms import longest
from dincl.schemes.base import Scheme
from dincl.status import Status
from dincl.trajectory import RunOutcome
from dincl.work import Work

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from dincl.problem import Problem
    from tests.twins.events.march import March

# The tolerance of a run is this much smaller than that of the run it is compared with.
TIGHTER = 100.0
# Runs at most; from the third on, tolerances of practical size have reached the rounding of the integrator.
MOST_RUNS = 4
# The stated error over the largest distance between the last two runs.
SAFETY = 2.0
# Stated at least, relative to the largest coordinate: what rounding leaves in a state that is put onto its contacts.
ROUNDING = 16 * np.finfo(float).eps


@dataclass(frozen=True)
class PlainEventDriven(Scheme):
    r"""x' = argmin {|v - F(t, x)| : n_k . v >= b_k for all closed contacts k}, from event to event  (1.26), (1.30).

    Between events the contacts that push are fixed, and x' = F + sum_k push_k n_k with n_k . x' = b_k is integrated by
    the Runge-Kutta pair of order 8 of Dormand and Prince with dense output, and held on g_k = 0. An event is a gap that
    closes, or a push that becomes zero; there the least-distance program decides anew.

    Parameters
    ----------
    tol
        Greatest estimated error of a kept state, max_i |X_i - exact| [length]. The run is repeated with a tighter
        tolerance until it moves by less than half of that; a run that does not get there, because it reaches the
        rounding of its steps, ends NOT_CONVERGED, with its states and their estimate.

    ``Trajectory.error`` holds the estimate, ``Trajectory.events`` the events. For at most a few dozen particles: every
    event costs a dense factorisation.
    """

    tol: float = field()

    def __post_init__(self) -> None:
        object.__setattr__(self, "tol", number("tol", self.tol, positive=True))

    def run(self, problem: Problem, times: NDArray[np.float64]) -> RunOutcome:
        """Two runs or more, each compared with the one before it."""
        from tests.twins.events.march import March

        work = Work(degrees_of_freedom=problem.x0.size)
        before: March | None = None
        for k in range(MOST_RUNS):
            march = March(problem, times, self.tol / TIGHTER**k, 2**k, work)
            try:
                # Numbers that overflow end the run with a Status; the integrator looks at the next number after t = 0.
                with np.errstate(all="ignore"):
                    march.run()
            except StepFailure as failure:
                march.keep_last()
                detail = f"{failure.detail} This was after t = {march.now:.6g}."
                return _outcome(march, work, failure.status, detail)
            if before is not None:
                error = _error(before, march, times)
                if error.max() <= self.tol:
                    return _outcome(march, work, Status.SUCCESS, "", error)
            before = march
        detail = f"The estimated error is {error.max():.2g}, asked for was {self.tol:.2g}."
        return _outcome(march, work, Status.NOT_CONVERGED, detail, error)


def _error(coarse: March, fine: March, times: NDArray[np.float64]) -> NDArray[np.float64]:
    """SAFETY times the largest distance of two runs at each kept time and halfway to its neighbours, and rounding.

    A single distance may be small by chance.
    """
    middle = (np.concatenate(([0.0], times[:-1])) + times) / 2
    kept = _distance(np.array(coarse.x), np.array(fine.x))
    between = _distance(coarse.between.states(middle), fine.between.states(middle))
    window = np.max([kept, between, np.append(between[1:], 0.0)], axis=0)
    error: NDArray[np.float64] = SAFETY * window + ROUNDING * np.abs(np.array(fine.x)).max()
    return error


def _distance(x: NDArray[np.float64], y: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.array([longest(a - b) for a, b in zip(x, y, strict=True)])


def _outcome(
    march: March,
    work: Work,
    status: Status,
    detail: str,
    error: NDArray[np.float64] | None = None,
) -> RunOutcome:
    return RunOutcome(
        t=np.array(march.t),
        x=np.array(march.x),
        status=status,
        detail=detail,
        stats=work,
        between=march.between,
        events=tuple(march.events),
        error=error,
    )
