"""Choices of the tab of inclusions: scenes, problems of users, methods; and their references."""

from __future__ import annotations

import inspect
import runpy
import threading
from collections.abc import Callable, Mapping
from functools import lru_cache, partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

import dincl
from dincl import scenes
from dincl.checks import array, describe, number
from dincl.errors import InvalidProblem
from dincl.norms import longest
from dincl.problem import Problem
from dincl.scenes import Scene
from dincl.schemes import Scheme

Floats = NDArray[np.float64]

TOL = 1e-11  # of projections and of the reference [length]
# With more particles a reference takes too long; one whose error is larger, relative to the size, shows nothing.
MOST_PARTICLES, WORST = 300, 1e-3
STRENGTH = 100.0  # of the penalty [1 / time]
PICTURES = 128  # output times after the start; steps are these, or halves or doubles of them, so that all times nest
LONGEST = 10  # times that of the problem, which a run may last
NAME = "problem"
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
    problem: Problem
    end: float


class KnownStates(NamedTuple):
    """The solution at the output times: states (K, N, d), or None where it is not known; and how well it is known."""

    x: Floats | None
    words: str


@lru_cache
def scene(name: str) -> Inclusion:
    """Return a scene of SCENES; the same one for all visitors."""
    make = SCENES[name]
    made = make()
    text = inspect.getdoc(make.func if isinstance(make, partial) else make) or ""
    return Inclusion(made.title, text.partition("\n\n")[0].replace("\n", " "), made, made.times[-1])


# A program is run with names of the interpreter that are one for all threads.
_running = threading.Lock()


def from_file(path: Path) -> Inclusion:
    """Load the problem that a Python file names: ``problem``, or the only dincl.Problem in it.

    Where the file names times ``t``, as for ``verification compare``, the last one ends the runs; otherwise a scene
    says when, or it is 1. The file is run, each time that it is read.

    Raises
    ------
    InvalidProblem
        If it cannot be run, names no problem or several, or one that is not in one or two dimensions.
    """
    try:
        with _running:
            named = runpy.run_path(str(path))
    except (Exception, SystemExit) as error:
        raise InvalidProblem(f"{path.name}: cannot be run: {type(error).__name__}: {error}") from error
    problem = _problem(named, path.name)
    d = problem.x0.shape[1]
    if d > 2:
        raise InvalidProblem(f"{path.name}: d = {d}: drawn are problems in 1 or 2 dimensions")
    times = array(f"{path.name}: t", named.get("t", getattr(problem, "times", 1.0)))
    end = number(f"{path.name}: the last of t", times.max(initial=0.0), positive=True)
    return Inclusion(getattr(problem, "title", path.name), repr(problem), problem, end)


def _problem(named: Mapping[str, Any], file: str) -> Problem:
    found = {name: value for name, value in named.items() if isinstance(value, Problem)}
    chosen = named.get(NAME) if NAME in named or len(found) != 1 else next(iter(found.values()))
    if isinstance(chosen, Problem):
        return chosen
    if chosen is not None:
        raise InvalidProblem(f"{file}: {NAME} = {describe(chosen)}: must be a dincl.Problem")
    several = f"names several problems, {', '.join(found)}" if found else "names no dincl.Problem"
    raise InvalidProblem(f"{file}: {several}: must name one, {NAME} = dincl.Problem(...)")


def checked_end(inclusion: Inclusion, value: Any) -> float:
    """Check the time at which runs are to end; in a much longer run the problem is at rest.

    Raises
    ------
    InvalidProblem
        If it is not a number > 0, or too long.
    """
    end, most = number("end time", value, positive=True), LONGEST * inclusion.end
    if end > most:
        raise InvalidProblem(f"end time = {describe(value)}: must be at most {most:g}")
    return end


def kept_times(end: float) -> Floats:
    """Return the times of pictures, 0 and ``end`` among them."""
    return np.arange(PICTURES + 1) * end / PICTURES


@lru_cache(maxsize=32)
def reference(problem: Problem, end: float) -> KnownStates:
    """Return the exact solution where there is a formula, else that of the event-driven scheme with its estimate."""
    times, exact, count = kept_times(end), getattr(problem, "exact", None), len(problem.x0)
    if exact is not None:
        return KnownStates(exact(times), "the exact solution")
    if count > MOST_PARTICLES:
        return KnownStates(None, f"unknown. {count} particles: it is computed for at most {MOST_PARTICLES}")
    try:
        path = dincl.solve(problem, dincl.EventDriven(TOL), t=times, throw=False)
    except InvalidProblem as error:
        return KnownStates(None, f"unknown. {error}")
    if path.error is None or path.error.max() > WORST * longest(path.final):
        return KnownStates(None, f"unknown. {path.status.value} {path.detail}".rstrip())
    return KnownStates(path.x, f"event-driven, estimated error {path.error.max():.1g}")
