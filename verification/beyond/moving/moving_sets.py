"""Orders on sets that turn, close and grow, whose solutions are known exactly; beyond the thesis."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np
import pandas as pd

import dincl
from dincl.scenes import Scene
from dincl.study import Key, Row, Study
from verification.instruments.error_norms import distance
from verification.instruments.measure import reached
from verification.instruments.order import estimate, order_text
from verification.thesis.chapter2.methods import (
    CATCH_UP_ACTIVE,
    LINEARISED_ACTIVE,
    METHODS,
    MIDPOINT_ACTIVE,
    PBD,
    PENALTY_TIED,
)
from verification.thesis.chapter2.runs import about, exact, timed

SCENES: Mapping[str, Callable[[], Scene]] = {
    "drum, one disc": dincl.scenes.drum,
    "drum, two discs": lambda: dincl.scenes.drum(2),
    "closing walls": dincl.scenes.closing_walls,
    "growing discs": dincl.scenes.growing_discs,
}
SCHEMES = (PBD, CATCH_UP_ACTIVE, LINEARISED_ACTIVE, MIDPOINT_ACTIVE, PENALTY_TIED)
# Steps are STEP / 2^k for k < STEPS [time]; errors are the largest at TIMES equally spaced times.
STEP, STEPS, TIMES = 0.1, 8, 20
# Errors below this come from the tolerance of the projections [length].
FLOOR = 1e-11


def study() -> Study:
    """Return all runs; there is one form only, it takes minutes."""
    return Study(
        name="moving_sets",
        title="Sets that turn, close and grow",
        key=("scene", "method", "dt"),
        runs=tuple(
            {"scene": name, "method": method.name, "dt": STEP / 2**k}
            for k in range(STEPS)
            for name in SCENES
            for method in SCHEMES
        ),
        run=run,
    )


def run(key: Key) -> list[Row]:
    """Return the largest error and the largest overlap of one run over all times: one row."""
    problem = SCENES[key["scene"]]()
    times = np.linspace(0.0, problem.times[-1], TIMES + 1)[1:]
    path, seconds = timed(problem, METHODS[key["method"]].make(key["dt"]), times)
    states = reached(path, times)
    overlaps = [problem.violation(t, x) if np.isfinite(x).all() else np.nan for t, x in zip(times, states, strict=True)]
    found = {"error": float(distance(states, exact(problem, times)).max()), "infeasibility": float(np.max(overlaps))}
    return [dict(key) | found | about(path, seconds)]


def orders(table: pd.DataFrame) -> pd.DataFrame:
    """Return one row for each scene and method: the order with its interval, and the errors of the ends."""
    rows = []
    for scene in SCENES:
        for method in SCHEMES:
            mine = table[(table["scene"] == scene) & (table["method"] == method.name)].sort_values("dt")
            order = estimate(mine["dt"], mine["error"], floor=FLOOR, failed=mine["error"].isna().to_numpy())
            ends = {"coarse": mine["error"].iloc[-1], "fine": mine["error"].iloc[0]}
            rows.append(
                {"scene": scene, "method": method.label, "order": order_text(order), "slope": order.slope}
                | ends
                | {"infeasibility": mine["infeasibility"].iloc[0]}
            )
    return pd.DataFrame(rows)
