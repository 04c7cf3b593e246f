"""Infeasibility over time of PBD against the penalty method with its best strength (Figure 6 of chapter 2)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import pandas as pd

import dincl
from dincl.study import Key, Row, Study
from verification.instruments.error_norms import distance
from verification.instruments.measure import reached
from verification.thesis.chapter2.convergence import SCENES
from verification.thesis.chapter2.reference import EventReference
from verification.thesis.chapter2.runs import about, scene, timed

# From far too weak to unstable.
SPRINGS = tuple(float(value) for value in np.geomspace(0.01, 10.0, 25))
PUSHES = tuple(float(value) for value in np.geomspace(0.3, 100.0, 25))
# Of so many of the steps, the coarsest, the curves are drawn.
DRAWN = 2
# Discs that were thrown apart do not overlap: a run competes only if its error is at most this many times that of PBD.
COMPARABLE = 5.0
# Infeasibility up to this multiple of the best one counts as the width of the optimum.
WIDTH = 2.0


@dataclass(frozen=True)
class InfeasibilityForm:
    """Steps and strengths of the scan.

    Attributes
    ----------
    steps
        Compared, the coarsest first [time].
    springs, pushes
        dt strength for exponent 2; the strength itself for exponent 1.
    """

    steps: tuple[float, ...]
    springs: tuple[float, ...] = SPRINGS
    pushes: tuple[float, ...] = PUSHES

    def strengths(self, dt: float, exponent: int) -> tuple[float, ...]:
        """Return the strengths scanned at a step; PBD, exponent 0, has none."""
        return {0: (0.0,), 1: self.pushes, 2: tuple(value / dt for value in self.springs)}[exponent]


FULL = InfeasibilityForm((0.02, 0.01, 0.005, 0.0025, 0.00125))


@dataclass(frozen=True)
class Scan:
    """The largest and the mean infeasibility in time, and the position errors, of one run: one row."""

    references: Mapping[str, EventReference]

    def __call__(self, key: Key) -> list[Row]:
        path, run = _run(key)
        kept = scene(key["scene"]).times
        error = distance(reached(path, np.array(kept)), self.references[key["scene"]].at(kept)[0])
        infeasible = path.violation()
        row = {"largest": infeasible.max(), "mean": infeasible.mean(), "error": error.max()}
        return [dict(key) | row | run]


def curve(key: Key) -> list[Row]:
    """Return the infeasibility of one run after every step: one row each."""
    path, run = _run(key)
    columns = zip(path.t.tolist(), path.violation().tolist(), strict=True)
    return [dict(key) | {"t": t, "infeasibility": value, "status": run["status"]} for t, value in columns]


def _run(key: Key) -> tuple[dincl.Trajectory, dict[str, Any]]:
    problem, dt = scene(key["scene"]), key["dt"]
    end = problem.times[-1]
    steps = round(end / dt)
    # Fractions of the end, so that the times of the scene are among them to the last bit.
    times = np.array([end * k / steps for k in range(steps + 1)])
    nearest = [int(np.abs(times - t).argmin()) for t in problem.times]
    times[nearest] = problem.times
    exponent = key["exponent"]
    penalty = dincl.Penalty(dt=dt, strength=key["strength"], exponent=exponent) if exponent else None
    path, seconds = timed(problem, penalty or dincl.PBD(dt=dt), times)
    return path, about(path, seconds)


def scan(references: Mapping[str, EventReference], form: InfeasibilityForm) -> Study:
    """Run PBD (exponent 0) and the penalty method at all strengths, for every step and scene."""
    runs = [
        {"scene": name, "dt": dt, "exponent": exponent, "strength": strength}
        for dt in sorted(form.steps)
        for name in reversed(SCENES)
        for exponent in (0, 1, 2)
        for strength in form.strengths(dt, exponent)
    ]
    return Study(
        name="penalty_scan",
        title="Penalty strengths",
        key=("scene", "dt", "exponent", "strength"),
        runs=tuple(runs),
        run=Scan(references),
    )


def curves(scanned: pd.DataFrame, form: InfeasibilityForm) -> Study:
    """Return the runs of PBD and of the best strengths, after every step."""
    best = best_strengths(scanned).dropna(subset="strength")
    wanted = [(row.scene, row.dt, row.exponent, row.strength) for row in best.itertuples()]
    wanted += [(row.scene, row.dt, 0, 0.0) for row in scanned[scanned["exponent"] == 0].itertuples()]
    names = ("scene", "dt", "exponent", "strength")
    return Study(
        name="infeasibility",
        title="Infeasibility over time",
        key=names,
        runs=tuple(dict(zip(names, values, strict=True)) for values in wanted),
        run=curve,
    )


def best_strengths(scanned: pd.DataFrame) -> pd.DataFrame:
    """Return for each scene, step and exponent the strength with the smallest largest infeasibility, and PBD beside it.

    Only runs that reach the end with an error of at most ``COMPARABLE`` times that of PBD compete; where there is
    none, strength and values are NaN.
    ``width`` is the factor between the largest and the smallest strength around the best that stay below ``WIDTH``
    times its infeasibility; ``least_error`` is the smallest position error that any strength reaches.
    """
    measured = ["largest", "mean", "error"]
    rows = []
    for (name, dt, exponent), group in scanned[scanned["exponent"] > 0].groupby(["scene", "dt", "exponent"]):
        same = (scanned["scene"] == name) & (scanned["dt"] == dt)
        pbd = scanned.loc[same & (scanned["exponent"] == 0), measured].iloc[0].add_prefix("pbd_").to_dict()
        fair = group[(group["error"] <= COMPARABLE * pbd["pbd_error"]) & (group["status"] == "SUCCESS")]
        fair = fair.sort_values("strength")
        best = dict.fromkeys(["strength", *measured], np.nan)
        if len(fair):
            best = fair.loc[fair["largest"].idxmin(), list(best)].to_dict()
        more = {"width": _width(fair, best), "least_error": group["error"].min()}
        rows.append({"scene": name, "dt": dt, "exponent": exponent} | best | pbd | more)
    return pd.DataFrame(rows)


def _width(fair: pd.DataFrame, best: Mapping[str, float]) -> float:
    """Return the factor between the ends of the unbroken range of good strengths around the best, or NaN."""
    if not len(fair):
        return np.nan
    good = (fair["largest"] <= WIDTH * best["largest"]).to_numpy()
    strength = fair["strength"].to_numpy()
    low = high = int(np.flatnonzero(strength == best["strength"])[0])
    while low > 0 and good[low - 1]:
        low -= 1
    while high < len(good) - 1 and good[high + 1]:
        high += 1
    return float(strength[high] / strength[low])
