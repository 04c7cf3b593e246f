"""Equal time steps in Python: the grid of a run, the states at output times, and a scheme bound to one problem."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from dincl.checks import bounded, describe
from dincl.constants import LARGEST
from dincl.errors import InvalidProblem, StepFailure
from dincl.status import Status
from dincl.work import Work

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from dincl.problem import Problem

# More steps than this are taken for a mistake in dt.
MOST_STEPS = 10**9
# t_end / dt is taken for a whole number when it is one up to rounding.
ROUNDING = 1e-12


class TimeGrid(NamedTuple):
    """Times t_k = origin + k t_end / steps for k = 0 ... steps, computed from k, never by adding up.

    A kernel is to make the steps ``first`` ... ``last`` - 1.
    """

    t_end: float
    steps: int
    first: int = 0
    last: int = 0
    origin: float = 0.0

    @property
    def h(self) -> float:
        """The step length [time]."""
        return self.t_end / self.steps if self.steps else 0.0

    def time(self, k: int) -> float:
        """Compute t_k."""
        return self.origin + (self.t_end if k == self.steps else k * self.t_end / self.steps)

    def before(self, t: NDArray[np.float64]) -> NDArray[np.int64]:
        """Find the last k with t_k < t, or 0, for times (K,); a t that is t_k up to rounding counts as t_k."""
        if not self.steps:
            return np.zeros(len(t), dtype=np.int64)
        place = (t - self.origin) / self.t_end * self.steps
        nearest = np.rint(place)
        on_grid = np.abs(place - nearest) <= ROUNDING * self.steps
        found: NDArray[np.int64] = np.maximum(np.where(on_grid, nearest - 1, np.floor(place)), 0).astype(np.int64)
        return found

    def weights(self, t: NDArray[np.float64], k: NDArray[np.int64]) -> NDArray[np.float64]:
        """Compute the places of times (K,) in the steps k: 1 at the end of a step, up to rounding."""
        start = np.where(k == self.steps, self.t_end, k * self.t_end / max(self.steps, 1))
        weight = (t - self.origin - start) / (self.h or 1.0)
        weight[weight >= 1 - ROUNDING * self.steps] = 1.0
        return weight


def divide_time(t_end: float, dt: float, t0: float = 0.0) -> TimeGrid:
    """Return the fewest equal steps no longer than dt from t0 to t_end."""
    time = t_end - t0
    if time / dt > MOST_STEPS:
        raise InvalidProblem(f"dt = {dt:g}: needs {time / dt:.3g} steps to t = {t_end:g}, allowed are {MOST_STEPS:g}")
    return TimeGrid(time, math.ceil(time / dt * (1 - ROUNDING)), origin=t0)


class StepState(NamedTuple):
    """Positions (N, d), for second-order schemes velocities (N, d), and what else a scheme needs from earlier steps.

    ``memory`` is the place for the states and drifts of earlier steps that a multi-step scheme needs: an array, or a
    tuple of arrays, that no later step changes. It is None at the start, unless ``start`` sets it. All steps of a run
    have the same length, as output times cut no step, and steps are repeated from stored states: what is stored in the
    Stepper instead does not belong to the state that a step is given.
    """

    x: NDArray[np.float64]
    v: NDArray[np.float64] | None = None
    memory: Any = None

    def towards(self, after: StepState, weight: float) -> NDArray[np.float64]:
        """Compute x on the straight line to the state ``after``  (1.48); exactly ``after.x`` for weight 1."""
        return after.x if weight == 1.0 else self.x + weight * (after.x - self.x)


class Output:
    """States at K increasing output times.

    Attributes
    ----------
    step, weight
        The step k in which each time lies, t_k < t <= t_{k+1}, and its place there, 1 at the end; shape (K,).
    x, before, velocity
        The states at the times, at t_k, and velocities at t_k for second-order schemes; shape (K, N, d).
    memory
        The memory of multi-step schemes at t_k, a list of K.
    filled
        How many of them a run has reached, shape (1,).
    """

    def __init__(self, step: NDArray[np.int64], weight: NDArray[np.float64], start: StepState) -> None:
        self.step, self.weight = step, weight
        shape = (len(step), *start.x.shape)
        self.x, self.before = np.empty(shape), np.empty(shape)
        self.velocity = np.empty(shape if start.v is not None else (0, *shape[1:]))
        self.memory: list[Any] = [None] * len(step)
        self.filled = np.zeros(1, dtype=np.int64)

    @classmethod
    def at(cls, on: TimeGrid, times: NDArray[np.float64], start: StepState) -> Output:
        """Make room for increasing times (K,), and fill in the start if it is one of them."""
        step = on.before(times)
        output = cls(step, on.weights(times, step), start)
        if len(times) and times[0] == on.origin:
            output.fill(0, start, start, most=1)
        return output

    def fill(self, k: int, state: StepState, after: StepState, most: int | None = None) -> None:
        """Fill in the output times in step k, on the straight line between two states."""
        q, last = int(self.filled[0]), len(self.step) if most is None else most
        while q < last and self.step[q] == k:
            self.before[q], self.x[q] = state.x, state.towards(after, self.weight[q])
            self.memory[q] = state.memory
            if state.v is not None:
                self.velocity[q] = state.v
            q += 1
        self.filled[0] = q

    def stored(self, q: int) -> StepState:
        """Return the state before the step in which output time q lies."""
        return StepState(self.before[q], self.velocity[q] if len(self.velocity) else None, self.memory[q])


class Reached(NamedTuple):
    """The step that a run reached, its state, and why it went no further; None if nothing failed."""

    k: int
    state: StepState
    failure: StepFailure | None = None


class Stepper(ABC):
    """A scheme bound to one problem; lists and warm starts that it stores between steps do not change its results.

    What the results depend on belongs into the StepState: steps are repeated from stored states.

    Attributes
    ----------
    problem
        The problem that it is bound to.
    work
        Counters that the steps add to; ``advance`` counts the steps themselves.
    """

    def __init__(self, problem: Problem) -> None:
        self.problem = problem
        self.work = Work(degrees_of_freedom=problem.x0.size)

    def start(self) -> StepState:
        """Return the state at the start."""
        return StepState(self.problem.x0)

    def prepare(self, grids: Sequence[TimeGrid], times: NDArray[np.float64]) -> None:  # noqa: B027  # few look ahead
        """Look at functions of time, before a run on these grids, one after another, with output at these times."""

    @abstractmethod
    def step(self, t: float, h: float, state: StepState) -> StepState:
        """Compute the state at t + h from the state at t, in new arrays; StepFailure if there is none."""

    def advance(self, on: TimeGrid, k: int, end: int, state: StepState, output: Output | None = None) -> Reached:
        """Make the steps from t_k to t_end, or until one fails or leaves the finite numbers; fill in the output."""
        for index in range(k, end):
            try:
                after = self.step(on.time(index), on.h, state)
            except StepFailure as failure:
                return Reached(index, state, failure)
            if not isinstance(after, StepState) or getattr(after.x, "shape", None) != state.x.shape:
                raise InvalidProblem(
                    f"scheme: {type(self).__name__}.step returned {describe(after)}: must be a dincl.StepState with x "
                    f"of shape {state.x.shape}"
                )
            if getattr(after.v, "shape", None) != getattr(state.v, "shape", None):
                raise InvalidProblem(
                    f"scheme: {type(self).__name__}.step returned v = {describe(after.v)} after "
                    f"v = {describe(state.v)}: must have velocities of the shape of those of start(), or "
                    "none if it has none; states of earlier "
                    "steps belong into memory"
                )
            if not bounded(after.x):
                detail = f"A coordinate is not a number, or exceeds {LARGEST:g} in magnitude."
                return Reached(index, state, StepFailure(Status.NON_FINITE, detail))
            self.work.steps += 1
            self.work.callbacks += 1
            if output is not None:
                output.fill(index, state, after)
            state = after
        return Reached(end, state)

    def velocity(self, t: float, x: NDArray[np.float64]) -> NDArray[np.float64]:
        """Compute the drift F(t, x), shape (N, d), counted; StepFailure if it cannot be evaluated."""
        self.work.drift_evaluations += 1
        return self.problem.velocity(t, x)
