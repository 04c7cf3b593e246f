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
from tissue.state.cells import Cells
from verification.thesis.chapter3 import linear
from verification.thesis.chapter3.frozen import FLOORED
from verification.thesis.chapter3.growing import Growing, extent, growing_from, nuclei, rms, with_noise
from verification.thesis.chapter3.intervals import CONFIDENCE, over_seeds
from verification.thesis.quasi_steady.run import QuasiSteadyRun, simulate_quasi_steady

Floats = NDArray[np.float64]
# What (3.26) as printed does: it leaves out the factor 1/2 of (3.25).
DOUBLED = {"daha.alpha": 2e-4, "daha.gamma": 2e-3}
# Readings of the model, with a step of DAHA as in (3.25) or in (3.26): a preset and what changes in it. The published
# program has the last one, and DAHA with the parameters of Table 4.
PRINTED, TERMINATING, SQUARED, PROGRAM = READINGS = (
    *("as printed", "desired rest lengths ≥ 0", "squared denominators", "published program"),
)
DOUBLED_CASE = f"{TERMINATING}, alpha doubled"
CASES: dict[str, tuple[str, dict[str, Any]]] = {
    PRINTED: ("thesis", {}),
    TERMINATING: ("thesis", FLOORED),
    f"{PRINTED}, alpha doubled": ("thesis", DOUBLED),
    DOUBLED_CASE: ("thesis", FLOORED | DOUBLED),
    SQUARED: ("corrected", {}),
    PROGRAM: ("published", {}),
}
# Of Figure 11; the tolerance of Table 4.
TOLERANCES, OWN = (1e-5, 1e-6, 1e-7), 1e-6
# Seeds of each case and tolerance that are compared with PBD; with 1e-7 a run takes ten times as long, and shows
# nothing but its iterations. Of each reading 73 give the 95 % interval of a share of 1/4 the half-width 0.1.
SEEDS, FEW, OF_READINGS = 20, 3, 73
END, TIMES = 10.0, (1.0, 10.0)
# (3.32), section 3.4, Table 5, Figure 15, and (3.32) with the factor that it leaves out.
DAMPINGS = (0.1, 0.1333, 0.14, 0.15, 0.2, 0.2667, 0.4)
THEORY, COMPARED, TABLE_5 = 0.1333, 0.14, 0.15
PBD_SUBSTEPS = (20, 200)
# Seeds of other noise are these beyond those of the run; resampled sets of seeds; points of a parabola.
OTHER, RESAMPLED, NEIGHBOURS = 1_000_000, 1000, 5
COLUMNS = {
    "case": "Model",
    "eps": "ε",
    "kind": "Against DAHA",
    "t": "t [h]",
    "mu": "μ [h]",
    "mu_low": "μ from",
    "mu_high": "μ to",
    "substeps": "Substeps",
    "runs": "Runs",
    "failed": "Not terminated",
    "share": "Share",
    "first": "First at [h]",
    "last": "Last at [h]",
    "stiffness": "Δτ² α λ_max of a cell there, median",
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
    "equal": "μ of equal height [h]",
    "equal_low": "of equal height, from",
    "equal_high": "of equal height, to",
    "height": "Height, relative deviation",
    "height_low": "Height, from",
    "height_high": "Height, to",
    "width": "Width, relative deviation",
    "width_low": "Width, from",
    "width_high": "Width, to",
}


def study(smallest: bool = False) -> Study:
    """Return one run for each case, tolerance and seed."""
    keys = [(TERMINATING, OWN, 0), (PRINTED, OWN, 0), (PROGRAM, OWN, 0)]
    if not smallest:
        keys = [(case, OWN, seed) for case in CASES for seed in range(OF_READINGS if case in READINGS else SEEDS)]
        compared = [case for case in CASES if case not in (SQUARED, PROGRAM)]
        keys += [(c, eps, s) for c in compared for eps, n in ((1e-5, SEEDS), (1e-7, FEW)) for s in range(n)]
    runs = tuple(dict(zip(("case", "eps", "seed"), key, strict=True)) for key in keys)
    settings = {"cases": CASES, "end": END, "times": TIMES, "dampings": DAMPINGS, "substeps": PBD_SUBSTEPS}
    by = ("kind", "t", "mu", "substeps")
    return Study("tissue_daha", "Tissue: DAHA", ("case", "eps", "seed"), runs, grown, settings, COLUMNS, by)


def parameters_of(case: str, eps: float, end: float = END) -> Parameters:
    """Return the parameters of a case."""
    name, changes = CASES[case]
    return preset(name).changed({**changes, "numerics.t_end": f"{end:g} h", "numerics.keep": "1 h", "daha.eps": eps})


