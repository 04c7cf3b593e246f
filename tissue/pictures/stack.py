"""A chart for telephones: its panels below each other."""

from __future__ import annotations

import textwrap
from collections.abc import Mapping

from tissue.pictures.charts import CHART_STYLE, caption
from tissue.pictures.sheet import Axes, Figure, style

MAKES_NO_NUMBERS = True

WIDTH = 4.4  # inches; a telephone shows figures at this width
AROUND = 1.0  # inches: legend and caption of a chart before
LINE, LETTER = 0.2, 0.08  # inches: a line of a legend or caption, a letter of the label of an axis
CAPTION_LETTERS, SHORT = 68, 24  # letters: of a line of the caption; of names that stand in two columns of a legend


def stack(figure: Figure) -> None:
    """Put the panels of a chart below each other, each as high as before, between its legend and its caption."""
    places = {panel: spec for panel in figure.axes if (spec := panel.get_subplotspec()) is not None}
    rows = next(iter(places.values())).get_gridspec().nrows
    tall = (figure.get_figheight() - AROUND) / rows
    with style(**CHART_STYLE):
        _repeat_labels({(spec.rowspan.start, spec.colspan.start): panel for panel, spec in places.items()}, tall)
        grid = figure.add_gridspec(len(places), 1)
        for k, panel in enumerate(places):
            panel.set_subplotspec(grid[k, 0])
        lines = _narrow_legend(figure)
        if text := figure.get_supxlabel():
            caption(figure, text, CAPTION_LETTERS)
            lines += 1 + figure.get_supxlabel().count("\n")
        figure.set_size_inches(WIDTH, len(places) * tall + LINE * (lines + 1))


def _repeat_labels(at: Mapping[tuple[int, int], Axes], tall: float) -> None:
    """Give each panel, by its row and column, the labels and ticks that it shared with others; ``tall`` in inches."""
    names = {place: (panel.get_xlabel(), panel.get_ylabel()) for place, panel in at.items()}
    for (row, column), panel in at.items():
        below = [x for (r, c), (x, _) in sorted(names.items()) if c == column and r >= row and x]
        left = [y for (r, c), (_, y) in sorted(names.items()) if r == row and c <= column and y]
        panel.set_xlabel("".join(below[:1]))
        panel.set_ylabel(textwrap.fill("".join(left[-1:]), int(tall / LETTER)))
        panel.tick_params(labelbottom=True, labelleft=bool(len(panel.get_yticks())))


def _narrow_legend(figure: Figure) -> int:
    """Draw the legend in one or two columns; return how many lines it has."""
    handles = [handle for legend in figure.legends for handle in legend.legend_handles if handle is not None]
    names = [text.get_text() for legend in figure.legends for text in legend.get_texts()]
    for legend in list(figure.legends):
        legend.remove()
    if not names:
        return 0
    columns = 2 if max(map(len, names)) <= SHORT else 1
    figure.legend(handles, names, loc="outside upper left", ncols=columns)
    return -(-len(names) // columns)
