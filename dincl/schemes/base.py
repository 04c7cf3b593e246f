"""Schemes: base classes, and the run of a scheme of equal time steps with the straight lines between the steps."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import partial
from itertools import pairwise
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from dincl.callables import UserFunction
from dincl.checks import number
from dincl.errors import StepFailure
from dincl.forces import Reaction
from dincl.norms import longest
from dincl.status import Status
from dincl.steps.grid import Output, Reached, Stepper, StepState, TimeGrid, divide_time
from dincl.trajectory import Between, RunOutcome

if TYPE_CHECKING:
    from dincl.compiled.arrays import Floats
    from dincl.problem import Problem


UNTIL = UserFunction("until", ("t", "x"), Status.FUNCTION_FAILED)
EPS = float(np.finfo(float).eps)
# Particles times steps between two looks at ``until``.
WATCHED = 6400


Until = Callable[[float, "Floats"], Any]


class Span(NamedTuple):
    """The time of a run besides its output times, as ``solve`` is given it.

    ``velocity`` (N, d) at t0 is that of a run that goes on with a second-order scheme.
    """

    t0: float = 0.0
    breaks: tuple[float, ...] = ()
    until: Until | None = None
    velocity: Floats | None = None


WHOLE = Span()


class Watch:
    """The function ``until`` along one run, from a time and a state on: where its value changes its sign."""

    def __init__(self, until: Until, t: float, x: Floats) -> None:
        self._until, self._sign = until, 0.0
        self.crossed(t, x)

    def crossed(self, t: float, x: Floats) -> bool:
        """Return whether the value at t has another sign than the first one that is not zero; StepFailure if it fails.

        Zero is another sign.
        """
        seen = x.copy()
        seen.flags.writeable = False
        sign = float(np.sign(UNTIL.evaluated(self._until, t, seen, shape=())))
        if self._sign == 0.0:
            self._sign = sign
        return sign != self._sign

    def locate(self, a: float, b: float, state: Callable[[float], Floats]) -> float:
        """Return the first time, to rounding, at which the sign has changed between a and b; ``state(t)`` is x(t)."""
        while b - a > EPS * b and a < (middle := 0.5 * (a + b)) < b:
            a, b = (a, middle) if self.crossed(middle, state(middle)) else (middle, b)
        return b


@dataclass(frozen=True)
class Scheme(ABC):
    """A way to solve x' in F(t, x) - N(S, x), an object that ``solve`` is given."""

    @abstractmethod
    def run(self, problem: Problem, times: Floats, span: Span = WHOLE) -> RunOutcome:
        """Compute the solution at increasing ``times`` (K,) >= t0, or until it fails; InvalidProblem if it cannot."""


@dataclass(frozen=True)
class FixedStep(Scheme):
    """A scheme with steps of length ``dt`` > 0 [time]; a run takes the next smaller length that divides it evenly.

    A subclass is a frozen dataclass; its further fields come after dt, and ``stepper`` makes its steps.
    """

    dt: float = field()

    def __post_init__(self) -> None:
        object.__setattr__(self, "dt", number("dt", self.dt, positive=True))

    def run(self, problem: Problem, times: Floats, span: Span = WHOLE) -> RunOutcome:
        """Make equal steps of at most ``dt`` to the last of ``times``."""
        return run_steps(partial(self.stepper, problem), self.dt, times, span)

    @abstractmethod
    def stepper(self, problem: Problem) -> Stepper:
        """Bind to a problem; InvalidProblem if the two do not go together."""


