"""The quasi-steady model by DAHA against the first-order model by PBD: same seed, same noise, same divisions."""

from __future__ import annotations

import time
from dataclasses import dataclass
from functools import cache, partial
from typing import Any

import numpy as np
import pandas as pd
from scipy.stats import binomtest

from dincl.study import Key, Row, Study
from tissue.files.parameters import Parameters, preset
from tissue.frames.frame import Frame
from tissue.frames.observables import height, widths
from tissue.quasi_steady.run import QuasiSteadyRun, simulate_quasi_steady
from tissue.state.cells import Cells
from verification.thesis.chapter3 import linear
from verification.thesis.chapter3.disturbed import OTHER
from verification.thesis.chapter3.growing import (
    Growing,
    extent,
    growing_from,
    nuclei,
    rms,
    with_noise,
)
from verification.thesis.chapter3.intervals import over_seeds
from verification.thesis.chapter3.judged import FLOORED

# What (3.26) as printed does: it leaves out the factor 1/2 of (3.25).
DOUBLED = {"daha.alpha": 2e-4, "daha.gamma": 2e-3}
CASES: dict[str, dict[str, Any]] = {
    "as printed": {},
    "rest lengths >= 0": FLOORED,
    "as printed, alpha doubled": DOUBLED,
    "rest lengths >= 0, alpha doubled": FLOORED | DOUBLED,
}
PRINTED, TERMINATING, _, DOUBLED_CASE = CASES
# Of Figure 11; the tolerance of Table 4.
TOLERANCES, OWN = (1e-5, 1e-6, 1e-7), 1e-6
END, TIMES = 10.0, (1.0, 10.0)
# (3.32), section 3.4, Table 5, Figure 15, and (3.32) with the factor that it leaves out.
DAMPINGS = (0.1, 0.1333, 0.14, 0.15, 0.2, 0.2667, 0.4)
THEORY, COMPARED, TABLE_5 = 0.1333, 0.14, 0.15
PBD_SUBSTEPS = (20, 200)


@dataclass(frozen=True)
class DahaForm:
    """Number of seeds by case and tolerance, dampings that are tried with the most substeps, too, end of runs [h]."""

    seeds: dict[tuple[str, float], int]
    fine: tuple[float, ...]
    end: float = END


# With 1e-7 a run takes ten times as long as with 1e-6, and shows nothing but its iterations.
FULL = DahaForm({(case, eps): 20 if eps >= OWN else 3 for case in CASES for eps in TOLERANCES}, DAMPINGS)


def study(form: DahaForm) -> Study:
    """Return the study: one run for each case, tolerance and seed."""
    runs = [
        {"case": case, "eps": eps, "seed": seed} for (case, eps), seeds in form.seeds.items() for seed in range(seeds)
    ]
    return Study(
        name="tissue_daha",
        title="Tissue: DAHA",
        key=("case", "eps", "seed"),
        runs=tuple(runs),
        run=partial(compared, end=form.end, fine=form.fine),
    )


def parameters_of(case: str, eps: float, end: float = END) -> Parameters:
    """Return the thesis preset with the changes of the case."""
    ends = {"numerics.t_end": f"{end:g} h", "numerics.keep": "1 h", "daha.eps": eps}
    return preset("thesis").changed(CASES[case] | ends)


def compared(key: Key, end: float, fine: tuple[float, ...]) -> list[Row]:
    """Return rows of three kinds: "step" for each step of DAHA; "run", how it ended; "pbd", the comparison with PBD.

    PBD is looked at for the tolerance of Table 4 only, at the times that DAHA reached.
    """
    parameters = parameters_of(key["case"], key["eps"], end)
    _warm_up()
    began = time.process_time()
    run = simulate_quasi_steady(parameters, key["seed"], throw=False)
    seconds = time.process_time() - began
    steps = zip(run.iterations.tolist(), run.terminated.tolist(), run.violation.tolist(), strict=True)
    dt = parameters.numbers().dt
    rows: list[dict[str, Any]] = [
        {"kind": "step", "t": (k + 1) * dt, "iterations": made, "terminated": done, "violation": off}
        for k, (made, done, off) in enumerate(steps)
    ]
    about = {"kind": "run", "t": run.final.t, "seconds": seconds, "terminated": bool(run.status)}
    about["stiffness"] = stiffness(run.final.cells, parameters)
    rows.append(about | {"status": run.status.name, "iterations": int(run.iterations.sum())})
    if key["eps"] == OWN:
        rows += _against(run, parameters, key["seed"], fine)
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
    simulate_quasi_steady(quick, 0, throw=False)
    growing_from(quick, 0).to(1.0)


