"""From event to event: one run with one tolerance."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

import numpy as np

from dincl.errors import StepFailure
from dincl.events.pairs import pair_for
from dincl.events.path import PathPieces
from dincl.kernels import events as kernels
from dincl.kernels.choice import TOUCHING
from dincl.kernels.handles import written
from dincl.kernels.march import STATE, Path, begin_march, room_for_path
from dincl.norms import longest
from dincl.projection.active_set import ActiveSet
from dincl.projection.feasible import FeasibleSet
from dincl.run.outcome import Event
from dincl.run.small import SmallSystem
from dincl.status import Status

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from dincl.problem import Problem
    from dincl.work import Work

# Of the differences that give the velocities of moving sets, as a part of the run.
SPACING = 1e-3
# Changes of the contacts allowed in one run, and steps: a hundred discs with 300 events take about a thousand.
MOST_EVENTS, MOST_STEPS = 100_000, 1_000_000
# Steps in the first call of a kernel; as many more in each call as keep it shorter than this [s].
FEWEST, SHORT = 64, 0.02


def size_of(problem: Problem) -> float:
    """The largest distance of a particle from the origin; 1 for a problem that is all there, and has no size."""
    return longest(problem.x0) or 1.0


def start_of(problem: Problem, work: Work) -> NDArray[np.float64]:
    """x0 (N d,), put onto S if it lies outside by more than rounding."""
    x0, allowed = problem.x0, TOUCHING * size_of(problem)
    violation = float(np.max(-problem.rows_within(0.0, x0, 0.0).values(x0), initial=0.0))
    if violation <= allowed:
        return x0.ravel()
    feasible = FeasibleSet(problem, ActiveSet(allowed).solver(), work, linearised=False)
    return feasible.nearest(0.0, x0, x0, violation).point.ravel()


class EventRun:
    """A run of the event-driven scheme from ``start`` to the last of ``times``; what it reached stays when it fails.

    ``tol`` is the local tolerance of the integrator. Into so many ``parts`` at least is the way to the end, or to the
    next event, divided, and so much shorter are the differences that give velocities of moving sets: runs that differ
    in ``parts`` have no step in common, even where the tolerance does not limit them, so that their distance tells the
    error of the coarser one.

    Attributes
    ----------
    now
        The time reached.
    between
        The dense output so far.
    """

    def __init__(
        self,
        system: SmallSystem,
        start: NDArray[np.float64],
        times: NDArray[np.float64],
        tol: float,
        parts: int,
        work: Work,
    ) -> None:
        problem = system.problem
        self._system, self._work, self._steps = system, work, 0
        system.sets.spacing = SPACING * float(times[-1]) / parts or SPACING
        size = size_of(problem)
        pair = pair_for(tol / size)
        n, m, most = problem.x0.size, len(system.arrays.rows.row), len(system.arrays.chosen.row)
        self._state = np.zeros(1, dtype=STATE)
        for name, value in {"end": times[-1], "tol": tol, "size": size, "parts": parts, "choose": 1}.items():
            self._state[name] = value
        path = room_for_path(kernels.ROOM * 8, n, most, m)
        self._march = begin_march(system.place, system.arrays, pair, self._state, path, start.copy())
        self._words = written(self._march)
        self.between = PathPieces(system, pair, size, start)
        self._changes: list[NDArray[np.float64]] = []

    @property
    def now(self) -> float:
        return float(self._state["now"][0])

    def go(self) -> None:
        """March to the end; StepFailure if that fails."""
        most, code = FEWEST, kernels.FULL
        while code == kernels.FULL:
            began = time.perf_counter()
            with self._system.drift, self._system.sets:
                code = kernels.march_on(int(self._words.ctypes.data), most)
            most = min(2 * most, MOST_STEPS) if time.perf_counter() - began < SHORT else most
            self._drain()
            self._system.count(self._work)
            if sum(map(len, self._changes)) > MOST_EVENTS or self._state["steps"][0] > MOST_STEPS:
                detail = f"More than {MOST_EVENTS} changes of the contacts, or {MOST_STEPS} steps."
                raise StepFailure(Status.NOT_CONVERGED, detail)
        if code == kernels.STUCK:
            detail = f"More than {kernels.MOST_AT_ONCE} changes of the contacts at one time."
            raise StepFailure(Status.NOT_CONVERGED, detail)
        if code == kernels.NO_STEP:
            raise StepFailure(
                Status.NOT_CONVERGED, "The integrator stopped: its step became too short, or a number overflowed."
            )
        if code != kernels.DONE:
            self._system.failure(code)

    @property
    def events(self) -> tuple[Event, ...]:
        """The changes of the contacts so far; those of one time with contacts first, in the order of their names."""
        names, found = self._system.names, []
        for t, row, closes, phase in np.concatenate(self._changes):
            found.append((phase, not closes, names[int(row)], float(t)))
        return tuple(Event(t, "release" if opens else "contact", *name) for _, opens, name, t in sorted(found))

    def state(self) -> NDArray[np.float64]:
        """The state reached, shape (N, d)."""
        return self._march.x.reshape(self._system.problem.x0.shape).copy()

    def _drain(self) -> None:
        """Take the pieces and events out of the room of the kernel."""
        state, path = self._state, self._march.path
        self._work.steps += int(state["steps"][0]) - self._steps
        self._steps = int(state["steps"][0])
        self.between.add(Path._make(part[: int(state["pieces"][0])].copy() for part in path), float(state["size"][0]))
        self._changes.append(path.event[: int(state["events"][0])].copy())
        state["pieces"], state["events"] = 0, 0