def run_steps(bind: Callable[[], Stepper], dt: float, times: Floats, span: Span = WHOLE) -> RunOutcome:
    """Make equal steps of at most ``dt`` until the last of ``times`` (K,), or until one fails.

    ``bind()`` makes a Stepper; it is stored, and must pickle for the outcome to pickle.
    """
    edges = [span.t0, *span.breaks, float(times[-1])]
    # A drift that still has its old value at the time of a break has its new one behind it.
    behind = [t if t == span.t0 else t + 2.0 * EPS * edges[-1] for t in edges[:-1]]
    grids = tuple(divide_time(end, dt, begin) for begin, end in zip(behind, edges[1:], strict=True))
    prepared = partial(_prepared, bind, grids, times)
    stepper, made = prepared(), list[RunOutcome]()
    start = state = stepper.start()
    if state.v is not None and span.velocity is not None:
        state = state._replace(v=span.velocity)
    watch = None if span.until is None else Watch(span.until, span.t0, state.x)
    # Numbers that overflow end the run with a Status of their own.
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        for grid, (begin, end) in zip(grids, pairwise(edges), strict=True):
            after = times >= begin if begin == span.t0 else times > begin
            part, reached = _run_grid(prepared, stepper, grid, state, times[after & (times <= end)], watch)
            made.append(part)
            if part.status is not Status.SUCCESS:
                break
            # Steps of another length begin, which have no use for earlier ones.
            state = start._replace(x=reached.x, v=reached.v)
    if len(made) == 1:
        return part
    t, x = (np.concatenate(list(parts)) for parts in zip(*((one.t, one.x) for one in made), strict=True))
    # A step that fails behind a break ends the run at the time of the break.
    keep = np.diff(t, prepend=-1.0) > 4.0 * EPS * edges[-1]
    between = Joined(np.array(edges[1 : len(made)]), tuple(one.between for one in made))
    return replace(part, t=t[keep], x=x[keep], between=between)


def _run_grid(
    bind: Callable[[], Stepper], stepper: Stepper, grid: TimeGrid, start: StepState, times: Floats, watch: Watch | None
) -> tuple[RunOutcome, StepState]:
    """Make the steps of a grid, with output at ``times`` in it; return their end, too."""
    output, stop = Output.at(grid, times, start), None
    if watch is None:
        reached = stepper.advance(grid, 0, grid.steps, start, output)
    else:
        reached, stop = _advance_until(watch, stepper, grid, start, output, times)
    count = int(output.filled[0])
    t, x, last = times[:count].copy(), output.x[:count], None
    status, detail, failure, v = Status.SUCCESS, "", reached.failure, reached.state.v
    if failure is not None:
        status, time = failure.status, grid.time(reached.k)
        detail = f"{failure.detail} This was in the step from t = {time:.6g} with dt = {grid.h:.6g}."
        if not count or t[-1] < time:
            t, x = np.append(t, time), np.concatenate((x, reached.state.x[None]))
            last = reached
    elif stop is not None:
        status, last, v = Status.STOPPED, reached, stop[1].v
        t, x = np.append(t, stop[0]), np.concatenate((x, stop[1].x[None]))
    lines = StraightLines(bind, grid, output, start, last)
    return RunOutcome(t, x, status, detail, stepper.work, lines, failure=failure, velocity=v), reached.state


def _prepared(bind: Callable[[], Stepper], grids: tuple[TimeGrid, ...], times: Floats) -> Stepper:
    stepper = bind()
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):  # of functions of time, as in steps
        stepper.prepare(grids, times)
    return stepper


def _on_line(on: TimeGrid, k: int, before: StepState, after: StepState, t: float) -> Floats:
    """Compute x(t) on the straight line of step k."""
    return before.towards(after, (t - on.time(k)) / on.h)