def grown(key: Key, end: float = END) -> list[Row]:
    """Return rows of three kinds: "run", how it ended; "step" for each step; "pbd" and others, the comparison with PBD.

    PBD is looked at for the tolerance of Table 4 only, at the times that DAHA reached. Runs beyond SEEDS, and those of
    readings without the parameters of Table 5, have the first kind alone.
    """
    parameters, seed = parameters_of(key["case"], key["eps"], end), key["seed"]
    _warm_up()
    began = time.process_time()
    run = simulate_quasi_steady(parameters, seed)
    seconds = time.process_time() - began
    about = {"kind": "run", "t": run.final.t, "seconds": seconds, "terminated": bool(run.status)}
    about |= {"status": run.status.name, "iterations": int(run.iterations.sum())}
    rows: list[dict[str, Any]] = [about]
    if seed < SEEDS and key["case"] not in (SQUARED, PROGRAM):
        about["stiffness"] = stiffness(run.final.cells, parameters)
        steps = zip(run.iterations.tolist(), run.terminated.tolist(), run.violation.tolist(), strict=True)
        for k, (made, done, off) in enumerate(steps):
            t = (k + 1) * parameters.numbers().dt
            rows.append({"kind": "step", "t": t, "iterations": made, "terminated": done, "violation": off})
        rows += _against(run, parameters, seed) if key["eps"] == OWN else []
    return [dict(key) | row for row in rows]


def stiffness(cells: Cells, parameters: Parameters) -> float:
    """Return dtau^2 alpha times the largest eigenvalue of D^2 W of a single cell, NaN for a state not finite."""
    own = parameters.daha_numbers()
    if not np.isfinite(extent(cells)):
        return np.nan
    return float(own.dtau**2 * own.alpha * linear.largest(linear.own_hessians(cells, parameters.numbers())).max())


@cache
def _warm_up() -> None:
    """Load and compile, apart from what is timed."""
    quick = parameters_of(PRINTED, OWN, 1.0).changed({"daha.most_iterations": 1})
    simulate_quasi_steady(quick, 0)
    growing_from(quick, 0).to(1.0)


def _against(run: QuasiSteadyRun, parameters: Parameters, seed: int) -> list[dict[str, Any]]:
    """Compare PBD with each damping and number of substeps, and with other noise, at the times that DAHA reached."""
    done = len(run.frames) if run.status else len(run.frames) - 1
    targets = {t: frame for frame in run.frames[:done] for t in TIMES if abs(frame.t - t) < parameters.numbers().dt / 2}
    few, many = PBD_SUBSTEPS
    rows, kept = [], {}
    for substeps in PBD_SUBSTEPS:
        for mu in DAMPINGS:
            for t, frame, seconds in _states(growing_from(parameters, seed, mu=mu, substeps=substeps), targets):
                kept[mu, substeps, t] = frame
                about = {"kind": "pbd", "mu": mu, "substeps": substeps, "seconds": seconds}
                rows.append(about | {"t": t} | _distances(targets[t], frame))
    other = with_noise(growing_from(parameters, seed, mu=COMPARED), OTHER + seed)
    for t, frame, _ in _states(other, targets):
        rows.append({"kind": "other noise", "mu": COMPARED, "t": t} | _distances(targets[t], frame))
        if all((COMPARED, substeps, t) in kept for substeps in PBD_SUBSTEPS):
            itself = _distances(kept[COMPARED, many, t], kept[COMPARED, few, t])
            rows.append({"kind": "pbd with itself", "mu": COMPARED, "t": t} | itself)
    return rows


def _states(run: Growing, targets: dict[float, Frame]) -> list[tuple[float, Frame, float]]:
    """Return time, state and seconds so far at each target, until the run is lost."""
    return [(t, run.frame(), run.seconds) for t in sorted(targets) if run.to(t)]


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
    """Return one row for each case and tolerance: quartiles over the steps that terminated, and μ by (3.32).

    ``half`` is dt / (n alpha / 2), by (3.25); ``whole`` is dt / (n alpha), (3.32); n is the median.
    """
    rows = []
    for (case, eps), mine in table[table["kind"] == "step"].groupby(["case", "eps"]):
        done = mine.loc[mine["terminated"].astype(bool), "iterations"]
        low, middle, high = done.quantile([0.25, 0.5, 0.75]) if len(done) else (np.nan,) * 3
        parameters = parameters_of(str(case), float(eps))
        whole = parameters.numbers().dt / (middle * parameters.daha_numbers().alpha)
        counts = {"steps": len(mine), "terminated": len(done), "violation": mine["violation"].max()}
        about = {"case": case, "eps": eps, "low": low, "median": middle, "high": high, "mean": done.mean()}
        rows.append(about | {"whole": whole, "half": 2 * whole} | counts)
    return pd.DataFrame(rows)


