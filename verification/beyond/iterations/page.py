"""Iterations or smaller steps: the error of PBD and XPBD at equal cost, divided in different ways."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from verification.beyond.iterations import study as iterations
from verification.instruments.charts import COLOURS, MARKERS
from verification.page.columns import headed, read_columns
from verification.page.context import Context
from verification.page.parts import Follows, Grid, Picture, Section, Text
from verification.page.prose import fill
from verification.page.report import Chapter, Finding
from verification.page.sheet import NOTE, Axes, sheet

PROSE = Path(__file__).parent / "prose" / "iterations.html"
COLUMNS = read_columns(Path(__file__).parent / "columns.toml")
TITLE = "Iterations or smaller steps?"
# Runs with so many sweeps in all are repeated beside the complete study; the piles take longer.
REPEATED = 256
QUANTITIES = {"error": "largest error [length]", "overlap": "largest overlap [length]"}
LOWEST = 1e-8


def run(context: Context) -> None:
    """Complete the study."""
    whole = iterations.study()
    part = whole.only(lambda key: key["total"] == REPEATED and not key["scene"].startswith("pile"))
    context.tables["iterations"] = context.rows_of(whole, part)
    context.keep("iterations_best", iterations.best_splits(context.tables["iterations"]))


def _said(context: Context) -> dict[str, str]:
    best = context.tables["iterations_best"]
    hard = best[best["method"] != list(iterations.METHODS)[-1]]
    touching = hard[hard["scene"] != "four discs"]
    few = hard[hard["scene"] == "four discs"]
    pile = hard[hard["scene"].str.startswith("pile") & (hard["total"] >= 1024)].set_index(["scene", "total", "method"])
    gain = pile["error"].xs("PBD", level="method") / pile["error"].xs("XPBD", level="method")
    return fill(
        PROSE,
        scenes=len(iterations.SCENES),
        most=iterations.SWEEPS[-1],
        one=touching["one"].max(),
        few=(few["most"].min(), few["most"].max()),
        one_best=int((few["best"] == 1).sum()),
        few_count=len(few),
        gain=gain.max(),
        compliance=iterations.COMPLIANCE,
    )


def sections(context: Context) -> Sequence[Section]:
    """Return the charts, the best division of each scene, and the rule."""
    said, table = _said(context), context.tables["iterations"]
    pictures = [Picture(context.draw(f"iterations_{name}", draw, table, name), said[name]) for name in QUANTITIES]
    grid = Grid(headed(context.tables["iterations_best"], COLUMNS["best"]), said["table"], "iterations_best")
    return [Section(TITLE, [Text(said["asked"]), *pictures, Follows(said["rule"]), grid, Text(said["why"])])]


def draw(table: pd.DataFrame, quantity: str, path: Path) -> Path:
    """Draw error or overlap against the sweeps in a step, one panel for each scene, one curve for each total."""
    with sheet(path, 5.6) as figure:
        panels = figure.subplots(2, 3, sharex=True).ravel()
        for panel, scene in zip(panels, iterations.SCENES, strict=True):
            _draw_scene(panel, table[table["scene"] == scene], quantity)
            panel.set(title=scene)
        for panel in panels[3:]:
            panel.set_xlabel("sweeps in a step")
        for panel in panels[::3]:
            panel.set_ylabel(QUANTITIES[quantity])
        handles, labels = panels[0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=3)
    return path


def _draw_scene(panel: Axes, table: pd.DataFrame, quantity: str) -> None:
    """Draw one curve for each method and total; totals are named at the left ends of the curves of PBD."""
    for k, method in enumerate(iterations.METHODS):
        for total, runs in table[table["method"] == method].groupby("total"):
            now = runs.sort_values("sweeps")
            values = np.maximum(now[quantity], LOWEST)
            look: dict[str, Any] = {"color": COLOURS[k], "marker": MARKERS[k]}
            if k == 0:  # PBD shows where XPBD hides it
                look |= {"markerfacecolor": "none", "markersize": 9}
                place = (-6, 3)
                panel.annotate(
                    f"{total:,}", (1, values.iloc[0]), place, textcoords="offset points", fontsize=NOTE, ha="right"
                )
            label = method if total == table["total"].max() else None
            panel.loglog(now["sweeps"], values, label=label, **look)
    panel.set_xticks(iterations.SWEEPS, [str(sweeps) for sweeps in iterations.SWEEPS])
    panel.set_xlim(0.5, 1.3 * iterations.SWEEPS[-1])
    panel.minorticks_off()


def findings(context: Context) -> Sequence[Finding]:
    """Return the rule."""
    return [Finding(_said(context)["rule"], TITLE)]


CHAPTER = Chapter(
    "iterations",
    TITLE,
    "At equal cost, is it better to make more sweeps in a step or more steps with one sweep?",
    run,
    sections,
    findings,
    place=4,
    tables=("iterations",),
)
