"""Midpoint catch-up with steps whose length follows an estimate of their error."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from dincl.checks import number
from dincl.errors import StepFailure
from dincl.schemes.base import Scheme, step_reaction
from dincl.status import Status
from dincl.steps.grid import StepState
from dincl.system.time_scales import RESOLVED, TimeScales, time_scales
from dincl.trajectory import Between, RunOutcome
from dincl.work import Work

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from numpy.typing import NDArray

    from dincl.forces import Reaction
    from dincl.problem import Problem
    from dincl.system.time_scales import Interval

    Floats = NDArray[np.float64]

# Tolerance of a projection, relative to that of a step.
PROJECTION = 1e-3
# Steps are at most this part of the run, and of what one polynomial resolves of all functions of time. The first one is
# this part of the longest one: nothing is known of its contacts yet.
PART, FIRST = 1 / 8, 1 / 64
# Particles times steps in one call of compiled code, so that an interrupt or a budget does not wait.
CHUNK = 6400
# Steps of a run. Each time after so many, the number that the run needs is estimated.
MOST_STEPS, CHECK = 1_000_000, 5_000


@dataclass(frozen=True)
class AdaptiveCatchUp(Scheme):
    r"""``MidpointCatchUp`` with steps as long as an estimate of their error allows, projected by ``ActiveSet``.

    A step x_{k+1} of midpoint catch-up with length h makes a step x^ of linearised catch-up on its way. |x_{k+1} - x^|,
    what the normals turn until the end of the step times their multipliers, and h/2 times the change of the drift in
    its second half estimate the error: O(h^2), h' = h (tol / estimate)^(1/2) is the next length, and a step beyond tol
    is repeated. A step in which a new contact takes a particle off an old one is repeated to end at the contact, since
    the order would be one there. Rows are linearised where the sets are at the start of a step and searched in all that
    it may sweep, so that small particles do not pass through each other however long it is.

    Parameters
    ----------
    tol
        Greatest estimated error of a step, max_i |X_i - exact| [length]. The error of a run is proportional to it, with
        a factor that depends on the problem: of the order of one in smooth motion, larger where many contacts follow
        one another.

    Functions of time are looked at before the run, so that no step passes over what they do. Steps end at output times
    and at breaks of these functions; where a set jumps, so does the state, x(t+) = P_{S(t+)}(x(t-)). ``path(t)`` is
    straight between steps; it makes the run once more. A run that needs more than a million steps, as where the drift
    jumps again and again, ends TOO_MANY_STEPS.
    """

    tol: float = field()

    def __post_init__(self) -> None:
        object.__setattr__(self, "tol", number("tol", self.tol, positive=True))

    def run(self, problem: Problem, times: Floats) -> RunOutcome:
        """Make steps to each of the output times, or until one fails."""
        scales = time_scales(problem, times, self.tol)
        runs = AdaptiveRuns(problem, PROJECTION * self.tol, scales.smooth)
        return runs.run(times, self.tol, stretches(scales, times, PART))


class Stretch(NamedTuple):
    """A part of a run: until when, the longest step in it, and the time behind a break at its end."""

    until: float
    longest_step: float
    resume: float


def stretches(scales: TimeScales, times: Floats, part: float) -> list[Stretch]:
    """Divide a run at output times, at breaks of functions of time, and where they need other steps.

    Steps are at most this part of the run, and of what one polynomial resolves of all functions of time.
    """
    end, pieces, stops = float(times[-1]), scales.pieces, scales.stops
    stops = stops[(stops[:, 0] > 0) & (stops[:, 0] < end)]
    behind = dict(stops.tolist())
    ends = np.unique(np.concatenate((times[times > 0], stops[:, 0], pieces[:, 0][pieces[:, 0] < end])))
    found = []
    for until in ends.tolist():
        k = int(np.searchsorted(pieces[:, 0], until)) if len(pieces) else 0
        resolving = RESOLVED * float(pieces[min(k, len(pieces) - 1), 1]) if len(pieces) else end
        found.append(Stretch(until, part * min(end, resolving), behind.get(until, until)))
    return found


class Reached(NamedTuple):
    """A state ``x`` (N, d) at time t, the length of the step that led to it from ``before`` (N, d), and of the next."""

    t: float
    x: Floats
    before: Floats
    last: float
    h: float


class AdaptiveRuns:
    """Runs of adaptive steps on one problem, which is bound once; each is the same as with a new object.

    ``smooth`` are the intervals of time in which sets are smooth, see ``TimeScales``.
    """

    def __init__(self, problem: Problem, tol: float, smooth: Mapping[int, Sequence[Interval]]) -> None:
        from dincl.compiled.structs import StructPointer
        from dincl.projection import ActiveSet
        from dincl.steps.adaptive import adapting
        from dincl.steps.loop import Settings
        from dincl.steps.stepper import CompiledStepper

        self.problem, self.tol, self._smooth = problem, tol, smooth
        self._stepper = CompiledStepper.projecting(problem, None, ActiveSet(tol), Settings())
        self._stepper.system.sets.tabulate(smooth)
        self._memory = StructPointer(adapting(problem.x0.size))
        self._timed = any(one.timed for one in problem.constraints)

    def run(self, times: Floats, tau: float, parts: Sequence[Stretch]) -> RunOutcome:
        """Make one run with steps whose estimates are at most ``tau``."""
        state, found, kept = self.start(parts), list[Reached](), set(times.tolist())
        work, between = self._stepper.work, _Between(self.problem, self.tol, self._smooth, tau, parts, found)
        if 0.0 in kept:
            found.append(state)
        try:
            for part in parts:
                state = self.advance(state, part, part.until, tau)
                if part.until in kept:
                    found.append(state)
                state = self.pass_break(state, part)
        except StepFailure as failure:
            t, reached = times[: len(found)], self.reached
            if not found or reached.t > found[-1].t:
                found.append(reached)
                t = np.append(t, reached.t)
            detail = f"{failure.detail} This was in a step after t = {reached.t:.6g}."
            states = np.array([one.x for one in found])
            return RunOutcome(t.copy(), states, failure.status, detail, work, between, failure=failure)
        return RunOutcome(times.copy(), np.array([one.x for one in found]), Status.SUCCESS, "", work, between)

    def start(self, parts: Sequence[Stretch]) -> Reached:
        """Forget earlier runs; return the state at t = 0."""
        arrays, x0 = self._stepper.system.arrays, self.problem.x0
        arrays.program.multiplier[:], self._memory.value.number[:] = 0.0, -1
        arrays.near.radius[0] = -1.0  # no list is long enough: the first step searches
        self._stepper.work = Work(degrees_of_freedom=x0.size)
        self.end = parts[-1].until if parts else 0.0
        self.reached = Reached(0.0, x0, x0, 0.0, FIRST * parts[0].longest_step if parts else 0.0)
        return self.reached

    def advance(self, state: Reached, part: Stretch, stop: float, tau: float) -> Reached:
        """Make steps towards the end of a stretch, until one reaches ``stop``."""
        from dincl.steps.adaptive import TOO_SHORT, adapt
        from dincl.system.arrays import OK

        stepper, shape = self._stepper, self.problem.x0.shape
        place, memory = stepper.pointer.address, self._memory.address
        t, h, last, code, total, most = state.t, state.h, state.last, OK, 0, max(CHUNK // len(self.problem.x0), 1)
        since, tried, slow = t, 0, False
        stepper.pointer.value.x[:] = state.x.ravel()
        with stepper.system.callbacks():
            while t < stop and code == OK and not slow:
                code, t, h, last, made, repeated = adapt(
                    place, memory, t, part.until, stop, h, last, tau, part.longest_step, self.tol, self._timed, most
                )
                total += made
                tried += made + repeated
                stepper.work.steps += made + repeated
                stepper.system.count(stepper.work)
                if tried >= CHECK:
                    slow = (self.end - t) * tried > MOST_STEPS * (t - since)
                    since, tried = t, 0
        x, before = (part.reshape(shape).copy() for part in (stepper.pointer.value.x, self._memory.value.before))
        self.reached = Reached(t, x, before if total else state.before, last, h)
        if code == TOO_SHORT:
            raise StepFailure(Status.STEP_TOO_SMALL, "The estimated error of a step does not fall with its length.")
        if code != OK:
            stepper.fail(code)
        if slow:
            detail = f"The run would need more than {MOST_STEPS} steps, at the rate of its last {CHECK}."
            raise StepFailure(Status.TOO_MANY_STEPS, detail)
        return self.reached

    def pass_break(self, state: Reached, part: Stretch) -> Reached:
        """Continue behind the break at the end of a stretch, at the nearest point of a set that jumped."""
        from dincl.projection import ActiveSet
        from dincl.projection.feasible import FeasibleSet

        if part.resume == part.until:
            return state
        x, violation = state.x, self.problem.violation(part.resume, state.x)
        if violation > self.tol:
            feasible = FeasibleSet(self.problem, ActiveSet(self.tol).solver(), self._stepper.work, linearised=False)
            x = feasible.nearest(part.resume, x, x, violation).point
        self.reached = Reached(part.resume, x, x, 0.0, FIRST * part.longest_step)
        return self.reached


@dataclass(frozen=True, eq=False)
class _Between(Between):
    """Straight lines between the steps of a run, which is made once more."""

    problem: Problem
    tol: float
    smooth: Mapping[int, Sequence[Interval]]
    tau: float
    parts: Sequence[Stretch]
    found: list[Reached]

    def states(self, times: Floats) -> Floats:
        """Compute x between two steps by (1.48)."""
        values = np.empty((len(times), *self.problem.x0.shape))
        for q, (t, state) in enumerate(zip(times, self._reached(times), strict=True)):
            weight = 1.0 - (state.t - t) / state.last if state.last else 1.0
            values[q] = state.x if state.t == t else state.before + weight * (state.x - state.before)
        return values

    def reactions(self, times: Floats) -> list[Reaction | None]:
        """Compute the reactions of the steps that end at or after each time; None at the start, or behind a jump."""
        known = {one.t: one for one in self.found}
        reached = [known[t] for t in times] if set(times.tolist()) <= known.keys() else self._reached(times)
        return [self._reaction(one) for one in reached]

    def _reached(self, times: Floats) -> Iterator[Reached]:
        """Make the run once more; give the end of the step that ends at or after each time, and x0 at the start."""
        runs, left = AdaptiveRuns(self.problem, self.tol, self.smooth), times.tolist()
        state = runs.start(self.parts)
        while left and left[0] <= 0.0:
            left.pop(0)
            yield state
        for part in self.parts:
            while left and left[0] <= part.until:
                state = runs.advance(state, part, left.pop(0), self.tau)
                yield state
            if not left:
                return
            state = runs.pass_break(runs.advance(state, part, part.until, self.tau), part)

    def _reaction(self, reached: Reached) -> Reaction | None:
        if reached.last == 0.0:
            return None
        try:
            before = StepState(reached.before)
            return step_reaction(self.problem, reached.t - reached.last, reached.last, before, reached.x)
        except StepFailure:
            return None
