"""Overlap of PBD against the penalty method with its best strength."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

import dincl
import verification
from dincl import scenes
from dincl.scenes import Scene
from dincl.study import Key, Row, Study
from verification.instruments.error_norms import distance
from verification.instruments.measure import reached
from verification.methods.methods import PBD, PENALTIES, PENALTY_PRINTED
from verification.methods.references import SCENES, TOL
from verification.site.sheet import legend_below, sheet

# Compared, the coarsest first [time].
STEPS = (0.02, 0.01, 0.005, 0.0025, 0.00125)
# From far too weak to unstable: the strength for the exponent 1, the force as printed; dt strength for 2, springs.
PUSHES = tuple(float(value) for value in np.geomspace(0.3, 100.0, 25))
SPRINGS = tuple(float(value) for value in np.geomspace(0.01, 10.0, 25))
# Discs that were thrown apart do not overlap: a run competes only if its error is at most this many times that of PBD.
COMPARABLE = 5.0
# An overlap up to this multiple of the best one counts as the width of the optimum.
WIDTH = 2.0
KEY = ("scene", "dt", "exponent", "strength")
# Exponent -> words and look; 0 is PBD.
LOOKS: Mapping[int, tuple[str, dict[str, Any]]] = {
    0: ("PBD", {"color": PBD.colour, "zorder": 3}),
    1: ("force as printed", {"color": PENALTY_PRINTED.colour, "linewidth": 0.8}),
    2: ("springs", {"color": PENALTIES[1].colour}),
}
COLUMNS = {
    "scene": "Scene",
    "dt": "dt [time]",
    "kind": "Force",
    "strength": "Best strength",
    "largest": "Largest overlap [length]",
    "mean": "Mean overlap [length]",
    "error": "Error [length]",
    "pbd_largest": "PBD: largest overlap [length]",
    "pbd_mean": "PBD: mean overlap [length]",
    "pbd_error": "PBD: error [length]",
    "width": "Width of the optimum",
    "least_error": "Least error, any strength [length]",
}


def strengths(dt: float, exponent: int) -> tuple[float, ...]:
    """Return the strengths that are tried at a step; PBD has none."""
    return {0: (0.0,), 1: PUSHES, 2: tuple(value / dt for value in SPRINGS)}[exponent]


def scan(smallest: bool = False) -> Study:
    """Return PBD and the penalty method with all strengths, for every step and scene; smallest: for one step."""
    keys = [
        (name, dt, exponent, strength)
        for dt in reversed(STEPS[: 1 if smallest else None])
        for name in SCENES
        for exponent in LOOKS
        for strength in strengths(dt, exponent)
    ]
    runs = tuple(dict(zip(KEY, key, strict=True)) for key in keys)
    return Study("penalty_scan", "Penalty strengths", KEY, runs, measure, {"tol": TOL}, COLUMNS)


def measure(key: Key) -> list[Row]:
    """Return the largest and the mean overlap over time, and the largest error at the times of the scene: one row."""
    path, known = _path(key), _reference(key["scene"])
    overlap, error = path.violation(), distance(reached(path, known.t), known.x)
    found = {"largest": overlap.max(), "mean": overlap.mean(), "error": error.max()}
    return [dict(key) | found | {"status": path.status.name, "detail": path.detail}]


@cache
def _scene(name: str) -> Scene:
    made: Scene = getattr(scenes, name)()
    return made


@cache
def _reference(name: str) -> verification.Known:
    return verification.reference(_scene(name), TOL)(_scene(name).times)


def _path(key: Key) -> dincl.Trajectory:
    problem, dt = _scene(key["scene"]), key["dt"]
    end = problem.times[-1]
    steps = round(end / dt)
    # Fractions of the end, so that the times of the scene are among them to the last bit.
    times = np.array([end * k / steps for k in range(steps + 1)])
    times[[int(np.abs(times - t).argmin()) for t in problem.times]] = problem.times
    exponent = key["exponent"]
    penalty = dincl.Penalty(dt=dt, strength=key["strength"], exponent=exponent) if exponent else None
    return dincl.solve(problem, penalty or dincl.PBD(dt=dt), t=times, throw=False)


def best_strengths(scanned: pd.DataFrame) -> pd.DataFrame:
    """Return for each scene, step and exponent the strength with the smallest largest overlap, and PBD beside it.

    Only runs that reach the end with an error of at most ``COMPARABLE`` times that of PBD compete; where there is
    none, strength and values are NaN.
    ``width`` is the factor between the largest and the smallest strength around the best that stay below ``WIDTH``
    times its overlap; ``least_error`` is the smallest position error that any strength reaches.
    """
    measured = ["largest", "mean", "error"]
    rows = []
    for (name, dt, exponent), group in scanned[scanned["exponent"] > 0].groupby(["scene", "dt", "exponent"]):
        same = (scanned["scene"] == name) & (scanned["dt"] == dt)
        pbd = scanned.loc[same & (scanned["exponent"] == 0), measured].iloc[0].add_prefix("pbd_").to_dict()
        fair = group[(group["error"] <= COMPARABLE * pbd["pbd_error"]) & (group["status"] == "SUCCESS")]
        fair = fair.sort_values("strength", ignore_index=True)
        best = dict.fromkeys(["strength", *measured, "width"], np.nan)
        if len(fair):
            place = int(fair["largest"].argmin())
            best = fair.loc[place, ["strength", *measured]].to_dict() | {"width": _width(fair, place)}
        more = {"least_error": group["error"].min()}
        rows.append({"scene": name, "dt": dt, "exponent": exponent} | best | pbd | more)
    return pd.DataFrame(rows).assign(
        kind=lambda table: table["exponent"].map({k: word for k, (word, _) in LOOKS.items()})
    )


def _width(fair: pd.DataFrame, place: int) -> float:
    """Return the factor between the ends of the unbroken range of good strengths around the best one."""
    bad = np.flatnonzero(fair["largest"] > WIDTH * fair["largest"][place])
    low, high = bad[bad < place].max(initial=-1) + 1, bad[bad > place].min(initial=len(fair)) - 1
    return float(fair["strength"][high] / fair["strength"][low])


def draw_scan(scanned: pd.DataFrame, path: Path) -> Path:
    """Draw the largest overlap in time, and dotted the error, against the strength, with the finest step."""
    dt = float(scanned["dt"].min())
    with sheet(path, 3.3) as figure:
        panels = figure.subplots(1, len(SCENES), sharey=True)
        for name, panel in zip(SCENES, panels, strict=True):
            now = scanned[(scanned["scene"] == name) & (scanned["dt"] == dt)]
            for exponent, (label, look) in LOOKS.items():
                one = now[now["exponent"] == exponent].sort_values("strength")
                for column, line, word in (("largest", "-", "overlap"), ("error", ":", "error of positions")):
                    given = {"linestyle": line, "label": f"{label}: {word}"} | look
                    if exponent:
                        panel.loglog(one["strength"], one[column].clip(lower=1e-4), **given)
                    else:
                        panel.axhline(one[column].iloc[0], **given)
            panel.set(title=f"{_scene(name).title}, dt = {dt:g}", xlabel="penalty strength", ylim=(3e-4, 20))
        panels[0].set_ylabel("largest over time [length]")
        legend_below(figure, panels, 3)
    return path
