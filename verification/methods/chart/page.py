"""Speed against accuracy: tables, figures and the chart that answers to the reader."""

from __future__ import annotations

from pathlib import Path

import pandas as pd

from verification.methods.chart import programs, work_precision
from verification.methods.chart.work_precision import COSTS, charts
from verification.methods.methods import METHODS
from verification.site.context import Context
from verification.site.sheet import sheet

STUDY = "work_precision"
# Letters of labels that fit side by side below both panels.
LETTERS = 135


def run(context: Context) -> None:
    """Complete the references and the studies; keep what they say."""
    context.rows("work_references")
    context.keep("work_winners", work_precision.winners(context.rows(STUDY)))
    context.keep("program_costs", programs.costs(context.rows("programs")))


def show(context: Context) -> None:
    """Give the charts of chosen scenes."""
    from verification.instruments import interactive

    tables, found = context.tables, charts(context.tables[STUDY])
    short = {method.label: method.short for method in METHODS.values()}
    # The scenes of many discs first: there calls of Python decide nothing.
    context.charts["speed"] = interactive.draw_chart(dict(reversed(found.items())), COSTS, short)
    winners = tables["work_winners"]
    context.show("cheapest", work_precision.wide(winners), "work_winners")
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
