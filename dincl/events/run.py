"""From event to event: one run with one tolerance."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

import numpy as np

from dincl.compiled.structs import written
from dincl.constants import LARGEST
from dincl.errors import StepFailure
from dincl.events import integrate as kernels
from dincl.events.arrays import STATE, Path, begin_march, room_for_path
from dincl.events.choice import TOUCHING
from dincl.events.gram_room import gram_room
from dincl.events.jumps import MOST_JUMPS
from dincl.events.path import PathPieces
from dincl.events.runge_kutta import pair_for
from dincl.events.steps import NO_STEP, STUCK
from dincl.matrices import row_squares
from dincl.norms import longest
from dincl.projection.active_set import ActiveSet
from dincl.projection.feasible import FeasibleSet
from dincl.run.outcome import Event
from dincl.status import Status
from dincl.system.compiled_problem import CompiledProblem
from dincl.system.units import units_of

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from dincl.problem import Problem
    from dincl.work import Work

# Of the differences that give the velocities of moving sets, as a part of the run.
SPACING = 1e-3
# Changes of the contacts allowed in one run.
MOST_EVENTS = 100_000
# Steps in the first call of a kernel; as many more in each call as keep it shorter than this [s].
FEWEST, SHORT = 64, 0.02
# More particles than these meet so often that steps are short: they are of order 5, and at an event a step is cut, at
# its dense output, in place of being repeated. With 200 discs and tol = 1e-8 this takes 0.28 of the evaluations.
MANY = 100
# How a kernel ends a run too early.
ENDS = {
    STUCK: (Status.NOT_CONVERGED, f"More than {kernels.MOST_AT_ONCE} changes of the contacts at one time."),
    NO_STEP: (
        Status.NOT_CONVERGED,
        "The integrator stopped: its step became too short, or a number overflowed.",
    ),
    kernels.SLOW: (
        Status.TOO_MANY_STEPS,
        f"The run would need more than {kernels.MOST_STEPS} steps, as its last {kernels.LOOK} tell: the drift is "
        "stiff, has noise, or jumps again and again.",
    ),
    kernels.JUMPS: (
        Status.TOO_MANY_STEPS,
        f"The drift jumped more than {MOST_JUMPS} times: from one side of a state to the other, so that none is a "
        "velocity there.",
    ),
}


def size_of(problem: Problem, end: float) -> float:
    """The largest distance of a particle from the origin [length].

    Where all particles are at the origin, how far they are from the nearest set or go until ``end``, whichever is less;
    1 for a problem that has no size at all.
    """
    x0 = problem.x0
    found = longest(x0)
    if found > 0:
        return found
    rows = problem.rows_within(0.0, x0, np.inf)
    slopes = np.sqrt(row_squares(rows.jacobian(x0)))
    gaps = rows.values(x0) / np.where(slopes > 0, slopes, 1.0)
    ways = [end * longest(problem.velocity(0.0, x0)), *gaps]
    return min((float(way) for way in ways if way > 0), default=1.0)


class EventSystem:
    """A problem as runs until ``end`` see it: in units in which its size and the time are about 1.

    Attributes
    ----------
    size
        Of the problem [length].
    small
        The compiled form.
    gram
        Room for factors.
    """

    def __init__(self, problem: Problem, end: float) -> None:
        self.size = size_of(problem, end)
        self.small = CompiledProblem(problem, units=units_of(self.size, end))
        self.small.sets.find_kinks(end)
        self.gram = gram_room(self.small.arrays)

    def start(self, work: Work) -> NDArray[np.float64]:
        """x0 (N, d), put onto S if it lies outside by more than rounding."""
        problem, allowed = self.small.problem, TOUCHING * self.size
        violation = float(self.small.overlaps(np.zeros(1), problem.x0[None])[0])
        if violation <= allowed:
            return problem.x0
        feasible = FeasibleSet(problem, ActiveSet(allowed).solver(), work, linearised=False)
        return feasible.nearest(0.0, problem.x0, problem.x0, violation).point


class EventRun:
    """A run of the event-driven scheme from ``start`` (N, d) to ``end``; what it reached stays when it fails.

    ``tol`` is the local tolerance of the integrator. Into so many ``parts`` at least is the way to the end, or to the
    next event, divided, and so much shorter are the differences that give velocities of moving sets: runs that differ
    in ``parts`` have no step in common, even where the tolerance does not limit them, so that their distance tells the
    error of the coarser one.

    Attributes
    ----------
    between
        The dense output so far.
    """

    def __init__(
        self, system: EventSystem, start: NDArray[np.float64], end: float, tol: float, parts: int, work: Work
    ) -> None:
        self._system, self._work, self._steps = system.small, work, 0
        self._units = unit = system.small.units
        small, x = system.small, start.ravel() / unit.length
        small.sets.spacing = SPACING * end / parts or SPACING
        size, kinks = system.size / unit.length, small.sets.kinks.ravel() / unit.time
        many = len(start) > MANY
        pair = pair_for(tol / system.size, many)
        n, m, most = x.size, len(small.arrays.rows.row), len(small.arrays.chosen.row)
        stop, resume = kinks[:2] if len(kinks) else (end / unit.time, end / unit.time)
        self._state = np.zeros(1, dtype=STATE)
        given = {"end": end / unit.time, "stop": stop, "resume": resume, "tol": tol / unit.length, "size": size}
        given |= {"most": LARGEST * min(1.0, 1.0 / unit.length), "parts": parts, "choose": 1, "cuts": many}
        for name, value in given.items():
            self._state[name] = value
        path = room_for_path(kernels.ROOM * 8, pair.terms, n, most, m)
        self._march = begin_march(
            small.place, system.gram.place, small.arrays, pair, self._state, path, x.copy(), kinks
        )
        self._words = written(self._march)
        self.between = PathPieces(small, system.gram, pair, size, x)
        self._changes: list[NDArray[np.float64]] = []

    @property
    def now(self) -> float:
        """The time reached."""
        return float(self._state["now"][0]) * self._units.time

    @property
    def doubt(self) -> float:
        """How far pushes that were taken for zero can have moved a particle [length]."""
        return float(self._state["doubt"][0]) * self._units.length

    def go(self) -> None:
        """March to the end; StepFailure if that fails."""
        most, code = FEWEST, kernels.FULL
        while code == kernels.FULL:
            began = time.perf_counter()
            with self._system.drift, self._system.sets:
                code = kernels.march_on(int(self._words.ctypes.data), most)
            most = min(2 * most, kernels.MOST_STEPS) if time.perf_counter() - began < SHORT else most
            self._drain()
            self._system.count(self._work)
            if sum(map(len, self._changes)) > MOST_EVENTS:
                raise StepFailure(Status.TOO_MANY_STEPS, f"More than {MOST_EVENTS} changes of the contacts.")
        if code in ENDS:
            raise StepFailure(*ENDS[code])
        if code != kernels.DONE:
            self._system.failure(code)
        if self._system.sets.foreseen is not None:
            raise self._system.sets.foreseen

    @property
    def events(self) -> tuple[Event, ...]:
        """The changes of the contacts so far; those of one time with contacts first, in the order of their names."""
        names, found = self._system.names, []
        for t, row, closes, phase in np.concatenate(self._changes):
            found.append((phase, not closes, names[int(row)], float(t) * self._units.time))
        return tuple(Event(t, "release" if opens else "contact", *name) for _, opens, name, t in sorted(found))

    def state(self) -> NDArray[np.float64]:
        """The state reached, shape (N, d)."""
        return self._march.x.reshape(self._system.problem.x0.shape) * self._units.length

    def _drain(self) -> None:
        """Take the pieces and events out of the room of the kernel."""
        state, path = self._state, self._march.path
        self._work.steps += int(state["steps"][0]) - self._steps
        self._steps = int(state["steps"][0])
        pieces = int(state["pieces"][0])
        widest = int(path.number[:pieces].max(initial=0))
        made = path._replace(held=path.held[:, :widest])
        self.between.add(Path._make(part[:pieces].copy() for part in made), float(state["size"][0]))
        self._changes.append(path.event[: int(state["events"][0])].copy())
        state["pieces"], state["events"] = 0, 0