def failures(table: pd.DataFrame) -> pd.DataFrame:
    """Return one row for each case and tolerance: runs that did not terminate, with Wilson's interval of their share.

    Beside it the times at which they failed, and the median ``stiffness`` there.
    """
    rows = []
    for (case, eps), mine in table[table["kind"] == "run"].groupby(["case", "eps"]):
        failed = mine[~mine["terminated"].astype(bool)]
        share = binomtest(len(failed), len(mine)).proportion_ci(method="wilson")
        about = {"case": case, "eps": eps, "runs": len(mine), "failed": len(failed), "share": len(failed) / len(mine)}
        about |= {"low": float(share.low), "high": float(share.high), "stiffness": failed["stiffness"].median()}
        rows.append(about | {"first": failed["t"].min(), "last": failed["t"].max()})
    return pd.DataFrame(rows)


def shares(failed: pd.DataFrame) -> pd.DataFrame:
    """Return the rows of ``failures`` for each reading of the model, with the tolerance of Table 4."""
    return failed[(failed["eps"] == OWN) & failed["case"].isin(READINGS)].reset_index(drop=True)


def distances(table: pd.DataFrame) -> pd.DataFrame:
    """Return one row for each case, kind, time, damping and number of substeps: means over the seeds with intervals."""
    rows = []
    names = ["case", "kind", "t", "mu", "substeps"]
    for group, mine in table[table["relative"].notna()].groupby(names, dropna=False):
        row: dict[str, Any] = dict(zip(names, group, strict=True))
        row |= {"rms": mine["rms"].mean(), "least": mine["relative"].min(), "runs": len(mine)}
        row["relative"], row["low"], row["high"] = over_seeds(mine["relative"])
        for name in ("height", "width"):
            off = mine[name] / mine[f"reference_{name}"] - 1
            row[name], row[f"{name}_low"], row[f"{name}_high"] = over_seeds(off)
        rows.append(row)
    return pd.DataFrame(rows)


def speed(table: pd.DataFrame) -> pd.DataFrame:
    """Return one row for each case with the ε of Table 4: seconds of runs of DAHA to END over seconds of PBD."""
    rows = []
    runs = table[(table["kind"] == "run") & (table["eps"] == OWN) & table["terminated"].eq(True)]
    pbd = table[(table["kind"] == "pbd") & (table["substeps"] == min(PBD_SUBSTEPS)) & (table["mu"] == TABLE_5)]
    for case, mine in runs[runs["case"].isin(pbd["case"]) & (runs["seed"] < SEEDS)].groupby("case"):
        own = pbd[(pbd["case"] == case) & (pbd["t"] == pbd["t"].max())].set_index("seed")["seconds"]
        found = over_seeds((mine.set_index("seed")["seconds"] / own).dropna())
        times = {"daha": mine["seconds"].median(), "pbd": own.median()}
        work = mine["iterations"].mean() / (min(PBD_SUBSTEPS) * END / parameters_of(str(case), OWN).numbers().dt)
        rows.append({"case": case} | times | {"ratio": found.mean, "low": found.low, "high": found.high, "work": work})
    return pd.DataFrame(rows, columns=["case", "daha", "pbd", "ratio", "low", "high", "work"])


def fitted(table: pd.DataFrame) -> pd.DataFrame:
    """Return one row for each case, time and number of substeps: the dampings of least distance and of equal height.

    ``mu`` is the minimum of a parabola in log mu through the mean relative distances next to the least of them, with
    the percentiles of resampled seeds; ``equal`` is where a line through the two nearest heights meets that of DAHA,
    mean over the seeds with Student's interval. Where the minimum is an end of the dampings, ``mu`` is that end.
    Fewer than NEIGHBOURS dampings make no row.
    """
    rows = []
    pbd = table[(table["kind"] == "pbd") & table["relative"].notna()]
    for (case, t, substeps), mine in pbd.groupby(["case", "t", "substeps"]):
        grid = mine.pivot(index="seed", columns="mu", values="relative").dropna(axis="columns")
        mu, relative = grid.columns.to_numpy(float), grid.to_numpy()
        if len(mu) < NEIGHBOURS:
            continue
        about = {"case": case, "t": t, "substeps": int(substeps), "mu": best(mu, relative.mean(axis=0))}
        about["mu_low"], about["mu_high"] = _resampled(mu, relative)
        about |= {"least": relative.mean(axis=0).min(), "runs": len(grid)}
        about["equal"], about["equal_low"], about["equal_high"] = over_seeds(_equal_heights(mine))
        rows.append(about)
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


def _equal_heights(rows: pd.DataFrame) -> list[float]:
    """Return for each seed the damping with the height of DAHA; seeds beyond the dampings are left out."""
    found = []
    for _, mine in rows.sort_values("mu").groupby("seed"):
        off, x = (mine["height"] - mine["reference_height"]).to_numpy(), np.log(mine["mu"].to_numpy())
        change = np.flatnonzero(np.sign(off[1:]) != np.sign(off[:-1]))
        if change.size:
            k = int(change[0])
            part = off[k] / (off[k] - off[k + 1])
            found.append(float(np.exp(x[k] + part * (x[k + 1] - x[k]))))
    return found
