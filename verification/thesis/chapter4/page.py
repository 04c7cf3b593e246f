"""EMT: what makes cells leave the tissue, by the studies of chapter 4, beside what the thesis says.

The figures are counterparts of Figures 10, 12, 14, 15, 20 and 21, the readings of the model beside each other.
"""

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
from verification.site.cells import percent, percents
from verification.site.context import Context
from verification.site.store import shipped
from verification.thesis.chapter4.differences import COUNTING, COUNTING_ROW, ROWS
from verification.thesis.chapter4.ensembles import POPULATIONS, PRESETS, preset_of, without_ending
from verification.thesis.chapter4.frequencies import READINGS
from verification.thesis.chapter4.groups import BY_EVENTS, ONSETS, TIMES
from verification.thesis.chapter4.outcomes import CONTROL
from verification.thesis.chapter4.printed import compared
from verification.thesis.chapter4.questions import ANSWERS, answered
from verification.thesis.chapter4.ratios import NO_INM, wilson

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
        of = {15: draw_programs, 20: draw_by_time, 21: draw_by_place}
        figure, entries = draw_in_time(number, tables) if number in CURVES else of[number](tables)
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


def draw_in_time(number: int, tables: Tables) -> Drawn:
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


def draw_programs(tables: Tables) -> Drawn:
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


def draw_by_time(tables: Tables) -> Drawn:
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


def draw_by_place(tables: Tables) -> Drawn:
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


# Tables, and what the page shows.
# Tables of which a part can be rerun; a part of the others has fewer runs, and other numbers.
IN_PARTS = ("emt_in_time", "emt_ratios")
TABLES = (*IN_PARTS, "emt_groups", "emt_ranking", "emt_effects")
LABELS = {preset: READINGS[preset].capitalize() for preset in PRESETS}
# The factors by short names.
SHORT = {"A": "[A]", "B": "[B]", "S": "[S]", "P": "protrusions", "inm": "INM", "onset": "place at the onset"}
SHORT |= {f"{event} time": f"time of [{event}]" for event in "ABSP"}
OUTCOME_WORDS = {"apical": "leaves apically", "basal": "leaves basally", "below": "lies below all control cells"}
CLEAR = 2.0  # effects of two rows are shown if one is this far from 0, by the half of its interval


def read(context: Context) -> None:
    """Fill in the tables: as they ship, a part of some made again beside them, or all made anew."""
    for name in TABLES:
        if context.full or (name in IN_PARTS and context.complete is not None):
            context.rows(name)
        else:
            context.keep(name, shipped(name))


def run(context: Context) -> None:
    """Read the tables, and derive the printed ratios beside the measured ones, and the answers."""
    read(context)
    context.keep("emt_printed", compared(context.tables))
    context.keep(ANSWERS, answered(context.tables))


def beside(table: pd.DataFrame, keys: list[str], shown: Sequence[str]) -> pd.DataFrame:
    """Return a row for each value of the keys, with the texts ``shown`` of the readings beside each other."""
    preset = table["preset"] if "preset" in table else table["study"].map(preset_of)
    table = table.assign(reading=preset.map(LABELS), text=list(shown))
    if "study" in keys:
        table = table.assign(study=table["study"].map(without_ending))
    wide = table.pivot_table("text", keys, "reading", aggfunc="first", sort=False)
    shown_labels = [label for label in LABELS.values() if label in wide]
    return wide[shown_labels].fillna("").reset_index().rename_axis(columns=None)


def _percents(table: pd.DataFrame) -> list[str]:
    return [percents((row.value, row.low, row.high), 1) for row in table.itertuples()]


def isolated(tables: dict[str, pd.DataFrame]) -> tuple[pd.DataFrame, str]:
    """Tabulate printed and measured ratios, with how far off those are that do not agree."""
    table = tables["emt_printed"]
    texts = []
    for row in table.itertuples():
        off = percents((row.difference, row.low, row.high), 0, "+").replace(" %", " points")
        texts.append(f"{row.time_h:g} h: {percent(row.measured, 1)}{'' if row.agrees else f', off by {off}'}")
    keys = {"scenario": "Scenario", "what": "Outcome", "printed": "Printed"}
    ends = table.assign(text=texts).groupby(["preset", *keys], sort=False)["text"].agg("; ".join).reset_index()
    rows = beside(ends, list(keys), ends["text"]).assign(printed=lambda wide: wide["printed"].map(percent))
    return rows.rename(columns=keys), "emt_printed"


