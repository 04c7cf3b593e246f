"""One run of the event-driven method with one tolerance, and its dense output."""

from __future__ import annotations

import time
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from dincl.compiled.structs import StructPointer
from dincl.constants import LARGEST
from dincl.errors import StepFailure
from dincl.events import integrate as kernels
from dincl.events.contacts import TOUCHING
from dincl.events.runge_kutta import pair_for
from dincl.events.workspace import (
    DONE,
    FULL,
    JUMPS,
    KIND,
    NO_STEP,
    SLOW,
    STUCK,
    StepTable,
    event_workspace,
    sparse_gram,
    step_table,
)
from dincl.matrices import row_squares
from dincl.norms import longest
from dincl.projection.active_set import ActiveSet
from dincl.projection.cone import distance_to_cone
from dincl.projection.feasible import FeasibleSet
from dincl.status import Status
from dincl.system.arrays import OK
from dincl.system.compiled_problem import CompiledProblem, units_of
from dincl.trajectory import Between, Event

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from dincl.events.runge_kutta import RungeKutta
    from dincl.problem import Problem
    from dincl.solvers.sparse_factor import SparseFactor
    from dincl.work import Work

# Spacing of the differences that give the velocities of moving sets, as a part of the run.
SPACING = 1e-3
# Changes of the contacts allowed in one run.
MOST_EVENTS = 100_000
# Steps in the first call of a kernel; as many more in each call as keep it shorter than this [s].
FEWEST, SHORT = 64, 0.02
# Steps for which a table has places.
PLACES = 256
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
    SLOW: (
        Status.TOO_MANY_STEPS,
        f"The run would need more than {kernels.MOST_STEPS} steps, at the rate of its last {kernels.CHECK}: the drift "
        "is stiff, has noise, or jumps again and again.",
    ),
    JUMPS: (
        Status.TOO_MANY_STEPS,
        f"The drift jumped more than {kernels.MOST_JUMPS} times: it points across a surface from both sides.",
    ),
}


