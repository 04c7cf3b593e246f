"""Sets that turn, close and grow: the orders of the methods on scenes with exact solutions."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import pandas as pd

from verification.beyond.moving import moving_sets
from verification.page.columns import headed, read_columns
from verification.page.context import Context
from verification.page.parts import Follows, Grid, Picture, Section, Text
from verification.page.prose import fill
from verification.page.report import Chapter, Finding
from verification.page.sheet import sheet
from verification.thesis.chapter2.figures import LABELS, LOWEST, error_curve, slope_one
from verification.thesis.chapter2.methods import METHODS, MIDPOINT_ACTIVE, PBD

PROSE = Path(__file__).parent / "prose" / "moving_sets.html"
COLUMNS = read_columns(Path(__file__).parent / "columns.toml")
TITLE = COLUMNS["sections"]["orders"]
# Runs with a step of at least this are repeated beside the complete study [time].
COARSE = 0.1 / 2**4


def run(context: Context) -> None:
    """Complete the study."""
    moving = moving_sets.study()
    context.tables["moving_sets"] = context.rows_of(moving, moving.only(lambda key: key["dt"] >= COARSE))
    context.keep("moving_orders", moving_sets.orders(context.tables["moving_sets"]))


def _said(context: Context) -> dict[str, str]:
    table, orders = context.tables["moving_sets"], context.tables["moving_orders"]
    slopes = orders.dropna(subset="slope").groupby("method")["slope"].agg(["min", "max"])
    return fill(
        PROSE,
        count=len(moving_sets.SCENES),
        times=moving_sets.TIMES,
        coarse=table["dt"].max(),
        fine=table["dt"].min(),
        pbd=slopes.loc[PBD.label].tolist(),
        midpoint=slopes.loc[MIDPOINT_ACTIVE.label].tolist(),
    )


def sections(context: Context) -> Sequence[Section]:
    """Write about errors against the step, and orders."""
    said = _said(context)
    figure = context.draw("moving_sets", draw, context.tables["moving_sets"], tuple(moving_sets.SCENES))
    grid = Grid(headed(context.tables["moving_orders"], COLUMNS["orders"]), said["table"], "moving_orders")
    return [Section(TITLE, [Text(said["intro"]), Picture(figure, said["picture"]), grid, Follows(said["follows"])])]


def draw(table: pd.DataFrame, scenes: Sequence[str], path: Path) -> Path:
    """Draw the error against dt, one panel for each scene."""
    with sheet(path, 3.6) as figure:
        panels = figure.subplots(1, len(scenes), sharex=True, sharey=True)
        for panel, scene in zip(panels, scenes, strict=True):
            now = table[table["scene"] == scene]
            for method in [METHODS[name] for name in METHODS if name in set(now["method"])]:
                error_curve(panel, now[now["method"] == method.name], method, "error")
            slope_one(panel, now, "error")
            panel.set(title=scene, xlabel="step dt [time]")
        panels[0].set(ylabel=LABELS["error"], ylim=(LOWEST["error"] / 3, 3))
        handles, labels = panels[0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=3)
    return path


def findings(context: Context) -> Sequence[Finding]:
    """Return the orders of PBD and of midpoint catch-up."""
    return [Finding(_said(context)["follows"], TITLE)]


CHAPTER = Chapter(
    "moving",
    "Sets that turn, close and grow",
    "Do the methods keep their orders when the feasible set depends on time?",
    run,
    sections,
    findings,
    place=6,
    tables=("moving_",),
)
