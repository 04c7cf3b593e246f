"""Speed against accuracy: every method on every scene, from coarse settings to fine ones, within a budget a run."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path

import pandas as pd

from dincl.study import Key, Row, Study
from verification.instruments.speed_accuracy import TARGETS, WorkPrecision, WorkPrecisionRuns
from verification.methods.chart import programs
from verification.methods.chart.references import SCENES, SMALL, known
from verification.methods.methods import CHARTED, METHODS, PBD
from verification.site.cells import number
from verification.site.context import Context
from verification.site.sheet import sheet

ERRORS, COSTS = ("largest", "final", "overlap"), ("cpu_seconds", "drift_evaluations")
# From coarse to fine; of scenes of many discs only coarse ones are within the budget.
SETTINGS = {"dt": [0.1 / 2**k for k in range(21)], "tol": [10.0**-k for k in range(1, 13)]}
COLUMNS = {
    "target": "Error",
    "cheapest": "Cheapest",
    "cost": "CPU seconds",
    "tied": "Within the spread",
    "next": "Next",
    "ratio": "Next: times as long",
    "pbd_ratio": "PBD: times as long",
    "method": "Method",
    "setting": "dt or tol",
    "status": "Status",
    "cpu_seconds": "CPU seconds",
    "spread": "Median over shortest",
    "disturbed": "Disturbed",
    "drift_evaluations": "Drift evaluations",
    "solver_iterations": "Solver iterations",
    "largest": "Largest error",
    "final": "Error at the end",
    "overlap": "Overlap",
    "detail": "Detail",
}


def study(smallest: bool = False) -> Study:
    """Return all methods on all scenes; in the smallest form the two coarsest settings of each on the small scenes."""
    scenes = reversed(SMALL if smallest else tuple(SCENES))
    runs = tuple({"scene": name, "method": method.label} for name in scenes for method in reversed(CHARTED))
    key, by = ("scene", "method"), ("setting",)
    run = ChartRun(smallest)
    return Study("work_precision", "Speed against accuracy", key, runs, run, columns=COLUMNS, by=by)


@dataclass(frozen=True)
class ChartRun:
    """All settings of one method on one scene: one row each."""

    smallest: bool

    def __call__(self, key: Key) -> list[Row]:
        rows = runs_of(key["scene"]).study(smallest=self.smallest).run({"method": key["method"]})
        return [{"scene": key["scene"]} | dict(row) for row in rows]


@cache
def runs_of(name: str) -> WorkPrecisionRuns:
    """Return the runs of all methods on a scene, against its reference as it ships."""
    charted, reference = SCENES[name], known(name)
    return WorkPrecisionRuns(charted.make(), CHARTED, SETTINGS, reference.t, reference, charted.budget, ERRORS)


def charts(rows: pd.DataFrame) -> dict[str, WorkPrecision]:
    """Return name of a scene -> its chart, from rows of the study."""
    return {name: replace(runs_of(name).result(mine), title=runs_of(name).problem.title) for name, mine in _each(rows)}


def _each(rows: pd.DataFrame) -> list[tuple[str, pd.DataFrame]]:
    there = set(rows["scene"])
    return [(name, rows[rows["scene"] == name]) for name in SCENES if name in there]


def winners(rows: pd.DataFrame) -> pd.DataFrame:
    """Return one row for each scene and target: ``WorkPrecision.cheapest``, and how many times more PBD costs."""
    found = []
    for name, one in charts(rows).items():
        costs = one.costs(TARGETS)
        pbd = costs.loc[PBD.label] if PBD.label in costs.index else pd.Series(dtype=float)
        won = one.cheapest(TARGETS)
        found.append(won.assign(scene=name, pbd_ratio=won["target"].map(pbd).astype(float) / won["cost"]))
    return pd.concat(found, ignore_index=True)


def wide(won: pd.DataFrame) -> pd.DataFrame:
    """Return the cheapest method for each scene and error, from the table of ``winners``: a row for each scene."""
    table = won.pivot(index="scene", columns="target", values="cheapest").rename_axis(columns=None)
    ordered = table.loc[[name for name in SCENES if name in table.index], sorted(table, reverse=True)]
    titles = [runs_of(name).problem.title for name in ordered.index]
    return ordered.rename(columns=number).reset_index(drop=True).assign(Scene=titles)[["Scene", *map(number, ordered)]]


# The page: tables, figures and the chart that answers to the reader.
STUDY = "work_precision"
# Letters of labels that fit side by side below both panels.
LETTERS = 135


def run(context: Context) -> None:
    """Complete the references and the studies; keep what they say."""
    context.rows("work_references")
    context.keep("work_winners", winners(context.rows(STUDY)))
    context.keep("program_costs", programs.costs(context.rows("programs")))


def show(context: Context) -> None:
    """Give the charts of chosen scenes."""
    from verification.instruments import interactive

    tables, found = context.tables, charts(context.tables[STUDY])
    short = {method.label: method.short for method in METHODS.values()}
    # The scenes of many discs first: there calls of Python decide nothing.
    context.charts["speed"] = interactive.draw_chart(dict(reversed(found.items())), COSTS, short)
    winners = tables["work_winners"]
    context.show("cheapest", wide(winners), "work_winners")
    for name in found:
        mine, won = (table[table["scene"] == name] for table in (tables[STUDY], winners))
        context.draw(f"work_precision_{name}", draw_scene, mine)
        context.show(f"cheapest_{name}", context.headed(STUDY, won), "work_winners")
    context.draw("programs", programs.draw, tables["programs"])
    context.show("programs", context.headed("programs", tables["program_costs"]), "program_costs")


def draw_scene(rows: pd.DataFrame, path: Path) -> Path:
    """Draw the largest error in time against CPU time and against counted work, with one legend below both."""
    (one,) = charts(rows).values()
    with sheet(path, 5.8) as figure:
        panels = figure.subplots(1, len(COSTS), sharey=True)
        for panel, cost in zip(panels, COSTS, strict=True):
            one.plot(panel, cost=cost).set_title("")
            panel.get_legend().remove()
        panels[0].set_ylim(top=10)
        panels[1].set_ylabel("")
        handles, labels = panels[0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=LETTERS // max(map(len, labels)))
    return path
