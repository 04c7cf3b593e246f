"""Figure 22 of chapter 4: the position at the onset against that at the end."""

from __future__ import annotations

import numpy as np
import pandas as pd

from tissue.pictures.sheet import GREY, Axes, Figure, Patch
from tissue.study.categories import happened, kept_times
from tissue.study.figures.cells import population
from tissue.study.figures.needs import Sources, needs
from tissue.study.figures.panels import grid, name_axes
from tissue.study.figures.style import OUTCOMES, POSITION, caption, counted, legend

MAKES_NO_NUMBERS = True

ONE = "table5_35"
GROUP = "Heterogeneous groups, 35 % of the cells with [P]"
MOST = 4000  # dots
SEED = 0  # of the choice of dots
SHOWN = (-0.75, 1.5)  # of the apical-basal scale
STILL = "#b8b8b8"  # of cells that stay in the tissue
HEIGHT = 3.2  # inches of a panel


@needs(table5_35="runs")
def figure_22(sources: Sources) -> Figure:
    """Position at the onset against the position at the end: a dot for each cell without [P]."""
    figure, panels = grid(["With INM", "Without INM"], list(sources), HEIGHT, sharex=True, sharey=True)
    tables = {preset: _without_p(population(source.studies[ONE], ONE)) for preset, source in sources.items()}
    some = {preset: cells.sample(min(MOST, len(cells)), random_state=SEED) for preset, cells in tables.items()}
    beyond = 0
    for (title, preset), panel in panels.items():
        cells = some[preset][some[preset]["inm"] == (title == "With INM")]
        end = f"ab_{kept_times(cells)[-1]:g}h"
        _scatter(panel, cells, end)
        panel.set(xlim=SHOWN, ylim=(-0.1, 1.1), xticks=np.arange(-0.5, SHOWN[1] + 0.1, 0.5))
        beyond += int((~cells[end].between(*SHOWN)).sum())
    name_axes(panels, f"position at the end, {POSITION}", f"position at the onset, {POSITION}")
    names = {OUTCOMES[what][2]: OUTCOMES[what][0] for what in ("basal", "apical")} | {"in the tissue": STILL}
    legend(figure, {name: Patch(color=colour) for name, colour in names.items()})
    shown, whole = counted(map(len, some.values()), "at random from"), (str(len(one)) for one in tables.values())
    text = f"{GROUP}: cells with [A] or [B] and without [P], {shown} {' and '.join(whole)}"
    caption(figure, f"{text}; {beyond} of these lie beyond the panels. Dotted: the basal and the apical layer.")
    return figure


def _without_p(cells: pd.DataFrame) -> pd.DataFrame:
    """Cells that begin an event before the end and never protrude."""
    return cells[~happened(cells, kept_times(cells)[-1])["P"] & cells["onset_ab"].notna()]


def _scatter(panel: Axes, cells: pd.DataFrame, end: str) -> None:
    """Dots in the colour of what became of the cell; those that stayed lie below the others."""
    basal, apical = cells[end] < 0, cells[end] > 1
    sides = ((~basal & ~apical, STILL), (apical, OUTCOMES["apical"][0]), (basal, OUTCOMES["basal"][0]))
    for side, colour in sides:
        panel.scatter(cells.loc[side, end], cells.loc[side, "onset_ab"], s=4, color=colour, linewidths=0)
    for layer in (0.0, 1.0):
        panel.axvline(layer, color=GREY, linewidth=0.8, linestyle=":")
