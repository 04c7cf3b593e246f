"""The chart of speed against accuracy of one scene, from its table only."""

from __future__ import annotations

from pathlib import Path

import pandas as pd

from verification.beyond.chart.work_precision import Form, chart
from verification.page.sheet import sheet

COSTS = ("cpu_seconds", "drift_evaluations")
# Letters of labels that fit side by side below both panels.
LETTERS = 135


def draw_chart(table: pd.DataFrame, scene: str, form: Form, path: Path) -> Path:
    """Draw the largest error in time against CPU time and against counted work, with one legend below both."""
    one = chart(table, scene, form)
    with sheet(path, 5.8) as figure:
        panels = figure.subplots(1, len(COSTS), sharey=True)
        for panel, cost in zip(panels, COSTS, strict=True):
            one.plot(panel, cost=cost)
            panel.get_legend().remove()
            panel.set_title("")
        panels[0].set_ylim(top=10)
        panels[1].set_ylabel("")
        handles, labels = panels[0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside lower center", ncols=LETTERS // max(map(len, labels)))
    return path
