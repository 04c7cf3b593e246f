"""From event to event: one run with one tolerance."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from dincl.checks import bounded
from dincl.errors import StepFailure
from dincl.norms import longest
from dincl.projection.daqp import Daqp
from dincl.projection.feasible import FeasibleSet
from dincl.status import Status
from dincl.trajectory import Event
from tests.twins.events.choice import TOUCHING, Chooser, ContactChoice
from tests.twins.events.held import Held
from tests.twins.events.pieces import DensePiece, Pieces
from tests.twins.events.watch import NextEvent, Watch

if TYPE_CHECKING:
    from numpy.typing import NDArray
    from scipy.integrate import DOP853

    from dincl.constraints.selection import Name
    from dincl.problem import Problem
    from dincl.work import Work
    from tests.twins.events.contacts import ContactRows

# The smallest relative tolerance that scipy's integrators take.
LEAST_RTOL = 100 * np.finfo(float).eps
# Of the differences that give the velocities of moving sets, as a part of the run.
SPACING = 1e-3
# Changes of the contacts allowed in one run, and at one and the same time.
MOST_EVENTS = 100_000
MOST_AT_ONCE = 100
# Steps allowed in one run; a hundred discs with 300 events take about a thousand.
MOST_STEPS = 1_000_000


class March:
    """A run of the event-driven scheme to the last of ``times``; what it reached stays when it fails.

    ``tol`` is the local tolerance of the integrator. Into so many ``parts`` at least is the way to the next event or
    kept time divided, and so much shorter are the differences that give velocities of moving sets: runs that differ in
    ``parts`` have no step in common, even where the tolerance does not limit them, so that their distance tells the
    error of the coarser one.

    Attributes
    ----------
    now, t, x
        The time reached, kept times and states (N, d) so far.
    between, events
        The dense output and the events so far.
    """

    def __init__(self, problem: Problem, times: NDArray[np.float64], tol: float, parts: int, work: Work) -> None:
        self.problem, self._times, self._tol, self._parts, self._work = problem, times, tol, parts, work
        # A problem all at the origin has no size of its own; then coordinates are compared with 1.
        self._size = longest(problem.x0) or 1.0
        self._chooser = Chooser(problem, self._size, SPACING * float(times[-1]) / parts, work)
        self.now = 0.0
        self.t: list[float] = []
        self.x: list[NDArray[np.float64]] = []
        self.between = Pieces(problem, TOUCHING * self._size)
        self.events: list[Event] = []
        self._flat, self._steps = problem.x0.ravel(), 0
        self._closed: frozenset[Name] = frozenset()

    def run(self) -> None:
        """March to the end; StepFailure if that fails."""
        self._flat = self._start()
        if self._times[0] == 0:
            self._keep()
        at_once = 0
        for count in range(MOST_EVENTS):
            before = self.now
            choice = self._chooser.choose(self.now, self._state)
            self._record(choice, first=count == 0)
            held = Held(choice.held, self._size, self._work)
            self._flat = held.corrected(self.now, self._flat)
            if not self._piece(held, choice):
                return
            at_once = at_once + 1 if self.now <= before else 0
            if at_once == MOST_AT_ONCE:
                raise StepFailure(Status.NOT_CONVERGED, f"{at_once} changes of the contacts at one time.")
        raise StepFailure(Status.NOT_CONVERGED, f"More than {MOST_EVENTS} changes of the contacts.")

    @property
    def _state(self) -> NDArray[np.float64]:
        return self._flat.reshape(self.problem.x0.shape)

    def _start(self) -> NDArray[np.float64]:
        """x0, put onto S if it lies outside by more than rounding."""
        violation = self.problem.violation(0.0, self.problem.x0)
        allowed = TOUCHING * self._size
        if violation <= allowed:
            return self.problem.x0.ravel()
        feasible = FeasibleSet(self.problem, Daqp(allowed).solver(), self._work, linearised=False)
        return feasible.nearest(0.0, self.problem.x0, self.problem.x0, violation).point.ravel()

    def keep_last(self) -> None:
        """Keep the state reached by a run that failed."""
        if not self.t or self.t[-1] < self.now:
            self._keep()

    def _keep(self) -> None:
        self.t.append(self.now)
        self.x.append(self._state)

    def _record(self, choice: ContactChoice, *, first: bool) -> None:
        """The changes of the closed contacts, but for those at the start."""
        if not first:
            changes = [(name, "contact") for name in sorted(choice.closed - self._closed)]
            changes += [(name, "release") for name in sorted(self._closed - choice.closed)]
            self.events += [Event(self.now, kind, *name) for name, kind in changes]
        self._closed = choice.closed

    def _piece(self, held: Held, choice: ContactChoice) -> bool:
        """The motion with these contacts until an event; False when it reaches the last time instead."""
        first_step = None
        for bound in self._times[len(self.t) :]:
            if bound > self.now:
                solver = self._solver(held, float(bound), first_step)
                while solver.status == "running":
                    if self._step(solver, held, choice):
                        return True
                first_step = solver.h_abs
                self.now, self._flat = float(bound), held.corrected(float(bound), solver.y)
            self._keep()
        return False

    def _solver(self, held: Held, bound: float, first_step: float | None = None) -> DOP853:
        from scipy.integrate import DOP853

        longest_step = (bound - self.now) / self._parts
        if first_step is not None:
            first_step = min(first_step / self._parts, longest_step)
        return DOP853(
            held.rate,
            self.now,
            self._flat,
            bound,
            rtol=max(self._tol, LEAST_RTOL),
            atol=max(self._tol, np.finfo(float).eps * self._size),
            first_step=first_step,
            max_step=longest_step,
        )

    def _step(self, solver: DOP853, held: Held, choice: ContactChoice) -> bool:
        """One step; when an event lies within, the state at the event instead."""
        self._advance(solver)
        dense = solver.dense_output()
        watch = Watch(held, choice, self._size, dense)
        found = watch.first(solver.t_old, solver.t)
        if found is None:
            self.between.pieces.append(DensePiece(solver.t, dense, held))
            self.now, self._flat = solver.t, solver.y
            return False
        self._arrive(found, held)
        return True

    def _advance(self, solver: DOP853) -> None:
        message = solver.step()
        self._work.steps += 1
        self._steps += 1
        if self._steps > MOST_STEPS:
            raise StepFailure(Status.NOT_CONVERGED, f"More than {MOST_STEPS} steps.")
        if solver.status == "failed" or not bounded(solver.y):
            raise StepFailure(Status.NOT_CONVERGED, f"The integrator stopped: {message or 'a number overflowed'}.")

    def _arrive(self, found: NextEvent, held: Held) -> None:
        """Go to the event; for a gap also the way that is left, which is as short as the dense output is accurate."""
        start = self.now
        pieces = self._integrate(held, found.t)
        if found.closing is not None:
            wait = max(_wait(found.closing, held, self.now, self._flat), start - self.now)
            self._flat = self._flat + wait * held.rate(self.now, self._flat)
            self.now += wait
        self._flat = held.corrected(self.now, self._flat)
        self.between.pieces.extend(pieces[:-1])
        self.between.pieces.extend(piece._replace(end=self.now) for piece in pieces[-1:])

    def _integrate(self, held: Held, end: float) -> list[DensePiece]:
        """Steps from here to ``end``, without looking for events."""
        pieces: list[DensePiece] = []
        if end <= self.now:
            return pieces
        solver = self._solver(held, end, end - self.now)
        while solver.status == "running":
            self._advance(solver)
            pieces.append(DensePiece(solver.t, solver.dense_output(), held))
        self.now, self._flat = end, solver.y
        return pieces


def _wait(closing: ContactRows, held: Held, t: float, flat: NDArray[np.float64]) -> float:
    """How long from t until this gap closes, by one Newton step; 0 if it does not close [time]."""
    x = flat.reshape(closing.problem.x0.shape)
    unit, length, least = closing.gradients(t, x)
    gap = float((closing.values(t, x) / length)[0])
    speed = float((unit @ held.rate(t, flat) - least)[0])
    return -gap / speed if speed < 0 else 0.0