def size_of(problem: Problem, end: float) -> float:
    """Compute the largest distance of a particle from the origin [length].

    With all particles at the origin: their distance to the nearest set or their displacement until ``end``, whichever
    is less; 1 if both are 0.
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
    """A problem for runs until ``end``: in units in which its size and the time are about 1.

    Attributes
    ----------
    size
        Of the problem [length].
    compiled
        The compiled problem.
    gram
        The sparse factor.
    """

    def __init__(self, problem: Problem, end: float) -> None:
        self.size = size_of(problem, end)
        self.compiled = CompiledProblem(problem, units=units_of(self.size, end))
        self.compiled.sets.find_kinks(end)
        self.gram = sparse_gram(self.compiled.arrays)

    def start(self, work: Work) -> NDArray[np.float64]:
        """Return x0 (N, d), moved onto S if it lies outside by more than rounding."""
        problem, allowed = self.compiled.problem, TOUCHING * self.size
        violation = float(self.compiled.overlaps(np.zeros(1), problem.x0[None])[0])
        if violation <= allowed:
            return problem.x0
        feasible = FeasibleSet(problem, ActiveSet(allowed).solver(), work, linearised=False)
        return feasible.nearest(0.0, problem.x0, problem.x0, violation).point


class EventRun:
    """A run of the event-driven method from ``start`` (N, d) to ``end``; what it reached stays when it fails.

    ``tol`` is the local tolerance of the integrator. The way to the end, or to the next event, is divided into at least
    ``parts`` parts, and the differences that give velocities of moving sets are so much shorter: runs that differ in
    ``parts`` have no step in common, even where the tolerance does not limit them, so that their distance estimates the
    error of the coarser one.

    Attributes
    ----------
    between
        The dense output so far.
    """

    def __init__(
        self, system: EventSystem, start: NDArray[np.float64], end: float, tol: float, parts: int, work: Work
    ) -> None:
        self._system, self._work, self._made = system.compiled, work, 0
        self._unit = unit = system.compiled.units
        sets, x, many = system.compiled.sets, start.ravel() / unit.length, len(start) > MANY
        sets.spacing = SPACING * end / parts or SPACING
        size, kinks, last = system.size / unit.length, sets.kinks.ravel() / unit.time, end / unit.time
        pair, arrays = pair_for(tol / system.size, many), system.compiled.arrays
        stop, resume = kinks[:2] if len(kinks) else (last, last)
        steps = step_table(PLACES, pair.terms, x.size, len(arrays.factor.row), len(arrays.rows.row))
        numbers = {"end": last, "stop": stop, "resume": resume, "tol": tol / unit.length, "size": size}
        numbers |= {"largest": LARGEST * min(1.0, 1.0 / unit.length), "parts": parts, "undecided": 1, "many": many}
        workspace = event_workspace(arrays, system.compiled.place, system.gram, pair, steps, x.copy(), kinks, **numbers)
        self._pointer, self._state = StructPointer(workspace, KIND), workspace.state
        self.between = DenseOutput(system.compiled, system.gram, pair, size, x)
        self._events: list[NDArray[np.float64]] = []

    @property
    def now(self) -> float:
        """The time reached."""
        return float(self._state["t"][0]) * self._unit.time

    @property
    def neglected(self) -> float:
        """How far multipliers < 0 that count as zero can have moved a particle [length]."""
        return float(self._state["neglected"][0]) * self._unit.length

    def integrate(self) -> None:
        """Integrate to the end; StepFailure if that fails."""
        most, code = FEWEST, FULL
        while code == FULL:
            began = time.perf_counter()
            with self._system.callbacks():
                code = kernels.integrate(self._pointer, most)
            most = min(2 * most, kernels.MOST_STEPS) if time.perf_counter() - began < SHORT else most
            self._drain()
            self._system.count(self._work)
            if sum(map(len, self._events)) > MOST_EVENTS:
                raise StepFailure(Status.TOO_MANY_STEPS, f"More than {MOST_EVENTS} changes of the contacts.")
        if code in ENDS:
            raise StepFailure(*ENDS[code])
        if code != DONE:
            self._system.failure(code)
        if self._system.sets.path_failure is not None:
            raise self._system.sets.path_failure

    @property
    def events(self) -> tuple[Event, ...]:
        """The changes of the contacts so far; those of one time with contacts first, in the order of their names."""
        names, found = self._system.names, []
        for t, row, closes, phase in np.concatenate(self._events):
            found.append((phase, not closes, names[int(row)], float(t) * self._unit.time))
        return tuple(Event(t, "release" if opens else "contact", *name) for _, opens, name, t in sorted(found))

    def state(self) -> NDArray[np.float64]:
        """Return the state reached, shape (N, d)."""
        x: NDArray[np.float64] = self._pointer.value.x
        return x.reshape(self._system.problem.x0.shape) * self._unit.length

    def _drain(self) -> None:
        """Move steps and events out of the table of the kernel."""
        state, table = self._state[0], self._pointer.value.steps
        self._work.steps += int(state["made"]) - self._made
        self._made, count = int(state["made"]), int(state["steps"])
        table = table._replace(active=table.active[:, : int(table.number[:count].max(initial=0))])
        self.between.add(StepTable._make(part[:count].copy() for part in table), float(state["size"]))
        self._events.append(table.event[: int(state["events"])].copy())
        state["steps"], state["events"] = 0, 0


class DenseOutput(Between):
    """A polynomial for each step of a run, in the units of its system; states are moved onto the active rows.

    ``size`` is that of the problem, ``start`` is x(0), shape (N d,).
    """

    def __init__(
        self, system: CompiledProblem, gram: SparseFactor, pair: RungeKutta, size: float, start: NDArray[np.float64]
    ) -> None:
        self._problem, self._units, self._pair, self._size = system.problem, system.units, pair, size
        self._start, self._system, self._gram = start, system, gram
        self._spacing, self._kinks = system.sets.spacing, system.sets.kinks
        self._tables: list[StepTable] = []

    def add(self, table: StepTable, size: float) -> None:
        """Append steps, and set the size of the problem after them."""
        if len(table.end):
            self._tables.append(table)
        self._size = size

    def states(self, times: NDArray[np.float64]) -> NDArray[np.float64]:
        """Evaluate the polynomials, moved onto the active rows."""
        x = self._states(np.asarray(times) / self._units.time)
        return x.reshape(-1, *self._problem.x0.shape) * self._units.length

    def residuals(self, times: NDArray[np.float64]) -> NDArray[np.float64]:
        """Evaluate residuals with the velocity from before each time, or from after t = 0."""
        scaled = np.asarray(times) / self._units.time
        points = zip(times, scaled, *self._steps(scaled), self._states(scaled), strict=True)
        return np.array([self._residual(float(t), float(s), int(k), int(p), x) for t, s, k, p, x in points])

    def __getstate__(self) -> dict[str, Any]:
        """Leave out what is bound to this process."""
        bound = ("_workspaces", "_system", "_gram")
        return {name: value for name, value in self.__dict__.items() if name not in bound}

    def __setstate__(self, state: dict[str, Any]) -> None:
        """Bind a system of this process."""
        system = CompiledProblem(state["_problem"], units=state["_units"])
        self.__dict__ |= state | {"_system": system, "_gram": sparse_gram(system.arrays)}

    @cached_property
    def _workspaces(self) -> list[StructPointer]:
        """One workspace for each table, once the run has ended: to join the tables needs twice their memory."""
        system, pair, x = self._system, self._pair, self._start
        tables = self._tables or [step_table(0, pair.terms, x.size, 0, 0)]
        first = event_workspace(
            system.arrays, system.place, self._gram, pair, tables[0], x.copy(), np.zeros(0), size=self._size
        )
        return [StructPointer(first._replace(steps=table), KIND) for table in tables]

    def _states(self, times: NDArray[np.float64]) -> NDArray[np.float64]:
        """Evaluate the states (K, n) in the units of the run."""
        self._system.sets.spacing, self._system.sets.kinks = self._spacing, self._kinks
        x = np.tile(self._start, (len(times), 1))
        if not self._tables or not len(times):
            return x
        table, step = self._steps(times)
        with self._system.callbacks():
            for k in range(table.min(), table.max() + 1):
                chosen = (table == k) & (times > 0)
                found = x[chosen]
                code = kernels.states_at(self._workspaces[k], times[chosen], step[chosen], found)
                if code != OK:
                    self._system.failure(code)
                x[chosen] = found
        return x

    def _steps(self, times: NDArray[np.float64]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Find the table of each time, and the step in it."""
        which, step = np.zeros(len(times), dtype=np.int64), np.zeros(len(times), dtype=np.int64)
        begins = -np.inf
        for k, table in enumerate(self._tables):
            later = times > begins
            which[later], begins = k, table.end[-1]
            step[later] = np.minimum(np.searchsorted(table.end, times[later]), len(table.end) - 1)
        return which, step

    def _residual(self, t: float, scaled: float, table: int, step: int, x: NDArray[np.float64]) -> float:
        """Compute the residual at time t, which is ``scaled`` in the units of the run, as x (n,) is."""
        if not self._tables:
            return np.inf
        rate, at = np.empty(x.size), x.reshape(self._problem.x0.shape) * self._units.length
        try:
            with self._system.callbacks():
                code = kernels.rate_at(self._workspaces[table], scaled, step, x, rate)
            if code != OK:
                self._system.failure(code)
            reaction = rate * self._units.speed - self._problem.velocity(t, at).ravel()
            touching = TOUCHING * self._size * self._units.length
            return distance_to_cone(reaction, self._problem.rows_within(t, at, touching).jacobian(at))
        except StepFailure:
            return np.inf
