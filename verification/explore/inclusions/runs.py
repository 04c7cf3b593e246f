"""Scenes and methods of the tab of inclusions; runs: states at output times, overlap and error, how the run ended."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterator, Mapping
from functools import lru_cache, partial
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

import dincl
from dincl import scenes
from dincl.errors import InvalidProblem, StepFailure
from dincl.norms import longest
from dincl.problem import Problem
from dincl.scenes import Scene
from dincl.schemes import FixedStep, Scheme
from dincl.status import Status
from dincl.steps.grid import Reached, TimeGrid

Floats = NDArray[np.float64]
Gone = Callable[[], bool]

TOL = 1e-11  # of projections and of the reference [length]
STRENGTH = 100.0  # of the penalty [1 / time]
PICTURES = 128  # output times after the start; steps are these, or halves or doubles of them, so that all times nest
DISCS = 30
# Scenes by the name of the function that makes them; those in space are left out.
SCENES: Mapping[str, Callable[[], Scene]] = {
    "ten_disks_corner": scenes.ten_disks_corner,
    "four_disks": scenes.four_disks,
    "two_disks": scenes.two_disks,
    "sliding_disc": scenes.sliding_disc,
    "pile": partial(scenes.pile, DISCS),
    "stack": scenes.stack,
    "step_inclusion": scenes.step_inclusion,
    "sweeping_interval": scenes.sweeping_interval,
}
METHODS: Mapping[str, Callable[[float], Scheme]] = {
    "PBD": dincl.PBD,
    "PBD, 16 sweeps": lambda dt: dincl.PBD(dt, sweeps=16),
    "catch-up": lambda dt: dincl.CatchUp(dt, dincl.ActiveSet(tol=TOL)),
    "linearised catch-up": lambda dt: dincl.LinearisedCatchUp(dt, dincl.ActiveSet(tol=TOL)),
    "midpoint catch-up": lambda dt: dincl.MidpointCatchUp(dt, dincl.ActiveSet(tol=TOL)),
    f"penalty {STRENGTH:g}": lambda dt: dincl.Penalty(dt, strength=STRENGTH),
}


class Inclusion(NamedTuple):
    """A problem to look at: what is seen, in a few words and in one line, and the time at which its runs end."""

    title: str
    about: str
    problem: Scene
    end: float


class KnownStates(NamedTuple):
    """The solution at the output times: states (K, N, d), and how well it is known."""

    x: Floats
    words: str


@lru_cache
def scene(name: str) -> Inclusion:
    """Return a scene of SCENES; the same one for all visitors."""
    make = SCENES[name]
    made = make()
    text = inspect.getdoc(make.func if isinstance(make, partial) else make) or ""
    return Inclusion(made.title, text.partition("\n\n")[0].replace("\n", " "), made, made.times[-1])


def kept_times(end: float) -> Floats:
    """Return the times of pictures, 0 and ``end`` among them."""
    return np.arange(PICTURES + 1) * end / PICTURES


@lru_cache(maxsize=32)
def reference(inclusion: Inclusion) -> KnownStates:
    """Return the exact solution where there is a formula, else that of the event-driven scheme with its estimate."""
    times = kept_times(inclusion.end)
    if inclusion.problem.exact is not None:
        return KnownStates(inclusion.problem.exact(times), "the exact solution")
    path = dincl.solve(inclusion.problem, dincl.EventDriven(TOL), t=times)
    error = np.inf if path.error is None else path.error.max()
    return KnownStates(path.x, f"event-driven, estimated error {error:.1g}")


class InclusionRun(NamedTuple):
    """Run to make: ``method`` is of METHODS; it makes ``steps`` steps, a power of 2."""

    inclusion: Inclusion
    method: str
    steps: int

    @property
    def dt(self) -> float:
        """The step [time]."""
        return self.inclusion.end / self.steps


class SavedState(NamedTuple):
    """A state.

    Attributes
    ----------
    t, x
        Time, and positions (N, d).
    deep
        Largest violation of a constraint that ties the particle, (N,).
    error
        Distance max_i |X_i - reference|; None at a time between two pictures.
    status, detail
        Why the run ends here; SUCCESS and "" if it goes on, or is at its end.
    """

    t: float
    x: Floats
    deep: Floats
    error: float | None
    status: Status
    detail: str

    @property
    def overlap(self) -> float:
        """The largest violation of a constraint."""
        return float(self.deep.max())

    @property
    def fault(self) -> str:
        """The fault, and what to try; "" if there is none."""
        return "" if self.status else f"{self.status.value} {self.detail}".rstrip()


def integrate(run: InclusionRun, gone: Gone = lambda: False) -> Iterator[SavedState]:
    """Compute the states of ``solve`` at all steps, or at 128 equal times, and give each as it comes.

    ``gone`` is asked before each: once it says True no more come. A run that fails ends with the last state that it
    reached.

    Raises
    ------
    InvalidProblem
        If the method cannot serve the problem.
    """
    problem, grid, scheme = run.inclusion.problem, TimeGrid(run.inclusion.end, run.steps), METHODS[run.method](run.dt)
    if not isinstance(scheme, FixedStep):
        raise InvalidProblem(f"{run.method}: must be a scheme with a step")
    stepper, known, every = scheme.stepper(problem), reference(run.inclusion).x, max(1, run.steps // PICTURES)
    reached = Reached(0, stepper.start())
    for k in range(0, run.steps + 1, every):
        if gone():
            return
        with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
            reached = stepper.advance(grid, reached.k, k, reached.state)
        failure, t, x = reached.failure, grid.time(reached.k), reached.state.x
        place = reached.k * PICTURES / run.steps
        error = None if place % 1 else longest(x - known[int(place)])
        status, detail = (failure.status, failure.detail) if failure else (Status.SUCCESS, "")
        yield SavedState(t, x, depths(problem, t, x), error, status, detail)
        if failure:
            return


def depths(problem: Problem, t: float, x: Floats) -> Floats:
    """Return for each particle the largest violation of a constraint that ties it, (N,); inf where one is undefined."""
    deep = np.zeros(len(x))
    try:
        for block in problem.rows_within(t, x, 0.0).by_kind():
            depth = -block.values(x)
            violated = depth > 0
            if violated.any():
                # The derivative of squared distances is defined also where two centres coincide.
                matrix = block.take(violated).squared_jacobian(x)
                deepest = np.repeat(depth[violated], np.diff(matrix.indptr))
                np.maximum.at(deep, matrix.indices // x.shape[1], deepest)
    except StepFailure:
        deep[:] = np.inf
    return deep
