"""Midpoint catch-up with steps whose length follows an estimate of their error."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from dincl.checks import number
from dincl.errors import StepFailure
from dincl.norms import longest
from dincl.schemes.base import Scheme
from dincl.schemes.resolution import resolving_step
from dincl.status import Status
from dincl.trajectory import Between, RunOutcome
from dincl.work import Work

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from dincl.problem import Problem

    Floats = NDArray[np.float64]

# Tolerance of a projection, relative to that of a step.
PROJECTION = 1e-3
# A run has at least so many steps; the first one is this part of the longest one: nothing is known of its contacts yet.
FEWEST, FIRST = 8, 1 / 64
# Particles times steps in one call of compiled code, so that an interrupt or a budget does not wait.
CHUNK = 6400


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

    Functions of time are looked at before the run, so that no step passes over what they do. Steps end at output times.
    ``path(t)`` is straight between steps; it makes the run once more.
    """

    tol: float = field()

    def __post_init__(self) -> None:
        object.__setattr__(self, "tol", number("tol", self.tol, positive=True))

    def run(self, problem: Problem, times: Floats) -> RunOutcome:
        """Make steps to each of the output times, or until one fails."""
        longest_step = min(float(times[-1]) / FEWEST, resolving_step(problem, times, self.tol))
        return AdaptiveRuns(problem, PROJECTION * self.tol).run(times, self.tol, longest_step)


class Reached(NamedTuple):
    """A state ``x`` (N, d) at time t, the length of the step that led to it from ``before`` (N, d), and of the next."""

    t: float
    x: Floats
    before: Floats
    last: float
    h: float


class AdaptiveRuns:
    """Runs of adaptive steps on one problem, which is bound once; each is the same as with a new object."""

    def __init__(self, problem: Problem, tol: float) -> None:
        from dincl.compiled.structs import StructPointer
        from dincl.projection import ActiveSet
        from dincl.steps.adaptive import adapting
        from dincl.steps.catch_up import midpoint_catch_up
        from dincl.steps.stepper import CompiledStepper

        self.problem, self.tol = problem, tol
        self._stepper = CompiledStepper.projecting(problem, midpoint_catch_up, ActiveSet(tol), linearised=True)
        self._memory = StructPointer(adapting(problem.x0.size))

    def run(self, times: Floats, tau: float, longest_step: float) -> RunOutcome:
        """Make one run with steps whose estimates are at most ``tau``."""
        state, work, found = self.start(longest_step), self._stepper.work, list[Reached]()
        between = _Between(self.problem, self.tol, times, tau, longest_step, found)
        for q, until in enumerate(times):
            try:
                state = self.advance(state, float(until), float(until), tau, longest_step)
            except StepFailure as failure:
                found.append(self.reached)
                t, detail = self.reached.t, f"{failure.detail} This was in a step after t = {self.reached.t:.6g}."
                states = np.array([one.x for one in found])
                return RunOutcome(
                    np.append(times[:q], t), states, failure.status, detail, work, between, failure=failure
                )
            found.append(state)
        return RunOutcome(times.copy(), np.array([one.x for one in found]), Status.SUCCESS, "", work, between)

    def start(self, longest_step: float) -> Reached:
        """Forget earlier runs; return the state at t = 0."""
        arrays, x0 = self._stepper.system.arrays, self.problem.x0
        arrays.program.multiplier[:] = 0.0
        arrays.near.radius[0] = -1.0  # no list is long enough: the first step searches
        self._stepper.work = self._stepper.system.sets.work = Work(degrees_of_freedom=x0.size)
        self._stepper.pointer.value.x[:] = x0.ravel()
        self.reached = Reached(0.0, x0, x0, 0.0, FIRST * longest_step)
        return self.reached

    def advance(self, state: Reached, until: float, stop: float, tau: float, longest_step: float) -> Reached:
        """Make the steps towards the output time ``until`` that end at ``stop`` or before the step after it."""
        from dincl.steps.adaptive import TOO_SHORT, adapt
        from dincl.system.arrays import OK

        stepper, shape = self._stepper, self.problem.x0.shape
        place, memory = stepper.pointer.address, self._memory.address
        t, h, last, code, total, most = state.t, state.h, state.last, OK, 0, max(CHUNK // len(self.problem.x0), 1)
        with stepper.system.callbacks():
            while t < stop and code == OK:
                code, t, h, last, made, repeated = adapt(
                    place, memory, t, until, stop, h, last, tau, longest_step, self.tol, most
                )
                total += made
                stepper.work.steps += made + repeated
                stepper.system.count(stepper.work)
        x, before = (part.reshape(shape).copy() for part in (stepper.pointer.value.x, self._memory.value.before))
        self.reached = Reached(t, x, before if total else state.before, last, h)
        if code == TOO_SHORT:
            raise StepFailure(Status.STEP_TOO_SMALL, "The estimated error of a step does not fall with its length.")
        if code != OK:
            stepper.fail(code)
        return self.reached


@dataclass(frozen=True, eq=False)
class _Between(Between):
    """Straight lines between the steps of a run, which is made once more."""

    problem: Problem
    tol: float
    times: Floats
    tau: float
    longest_step: float
    found: list[Reached]

    def states(self, times: Floats) -> Floats:
        """Compute x between two steps by (1.48)."""
        runs, values = AdaptiveRuns(self.problem, self.tol), np.empty((len(times), *self.problem.x0.shape))
        state = runs.start(self.longest_step)
        for k, t in enumerate(times):
            for until in self.times[np.searchsorted(self.times, state.t, side="right") :]:
                if state.t >= t:
                    break
                state = runs.advance(state, float(until), min(float(t), float(until)), self.tau, self.longest_step)
            weight = 1.0 - (state.t - t) / state.last if state.last else 1.0
            values[k] = state.x if state.t == t else state.before + weight * (state.x - state.before)
        return values

    def residuals(self, times: Floats) -> Floats:
        """Compute the residuals of the steps that end at the output times."""
        return np.array([self._residual(one) for one in self.found])

    def _residual(self, reached: Reached) -> float:
        from dincl.projection.cone import distance_to_cone

        if reached.last == 0.0:
            return np.inf
        try:
            drift = self.problem.velocity(reached.t - reached.last, reached.before)
            reaction = (reached.x - reached.before) / reached.last - drift
            rows = self.problem.rows_within(reached.t, reached.x, reached.last * longest(drift) / 2)
            return distance_to_cone(reaction.ravel(), rows.jacobian(reached.x))
        except StepFailure:
            return np.inf