def programs(tables: dict[str, pd.DataFrame]) -> tuple[pd.DataFrame, str]:
    """Tabulate basal extrusion in the 44 cases of Table 4."""
    table = tables["emt_ratios"]
    table = table[table["study"].str.startswith("figure15") & (table["what"] == "basal")]
    texts = [f"{text}, {size:.0f} effective" for text, size in zip(_percents(table), table["effective"], strict=True)]
    return beside(table, ["scenario"], texts).rename(columns={"scenario": "Scenario"}), "emt_ratios"


def categories(tables: dict[str, pd.DataFrame]) -> tuple[pd.DataFrame, str]:
    """Tabulate basal extrusion in heterogeneous groups by events."""
    table = tables["emt_groups"]
    table = table[table["given"] == BY_EVENTS]
    texts = [f"{text} of {of}" for text, of in zip(_percents(table), table["of"], strict=True)]
    rows = beside(table, ["study", "kind"], texts).replace({"study": POPULATIONS})
    return rows.rename(columns={"study": "Group", "kind": "Cells with"}), "emt_groups"


def factors(tables: dict[str, pd.DataFrame]) -> tuple[pd.DataFrame, str]:
    """Tabulate the importance of factors."""
    table = tables["emt_ranking"]
    texts = [f"{row.value:.4f} [{row.low:.4f}, {row.high:.4f}]" for row in table.itertuples()]
    return beside(table, ["factor"], texts).rename(columns={"factor": "Factor"}), "emt_ranking"


def questions(tables: dict[str, pd.DataFrame]) -> tuple[pd.DataFrame, str]:
    """Tabulate the verdicts on the answers of section 4.7."""
    table = tables[ANSWERS]
    whole = table.drop_duplicates(["preset", "id"])
    needed = ["" if pd.isna(runs) else f", {runs:.0f} runs needed" for runs in whole["needed"]]
    keys = {"id": "", "question": "Question", "thesis": "Answer of the thesis"}
    rows = beside(whole, list(keys), [*map("".join, zip(whole["verdict"], needed, strict=True))])
    return rows.rename(columns=keys), ANSWERS


def compared_parts(tables: dict[str, pd.DataFrame]) -> tuple[pd.DataFrame, str]:
    """Tabulate the comparisons that the verdicts rest on."""
    table = tables[ANSWERS]
    parts = beside(table, ["id", "compared"], table["found"])
    return parts.rename(columns={"id": "", "compared": "Compared, basal extrusion"}), ANSWERS


def meanings(tables: dict[str, pd.DataFrame]) -> tuple[pd.DataFrame, str]:
    """Tabulate what each difference between the presets says in both models."""
    rows = [(name, row.printed, row.published) for name, row in (ROWS | {COUNTING: COUNTING_ROW}).items()]
    return pd.DataFrame(rows, columns=["Difference", "In the model as printed", "In the published runs"]), "emt_effects"


def effects(tables: dict[str, pd.DataFrame]) -> tuple[pd.DataFrame, str]:
    """Tabulate a line for each difference, and for each two that matter together, a column for each printed ratio."""
    table = tables["emt_effects"]
    clear = table["effect"].abs() > CLEAR * (table["high"] - table["low"]) / 2
    table = table[(table["with"] == "") | clear.groupby([table["row"], table["with"]]).transform("any")]
    table = table.assign(
        Changed=table["row"] + (" with " + table["with"]).where(table["with"] != "", ""),
        ratio=table["scenario"].str.replace("no INM", "without INM") + " " + table["what"].map(OUTCOME_WORDS),
        text=[percents((row.effect, row.low, row.high), 0, "+").replace(" %", "") for row in table.itertuples()],
    )
    wide = table.pivot_table("text", "Changed", "ratio", aggfunc="first", sort=False)
    return wide.rename_axis(columns=None).reset_index(), "emt_effects"


def show(context: Context) -> None:
    """Give isolated cells, homogeneous and heterogeneous groups, what matters most, and the eight questions."""
    tables = {name: table for name, table in context.tables.items() if name.startswith("emt_")}
    for number in FIGURES:
        context.draw(f"emt_figure{number}", draw, number, tables)
    for tabulate in (isolated, meanings, effects, programs, categories, factors, questions, compared_parts):
        context.show(f"emt_{tabulate.__name__}", *tabulate(tables))
    ranking = tables["emt_ranking"]
    mine = ranking[ranking["study"].map(preset_of) == "published"].set_index("factor")["value"]
    context.numbers["emt"] = SHORT[mine.idxmax()].capitalize()
