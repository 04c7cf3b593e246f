"""The quasi-steady model by DAHA against the first-order model by PBD: same seed, same noise, same divisions."""
# ruff: noqa: RUF001 - headings for readers are written with Greek letters

from __future__ import annotations

import time
from functools import cache
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from scipy.stats import binomtest

from dincl.study import Key, Row, Study
from tissue.files.parameters import Parameters, preset
from tissue.frames.frame import Frame
from tissue.frames.observables import extents, height
from verification.thesis.chapter3.growing import FLOORED, growing_from, nuclei, rms, with_noise
from verification.thesis.chapter3.sampled import CONFIDENCE, over_seeds
from verification.thesis.quasi_steady.daha import simulate_quasi_steady
from verification.thesis.quasi_steady.iteration import TABLE_4, Daha

Floats = NDArray[np.float64]
# What (3.26) as printed does: it leaves out the factor 1/2 of (3.25).
DOUBLED = TABLE_4._replace(alpha=2e-4, gamma=2e-3)
# Readings of the model, with a step of DAHA as in (3.25) or in (3.26): a preset, what changes in it, and the numbers of
# DAHA. The published program has the last one.
PRINTED, TERMINATING, SQUARED, PROGRAM = READINGS = (
    *("as printed", "desired rest lengths ≥ 0", "squared denominators", "published program"),
)
DOUBLED_CASE = f"{TERMINATING}, alpha doubled"
CASES: dict[str, tuple[str, dict[str, Any], Daha]] = {
    PRINTED: ("thesis", {}, TABLE_4),
    TERMINATING: ("thesis", FLOORED, TABLE_4),
    DOUBLED_CASE: ("thesis", FLOORED, DOUBLED),
    SQUARED: ("corrected", {}, TABLE_4),
    PROGRAM: ("published", {}, TABLE_4),
}
# Seeds that are compared with PBD; of each reading 73 give the 95 % interval of a share of 1/4 the half-width 0.1.
SEEDS, OF_READINGS, END = 20, 73, 10.0
# (3.32), section 3.4, Table 5, Figure 15, and (3.32) with the factor that it leaves out.
DAMPINGS = (0.1, 0.1333, 0.14, 0.15, 0.2, 0.2667, 0.4)
THEORY, COMPARED, TABLE_5 = 0.1333, 0.14, 0.15
PBD_SUBSTEPS = 20
# Seeds of other noise are these beyond those of the run; resampled sets of seeds; points of a parabola.
OTHER, RESAMPLED, NEIGHBOURS = 1_000_000, 1000, 5
COLUMNS = {
    "case": "Model",
    "kind": "Against DAHA",
    "mu": "μ [h]",
    "mu_low": "μ from",
    "mu_high": "μ to",
    "runs": "Runs",
    "failed": "Not terminated",
    "share": "Share",
    "first": "First at [h]",
    "last": "Last at [h]",
    "median": "Median iterations",
    "relative": "Distance of nuclei, relative",
    "daha": "DAHA [s]",
    "pbd": "PBD [s]",
    "ratio": "Ratio",
    "low": "from",
    "high": "to",
    "work": "Iterations / substeps",
    "whole": "Δt/(n α) [h], (3.32)",
    "half": "2Δt/(n α) [h]",
    "violation": "Largest violation [R_soft]",
    "rms": "Distance of nuclei [R_soft]",
    "least": "Least distance",
    "height": "Height, relative deviation",
    "height_low": "Height, from",
    "height_high": "Height, to",
    "width": "Width, relative deviation",
    "width_low": "Width, from",
    "width_high": "Width, to",
}


def study(smallest: bool = False) -> Study:
    """Return one run for each case and seed."""
    keys = [(case, seed) for case in CASES for seed in range(OF_READINGS if case in READINGS else SEEDS)]
    if smallest:
        keys = [(TERMINATING, 0), (PRINTED, 0), (PROGRAM, 0)]
    runs = tuple({"case": case, "seed": seed} for case, seed in keys)
    settings = {"cases": CASES, "end": END, "dampings": DAMPINGS, "substeps": PBD_SUBSTEPS}
    return Study("tissue_daha", "Tissue: DAHA", ("case", "seed"), runs, grown, settings, COLUMNS, ("kind", "t", "mu"))


