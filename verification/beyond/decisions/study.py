"""``Auto`` and the methods that it chooses among, on random scenes: errors and CPU times on ladders of steps."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

import dincl
from dincl.drifts.counted import OutOfBudgetError
from dincl.errors import StepFailure
from dincl.schemes.auto import Choice
from dincl.schemes.event_driven import not_begun
from dincl.schemes.pilots import Candidate, candidates, limited
from dincl.study import Key, Row, Study
from dincl.work import Work
from verification.beyond.decisions.scenes import RandomScene, scene
from verification.instruments.error_norms import distance

Array = NDArray[np.float64]
AUTO = "Auto"
ALONE = "alone: "
NO_REFERENCE = "no reference"
# References have at most this part of the error that is asked for, and take at most so many seconds.
REFERENCE, PATIENCE = 1 / 20, 10.0
# Ladders: steps grow by this factor from so many on, until a run takes so many seconds or its error is the finest.
FACTOR, FEWEST, LONGEST, FINEST = 2**0.5, 4, 0.6, 1e-5
TOLERANCES = (1e-2, 1e-3, 1e-4, 1e-5)
# Runs shorter than this are made twice [s]; the shorter time counts.
BRIEF = 0.3


@dataclass(frozen=True)
class DecisionsForm:
    """Seeds of the scenes; ``Auto`` was calibrated on others, below 100."""

    seeds: tuple[int, ...] = tuple(range(1000, 1200))


FULL = DecisionsForm()


def study(form: DecisionsForm = FULL) -> Study:
    """Return the study: a run for each random scene."""
    return Study("decisions", "Random scenes", ("seed",), tuple({"seed": seed} for seed in form.seeds), run)


def run(key: Key) -> list[Row]:
    """Return the rows of a scene: of each method and setting, of ``Auto``, and of its best method chosen alone.

    One row without numbers if there is no reference; none of ``Auto`` if no method reaches the error in ``LONGEST``.
    """
    given = scene(key["seed"])
    n, d = given.problem.x0.shape
    about = {**key, "particles": n, "dimension": d, "sets": given.sets, "drift": given.drift}
    about |= {"end": float(given.t[-1]), "asked": given.error}
    exact = known(given)
    if exact is None:
        return [about | _row(NO_REFERENCE, np.nan, np.nan, np.nan)]
    methods = candidates(given.problem, given.error)
    rows = [row for method in methods for row in ladder(given, method, exact)]
    enough = [row for row in rows if row["error"] <= given.error]
    if enough:
        best = min(enough, key=lambda row: row["seconds"])["method"]
        rows.append(_chosen(given, exact, AUTO, methods))
        rows.append(_chosen(given, exact, ALONE + best, [one for one in methods if one.label == best]))
    return [about | row for row in rows]


def known(given: RandomScene) -> Array | None:
    """Return the solution at the output times, by events or by midpoint catch-up; None if both are too slow."""
    for tol in (given.error / 100, given.error * REFERENCE):
        found = _limited(given, dincl.EventDriven(tol), PATIENCE)
        if found is not None:
            return found
    midpoint = next(one for one in candidates(given.problem, 0.1 * given.error) if one.order == 2)
    steps, moved, last, seconds = 32, np.inf, None, 0.0
    while 2.5 * seconds < PATIENCE:
        began = time.process_time()
        now = _limited(given, midpoint.make(float(given.t[-1]) / steps), PATIENCE)
        seconds = time.process_time() - began
        if now is not None and last is not None:
            before, moved = moved, _apart(now, last)
            if 2 * max(moved, before / 4) <= REFERENCE * given.error:
                return now
        last, steps = now, 2 * steps
    return None


def _limited(given: RandomScene, scheme: dincl.Scheme, seconds: float) -> Array | None:
    """Return the states of a run that takes at most so many seconds; None if it takes longer, is refused or fails."""
    try:
        path = dincl.solve(limited(given.problem, seconds), scheme, t=given.t, throw=False)
    except (OutOfBudgetError, dincl.InvalidProblem):
        return None
    return path.x if path.status else None


def ladder(given: RandomScene, method: Candidate, exact: Array) -> Iterator[dict[str, Any]]:
    """Yield a row for each setting of a method."""
    if not method.order:
        for tol in sorted({*TOLERANCES, given.error}, reverse=True):
            if _limited(given, method.make(tol), LONGEST) is None:
                return
            yield _measured(given, exact, method.label, tol, partial(_solve, given, method.make(tol)))
        return
    steps, row = FEWEST, _row(method.label, 0.0, np.nan, 0.0)
    while row["seconds"] <= LONGEST and not row["error"] <= FINEST:
        setting = float(given.t[-1]) / steps
        row = _measured(given, exact, method.label, setting, partial(_solve, given, method.make(setting)))
        yield row
        steps = int(np.ceil(FACTOR * steps))


def _chosen(given: RandomScene, exact: Array, label: str, methods: Sequence[Candidate]) -> dict[str, Any]:
    """Return the row of a choice among methods, with all of its runs, and what was taken."""
    choices: list[Any] = []

    def choose() -> Any:
        try:
            choices.append(Choice(given.problem, given.t, given.error, methods).run())
        except StepFailure as failure:
            choices.append(not_begun(given.problem, Work(), failure))
        return choices[-1]

    row = _measured(given, exact, label, given.error, choose)
    made = choices[-1]
    stated = float(np.max(made.error)) if made.error is not None else np.nan
    # How many pilot runs a choice makes depends on times, so its work is not counted.
    return row | {
        "drift_evaluations": np.nan,
        "stated": stated,
        "took": type(made.scheme).__name__ if made.scheme is not None else "",
    }


def _solve(given: RandomScene, scheme: dincl.Scheme) -> Any:
    return dincl.solve(given.problem, scheme, t=given.t, throw=False)


def _measured(given: RandomScene, exact: Array, label: str, setting: float, make: Callable[[], Any]) -> dict[str, Any]:
    """Return the row of a run: largest error over the output times, CPU time, calls of the drift.

    The error is infinite if the run failed.
    """
    seconds = np.inf
    for _ in range(2):
        began = time.process_time()
        made = make()
        seconds = min(seconds, time.process_time() - began)
        if seconds > BRIEF:
            break
    reached = bool(made.status) and len(made.x) == len(given.t)
    row = _row(label, setting, _apart(made.x, exact) if reached else np.inf, seconds)
    return row | {"drift_evaluations": float(made.stats.drift_evaluations), "status": made.status.name}


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
    }


def _apart(x: Array, y: Array) -> float:
    return float(distance(x, y).max())
