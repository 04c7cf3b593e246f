"""Seconds per disc and step of PBD, per projection of each back end, and of the tissue: tables, printed and kept.

Warm-up (compilation, first neighbour lists) is apart from what is timed; of several repeats the best and the median are
kept. Beside each time stands the load under which it was measured.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

import dincl
from dincl.errors import StepFailure
from dincl.files import replacing
from dincl.projection import Projection
from dincl.rows.affine import linearised
from dincl.scenes import Scene, pile
from dincl.steps.grid import Reached, Stepper, TimeGrid
from verification.thesis.chapter3 import bench
from verification.thesis.chapter4 import bench as emt_bench

SIZES = (1_000, 10_000, 100_000, 1_000_000)
DT = 1e-3
# Disc-steps in one timed repeat: long against the clock, short against the patience of a reader.
DISC_STEPS = 3_000_000
REPEATS = 5
# Steps before timing starts: a pile has landed after 1000, jostling discs have met their neighbours after 500.
LANDED, JOSTLED = 1_000, 500

PROJECTIONS: dict[str, Projection] = {
    "Daqp": dincl.Daqp(tol=1e-9),
    "Piqp": dincl.Piqp(tol=1e-9),
    "Clarabel": dincl.Clarabel(tol=1e-9),
    "GaussSeidel": dincl.GaussSeidel(tol=1e-9),
    "CvxpyQP": dincl.CvxpyQP(tol=1e-9),
    "Ipopt": dincl.Ipopt(tol=1e-9),
}
COUNTS = (4, 10, 100, 1_000)
# Different points are projected in turn, so that a warm start helps as it does from one time step to the next.
VARIANTS = 8
# A back end that takes longer than this for one quadratic program is not asked for the many that S takes [ms].
PATIENCE = 1_000.0


def pbd_table(sizes: tuple[int, ...] = SIZES) -> pd.DataFrame:
    """Return one row per scene and size: ns per disc and step, candidate pairs and corrections."""
    rows = []
    for n in sizes:
        rows.append(_pbd_row("pile", pile(n), LANDED))
        rows.append(_pbd_row("jostle", jostle(n), JOSTLED))
    return pd.DataFrame(rows)


def jostle(n: int) -> dincl.Problem:
    """Return the discs of ``pile(n)``, each driven into its neighbours in a random direction, alike for all n.

    In a pile the pressure spreads by one layer a step, so that large piles have few contacts for a long time.
    """
    start = pile(n)
    angle = np.random.default_rng(1).uniform(0, 2 * np.pi, n)
    velocity = np.column_stack((np.cos(angle), np.sin(angle)))
    return dincl.Problem(start.x0, lambda t, x: velocity, start.constraints)


def growth(table: pd.DataFrame, scene: str) -> float:
    """Return p of cost per step ~ n^p, the slope of a line through the logarithms of the best times."""
    part = table[table["scene"] == scene]
    return float(np.polyfit(np.log(part["n"]), np.log(part["n"] * part["ns_best"]), 1)[0])


def _pbd_row(name: str, problem: dincl.Problem, warm_up: int) -> dict[str, Any]:
    n = len(problem.x0)
    count = max(20, DISC_STEPS // n)
    stepper = dincl.PBD(DT).stepper(problem)
    steps = _Steps(stepper)
    steps.make(warm_up)
    before = replace(stepper.work)
    seconds = np.array([_timed(lambda: steps.make(count)) for _ in range(REPEATS)])
    made = count * REPEATS * n
    return {
        "scene": name,
        "n": n,
        "ns_best": 1e9 * seconds.min() / (count * n),
        "ns_median": 1e9 * float(np.median(seconds)) / (count * n),
        "pairs": (stepper.work.candidate_pairs - before.candidate_pairs) / made,
        "corrections": (stepper.work.constraint_projections - before.constraint_projections) / made,
        "steps_per_list": count * REPEATS / max(1, stepper.work.neighbour_builds - before.neighbour_builds),
    }


class _Steps:
    """Steps of a scheme, one after the other."""

    def __init__(self, stepper: Stepper) -> None:
        self._stepper, self._reached = stepper, Reached(0, stepper.start())

    def make(self, count: int) -> None:
        k, state, _ = self._reached
        self._reached = self._stepper.advance(TimeGrid(DT * 10**9, 10**9), k, k + count, state)


def _timed(action: Callable[[], Any]) -> float:
    began = time.perf_counter()
    action()
    return time.perf_counter() - began


def projection_table(counts: tuple[int, ...] = COUNTS) -> pd.DataFrame:
    """Return one row per back end, set and size: milliseconds per projection, certified residual, iterations.

    The points to project are a landed pile after steps of the drift with dt = 0.008 ... 0.012; the sets are its inner
    convex approximation S~ (one quadratic program) and S itself.
    """
    rows: list[dict[str, Any]] = []
    for n in counts:
        scene, landed = _landed(n)
        for name, projection in PROJECTIONS.items():
            flat = _projection_row(name, projection, "S~", scene, landed)
            left_out = {"back_end": name, "set": "S", "n": n, "rows": flat["rows"], "status": "LEFT OUT"}
            curved = flat["ms_best"] < PATIENCE and _projection_row(name, projection, "S", scene, landed)
            rows += [flat, curved or left_out]
    return pd.DataFrame(rows)


def _landed(n: int) -> tuple[Scene, np.ndarray]:
    """Return a pile of n discs at t = 2 by linearised catch-up, which leaves no overlap."""
    scene = pile(n)
    scheme = dincl.LinearisedCatchUp(0.02, dincl.Daqp(1e-10) if n <= 30 else dincl.Piqp(1e-9))
    return scene, dincl.solve(scene, scheme, t=[2.0]).final


def _projection_row(name: str, projection: Projection, kind: str, scene: Scene, x: np.ndarray) -> dict[str, Any]:
    rng = np.random.default_rng(0)
    moves = 0.01 * scene.velocity(0.0, x) * rng.uniform(0.8, 1.2, size=(VARIANTS, *x.shape))
    near = scene.rows_within(0.0, x, 0.08)
    rows = linearised(near, x) if kind == "S~" else near
    solver = projection.solver()
    result: dict[str, Any] = {"back_end": name, "set": kind, "n": len(x), "rows": len(rows.values(x))}
    try:
        first = _timed(lambda: solver.nearest(rows, x + moves[0], x))
        seconds: list[float] = []
        began = time.perf_counter()
        while len(seconds) < 3 or (len(seconds) < 50 and time.perf_counter() - began < 1.0):
            y = x + moves[len(seconds) % VARIANTS]
            seconds.append(_timed(partial(solver.nearest, rows, y, x)))
        found = solver.nearest(rows, x + moves[0], x)
    except StepFailure as failure:
        return {**result, "status": failure.status.name, "ms_best": 0.0}
    times = {"ms_first": 1e3 * first, "ms_best": 1e3 * min(seconds), "ms_median": 1e3 * float(np.median(seconds))}
    return {**result, "status": "SUCCESS", **times, "residual": found.residual, "iterations": found.iterations}


def show(table: pd.DataFrame, title: str) -> None:
    """Print a table, numbers to three digits."""
    print(f"\n{title}\n{table.to_string(index=False, float_format='{:.3g}'.format, na_rep='')}")


def main(out: Path) -> None:
    """Measure, print, and keep all tables in the folder ``out``."""
    out.mkdir(parents=True, exist_ok=True)

    def keep(name: str, table: pd.DataFrame) -> None:
        with replacing(out / f"{name}.csv") as partial:
            table.to_csv(partial, index=False)

    pbd = pbd_table()
    show(pbd, "PBD: ns per disc and step, with the pairs and corrections per disc and step")
    for scene in ("pile", "jostle"):
        print(f"{scene}: the cost of a step grows as n^{growth(pbd, scene):.2f}")
    keep("bench_pbd", pbd)
    projections = projection_table()
    show(projections, "Projections: milliseconds each, with the certified residual")
    keep("bench_projections", projections)
    for name, (title, table) in (bench.tables() | emt_bench.tables()).items():
        show(table, title)
        keep(name, table)
