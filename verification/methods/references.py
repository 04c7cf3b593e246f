"""The event-driven reference beside the limits of catch-up and of linearised catch-up: an independent check.

Catch-up converges with order 1, x_h = x + c h + ..., so 2 x_{h/2} - x_h loses the term c h (Richardson). Events (a
contact that opens or closes inside of a step) make c depend on h; then the differences do not halve, and nothing can be
extrapolated.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pandas as pd
from numpy.typing import NDArray

import dincl
from dincl import scenes
from dincl.plotting import Film, plot
from dincl.study import Key, Row, Study
from verification.instruments.error_norms import distance
from verification.methods.methods import REFERENCE_TOL
from verification.site.sheet import sheet

Floats = NDArray[np.float64]
# Greatest estimated error of the reference [length].
TOL = 1e-12
SCENES = ("four_disks", "ten_disks_corner")
# Between two output times; the times of the scenes are among them [time].
EVERY = 0.25
# Of the projections [length]: what they leave in each step adds up over a run.
PROJECTION = dincl.ActiveSet(tol=1e-14)
# Of the three runs [time].
STEPS = (0.1 / 2**8, 0.1 / 2**9, 0.1 / 2**10)
# |x_{h/2} - x_h| / |x_{h/4} - x_{h/2}| is 2 where c h is the error; outside of this range it is not.
RATIOS = (1.6, 2.5)
# A difference of successive results is about their error, but it may be small by chance: where an event falls within a
# step, differs from run to run. So twice the largest difference at a time and at its two neighbours is stated.
SAFETY = 2.0
COLUMNS = {
    "scene": "Scene",
    "t": "t [time]",
    "events": "Events so far",
    "error": "Stated error [length]",
    "catch_up": "Distance to catch-up [length]",
    "catch_up_error": "Error of catch-up [length]",
    "catch_up_ratio": "Ratio of its differences",
    "linearised": "Catch-up against linearised [length]",
    "linearised_error": "Error of linearised [length]",
}


def study(smallest: bool = False) -> Study:
    """Return one run for each scene; they take a second, so that the smallest form has both."""
    keys = tuple({"scene": name} for name in SCENES)
    settings = {"tol": TOL, "every": EVERY, "steps": STEPS, "projection": PROJECTION}
    return Study("references", "References", ("scene",), keys, run, settings, COLUMNS, by=("t", "particle"))


def run(key: Key) -> list[Row]:
    """Return the positions of a scene, the errors and the distances: one row for each time and particle."""
    scene = getattr(scenes, key["scene"])()
    t = np.arange(0.0, scene.times[-1] + EVERY / 2, EVERY)
    path = dincl.solve(scene, dincl.EventDriven(TOL), t)
    full, full_error, ratio = limit(scene, dincl.CatchUp, t)
    linear, linear_error, _ = limit(scene, dincl.LinearisedCatchUp, t)
    columns = {
        "t": t,
        "events": np.searchsorted([event.t for event in path.events], t, side="right"),
        "error": np.asarray(path.error),
        "catch_up": distance(path.x, full),
        "catch_up_error": full_error,
        "catch_up_ratio": ratio,
        "linearised": distance(full, linear),
        "linearised_error": linear_error,
    }
    return [
        dict(key) | {name: values[k] for name, values in columns.items()} | {"particle": i, "x": x, "y": y}
        for k, state in enumerate(path.x)
        for i, (x, y) in enumerate(state)
    ]


def limit(scene: dincl.Problem, scheme: Callable[..., dincl.Scheme], t: Floats) -> tuple[Floats, Floats, Floats]:
    """Return ``extrapolate`` of the runs of a scheme with the three steps."""
    runs = [dincl.solve(scene, scheme(dt, PROJECTION), t).x for dt in STEPS]
    return extrapolate(runs[0], runs[1], runs[2], REFERENCE_TOL)


def extrapolate(coarse: Floats, middle: Floats, fine: Floats, tol: float) -> tuple[Floats, Floats, Floats]:
    """Return x = 2 x_{h/4} - x_{h/2} where the differences halve, otherwise x_{h/4}; its error; the ratio.

    The error is estimated by |x - (2 x_{h/2} - x_h)|, the difference of two successive extrapolations, or by the last
    difference |x_{h/4} - x_{h/2}|, or half of the first if that is larger; stated is ``SAFETY`` times the largest
    estimate at the time and at its neighbours. The ratio of the differences is NaN where both are equal.

    Arguments
    ---------
    coarse, middle, fine : (K, N, d) positions with steps h, h/2, h/4 [length]
    tol : of the projections that made them; no smaller error is stated [length]
    """
    first, second = distance(coarse, middle), distance(middle, fine)
    ratio = np.divide(first, second, out=np.full(len(first), np.nan), where=second > 0)
    halving = (ratio >= RATIOS[0]) & (ratio <= RATIOS[1])
    better = 2 * fine - middle
    x = np.where(halving[:, None, None], better, fine)
    estimate = np.where(halving, distance(better, 2 * middle - coarse), np.maximum(first / 2, second))
    padded = np.pad(estimate, 1)
    error = SAFETY * np.max([padded[:-2], estimate, padded[2:]], axis=0)
    return x, np.maximum(error, tol), ratio


def draw(rows: pd.DataFrame, path: Path) -> Path:
    """Draw both scenes: the start, the paths and the end of the reference."""
    with sheet(path, 3.4) as figure:
        for name, panel in zip(SCENES, figure.subplots(1, len(SCENES)), strict=True):
            mine, scene = rows[rows["scene"] == name], getattr(scenes, name)()
            t = np.unique(mine["t"])
            plot(Film(scene, t, mine[["x", "y"]].to_numpy().reshape(len(t), -1, 2), scene.title, ""), panel)
    return path
