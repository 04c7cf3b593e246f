"""The event-driven reference."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np

from dincl.checks import number
from dincl.errors import InvalidProblem, StepFailure
from dincl.norms import longest
from dincl.schemes.base import WHOLE, Scheme, Span, Watch
from dincl.status import Status
from dincl.system.time_scales import CUT
from dincl.trajectory import Between, RunOutcome
from dincl.work import Work

if TYPE_CHECKING:
    from dincl.compiled.arrays import Floats
    from dincl.events.run import EventRun
    from dincl.forces import Reaction
    from dincl.problem import Problem
    from dincl.system.compiled_problem import CompiledProblem

# The tolerance of a step of the first run is this much smaller than that of a state, since a run of many events adds up
# what its steps leave; that of a run is this much smaller than that of the run before it.
FIRST, TIGHTER = 100.0, 10.0
# The table of all pairs of more particles than these is too long.
MOST_PARTICLES = 1000
# Runs at most; from the third on, tolerances of practical size have reached the rounding of the integrator.
MOST_RUNS = 4
# The stated error over the largest distance between the last two runs.
SAFETY = 2.0
# Stated at least, relative to the largest coordinate: what rounding leaves in a state that is put onto its contacts.
ROUNDING = 16 * np.finfo(float).eps
# Times between kept ones at which the last run may not overlap sets that Python evaluates, as parts of the run.
WATCHED = 31
# Stated at least, relative to the tolerance: two runs agree at some times better than their steps allow. This is fifty
# times the tolerance of a step of the second run: by so much a kink of the drift can mislead the estimate of a step.
AGREEMENT = 5e-2


@dataclass(frozen=True)
class EventDriven(Scheme):
    r"""x' = argmin {|v - F(t, x)| : n_k . v >= b_k for all closed contacts k}, from event to event  (1.26), (1.30).

    Between events the contacts that push are fixed, and x' = F + sum_k push_k n_k with n_k . x' = b_k is integrated by
    a Runge-Kutta pair with dense output, of order 3, 5 or 8 as the tolerance and the number of particles ask, and held
    on g_k = 0. An event is a gap that closes, or a push that becomes zero; a step ends there by its dense output, and
    the least-distance program decides anew. Jumps of the drift, of a set and of its velocity are found, and steps end
    at them. Where a set jumps, x(t+) = P_{S(t+)}(x(t-)), the limit of catch-up: contacts that are lost let go, and what
    is outside moves to the nearest point of the set. Numbers are scaled once by powers of two, so that a problem in
    other units makes the same steps. From 32 contacts on, the matrix of the contacts has a sparse factor. Lerner,
    Düring and Wyart (arXiv 1111.7225) go from contact to contact likewise.

    Parameters
    ----------
    tol
        Greatest estimated error of a kept state, max_i |X_i - exact| [length]. The run is repeated with a tighter
        tolerance until it moves by less than half of that; a run that does not get there, because it reaches the
        rounding of its steps, ends NOT_CONVERGED, with its states and their estimate. One that needs more than 100,000
        steps, as a drift with noise or one that is stiff makes it, ends TOO_MANY_STEPS after 5,000 of them.

    ``Trajectory.error`` holds the estimate, with all overlaps in it, ``Trajectory.events`` the events. For at most
    1,000 particles. A run is made in compiled code, and its cost is that of its events times that of a factorisation
    of the contacts: milliseconds for ten discs, a second or two for some hundred, minutes for a thousand. A path of
    1,000 discs takes 90 kB for each of its steps. In piles of 10 to 100 discs it is the cheapest method for errors of
    1e-4 and less, and catch-up for coarser ones; a coarse tolerance costs little less than a fine one, since events are
    as many.
    """

    tol: float = field()

    def __post_init__(self) -> None:
        object.__setattr__(self, "tol", number("tol", self.tol, positive=True))

    def run(self, problem: Problem, times: Floats, span: Span = WHOLE) -> RunOutcome:
        """Two runs or more, each compared with the one before it."""
        from dincl.events.run import EventRun, EventSystem

        if len(problem.x0) > MOST_PARTICLES:
            raise InvalidProblem(f"EventDriven: {len(problem.x0)} particles: serves at most {MOST_PARTICLES}")
        work, end, before = Work(degrees_of_freedom=problem.x0.size), float(times[-1]), None
        try:
            system = EventSystem(problem, times, self.tol, span)
            start = system.start(work)
        except StepFailure as failure:
            return not_begun(problem, work, failure, span.t0)
        coarse: EventRun | None = None
        for k in range(MOST_RUNS):
            watch = None if span.until is None else Watch(span.until, span.t0, start)
            run = EventRun(system, start, end, self.tol / FIRST / TIGHTER**k, 2**k, work, watch)
            try:
                run.integrate()
                kept = times if run.stopped is None else np.append(times[times < run.stopped], run.stopped)
                x = run.between.states(np.concatenate((kept, (np.append(span.t0, kept[:-1]) + kept) / 2)))
                overlap, error = system.compiled.overlaps(kept, x[: len(kept)]), np.full(len(kept), np.inf)
                # A run that stopped at another side of an output time is not compared.
                if before is not None and len(before) == len(x):
                    error = _error(before, x) + AGREEMENT * self.tol + run.neglected + overlap + system.scales.rest
                    if coarse is not None and coarse.stopped is not None and run.stopped is not None:
                        t = min(coarse.stopped, run.stopped)
                        error[-1] += SAFETY * longest(coarse.between.at(t) - run.between.at(t))
                    if error.max() <= self.tol and system.compiled.sets.address:
                        error += _hidden(system.compiled, run, span.t0, float(kept[-1]), self.tol)
            except StepFailure as failure:
                # What is too coarse to order the events of a crowd may stop a run that a finer one passes.
                if failure.status is Status.NOT_CONVERGED and k < MOST_RUNS - 2:
                    before = None
                    continue
                return _failed(run, times, work, failure)
            if error.max() <= self.tol:
                status = Status.SUCCESS if run.stopped is None else Status.STOPPED
                return _outcome(run, kept, x[: len(kept)], work, status, "", error)
            if before is not None and system.scales.rest > self.tol:
                break
            before, coarse = x, run
        detail = (
            f"The estimated error is {error.max():.2g}, asked for was {self.tol:.2g}. {system.scales.detail}".strip()
        )
        return _outcome(run, kept, x[: len(kept)], work, Status.NOT_CONVERGED, detail, error)


@dataclass(frozen=True, eq=False)
class _Start(Between):
    """A run that did not begin: there is x0 (N, d), and no velocity."""

    x0: Floats

    def states(self, times: Floats) -> Floats:
        """x0."""
        return np.tile(self.x0, (len(times), 1, 1))

    def reactions(self, times: Floats) -> list[Reaction | None]:
        """None."""
        return [None] * len(times)


def _hidden(system: CompiledProblem, run: EventRun, start: float, end: float, tol: float) -> float:
    """Return by how much a run overlaps sets that Python evaluates, at times that nobody chooses, if more than tol."""
    times = start + (np.arange(WATCHED) + CUT) / WATCHED * (end - start)
    largest = float(system.overlaps(times, run.between.states(times)).max())
    return largest if largest > tol else 0.0


def _error(coarse: Floats, fine: Floats) -> Floats:
    """SAFETY times the largest distance of two runs (2 K, N, d) at each kept time and halfway to its neighbours.

    A single distance may be small by chance. And what rounding leaves in a state.
    """
    kept, between = np.sqrt(((coarse - fine) ** 2).sum(axis=-1)).max(axis=-1, initial=0.0).reshape(2, -1)
    window = np.max([kept, between, np.append(between[1:], 0.0)], axis=0)
    error: Floats = SAFETY * window + ROUNDING * np.abs(fine[: len(kept)]).max()
    return error


def not_begun(problem: Problem, work: Work, failure: StepFailure, t0: float) -> RunOutcome:
    """The start alone."""
    t, x = np.array([t0]), problem.x0[None].copy()
    detail = f"{failure.detail} This was at the start."
    return RunOutcome(t, x, failure.status, detail, work, _Start(problem.x0), failure=failure)


def _failed(run: EventRun, times: Floats, work: Work, failure: StepFailure) -> RunOutcome:
    """The states kept until a run failed, and the one that it reached; those that cannot be read are left out."""
    reached, x = [], []
    for t in times[times <= run.now].tolist():
        with suppress(StepFailure):
            x.append(run.between.at(t))
            reached.append(t)
    if not reached or reached[-1] < run.now:
        reached.append(run.now)
        x.append(run.state())
    detail = f"{failure.detail} This was after t = {run.now:.6g}."
    return replace(_outcome(run, np.array(reached), np.array(x), work, failure.status, detail), failure=failure)


def _outcome(
    run: EventRun, t: Floats, x: Floats, work: Work, status: Status, detail: str, error: Floats | None = None
) -> RunOutcome:
    events = run.events if run.stopped is None else tuple(one for one in run.events if one.t <= run.stopped)
    return RunOutcome(t.copy(), x, status, detail, work, run.between, events, error)
