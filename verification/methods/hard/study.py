"""Every method on the hard scenes: right, wrong or refused."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

import dincl
from dincl.study import Key, Row, Study
from verification.methods.hard.drawn import drawn
from verification.methods.hard.scenes import SCENES, HardScene
from verification.methods.stability.schemes import tied
from verification.site.context import Context
from verification.site.sheet import NOTE, sheet

# One of each family of ``hard_problem``.
SEEDS = (0, 1, 3, 4, 6, 7, 12, 14, 21, 23, 38)
KINDS: Mapping[str, Mapping[str, Callable[[], HardScene]]] = {
    **SCENES,
    "drawn at random": {f"seed {seed}": partial(drawn, seed) for seed in SEEDS},
}
# Of projections; errors of equal steps and of states that are below these are rounding [sizes of a scene].
TOL, FLOOR, ROUNDING = 1e-11, 1e-9, 1e-13
# Equal steps: so many to the end, not multiples of each other. A method converges if its last error is at most HALF of
# the largest and FALLS times the one before, or at most SLACK times its setting: errors of jumps scatter by about dt.
STEPS, HALF, FALLS, SLACK = (127, 503, 1999), 0.5, 0.7, 2.0
TOLERANCES = (1e-2, 1e-3, 1e-4)
Maker = Callable[[float, float], dincl.Scheme]
# Label -> (dt, size) -> scheme.
EQUAL: Mapping[str, Maker] = {
    "PBD": lambda dt, size: dincl.PBD(dt),
    "PBD, 16 sweeps": lambda dt, size: dincl.PBD(dt, sweeps=16),
    "penalty, 0.3/dt": lambda dt, size: tied(dt),
    "catch-up": lambda dt, size: dincl.CatchUp(dt, dincl.ActiveSet(TOL * size)),
    "linearised": lambda dt, size: dincl.LinearisedCatchUp(dt, dincl.ActiveSet(TOL * size)),
    "midpoint": lambda dt, size: dincl.MidpointCatchUp(dt, dincl.ActiveSet(TOL * size)),
}
ADAPTIVE, AUTO, EVENTS = "adaptive", "Auto", "event-driven"
METHODS = (*EQUAL, ADAPTIVE, AUTO, EVENTS)
RIGHT, REFUSES, WRONG = "right", "refuses", "wrong"
COLOURS = {RIGHT: "#8fc49a", REFUSES: "#e0a33e", WRONG: "#b3261e"}
COLUMNS = {"method": "Method", RIGHT: "Right", REFUSES: "Refuses", WRONG: "Wrong", "where": "Wrong on"}


def study(smallest: bool = False) -> Study:
    """Return all methods on all scenes; in the smallest form on two scenes of each kind."""
    few = 2 if smallest else None
    runs = tuple({"kind": kind, "scene": name} for kind, scenes in KINDS.items() for name in list(scenes)[:few])
    return Study(
        "hard_scenes", "Hard scenes", ("kind", "scene"), runs, run_scene, columns=COLUMNS, by=("method", "setting")
    )


def run_scene(key: Key) -> list[Row]:
    """Return the rows of a scene: the status of each method at each setting, its true and its stated error."""
    scene = KINDS[key["kind"]][key["scene"]]()
    return [
        {**key, "method": name, "setting": setting} | attempt(scene, scheme)
        for name in METHODS
        for setting, scheme in schemes(name, scene)
    ]


def schemes(name: str, scene: HardScene) -> list[tuple[float, dincl.Scheme]]:
    """Return dt [time] or tol [sizes] of a method, from coarse to fine, with its schemes."""
    size, end = scene.size, float(np.max(scene.t))
    if name in EQUAL:
        return [(end / count, EQUAL[name](end / count, size)) for count in STEPS]
    if name == ADAPTIVE:
        return [(tol, dincl.AdaptiveCatchUp(tol * size)) for tol in TOLERANCES]
    if name == AUTO:
        return [(tol, dincl.Auto(tol * size)) for tol in TOLERANCES[1:]]
    return [(tol, dincl.EventDriven(tol * size)) for tol in scene.tols]


def attempt(scene: HardScene, scheme: dincl.Scheme) -> dict[str, Any]:
    """Return status, the largest error over that of the reference, and the stated one, in sizes of the scene."""
    try:
        path = dincl.solve(scene.problem, scheme, scene.t, throw=False)
    except dincl.InvalidProblem as refusal:
        return {"status": "REFUSED", "error": np.nan, "stated": np.nan, "detail": str(refusal)}
    stated = np.nan if path.error is None or not len(path.error) else float(np.max(path.error)) / scene.size
    row = {"status": path.status.name, "error": np.nan, "stated": stated, "detail": path.detail}
    if path.status:
        away = np.linalg.norm(path.x - np.asarray(scene.exact), axis=-1).max() / scene.size
        row["error"] = max(float(away) - scene.bound, 0.0)
    return row


def verdicts(rows: pd.DataFrame) -> pd.DataFrame:
    """Return right, refuses or wrong for each scene and method.

    A method that states its error is wrong if a run that ends SUCCESS is farther off than stated, or than asked for;
    any other one if its errors do not fall with its setting. It refuses if the run, for others the last run, fails.
    """
    found = []
    for (kind, scene, method), mine in rows.groupby(["kind", "scene", "method"], sort=False):
        done = mine["status"] == "SUCCESS"
        error = mine["error"].to_numpy()
        if method in (AUTO, EVENTS):
            wrong = bool((error[done] > mine[["stated", "setting"]].min(axis=1)[done] + ROUNDING).any())
            verdict = WRONG if wrong else RIGHT if done.all() else REFUSES
        else:
            known = np.nan_to_num(error)
            enough = max(FLOOR, min(HALF * known.max(), FALLS * known[-2]), SLACK * mine["setting"].iloc[-1])
            verdict = REFUSES if not done.iloc[-1] else RIGHT if error[-1] <= enough else WRONG
        found.append({"kind": kind, "scene": scene, "method": method, "verdict": verdict})
    return pd.DataFrame(found)


def counted(found: pd.DataFrame) -> pd.DataFrame:
    """Return how often each method is right, refuses and is wrong, and on which kinds of scenes it is wrong."""
    table = found.groupby(["method", "verdict"]).size().unstack(fill_value=0).reindex(METHODS)
    table = table.reindex(columns=[RIGHT, REFUSES, WRONG], fill_value=0)
    missed = found[found["verdict"] == WRONG].groupby("method")["kind"].unique().map(", ".join)
    return table.assign(where=missed).fillna({"where": ""}).reset_index()


def draw(found: pd.DataFrame, path: Path) -> Path:
    """Draw a cell for each scene and method."""
    wide = found.pivot(index=["kind", "scene"], columns="method", values="verdict")
    order = [(kind, name) for kind, scenes in KINDS.items() for name in scenes if (kind, name) in wide.index]
    red_green_blue = {verdict: [int(colour[k : k + 2], 16) for k in (1, 3, 5)] for verdict, colour in COLOURS.items()}
    cells = [[red_green_blue[verdict] for verdict in row] for row in wide.loc[order, list(METHODS)].to_numpy()]
    with sheet(path, 0.16 * len(order) + 1.5) as figure:
        panel = figure.subplots()
        panel.imshow(cells, aspect="auto", interpolation="nearest", extent=(0, len(METHODS), len(order), 0))
        panel.grid(False)
        panel.hlines(np.arange(len(order)), 0, len(METHODS), "w")
        panel.vlines(np.arange(len(METHODS)), 0, len(order), "w")
        panel.set_xticks(np.arange(len(METHODS)) + 0.5, METHODS, rotation=40, ha="right")
        panel.set_yticks(np.arange(len(order)) + 0.5, [name for _, name in order], fontsize=NOTE)
    return path


def run(context: Context) -> None:
    """Complete the study; keep the verdicts."""
    context.keep("hard_verdicts", verdicts(context.rows("hard_scenes")))


def show(context: Context) -> None:
    """Give how often each method is right, and a cell for each scene and method."""
    found = context.tables["hard_verdicts"]
    context.show("hard_methods", context.headed("hard_scenes", counted(found)), "hard_verdicts")
    context.draw("hard_scenes", draw, found)