def parameters_of(case: str, end: float = END) -> Parameters:
    """Return the parameters of a case."""
    name, changes, _ = CASES[case]
    return preset(name).changed({**changes, "numerics.t_end": f"{end:g} h", "numerics.keep": "1 h"})


def grown(key: Key, end: float = END) -> list[Row]:
    """Return rows of three kinds: "run", how it ended; "step" for each step; "pbd" and "other noise", comparisons.

    PBD is looked at where DAHA reached the end. Runs beyond SEEDS, and those of readings without the parameters of
    Table 5, have the first kind alone.
    """
    parameters, seed = parameters_of(key["case"], end), key["seed"]
    _warm_up()
    began = time.process_time()
    run = simulate_quasi_steady(parameters, seed, CASES[key["case"]][2])
    seconds = time.process_time() - began
    about = {"kind": "run", "t": run.final.t, "seconds": seconds, "terminated": bool(run.status)}
    rows: list[dict[str, Any]] = [about | {"status": run.status.name, "iterations": int(run.iterations.sum())}]
    if seed < SEEDS and key["case"] not in (SQUARED, PROGRAM):
        steps = zip(run.iterations.tolist(), run.terminated.tolist(), run.violation.tolist(), strict=True)
        for k, (made, done, off) in enumerate(steps):
            t = (k + 1) * parameters.numbers().dt
            rows.append({"kind": "step", "t": t, "iterations": made, "terminated": done, "violation": off})
        rows += _against(run.final, parameters, seed) if run.status else []
    return [dict(key) | row for row in rows]


@cache
def _warm_up() -> None:
    """Load and compile, apart from what is timed."""
    quick = parameters_of(PRINTED, 1.0)
    simulate_quasi_steady(quick, 0, TABLE_4._replace(most_iterations=1))
    growing_from(quick, 0).to(1.0)


def _against(target: Frame, parameters: Parameters, seed: int) -> list[dict[str, Any]]:
    """Compare PBD with each damping, and with other noise, at the end; a run that is lost has no row."""
    made = [("pbd", mu, growing_from(parameters, seed, mu=mu, substeps=PBD_SUBSTEPS)) for mu in DAMPINGS]
    made.append(("other noise", COMPARED, with_noise(growing_from(parameters, seed, mu=COMPARED), OTHER + seed)))
    return [
        {"kind": kind, "mu": mu, "t": target.t, "seconds": run.seconds} | _distances(target, run.frame())
        for kind, mu, run in made
        if run.to(target.t)
    ]


def _distances(one: Frame, other: Frame) -> dict[str, float]:
    """Return |X - Y| relative to |X| as in section 3.4, per nucleus in R_soft, and heights and widths of both."""
    x, y = nuclei(one), nuclei(other)
    return {
        "relative": float(np.linalg.norm(x - y) / np.linalg.norm(x)),
        "rms": rms(x, y),
        "height": height(other),
        "reference_height": height(one),
        "width": extents(other).apical_width,
        "reference_width": extents(one).apical_width,
    }


def iterations(table: pd.DataFrame) -> pd.DataFrame:
    """Return one row for each case: quartiles over the steps that terminated, and μ by (3.32).

    ``half`` is dt / (n alpha / 2), by (3.25); ``whole`` is dt / (n alpha), (3.32); n is the median.
    """
    rows = []
    for case, mine in table[table["kind"] == "step"].groupby("case"):
        done = mine.loc[mine["terminated"].astype(bool), "iterations"]
        low, middle, high = done.quantile([0.25, 0.5, 0.75])
        whole = parameters_of(str(case)).numbers().dt / (middle * CASES[str(case)][2].alpha)
        counts = {"steps": len(mine), "terminated": len(done), "violation": mine["violation"].max()}
        about = {"case": case, "low": low, "median": middle, "high": high, "mean": done.mean()}
        rows.append(about | {"whole": whole, "half": 2 * whole} | counts)
    return pd.DataFrame(rows)


def failures(table: pd.DataFrame) -> pd.DataFrame:
    """Return one row for each case: runs that did not terminate, Wilson's interval of their share, when they failed."""
    rows = []
    for case, mine in table[table["kind"] == "run"].groupby("case"):
        failed = mine[~mine["terminated"].astype(bool)]
        share = binomtest(len(failed), len(mine)).proportion_ci(method="wilson")
        about = {"case": case, "runs": len(mine), "failed": len(failed), "share": len(failed) / len(mine)}
        about |= {"low": float(share.low), "high": float(share.high)}
        rows.append(about | {"first": failed["t"].min(), "last": failed["t"].max()})
    return pd.DataFrame(rows)


