"""Midpoint catch-up with steps whose length follows an estimate of their error."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, NamedTuple, cast

import numpy as np

from dincl.checks import number
from dincl.errors import StepFailure
from dincl.norms import longest
from dincl.schemes.base import WHOLE, Scheme, Span, Watch, step_reaction
from dincl.status import Status
from dincl.steps.grid import StepState
from dincl.system.time_scales import RESOLVED, TimeScales, time_scales
from dincl.trajectory import Between, RunOutcome
from dincl.work import Work

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from numpy.typing import NDArray

    from dincl.forces import Reaction
    from dincl.problem import Problem
    from dincl.schemes.base import Until

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

    def run(self, problem: Problem, times: Floats, span: Span = WHOLE) -> RunOutcome:
        """Make steps to each of the output times, or until one fails."""
        scales = time_scales(problem, times, self.tol, span.t0, span.breaks)
        runs = AdaptiveRuns(problem, PROJECTION * self.tol, scales)
        return runs.run(times, self.tol, stretches(scales, times, PART), span.until)


class Stretch(NamedTuple):
    """A part of a run: until when, the longest step in it, and the time behind a break at its end."""

    until: float
    longest_step: float
    resume: float


def stretches(scales: TimeScales, times: Floats, part: float) -> list[Stretch]:
    """Divide a run at output times, at breaks of functions of time, and where they need other steps.

    Steps are at most this part of the run, and of what one polynomial resolves of all functions of time.
    """
    start, end, pieces, stops = scales.start, float(times[-1]), scales.pieces, scales.stops
    stops = stops[(stops[:, 0] > start) & (stops[:, 0] < end)]
    behind = dict(stops.tolist())
    ends = np.unique(np.concatenate((times[times > start], stops[:, 0], pieces[:, 0][pieces[:, 0] < end])))
    found = []
    for until in ends.tolist():
        k = int(np.searchsorted(pieces[:, 0], until)) if len(pieces) else 0
        resolving = RESOLVED * float(pieces[min(k, len(pieces) - 1), 1]) if len(pieces) else end
        found.append(Stretch(until, part * min(end - start, resolving), behind.get(until, until)))
    return found


class Reached(NamedTuple):
    """A state ``x`` (N, d) at time t, the length of the step that led to it from ``before`` (N, d), and of the next.

    Behind a break the run begins ``anew``: the step before tells nothing of the next one.
    """

    t: float
    x: Floats
    before: Floats
    last: float
    h: float
    anew: bool = False

    def at(self, t: float) -> Floats:
        """Compute x(t) within the last step by (1.48)."""
        weight = 1.0 - (self.t - t) / self.last if self.last and t != self.t else 1.0
        return self.x if weight == 1.0 else self.before + weight * (self.x - self.before)


class AdaptiveRuns:
    """Runs of adaptive steps on one problem, which is bound once; each is the same as with a new object.

    ``scales`` are those of its functions of time.
    """

    def __init__(self, problem: Problem, tol: float, scales: TimeScales) -> None:
        from dincl.compiled.structs import StructPointer
        from dincl.projection import ActiveSet
        from dincl.steps.adaptive import adapting
        from dincl.steps.loop import Settings
        from dincl.steps.stepper import CompiledStepper

        self.problem, self.tol, self._scales = problem, tol, scales
        self._watch: Watch | None = None
        self._stepper = CompiledStepper.projecting(problem, None, ActiveSet(tol), Settings(), exact=False)
        self._stepper.system.sets.tabulate(scales.smooth)
        self._memory = StructPointer(adapting(problem.x0.size))
        self._timed = any(one.timed for one in problem.constraints)

    def run(self, times: Floats, tau: float, parts: Sequence[Stretch], until: Until | None = None) -> RunOutcome:
        """Make one run with steps whose estimates are at most ``tau``."""
        state, found, kept = self.start(parts), dict[float, Reached](), set(times.tolist())
        work, between = self._stepper.work, _Between(self.problem, self.tol, self._scales, tau, parts, found)
        if state.t in kept:
            found[state.t] = state
        status, detail, cause = Status.SUCCESS, "", None
        try:
            self._watch = None if until is None else Watch(until, state.t, state.x)
            for part in parts:
                state = self.advance(state, part, part.until, tau)
                if not self._stopped and part.until in kept:
                    found[part.until] = state
                if not self._stopped:
                    state = self.pass_break(state, part)
                if self._stopped:
                    status, found[self._stopped] = Status.STOPPED, state
                    break
        except StepFailure as failure:
            status, cause, state = failure.status, failure, self.reached
            if not found or state.t > max(found):
                found[state.t] = state
            detail = f"{failure.detail} This was in a step after t = {state.t:.6g}."
        self._watch = None
        x = np.array([one.at(t) for t, one in found.items()])
        return RunOutcome(np.array(list(found)), x, status, detail, work, between, failure=cause)

    def start(self, parts: Sequence[Stretch]) -> Reached:
        """Forget earlier runs; return the state at the start."""
        arrays, x0 = self._stepper.system.arrays, self.problem.x0
        arrays.program.multiplier[:], self._memory.value.number[:] = 0.0, -1
        arrays.near.radius[0] = -1.0  # no list is long enough: the first step searches
        self._stepper.work = Work(degrees_of_freedom=x0.size)
        t0, self._stopped = self._scales.start, 0.0
        self.end = parts[-1].until if parts else t0
        self.reached = Reached(t0, x0, x0, 0.0, FIRST * parts[0].longest_step if parts else 0.0)
        return self.reached

    def advance(self, state: Reached, part: Stretch, stop: float, tau: float) -> Reached:
        """Make steps towards the end of a stretch, until one reaches ``stop``, or ``until`` ends the run."""
        from dincl.steps.adaptive import TOO_SHORT, adapt
        from dincl.system.arrays import OK

        stepper = self._stepper
        place, memory = stepper.pointer.address, self._memory.address
        last = 0.0 if state.anew else state.last
        t, h, code, total, most = state.t, state.h, OK, 0, max(CHUNK // len(self.problem.x0), 1)
        since, tried, slow = t, 0, False
        most = most if self._watch is None else 1
        stepper.pointer.value.x[:] = state.x.ravel()
        with stepper.system.callbacks():
            while t < stop and code == OK and not (slow or self._stopped):
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
                if self._watch is not None and made:
                    self.reached = self._here(t, last, h)
                    self._look(self.reached)
        self.reached = self._here(t, last, h) if total else state
        if code == TOO_SHORT:
            raise StepFailure(Status.STEP_TOO_SMALL, "The estimated error of a step does not fall with its length.")
        if code != OK:
            stepper.fail(code)
        if slow:
            detail = f"The run would need more than {MOST_STEPS} steps, at the rate of its last {CHECK}."
            raise StepFailure(Status.TOO_MANY_STEPS, detail)
        return self.reached

    def _here(self, t: float, last: float, h: float) -> Reached:
        """Read the state that steps reached."""
        shape, place = self.problem.x0.shape, self._stepper.pointer.value.x
        return Reached(t, place.reshape(shape).copy(), self._memory.value.before.reshape(shape).copy(), last, h)

    def _look(self, reached: Reached) -> None:
        """Let ``until`` end the run within the last step, or behind a break."""
        if self._watch is not None and self._watch.crossed(reached.t, reached.x):
            self._stopped = self._watch.locate(reached.t - reached.last, reached.t, reached.at)

    def pass_break(self, state: Reached, part: Stretch) -> Reached:
        """Continue behind the break at the end of a stretch, at the nearest point of a set that jumped."""
        from dincl.projection import ActiveSet
        from dincl.projection.feasible import FeasibleSet

        if part.resume == part.until:
            return state
        x, violation = state.x, self.problem.violation(part.resume, state.x)
        reached = state._replace(t=part.resume, h=FIRST * part.longest_step, anew=True)
        if violation > self.tol:
            feasible = FeasibleSet(self.problem, ActiveSet(self.tol).solver(), self._stepper.work, linearised=False)
            x = feasible.nearest(part.resume, x, x, violation).point
            reached = reached._replace(x=x, before=x, last=0.0)
        self.reached = reached
        self._look(self.reached)
        return self.reached


@dataclass(frozen=True, eq=False)
class _Between(Between):
    """Straight lines between the steps of a run, which is made once more."""

    problem: Problem
    tol: float
    scales: TimeScales
    tau: float
    parts: Sequence[Stretch]
    found: dict[float, Reached]

    def states(self, times: Floats) -> Floats:
        """Compute x between two steps by (1.48)."""
        found = [state.at(t) for t, state in zip(times.tolist(), self._reached(times), strict=True)]
        return np.array(found).reshape(len(times), *self.problem.x0.shape)

    def reactions(self, times: Floats) -> list[Reaction | None]:
        """Compute the reactions of the steps that end at or after each time; None at the start, or behind a jump."""
        known = set(times.tolist()) <= self.found.keys()
        reached = [self.found[t] for t in times.tolist()] if known else self._reached(times)
        return [self._reaction(one) for one in reached]

    def _reached(self, times: Floats) -> Iterator[Reached]:
        """Make the run once more; give the end of the step that ends at or after each time, and x0 at the start."""
        runs, left = AdaptiveRuns(self.problem, self.tol, self.scales), times.tolist()
        state = runs.start(self.parts)
        while left and left[0] <= state.t:
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


def speed_at_end(outcome: RunOutcome) -> float:
    """Return max_i |X_i'| in the last step of a run."""
    reached: Reached = cast(Any, outcome.between).found[float(outcome.t[-1])]
    return longest(reached.x - reached.before) / reached.last if reached.last else 0.0