def _advance_until(
    watch: Watch, stepper: Stepper, on: TimeGrid, state: StepState, output: Output, times: Floats
) -> tuple[Reached, tuple[float, StepState] | None]:
    """Make steps, some in one call, and look at the state after each; return the last one, and where it stopped."""
    most, k, made = max(WATCHED // len(state.x), 1), 0, 0
    try:
        while k < on.steps:
            end = min(k + most, on.steps)
            ends = Output(np.arange(k, end), np.ones(end - k), state)
            reached = stepper.advance(on, k, end, state, ends)
            for q in range(reached.k - k):
                state, after, made = ends.stored(q), StepState(ends.x[q]), k + q
                if watch.crossed(on.time(k + q + 1), after.x):
                    line = partial(_on_line, on, k + q, state, after)
                    t = watch.locate(on.time(k + q), on.time(k + q + 1), line)
                    output.fill(k + q, state, after, most=int(np.searchsorted(times, t)))
                    v = None if state.v is None else (after.x - state.x) / on.h
                    return Reached(k + q, state), (t, StepState(line(t), v))
                output.fill(k + q, state, after)
            k, state = reached.k, reached.state
            if reached.failure is not None:
                return reached, None
    except StepFailure as failure:
        return Reached(made, state, failure), None
    return Reached(k, state), None


@dataclass(frozen=True, eq=False)
class Joined(Between):
    """Parts of a run, one after another, which end at ``ends`` but for the last one."""

    ends: Floats
    parts: tuple[Between, ...]

    def states(self, times: Floats) -> Floats:
        """Compute x in each of the parts."""
        return np.concatenate([part.states(here) for part, here in self._split(times)])

    def reactions(self, times: Floats) -> list[Reaction | None]:
        """Compute the reactions in each of the parts."""
        return [one for part, here in self._split(times) for one in part.reactions(here)]

    def _split(self, times: Floats) -> Iterator[tuple[Between, Floats]]:
        which = np.searchsorted(self.ends, times)
        for k in np.unique(which).tolist():
            yield self.parts[k], times[which == k]


@dataclass(frozen=True, eq=False)
class StraightLines(Between):
    """Straight lines between the steps; the steps around a time are repeated from a stored state before it.

    ``bind()`` makes a new Stepper of the scheme for the problem: repeated steps do not add to the work of the run.
    Stored are the ``start``, the states before the steps of the output times, and the ``last`` one of a run that failed
    or was stopped.
    """

    bind: Callable[[], Stepper]
    grid: TimeGrid
    output: Output
    start: StepState
    last: Reached | None = None

    def states(self, times: Floats) -> Floats:
        """Compute x between two steps by (1.48)."""
        values = np.empty((len(times), *self.start.x.shape))
        weights = self.grid.weights(times, self.grid.before(times)).tolist()
        for q, (weight, (_, state, after)) in enumerate(zip(weights, self._steps(self.bind(), times), strict=True)):
            if isinstance(after, StepFailure):
                raise after
            values[q] = state.x if after is None else state.towards(after, weight)
        return values

    def reactions(self, times: Floats) -> list[Reaction | None]:
        """Compute the reactions of the steps that end at or after each time; None at the start."""
        stepper, found = self.bind(), list[Reaction | None]()
        for k, state, after in self._steps(stepper, times):
            found.append(None)
            if isinstance(after, StepState):
                with suppress(StepFailure):
                    found[-1] = step_reaction(stepper.problem, self.grid.time(k), self.grid.h, state, after.x)
        return found

    def _steps(
        self, stepper: Stepper, times: Floats
    ) -> Iterator[tuple[int, StepState, StepState | StepFailure | None]]:
        """Repeat the step of each time; give its number, the state before it, and that after it, None at the start."""
        k, state = 0, self.start
        for t, step in zip(times.tolist(), self.grid.before(times).tolist(), strict=True):
            stored = self._stored_before(step)
            if stored.k > k:
                k, state = stored.k, stored.state
            if t == self.grid.origin or not self.grid.steps:
                yield k, state, None
                continue
            before = stepper.advance(self.grid, k, step, state)
            after = before if before.failure else stepper.advance(self.grid, step, step + 1, before.state)
            if not before.failure:
                k, state = step, before.state
            yield k, state, after.failure or after.state

    def _stored_before(self, step: int) -> Reached:
        """Return the last stored state at or before a step; without any, step -1."""
        if self.last is not None and self.last.k <= step:
            return self.last
        q = int(np.searchsorted(self.output.step[: int(self.output.filled[0])], step, side="right")) - 1
        return Reached(int(self.output.step[q]), self.output.stored(q)) if q >= 0 else Reached(-1, self.start)


def step_reaction(problem: Problem, t: float, h: float, before: StepState, after: Floats) -> Reaction:
    """Compute (after - before) / h - F(t, before) of a step, or of second order ((after - before) / h - v) / h - F."""
    drift = velocity = problem.velocity(t, before.x)
    rate = (after - before.x) / h
    if before.v is not None:
        rate, velocity = (rate - before.v) / h, before.v + h * drift
    value = (rate - drift).ravel()
    return Reaction(problem, t + h, after, value, h * longest(velocity) / 2, second_order=before.v is not None)
