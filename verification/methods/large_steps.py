"""Growth of coordinates at large steps: PBD against the penalty method (Figure 2 of chapter 2)."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd

import dincl
from dincl import scenes
from dincl.study import Key, Row, Study
from verification.methods.methods import METHODS, PBD, PENALTIES, PENALTY_PRINTED
from verification.methods.references import SCENES
from verification.site.sheet import GREY, NOTE, legend_below, sheet

COMPARED = (PBD, *PENALTIES, PENALTY_PRINTED)
STEPS = (0.0125, 0.025, 0.05, 0.1, 0.2, 0.4, 0.8, 1.0, 1.6)
# Long enough that something unstable has time to grow [time].
END = 32.0
# A run is unstable if a disc gets this many times farther out than any disc was at the start.
FAR = 2.0
# Growths above this are drawn on the upper edge.
HIGHEST = 1e3


def study(smallest: bool = False) -> Study:
    """Return all runs; they take a second, so that the smallest form has all of them."""
    keys = tuple(
        {"scene": name, "method": method.name, "dt": dt} for name in SCENES for method in COMPARED for dt in STEPS
    )
    return Study("large_steps", "Large steps", ("scene", "method", "dt"), keys, run, {"end": END, "far": FAR})


def run(key: Key) -> list[Row]:
    """Return the largest coordinate of one run, after every step, over that of the start: one row."""
    scene, steps = getattr(scenes, key["scene"])(), round(END / key["dt"])
    times = np.array([END * k / steps for k in range(steps + 1)])
    path = dincl.solve(scene, METHODS[key["method"]].make(END / steps), times, throw=False)
    growth = float(np.abs(path.x).max() / np.abs(scene.x0).max())
    found = {"growth": growth, "overlap": float(path.violation()[-1]), "stable": bool(path.status) and growth <= FAR}
    return [dict(key) | found | {"status": path.status.name, "detail": path.detail}]


def draw(table: pd.DataFrame, path: Path) -> Path:
    """Draw how many times farther out than at the start a disc gets, against dt; runs that stopped as crosses."""
    with sheet(path, 3.2) as figure:
        panels = figure.subplots(1, len(SCENES), sharey=True)
        for name, panel in zip(SCENES, panels, strict=True):
            for method in COMPARED:
                one = table[(table["scene"] == name) & (table["method"] == method.name)]
                done, look = one["status"] == "SUCCESS", dict(method.look)
                panel.loglog(one["dt"], one["growth"].clip(upper=HIGHEST).where(done), label=method.label, **look)
                stopped = np.full((~done).sum(), 0.97)
                cross = {"color": method.colour, "transform": panel.get_xaxis_transform()}
                panel.plot(one["dt"][~done], stopped, "x", **cross)
            panel.axhspan(FAR, 2 * HIGHEST, color="#f6ece6", zorder=0)
            panel.set(title=getattr(scenes, name)().title, xlabel="step dt [time]", ylim=(0.7, 2 * HIGHEST))
            panel.text(0.02, FAR * 1.1, "unstable", transform=panel.get_yaxis_transform(), color=GREY, fontsize=NOTE)
        panels[0].set_ylabel("largest coordinate / at the start")
        legend_below(figure, panels, 3)
    return path
