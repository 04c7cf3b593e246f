"""``Auto`` and the methods that it stands beside, on random scenes: errors and CPU times on ladders of settings."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

import dincl
from dincl.drifts.counted import OutOfBudgetError
from dincl.norms import longest
from dincl.problem import with_counted_drift
from dincl.study import Key, Row, Study
from verification.beyond.decisions.scenes import RandomScene, scene
from verification.instruments.error_norms import distance
from verification.instruments.recommend import PROJECTION, usual_projection

Array = NDArray[np.float64]
AUTO, MIDPOINT, ADAPTIVE = "Auto", "midpoint catch-up", "adaptive catch-up"
NO_REFERENCE, OUT_OF_BUDGET = "no reference", "OUT_OF_BUDGET"
# References have at most this part of the error that is asked for. A run for them, or of Auto, takes at most so many
# seconds; the first one for them less, as another method follows.
REFERENCE, PATIENCE, BRIEFLY = 1 / 20, 60.0, 15.0
# Steps of a ladder grow by the factor from so many on, and tolerances fall by TIGHTER from the largest, until a run
# takes so many seconds, its error is this part of the one asked for, or there were so many settings.
FACTOR, FEWEST, LARGEST, TIGHTER, LONGEST, FINEST, MOST = 2**0.5, 4, 0.1, 2.0, 0.5, 0.1, 50
# Runs shorter than this are made twice [s], the shorter time counts; longer runs of Auto are made once.
BRIEF, LONG = 0.3, 5.0
# The run that loads compiled code ends at this part of the time.
SHORT = 1e-6


@dataclass(frozen=True)
class DecisionsForm:
    """Seeds of the scenes; ``Auto`` was calibrated on none of them."""

    seeds: tuple[int, ...] = tuple(range(200))


FULL = DecisionsForm()


class Known(NamedTuple):
    """States at the output times, (K, N, d), and a bound of their error [length]."""

    x: Array
    error: float


def study(form: DecisionsForm = FULL) -> Study:
    """Return the study: a run for each random scene."""
    return Study("decisions", "Random scenes", ("seed",), tuple({"seed": seed} for seed in form.seeds), run)


def run(key: Key) -> list[Row]:
    """Return the rows of a scene: of each method and setting, and of ``Auto``; one row if there is no reference."""
    given = scene(key["seed"])
    n, d = given.problem.x0.shape
    about = {**key, "particles": n, "dimension": d, "layout": given.layout, "sets": given.sets, "drift": given.drift}
    about |= {"end": float(given.t[-1]), "asked": given.error}
    exact = known(given)
    if exact is None:
        return [about | _row(NO_REFERENCE, np.nan, np.nan, np.nan)]
    rows = [row for method in methods(given, PROJECTION * given.error) for row in ladder(given, method, exact.x)]
    return [about | row | {"reference": exact.error} for row in (*rows, _auto(given, exact.x))]


def known(given: RandomScene) -> Known | None:
    """Return the solution at the output times, by events or by midpoint catch-up; None if both are too slow."""
    return _by_events(given, BRIEFLY) or _by_steps(given) or _by_events(given, PATIENCE)


def _by_events(given: RandomScene, seconds: float) -> Known | None:
    for tol in (given.error / 100, given.error * REFERENCE):
        path = limited(given, dincl.EventDriven(tol), seconds)
        if path is None:
            return None
        if path.status and path.error is not None:
            return Known(path.x, float(path.error.max()))
    return None


def _by_steps(given: RandomScene) -> Known | None:
    """Halve the steps of midpoint catch-up until two runs agree, or could not in time, at an order of two."""
    midpoint, end, wanted = methods(given, tol=1e-5 * given.error)[2], float(given.t[-1]), REFERENCE * given.error
    # No particle moves farther in a step than the least radius.
    fastest = longest(given.problem.velocity(0.0, given.problem.x0))
    steps, moved, last, seconds = max(32, int(end * fastest / given.radius)), np.inf, None, 0.0
    while 2.5 * seconds < PATIENCE:
        began = time.process_time()
        now = limited(given, midpoint.make(end / steps), PATIENCE)
        seconds = time.process_time() - began
        if now is None or not now.status:
            last = None
        elif last is None:
            last = now.x
        else:
            # Twice the difference of the last runs: the order is at least one. One difference is small by chance.
            before, moved, last = moved, float(distance(now.x, last).max()), now.x
            if 2 * max(moved, before / 4) <= wanted:
                return Known(now.x, 2 * max(moved, before / 4))
            if seconds * (2 * moved / wanted) ** 0.5 > PATIENCE:
                return None
        steps *= 2
    return None


def limited(given: RandomScene, scheme: dincl.Scheme, seconds: float) -> dincl.Trajectory | None:
    """Return a run of at most so many seconds of CPU time; None if it takes longer, or is refused."""
    began = time.process_time()
    problem, _ = with_counted_drift(given.problem, lambda _: time.process_time() - began > seconds)
    try:
        return dincl.solve(problem, scheme, t=given.t, throw=False)
    except (OutOfBudgetError, dincl.InvalidProblem):
        return None


class Candidate(NamedTuple):
    """A method: ``make(setting)`` is its scheme for dt, or, if ``adaptive``, for tol."""

    label: str
    make: Callable[[float], dincl.Scheme]
    adaptive: bool


def methods(given: RandomScene, tol: float) -> tuple[Candidate, ...]:
    """Return the methods that have ladders; ``tol`` is the tolerance of projections."""
    projection = usual_projection(given.problem, tol)
    return (
        Candidate("PBD", dincl.PBD, adaptive=False),
        Candidate("linearised catch-up", lambda dt: dincl.LinearisedCatchUp(dt, projection), adaptive=False),
        Candidate(MIDPOINT, lambda dt: dincl.MidpointCatchUp(dt, projection), adaptive=False),
        Candidate("event-driven", dincl.EventDriven, adaptive=True),
        Candidate(ADAPTIVE, dincl.AdaptiveCatchUp, adaptive=True),
    )


def ladder(given: RandomScene, method: Candidate, exact: Array) -> Iterator[dict[str, Any]]:
    """Yield a row for each setting of a method, from coarse to fine."""
    steps, setting = FEWEST, LARGEST
    for k in range(MOST):
        if not method.adaptive:
            setting = float(given.t[-1]) / steps
        scheme = method.make(setting)
        if k == 0:
            with suppress(dincl.InvalidProblem):  # a short run loads compiled code, which belongs to no cost
                dincl.solve(given.problem, scheme, t=SHORT * given.t[-1], throw=False)
        # How long a run with a tolerance takes is not known beforehand.
        if (k == 0 or method.adaptive) and limited(given, scheme, LONGEST) is None:
            return
        row = _measured(given, exact, method.label, setting, scheme)
        yield row
        if row["seconds"] > LONGEST or row["error"] <= FINEST * given.error:
            return
        steps, setting = int(np.ceil(FACTOR * steps)), setting / TIGHTER


def _auto(given: RandomScene, exact: Array) -> dict[str, Any]:
    """Return the row of ``Auto``: its error, and what it states and takes."""
    began = time.process_time()
    path = limited(given, dincl.Auto(given.error), PATIENCE)
    seconds = time.process_time() - began
    if path is None:
        return _row(AUTO, given.error, np.inf, PATIENCE) | {"status": OUT_OF_BUDGET}
    if seconds > LONG:  # the first run loads compiled code
        row = _told(path, exact, AUTO, given.error, seconds)
    else:
        row = _measured(given, exact, AUTO, given.error, dincl.Auto(given.error))
    stated = np.nan if path.error is None else float(np.max(path.error))
    return row | {"stated": stated, "took": type(path.scheme).__name__}


def _measured(given: RandomScene, exact: Array, label: str, setting: float, scheme: dincl.Scheme) -> dict[str, Any]:
    """Return the row of a run; see ``_told``."""
    seconds = np.inf
    for _ in range(2):
        began = time.process_time()
        path = dincl.solve(given.problem, scheme, t=given.t, throw=False)
        seconds = min(seconds, time.process_time() - began)
        if seconds > BRIEF:
            break
    return _told(path, exact, label, setting, seconds)


def _told(path: dincl.Trajectory, exact: Array, label: str, setting: float, seconds: float) -> dict[str, Any]:
    """Return the row of a run: largest error over the output times, CPU time, calls of the drift.

    The error is infinite if the run failed.
    """
    error = float(distance(path.x, exact).max()) if path.status else np.inf
    row = _row(label, setting, error, seconds)
    return row | {"drift_evaluations": float(path.stats.drift_evaluations), "status": path.status.name}


def _row(method: str, setting: float, error: float, seconds: float) -> dict[str, Any]:
    return {
        "method": method,
        "setting": setting,
        "error": error,
        "seconds": seconds,
        "drift_evaluations": np.nan,
        "status": "",
        "stated": np.nan,
        "took": "",
        "reference": np.nan,
    }