def _against(run: QuasiSteadyRun, parameters: Parameters, seed: int, fine: tuple[float, ...]) -> list[dict[str, Any]]:
    """Compare PBD with each damping and number of substeps, and with other noise, at the times that DAHA reached."""
    done = len(run.frames) if run.status else len(run.frames) - 1
    targets = {t: frame for frame in run.frames[:done] for t in TIMES if abs(frame.t - t) < parameters.numbers().dt / 2}
    few, many = PBD_SUBSTEPS
    tried = [(mu, few) for mu in DAMPINGS] + [(mu, many) for mu in fine]
    rows, kept = [], {}
    for mu, substeps in tried:
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
        "width": widths(other).apical,
        "reference_width": widths(one).apical,
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
        low, high = wilson(len(failed), len(mine))
        about = {"case": case, "eps": eps, "runs": len(mine), "failed": len(failed)}
        about |= {"share": len(failed) / len(mine), "low": low, "high": high}
        about["stiffness"] = failed["stiffness"].median()
        rows.append(about | {"first": failed["t"].min(), "middle": failed["t"].median(), "last": failed["t"].max()})
    return pd.DataFrame(rows)


def wilson(hits: int, tries: int) -> tuple[float, float]:
    """Return Wilson's 95 % interval of a probability."""
    interval = binomtest(hits, tries).proportion_ci(method="wilson")
    return float(interval.low), float(interval.high)


def distances(table: pd.DataFrame) -> pd.DataFrame:
    """Return one row for each case, kind, time, damping and number of substeps: means over the seeds with intervals."""
    rows = []
    names = ["case", "kind", "t", "mu", "substeps"]
    for group, mine in table[table["relative"].notna()].groupby(names, dropna=False):
        mean, low, high = over_seeds(mine["relative"])
        tall, wide = (over_seeds(mine[name] / mine[f"reference_{name}"] - 1) for name in ("height", "width"))
        about = dict(zip(names, group, strict=True)) | {"relative": mean, "low": low, "high": high}
        about |= {"rms": mine["rms"].mean(), "least": mine["relative"].min(), "runs": len(mine)}
        about |= {"height": tall.mean, "height_low": tall.low, "height_high": tall.high}
        rows.append(about | {"width": wide.mean, "width_low": wide.low, "width_high": wide.high})
    return pd.DataFrame(rows)


def speed(table: pd.DataFrame, end: float = END) -> pd.DataFrame:
    """Return one row for each case with the ε of Table 4: seconds of runs of DAHA to ``end`` over seconds of PBD."""
    rows = []
    ended = table[(table["kind"] == "run") & (table["eps"] == OWN) & table["terminated"].eq(True)]
    pbd = table[(table["kind"] == "pbd") & (table["substeps"] == min(PBD_SUBSTEPS)) & (table["mu"] == TABLE_5)]
    for case, mine in ended.groupby("case"):
        own = pbd[(pbd["case"] == case) & (pbd["t"] == pbd["t"].max())].set_index("seed")["seconds"]
        ratio = mine.set_index("seed")["seconds"] / own
        found = over_seeds(ratio.dropna())
        times = {"daha": mine["seconds"].median(), "pbd": own.median()}
        work = mine["iterations"].mean() / (min(PBD_SUBSTEPS) * end / parameters_of(str(case), OWN).numbers().dt)
        rows.append({"case": case} | times | {"ratio": found.mean, "low": found.low, "high": found.high, "work": work})
    return pd.DataFrame(rows, columns=["case", "daha", "pbd", "ratio", "low", "high", "work"])
