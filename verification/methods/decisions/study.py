"""Random scenes: errors and costs of five methods over ladders of settings, and of ``Auto``, which chooses its own."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from typing import Any

import numpy as np
import pandas as pd

import dincl
from dincl.study import Key, Row, Study
from verification.instruments.budget import CpuSeconds, OutOfBudgetError, counted
from verification.instruments.recommend import PROJECTION, usual_methods, usual_projection
from verification.instruments.references import Known, reference
from verification.instruments.speed_accuracy import WorkPrecision, WorkPrecisionRuns, WorkPrecisionSet
from verification.methods.decisions.scenes import RandomScene, scene
from verification.methods.methods import ADAPTIVE, EVENT_DRIVEN, LINEARISED_ACTIVE, MIDPOINT_ACTIVE, PBD

AUTO, NO_REFERENCE = "Auto", "NO_REFERENCE"
DRAWN_AS = {
    "PBD": PBD,
    "linearised catch-up": LINEARISED_ACTIVE,
    "midpoint catch-up": MIDPOINT_ACTIVE,
    "event-driven": EVENT_DRIVEN,
    "adaptive catch-up": ADAPTIVE,
}
LOOKS: dict[str, dict[str, Any]] = {
    label: {"family": label, "color": one.colour, "marker": one.marker} for label, one in DRAWN_AS.items()
}
SEEDS, SMALL = range(200), (1, 2, 17, 20)
# Of one run of a method with a ladder, of a run of Auto, and of each way to a reference.
BUDGET, PATIENCE, BRIEFLY = CpuSeconds(0.5), CpuSeconds(30.0), CpuSeconds(7.5)
# Over the error that is asked for: where a ladder ends, errors of references by events and by steps.
ENOUGH, BY_EVENTS, BY_STEPS = 1 / 10, 1 / 100, 1 / 20
# The numbers of steps of a ladder: the first one, the factor, how many. Its tolerances [length].
FIRST, FACTOR, MOST = 4, 2**0.5, 50
TOLERANCES = [0.1 / 2**k for k in range(25)]
# Columns of the instrument that the page reads.
KEPT = ["method", "setting", "status", "largest", "stated", "reference_error"]
KEPT += ["cpu_seconds", "spread", "drift_evaluations"]
COLUMNS = {"cost": "Cost", "error": "Error", "scenes": "Scenes", "method": "Method", "alone": "Cheapest alone"}
COLUMNS |= {"1": "Cheapest or tied", "2": "At most 2 times the least", "10": "10 times", "reached": "Error reached"}
COLUMNS |= {"what": "On random scenes", "count": "Scenes", "of": "of", "share": "Share", "low": "from", "high": "to"}
COLUMNS |= {"over": "CPU time of Auto over", "median": "Median", "most": "At most, in nine of ten scenes"}


def study(smallest: bool = False) -> Study:
    """Return the study: a run for each random scene; in the smallest form the coarsest settings on four small ones."""
    runs, by = tuple({"seed": seed} for seed in (SMALL if smallest else SEEDS)), ("method", "setting")
    return Study("decisions", "Random scenes", ("seed",), runs, partial(run, smallest=smallest), columns=COLUMNS, by=by)


def run(key: Key, smallest: bool) -> list[Row]:
    """Return the rows of a scene: one for each method and setting; a single one if there is no reference."""
    given = scene(key["seed"])
    n, d = given.problem.x0.shape
    about = {**key, "particles": n, "dimension": d, "layout": given.layout, "sets": given.sets, "drift": given.drift}
    about |= {"end": float(given.t[-1]), "asked": given.error}
    known = solution(given)
    if known is None:
        return [about | dict.fromkeys(KEPT, np.nan) | {"method": "", "status": NO_REFERENCE}]
    ladders = {"dt": list(steps(float(given.t[-1]))), "tol": TOLERANCES}
    by_hand, enough = usual_methods(given.problem, given.error), ENOUGH * given.error
    hand = WorkPrecisionRuns(given.problem, by_hand, ladders, given.t, known, BUDGET, "largest", enough)
    norms = ("largest", "stated")
    auto = WorkPrecisionRuns(given.problem, {AUTO: dincl.Auto}, [given.error], given.t, known, PATIENCE, norms)
    rows = pd.concat([hand.study(smallest=smallest).rows(), auto.study().rows()])
    return [about | row for row in rows.loc[rows["status"] != "LEFT_OUT", KEPT].to_dict("records")]


def steps(end: float) -> Iterator[float]:
    """Yield steps from coarse to fine that divide the time of a run."""
    count = FIRST
    for _ in range(MOST):
        yield end / count
        count = int(np.ceil(FACTOR * count))


def solution(given: RandomScene) -> Known | None:
    """Return the solution by events, or by halved midpoint steps where there are many; None if it takes too long."""
    projection = usual_projection(given.problem, 1e-2 * PROJECTION * given.error)
    by_steps = lambda dt: dincl.MidpointCatchUp(dt, projection)  # noqa: E731
    for tol, scheme, budget in (
        (BY_EVENTS, None, BRIEFLY),
        (BY_STEPS, by_steps, PATIENCE),
        (BY_STEPS, None, PATIENCE),
    ):
        problem, _ = counted(given.problem, budget)
        try:
            return reference(problem, tol * given.error, scheme)(given.t)
        except (OutOfBudgetError, RuntimeError, dincl.InvalidProblem):
            continue
    return None


def charts(rows: pd.DataFrame) -> tuple[WorkPrecisionSet, dict[str, float]]:
    """Return a chart for each scene that has a reference, and the error that is asked for in it."""
    found, asked = {}, {}
    for seed, mine in rows[rows["method"].isin(LOOKS)].groupby("seed"):
        found[str(seed)] = WorkPrecision(mine, ("largest",), BUDGET, LOOKS, title=f"Random scene {seed}")
        asked[str(seed)] = float(mine["asked"].iloc[0])
    return WorkPrecisionSet(found, "Random scenes", "decisions"), asked
