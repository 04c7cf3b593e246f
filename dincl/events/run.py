"""One run of the event-driven method with one tolerance."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

import numpy as np

from dincl.compiled.structs import StructPointer
from dincl.constants import LARGEST
from dincl.constraints.selection import gradient_lengths
from dincl.errors import StepFailure
from dincl.events import integrate as kernels
from dincl.events.dense_output import DenseOutput
from dincl.events.runge_kutta import EPS, pair_for
from dincl.events.workspace import (
    DONE,
    FULL,
    JUMPS,
    KIND,
    MOVED,
    NO_STEP,
    SLOW,
    STUCK,
    TOUCHING,
    StepTable,
    event_workspace,
    sparse_gram,
    step_table,
)
from dincl.matrices import row_squares
from dincl.norms import longest
from dincl.projection.compiled import ActiveSet
from dincl.projection.feasible import FeasibleSet
from dincl.status import Status
from dincl.system.compiled_problem import CompiledProblem, units_of
from dincl.system.time_scales import time_scales
from dincl.trajectory import Event

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from dincl.problem import Problem
    from dincl.schemes.base import Span, Watch
    from dincl.work import Work

# Spacing of the differences that give the velocities of moving sets, as a part of the run.
SPACING = 1e-3
# And as a part of a step that resolves the sets. Of a sine that takes a whole step, differences of order 6 then have
# errors of 1e-10 of the largest velocity.
PART = 1e-2
# Changes of the contacts allowed in one run.
MOST_EVENTS = 100_000
# Steps in the first call of a kernel; as many more in each call as keep it shorter than this [s].
FEWEST, SHORT = 64, 0.02
# Steps for which a table has places.
PLACES = 256
SLOWLY = f"The run would need more than {kernels.MOST_STEPS} steps, at the rate of its last {kernels.CHECK}"
# Normals are compared so far away, as a part of the size of the problem. A step is limited by a contact that turns the
# motion by this angle in it, or by more.
NEARBY, STIFF = 1e-9, 0.3
# How a kernel ends a run too early.
ENDS = {
    STUCK: (Status.NOT_CONVERGED, f"More than {kernels.MOST_AT_ONCE} changes of the contacts at one time."),
    NO_STEP: (
        Status.NOT_CONVERGED,
        "The integrator stopped: its step became too short, or a number overflowed.",
    ),
    SLOW: (
        Status.TOO_MANY_STEPS,
        f"{SLOWLY}: the drift is stiff, has noise, or jumps again and again.",
    ),
    JUMPS: (
        Status.TOO_MANY_STEPS,
        f"The drift jumped more than {kernels.MOST_JUMPS} times: it points across a surface from both sides.",
    ),
}


def size_of(problem: Problem, start: float, end: float) -> float:
    """Compute the largest distance of a particle from the origin [length].

    With all particles at the origin: their distance to the nearest set or their displacement from ``start`` to ``end``,
    whichever is less; 1 if both are 0.
    """
    x0 = problem.x0
    found = longest(x0)
    if found > 0:
        return found
    rows = problem.rows_within(start, x0, np.inf)
    slopes = np.sqrt(row_squares(rows.jacobian(x0)))
    gaps = rows.values(x0) / np.where(slopes > 0, slopes, 1.0)
    ways = [(end - start) * longest(problem.velocity(start, x0)), *gaps]
    return min((float(way) for way in ways if way > 0), default=1.0)


class EventSystem:
    """A problem for runs of a ``span`` to ``times[-1]``: in units in which its size and the time are about 1.

    Attributes
    ----------
    size
        Of the problem [length].
    compiled
        The compiled problem.
    scales
        Of its functions of time, which are looked at at ``times``, for an accuracy of ``tol``.
    gram
        The sparse factor.
    """

    def __init__(self, problem: Problem, times: NDArray[np.float64], tol: float, span: Span) -> None:
        t0, end = span.t0, float(times[-1])
        self.size = size_of(problem, t0, end)
        self.compiled = CompiledProblem.for_events(problem, units_of(self.size, end - t0))
        self.scales = time_scales(problem, times, tol, t0, span.breaks)
        self.compiled.sets.tabulate(self.scales.smooth)
        # No difference looks before the start, or behind the end.
        self.compiled.sets.breaks = np.concatenate(([[-np.inf, t0]], self.scales.breaks, [[end, np.inf]]))
        self.gram = sparse_gram(self.compiled.arrays)

    def start(self, work: Work) -> NDArray[np.float64]:
        """Return x0 (N, d), moved onto S if it lies outside by more than rounding."""
        work.drift_evaluations += self.scales.evaluations
        return self.nearest(self.scales.start, self.compiled.problem.x0, work)

    def nearest(self, t: float, x: NDArray[np.float64], work: Work) -> NDArray[np.float64]:
        """Return x (N, d), moved onto S(t) if it lies outside by more than rounding."""
        problem, allowed = self.compiled.problem, TOUCHING * self.size
        violation = float(self.compiled.overlaps(np.array([t]), x[None])[0])
        if violation <= allowed:
            return x
        # The tolerance of a projection is in units of g, that of contacts is a length.
        rows = problem.rows_within(t, x, violation)
        longest_row = max((float(gradient_lengths(block, x).max(initial=0.0)) for block in rows.blocks), default=1.0)
        feasible = FeasibleSet(problem, ActiveSet(allowed * max(1.0, longest_row)).solver(), work, linearised=False)
        return feasible.nearest(t, x, x, violation).point


class EventRun:
    """A run of the event-driven method from x(t0) = ``start`` (N, d) to ``end``; what it reached stays when it fails.

    ``tol`` is the local tolerance of the integrator. The way to the end, or to the next event, is divided into at least
    ``parts`` parts, and the differences that give velocities of moving sets are so much shorter: runs that differ in
    ``parts`` have no step in common, even where the tolerance does not limit them, so that their distance estimates the
    error of the coarser one.

    Attributes
    ----------
    between
        The dense output so far.
    stopped
        When ``until``, which ``watch`` looks at, ended the run; None if it did not.
    """

    def __init__(
        self,
        system: EventSystem,
        start: NDArray[np.float64],
        end: float,
        tol: float,
        parts: int,
        work: Work,
        watch: Watch | None = None,
    ) -> None:
        self._system, self._whole, self._work, self._made = system.compiled, system, work, 0
        self._unit = unit = system.compiled.units
        sets, x = system.compiled.sets, start.ravel() / unit.length
        begin = system.scales.start
        sets.spacing = SPACING * (end - begin) / parts or SPACING
        sets.spacings = system.scales.pieces * (1.0, PART / parts)
        size, last = system.size / unit.length, end / unit.time
        before, behind = system.scales.stops.T / unit.time
        # A stage at the end of a step, whose time is rounded, is still before the break.
        breaks = np.column_stack((before - 4.0 * EPS * last, before, behind))
        pair, arrays = pair_for(tol / system.size, len(start)), system.compiled.arrays
        stop, _, resume = breaks[0] if len(breaks) else (last, last, last)
        steps = step_table(PLACES, pair.terms, x.size, len(arrays.factor.row), len(arrays.rows.row))
        numbers = dict.fromkeys(("t", "start", "checked_t"), begin / unit.time)
        numbers |= {"end": last, "stop": stop, "resume": resume, "tol": tol / unit.length, "size": size}
        numbers |= {"largest": LARGEST * min(1.0, 1.0 / unit.length), "parts": parts, "undecided": 1}
        place, pieces = system.compiled.place, system.scales.pieces / unit.time
        workspace = event_workspace(arrays, place, system.gram, pair, steps, x.copy(), breaks, pieces, **numbers)
        self._pointer, self._state = StructPointer(workspace, KIND), workspace.state
        self.between = DenseOutput(system, pair, size, x, during=watch is not None)
        self.stopped: float | None = None
        self._watch = watch
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
        while code in (FULL, MOVED):
            if code == MOVED:
                self._pass_jump()
            began = time.perf_counter()
            with self._system.callbacks():
                code = kernels.integrate(self._pointer, most, *kernels.NO_STATES)
            most = min(2 * most, kernels.MOST_STEPS) if time.perf_counter() - began < SHORT else most
            self._drain()
            self._system.count(self._work)
            if self.stopped is not None:
                code = DONE
            if sum(map(len, self._events)) > MOST_EVENTS:
                raise StepFailure(Status.TOO_MANY_STEPS, f"More than {MOST_EVENTS} changes of the contacts.")
        if code in ENDS:
            status, detail = ENDS[code]
            raise StepFailure(status, (code == SLOW and self._stiff_contact()) or detail)
        if code != DONE:
            self._system.failure(code)
        if self._whole.scales.failure is not None:
            raise self._whole.scales.failure

    def _stiff_contact(self) -> str:
        """Say which contact makes the motion stiff, if one does; else an empty string.

        A contact with the multiplier lambda and normals n(x) turns the motion at the rate lambda |dn/dx|: a pull over a
        radius of curvature.
        """
        run, system, t = self._pointer.value, self._system, self.now
        count, x = int(run.active.number[0]), self.state()
        if count == 0:
            return ""
        active, selection = run.active.row[:count], system.selection
        away = NEARBY * self._whole.size * np.random.default_rng(0).normal(size=x.shape)
        normals = []
        for point in (x, x + away):
            rows = selection.at(t)
            lengths = np.concatenate([gradient_lengths(block, point) for block in rows.blocks])
            normals.append(rows.jacobian(point).toarray()[active] / lengths[active, None])
        moved = np.sqrt((normals[0] != 0).astype(float) @ away.ravel() ** 2)
        curvature = np.sqrt(((normals[1] - normals[0]) ** 2).sum(axis=1)) / np.where(moved > 0, moved, 1.0)
        rates = run.multiplier[0, :count] * self._unit.speed * curvature
        k = int(rates.argmax())
        if rates[k] * float(self._state["last_h"][0]) * self._unit.time < STIFF:
            return ""
        constraint, row = selection.names[int(active[k])]
        return (
            f"{SLOWLY}: {row} (constraints[{constraint}]) is pulled against a set so curved that it turns at the rate "
            f"{rates[k]:.2g}, the pull over the radius of curvature: use a larger radius, or a scheme with fixed steps."
        )

    @property
    def events(self) -> tuple[Event, ...]:
        """The changes of the contacts so far; those of one time with contacts first, in the order of their names."""
        names, found = self._system.selection.names, []
        for t, row, closes, phase in np.concatenate(self._events):
            found.append((phase, not closes, names[int(row)], float(t) * self._unit.time))
        return tuple(Event(t, "release" if opens else "contact", *name) for _, opens, name, t in sorted(found))

    def state(self) -> NDArray[np.float64]:
        """Return the state reached, shape (N, d)."""
        x: NDArray[np.float64] = self._pointer.value.x
        return x.reshape(self._system.problem.x0.shape) * self._unit.length

    def _pass_jump(self) -> None:
        """Let sets that jumped act at once: a contact that is lost lets go, x becomes the nearest point of S(t).

        The table of steps is empty. The time of the jump itself gets a step of its own, in which nothing moves.
        """
        state, workspace = self._state[0], self._pointer.value
        x = self._whole.nearest(self.now, self.state(), self._work).ravel() / self._unit.length
        workspace.x[:] = x
        workspace.active.number[0] = workspace.gram.number[1] = 0
        steps = workspace.steps
        steps.start[0] = steps.end[0] = state["t"]
        steps.h[0], steps.x[0], steps.dense[0], steps.number[0] = 1.0, x, 0.0, 0
        state["steps"] = 1

    def _drain(self) -> None:
        """Move steps and events out of the table of the kernel."""
        state, table = self._state[0], self._pointer.value.steps
        self._work.steps += int(state["made"]) - self._made
        self._made, count = int(state["made"]), int(state["steps"])
        table = table._replace(active=table.active[:, : int(table.number[:count].max(initial=0))])
        self.between.add(StepTable._make(part[:count].copy() for part in table), float(state["size"]))
        self._events.append(table.event[: int(state["events"])].copy())
        state["steps"], state["events"] = 0, 0
        if self._watch is not None and count:
            self._look(self._watch, *(part[:count] * self._unit.time for part in (table.start, table.end)))

    def _look(self, watch: Watch, starts: NDArray[np.float64], ends: NDArray[np.float64]) -> None:
        """Look at ``until`` at the ends of new steps."""
        for start, end, x in zip(starts.tolist(), ends.tolist(), self.between.states(ends), strict=True):
            if watch.crossed(end, x):
                self.stopped = watch.locate(start, end, self.between.at)
                return
