"""Counterparts of Figures 10, 12, 14, 15, 20 and 21 of chapter 4, the readings of the model beside each other."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product
from pathlib import Path
from typing import Any

import pandas as pd

from tissue.pictures.charts import (
    CHART_STYLE,
    CONTROLS,
    OUTCOMES,
    RATIO,
    TIME,
    RatioSeries,
    band,
    draw_series,
    grid,
    legend,
    time_axis,
    time_series_entries,
)
from tissue.pictures.sheet import GREY, Axes, Figure, Line2D, Patch, style, write
from verification.claims import Tables
from verification.thesis.chapter4.categories import NO_INM
from verification.thesis.chapter4.ensembles import POPULATIONS, PRESETS
from verification.thesis.chapter4.groups import ONSETS, TIMES
from verification.thesis.chapter4.in_time import CONTROL
from verification.thesis.chapter4.ratios import wilson

PROGRAMS = ("[ABP]", "[BAP]", "[BPx]", "[BxP]", "[AxB]", "[BxA]", "[Ax]", "[xA]", "[Bx]", "[xB]", "no EMT")
# Figures 10, 12 and 14: the scenarios; of the last one time counts from [A] on in another panel.
CURVES = {
    10: ("[A]", "[B]", "[S]", "[BP]"),
    12: ("[A] no INM", "[B] no INM", "[S] no INM", "no EMT no INM"),
    14: ("[AxB]", "[AB]", "[BxA]"),
}
SINCE, SHADES = "Basal positioning since [A]", dict(zip(CURVES[14], ("#e0a100", "#8f6400", "#3f2c00"), strict=True))
# Around a cell, with its colour.
ENVIRONMENTS = {"individual": "#808080", "homogeneous group": "#8c6bb1"}
COLOURS = dict(zip(POPULATIONS, ("#00796b", "#2fa89a", "#7fcabf"), strict=True))
MARKERS = dict(zip(POPULATIONS, "os^", strict=True))
ENDINGS = {"with INM": "", "without INM": NO_INM}
BY_TIME = {"[A], cells without [P]": "t_a_h", "[B], cells without [P]": "t_b_h", "[P]": "t_p_h"}
TWO = ("thesis", "published")  # the readings whose cells were followed in time
END, HEIGHT, LINE, ROOM = "ratio of basal extrusion at the end [%]", 1.9, 0.23, 0.5  # inches: a panel, a line in one
FIGURES = (10, 12, 14, 15, 20, 21)
Entries = dict[str, Line2D | Patch]
Drawn = tuple[Figure, Entries]


def draw(number: int, tables: Tables, path: Path) -> Path:
    """Draw the counterpart of a figure from the tables of this chapter."""
    with style(**CHART_STYLE):
        of = {15: programs, 20: by_time, 21: by_place}
        figure, entries = in_time(number, tables) if number in CURVES else of[number](tables)
        legend(figure, entries)
    write(figure, path)
    return path


def _grid(
    parts: Sequence[str], presets: Sequence[str], height: float, x: str, y: str = "", **shared: Any
) -> tuple[Figure, dict[tuple[str, str], Axes]]:
    """Make a panel for each part and, beside each other, each preset."""
    names = [(part, one) for part in parts for one in presets]
    titles = [", ".join(name) for name in names]
    figure, panels = grid(titles, height, x=x, y=y, columns=len(presets), sharey=True, **shared)
    return figure, dict(zip(names, panels, strict=True))


def in_time(number: int, tables: Tables) -> Drawn:
    """Draw r(t) of (4.7) with 95 % bands, and apical extrusion of the control cells."""
    names = [*CURVES[number], *([SINCE] if number == 14 else [])]
    figure, panels = _grid(names, TWO, HEIGHT, TIME, RATIO)
    entries = time_series_entries()
    for (name, preset), panel in panels.items():
        for scenario in CURVES[14] if name == SINCE else [name]:
            rows = _curve(tables["emt_in_time"], f"figure{number}{PRESETS[preset]}", scenario)
            if name == SINCE:
                mine, look = rows[rows["what"] == "below"], {"color": SHADES[scenario], "label": scenario}
                band(panel, mine["time_h"] - mine["a_h"], mine, **look)
                entries[f"since [A]: {scenario}"] = Line2D([], [], color=SHADES[scenario])
                panel.axvline(0.0, color=GREY, linestyle=":", linewidth=1.0)
                continue
            for what, (colour, line, label) in OUTCOMES.items():
                mine = rows[rows["what"] == what]
                band(panel, mine["time_h"], mine, color=colour, linestyle=line, label=label)
            mine = rows[rows["what"] == CONTROL]
            panel.plot(mine["time_h"], 100 * mine["value"], color=GREY, linewidth=0.8, label=CONTROLS)
            time_axis(panel, float(rows["time_h"].max()))
        panel.set_ylim(-2, 102)
    return figure, entries


def _curve(table: pd.DataFrame, study: str, scenario: str) -> pd.DataFrame:
    rows = table[(table["study"] == study) & (table["scenario"] == scenario)]
    value = rows["count"] / rows["of"]
    low, high = wilson(value, rows["of"])
    return rows.assign(value=value, low=low, high=high)


def _of(tables: Tables, study: str) -> pd.DataFrame:
    """Return the basal ratios of a study at the end by scenario."""
    table = tables["emt_ratios"]
    return table[(table["study"] == study) & (table["what"] == "basal")].set_index("scenario")


def programs(tables: Tables) -> Drawn:
    """Draw basal extrusion at the end: eleven programs of events, alone and in a group, with INM and without."""
    figure, panels = _grid(list(ENDINGS), list(PRESETS), ROOM + LINE * len(PROGRAMS), END, sharex=True)
    entries: Entries = {}
    for (title, preset), panel in panels.items():
        every, series = _of(tables, f"figure15{PRESETS[preset]}"), []
        for (label, colour), ending, marker in zip(ENVIRONMENTS.items(), ("", ", 10 cells"), "os", strict=True):
            rows = every.loc[[f"{name}{ENDINGS[title]}{ending}" for name in PROGRAMS]].set_axis(list(PROGRAMS))
            look: dict[str, Any] = {"color": colour, "marker": marker}
            series.append(RatioSeries(label, rows, look))
            entries[label] = Line2D([], [], linestyle="none", **look)
        draw_series(panel, PROGRAMS, series)
    return figure, entries


def by_time(tables: Tables) -> Drawn:
    """Draw E[basal extrusion | time of the event] of (4.12) for [A], [B], [P], with INM and without.

    The caption of the thesis names [S] in place of [P], but [S] does not happen in the populations of Table 5.
    """
    x, y = "time of the event [h]", "basal extrusion at the end [%]"
    figure, panels = _grid(list(BY_TIME), list(PRESETS), HEIGHT, x, y, sharex=True)
    for (title, preset), panel in panels.items():
        for study, filled in product(POPULATIONS, (True, False)):
            look = {} if filled else {"markerfacecolor": "white", "linestyle": "--"}
            _line(panel, tables, study, preset, BY_TIME[title], "INM" if filled else "no INM", **look)
        panel.set(xlim=(TIMES[0], TIMES[-1]), xticks=TIMES[::2])
        panel.set_ylim(-2, 102)
    lines: Entries = {
        "with INM": Line2D([], [], color="black", linestyle="-"),
        "without INM": Line2D([], [], color="black", linestyle="--"),
    }
    return figure, _groups() | lines


def by_place(tables: Tables) -> Drawn:
    """Draw E[basal extrusion | position at the onset] of 3.3.4, cells without [P], with INM and without."""
    x, y = "position at the onset, $y_{AB}$", "basal extrusion at the end [%]"
    figure, panels = _grid(list(ENDINGS), list(PRESETS), HEIGHT, x, y, sharex=True)
    for (title, preset), panel in panels.items():
        for study in POPULATIONS:
            _line(panel, tables, study, preset, "onset_ab", "no INM" if ENDINGS[title] else "INM")
        panel.set(xlim=(ONSETS[0], ONSETS[-1]))
        panel.set_ylim(-2, 102)
    return figure, _groups()


def _line(panel: Axes, tables: Tables, study: str, preset: str, given: str, kind: str, **look: Any) -> None:
    """Draw the line of a population."""
    table = tables["emt_groups"]
    mine = table[(table["study"] == study + PRESETS[preset]) & (table["given"] == given) & (table["kind"] == kind)]
    band(panel, (mine["low_edge"] + mine["high_edge"]) / 2, mine, **_look(study), **look)


def _look(study: str) -> dict[str, Any]:
    return {"color": COLOURS[study], "marker": MARKERS[study], "markersize": 4.0}


def _groups() -> Entries:
    return {f"heterogeneous, {name}": Line2D([], [], **_look(study)) for study, name in POPULATIONS.items()}
