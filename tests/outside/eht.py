"""Means of an independent program of the same tissue model, and the same means of our runs; see README.md here."""

from functools import cache
from pathlib import Path

import numpy as np
import pandas as pd
from scipy.stats import fisher_exact, norm

from tissue.files.parameters import load
from tissue.frames.observables import ab_positions
from tissue.runs.simulate import simulate_many

FOLDER = Path(__file__).parent
# Runs at once: their states need memory.
RUNS_AT_ONCE = 16
# Quantities that are parts of the runs; the others are means of lengths and numbers.
PARTS = ("emt_basal_extr", "emt_apical_extr", "emt_below_control", "emt_below_control_y")
# A scenario such as A12_noINM names its event, the time of it there, and whether the EMT cell has INM. Events of that
# program act at the end of a step, ours from its beginning: 12.1 h.
DELAY = 0.1


def theirs():
    """Their means by scenario, time [h] and quantity, with ``runs`` and ``standard_error``."""
    return pd.read_csv(FOLDER / "eht_straight.csv").set_index(["scenario", "t_h", "quantity"])


def parameters_of(scenario):
    """Ours for a scenario."""
    times = sorted(set(theirs().index.get_level_values("t_h")))
    keep = {"numerics.keep": [f"{t} h" for t in times]}
    if scenario == "control":
        return load(FOLDER / "eht_like_control.toml").changed(keep)
    event, _, resting = scenario.partition("_")
    begins = {} if event == "none" else {f"emt.{event[0].lower()}": f"{int(event[1:]) + DELAY} h"}
    return load(FOLDER / "eht_like.toml").changed({**keep, **begins, "emt.inm": 0 if resting else 1})


@cache
def ours(scenario, runs):
    """The quantities of runs with the seeds 0, 1, ...: a row for each run and time, by run and ``t_h``."""
    parameters, rows = parameters_of(scenario), {}
    for begin in range(0, runs, RUNS_AT_ONCE):
        for run in simulate_many(parameters, range(begin, min(runs, begin + RUNS_AT_ONCE))):
            assert run.status
            rows |= {(run.seed, round(frame.t)): measured(frame) for frame in run.frames[1:]}
    return pd.DataFrame.from_dict(rows, orient="index").rename_axis(["run", "t_h"])


def measured(frame):
    """The quantities of one state [R_soft]."""
    cells, apical, basal = frame.cells, frame.layers.apical, frame.layers.basal
    positions, emt = ab_positions(frame), cells.emt >= 0
    found = {
        "n_cells": len(cells.x),
        "apical_height": cells.ay[apical].mean(),
        "nucleus_height": cells.y.mean(),
        "nucleus_height_control": cells.y[~emt].mean(),
        "apical_width": np.ptp(cells.ax[apical]),
        "apical_strip_length": np.hypot(np.diff(cells.ax[apical]), np.diff(cells.ay[apical])).sum(),
        "basal_width": np.ptp(cells.bx[basal]),
        "mean_yAB_control": positions[~emt].mean(),
    }
    if not emt.any():
        return found
    i = int(np.flatnonzero(emt)[0])
    return found | {
        "emt_basal_extr": positions[i] < 0,
        "emt_apical_extr": positions[i] > 1,
        "emt_below_control": positions[i] <= positions[~emt].min(),
        "emt_below_control_y": cells.y[i] <= cells.y[~emt].min(),
        "emt_y": cells.y[i],
        "emt_yAB": positions[i],
        "emt_A_y": cells.ay[i],
        "emt_B_y": cells.by[i],
    }


def p_values(scenario, runs):
    """The probability of differences of our means from theirs that are as large, by time and quantity.

    Of means by their standard errors, of parts of the runs by Fisher's exact test; 1 if both are the same in all runs.
    """
    table, expected = ours(scenario, runs).astype(float), theirs().loc[scenario]
    groups = table.groupby("t_h")
    mean, error = (part.stack().reindex(expected.index) for part in (groups.mean(), groups.sem()))
    spread, difference = np.hypot(error, expected["standard_error"]), mean - expected["mean"]
    found = pd.Series(2 * norm.sf((difference / spread).abs()), expected.index).where(difference.abs() > 1e-12, 1.0)
    for at, there in expected.iterrows():
        if at[1] in PARTS:
            count, size = round(mean[at] * runs), int(there["runs"])
            others = round(there["mean"] * size)
            found[at] = fisher_exact([[count, runs - count], [others, size - others]]).pvalue
    return found