def shares(failed: pd.DataFrame) -> pd.DataFrame:
    """Return the rows of ``failures`` for each reading of the model."""
    return failed[failed["case"].isin(READINGS)].reset_index(drop=True)


def distances(table: pd.DataFrame) -> pd.DataFrame:
    """Return one row for each case, kind and damping: means over the seeds with intervals."""
    rows = []
    names = ["case", "kind", "mu"]
    for group, mine in table[table["relative"].notna()].groupby(names):
        row: dict[str, Any] = dict(zip(names, group, strict=True))
        row |= {"rms": mine["rms"].mean(), "least": mine["relative"].min(), "runs": len(mine)}
        row["relative"], row["low"], row["high"] = over_seeds(mine["relative"])
        for name in ("height", "width"):
            off = mine[name] / mine[f"reference_{name}"] - 1
            row[name], row[f"{name}_low"], row[f"{name}_high"] = over_seeds(off)
        rows.append(row)
    return pd.DataFrame(rows)


def speed(table: pd.DataFrame) -> pd.DataFrame:
    """Return one row for each case: seconds of runs of DAHA to END over seconds of PBD."""
    rows = []
    runs = table[(table["kind"] == "run") & table["terminated"].eq(True)]
    pbd = table[(table["kind"] == "pbd") & (table["mu"] == TABLE_5)]
    for case, mine in runs[runs["case"].isin(pbd["case"]) & (runs["seed"] < SEEDS)].groupby("case"):
        own = pbd[pbd["case"] == case].set_index("seed")["seconds"]
        found = over_seeds((mine.set_index("seed")["seconds"] / own).dropna())
        times = {"daha": mine["seconds"].median(), "pbd": own.median()}
        work = mine["iterations"].mean() / (PBD_SUBSTEPS * END / parameters_of(str(case)).numbers().dt)
        rows.append({"case": case} | times | {"ratio": found.mean, "low": found.low, "high": found.high, "work": work})
    return pd.DataFrame(rows, columns=["case", "daha", "pbd", "ratio", "low", "high", "work"])


def fitted(table: pd.DataFrame) -> pd.DataFrame:
    """Return one row for each case: the damping of least distance.

    ``mu`` is the minimum of a parabola in log mu through the mean relative distances next to the least of them, with
    the percentiles of resampled seeds. Where the minimum is an end of the dampings, ``mu`` is that end.
    """
    rows = []
    for case, mine in table[table["kind"] == "pbd"].groupby("case"):
        grid = mine.pivot(index="seed", columns="mu", values="relative")
        mu, relative = grid.columns.to_numpy(float), grid.to_numpy()
        about = {"case": case, "mu": best(mu, relative.mean(axis=0))}
        about["mu_low"], about["mu_high"] = _resampled(mu, relative)
        rows.append(about | {"least": relative.mean(axis=0).min(), "runs": len(grid)})
    return pd.DataFrame(rows)


def best(mu: Floats, distance: Floats) -> float:
    """Return the minimum of distances (K,) over the dampings (K,), K >= NEIGHBOURS."""
    k = int(np.argmin(distance))
    first = int(np.clip(k - NEIGHBOURS // 2, 0, max(0, len(mu) - NEIGHBOURS)))
    some = slice(first, first + NEIGHBOURS)
    x = np.log(mu[some])
    bend, slope, _ = np.polyfit(x, distance[some], 2)
    if bend <= 0:
        return float(mu[k])
    return float(np.exp(np.clip(-slope / (2 * bend), x[0], x[-1])))


def _resampled(mu: Floats, relative: Floats) -> tuple[float, float]:
    """Return the interval of ``best`` over resampled rows of (seeds, K)."""
    if len(relative) < 2:
        return np.nan, np.nan
    drawn = np.random.default_rng(0).integers(len(relative), size=(RESAMPLED, len(relative)))
    found = [best(mu, relative[rows].mean(axis=0)) for rows in drawn]
    low, high = np.quantile(found, (0.5 - CONFIDENCE / 2, 0.5 + CONFIDENCE / 2))
    return float(low), float(high)
