"""Figure of a study: the ratios of EMT cells at the end, of all scenarios."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from typing import TYPE_CHECKING

from tissue.pictures.charts import CHART_STYLE, NAME_LETTERS, NARROW, OUTCOMES, WIDTH, RatioSeries, draw_series, grid
from tissue.pictures.sheet import Figure, style
from tissue.study.answers import scenario_means

if TYPE_CHECKING:
    from tissue.study.read import Results

LINE, ROOM = 0.23, 0.5  # inches: a line of ratios; title and axis of a panel


def at_end(results: Results, scenarios: Sequence[str], width: float = WIDTH) -> Figure:
    """Draw the three outcomes at the end with 95 % intervals for each of these scenarios, which have EMT cells."""
    ratios = scenario_means(results, OUTCOMES)
    height = ROOM + LINE * sum(len(textwrap.wrap(name, NAME_LETTERS)) for name in scenarios)
    titles = [name for *_, name in OUTCOMES.values()]
    columns = len(titles) if width > NARROW else 1
    with style(**CHART_STYLE):
        axis = "ratio at the end [%]"
        figure, panels = grid(titles, height, x=axis, columns=columns, width=width, sharex=True, sharey=True)
        for panel, (what, (colour, _, _)) in zip(panels, OUTCOMES.items(), strict=True):
            rows = ratios[(ratios["outcome"] == what) & ratios["scenario"].isin(scenarios)].set_index("scenario")
            draw_series(panel, scenarios, [RatioSeries("", rows, {"color": colour, "marker": "o"})])
    return figure
