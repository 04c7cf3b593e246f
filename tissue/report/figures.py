"""Figures of a study: answers, each with the groups that are compared; ratios of EMT cells in time."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd

from dincl.plotting import log_ticks
from tissue.pictures.charts import (
    CAP,
    CHART_STYLE,
    RATIO,
    TIME,
    draw_time_series,
    grid,
    legend,
    page,
    time_series_entries,
    verbatim,
)
from tissue.pictures.sheet import Axes, Figure, style
from tissue.study.answers import outcome_name, scenario_means
from tissue.study.categories import EXTREME

if TYPE_CHECKING:
    from tissue.study.plan import Weights
    from tissue.study.read import Results


LINE, AROUND = 0.26, 0.75  # inches: of a group, of title and axis
FAR = 1e9  # past the edge of each axis
MOST_PLAIN = 1e6  # ratio of the ends of an axis up to which its numbers are plain
PLUS, MINUS, PLAIN = "#2c6fbb", "#8a8a8a", "#222222"
HEIGHT = 1.8  # inches of a panel


def effect_figure(results: Results, row: Mapping[str, Any], weights: Weights) -> Figure:
    """Draw an answer: the means of its scenarios, with 95 % intervals of each alone, and the effect with its interval.

    Parameters
    ----------
    results
        Of the study.
    row
        Of ``tissue.study.answers.answer_table``, with an answer.
    weights
        Of its scenarios.
    """
    means = scenario_means(results, [row["outcome"]]).set_index("scenario")
    table, percent = means.loc[list(weights)], 100 if row["outcome"] in EXTREME else 1
    with style(**CHART_STYLE):
        figure = page(AROUND + LINE * max(2, len(table)))
        left, right = figure.subplots(1, 2, width_ratios=(3, 2))
        colours = [PLUS if weights[str(name)] > 0 else MINUS for name in table.index]
        _dots(left, percent * table, colours)
        left.set_yticks(range(len(table)), [verbatim(str(name)) for name in table.index])
        left.set_xlabel(outcome_name(row["outcome"]) + (" [%]" if percent == 100 else ""))
        ratio = row["measure"] == "ratio"
        scale = 1 if ratio else percent
        effect = scale * pd.DataFrame([row])[["value", "low", "high"]].astype(float)
        _dots(right, effect, [PLAIN])
        right.axvline(1 if ratio else 0, color=MINUS, linewidth=0.9, linestyle="--", zorder=1)
        right.set_yticks([])
        right.set(xlim=_limits(effect, ratio=ratio), xscale="log" if ratio else "linear")
        log_ticks(right, plain=MOST_PLAIN)
        points = " [points]" if percent == 100 else ""
        right.set_xlabel("ratio, 1: no effect" if ratio else f"difference{points}, 0: no effect")
    return figure


def _limits(effect: pd.DataFrame, *, ratio: bool) -> tuple[float, float]:
    """Return the ends of the axis of an effect: all that is finite, with room for intervals that are open."""
    neutral, least = (1.0, np.log(2)) if ratio else (0.0, 1e-9)
    points = np.append(effect.to_numpy(float).ravel(), neutral)
    if ratio:
        with np.errstate(divide="ignore"):
            points = np.log(points)
    points = points[np.isfinite(points)]
    room = max(0.15 * float(np.ptp(points)), least)
    ends = points.min() - room, points.max() + room
    return (float(np.exp(ends[0])), float(np.exp(ends[1]))) if ratio else ends


def _dots(panel: Axes, table: pd.DataFrame, colours: list[str]) -> None:
    """Draw values with their intervals, from above to below; an infinite end goes past the edge, without a cap."""
    values, low, high = (table[name].to_numpy(float) for name in ("value", "low", "high"))
    for k, colour in enumerate(colours):
        reach = np.array([[values[k] - low[k]], [high[k] - values[k]]])
        reach[np.isnan(reach)] = 0.0
        reach[np.isinf(reach)] = FAR
        panel.errorbar(values[k], k, xerr=np.maximum(reach, 0), marker="o", color=colour, markersize=5, **CAP)
    panel.set_ylim(len(colours) - 0.5, -0.5)
    panel.grid(visible=False, axis="y")


def ratios_against_time(results: Results, scenarios: Sequence[str]) -> Figure:
    """Draw r(t) of (4.7) of the EMT cells in a panel for each of these scenarios, which have such cells."""
    with style(**CHART_STYLE):
        figure, panels = grid(scenarios, HEIGHT, x=TIME, y=RATIO, sharey=True)
        for scenario, panel in zip(scenarios, panels, strict=True):
            draw_time_series(panel, results.cells(scenario), results.runs(scenario))
        legend(figure, time_series_entries())
    return figure
