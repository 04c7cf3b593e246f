"""The chapter on EMT as sections of the page: it reads tables, and draws figures from the stored results."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pandas as pd

from tissue.study.comparisons import PRINTED_LEVEL, Difference, corrected
from tissue.study.ratios import as_ratio
from verification.page.parts import Grid, Picture, Section, Text
from verification.page.prose import fill
from verification.page.report import Context
from verification.thesis.chapter3.maps import LABELS
from verification.thesis.chapter4 import figures, headings, sensitivity, studies

POSITIONS = "Position at the onset, timing, and what matters most"
PROSE = Path(__file__).parent / "prose"
# Figures of single runs, which want every state of some.
EXAMPLES = (11, 16)
MARKED = {"INM": "with INM", "no INM": "without INM"}


def folder(context: Context) -> Path:
    """Where the results of the studies are."""
    return context.out / "emt"


def sections(context: Context) -> list[Section]:
    """All sections, in their order."""
    return [
        _isolated(context),
        _groups(context),
        _heterogeneous(context),
        _positions(context),
        _questions(context),
        _sensitivity(context),
        _controls(context),
        *([] if context.full else [_short(context)]),
    ]


def _complete(context: Context, name: str) -> pd.DataFrame:
    return context.tables[f"emt_complete_{name}"]


def _named(table: pd.DataFrame, headings: dict[str, str]) -> pd.DataFrame:
    table = table[list(headings)]
    if "preset" in table:
        table = table.assign(preset=table["preset"].map(LABELS))
    return table.rename(columns=headings)


def _pictures(context: Context, *numbers: int) -> Iterator[Picture]:
    """Figures of the thesis, of the runs of this page, for each preset whose studies are among them."""
    made = studies.chosen(context.form(studies.SHORT, studies.FULL))
    for one in numbers:
        for preset, suffix in studies.PRESETS.items():
            wanted = {study: study + suffix for study in figures.needs(one)}
            if all(name in made and (one not in EXAMPLES or made[name].trajectories) for name in wanted.values()):
                where = {study: studies.place(name, made[name], folder(context)) for study, name in wanted.items()}
                path = context.draw(f"emt_figure{one}{suffix}", figures.drawn, one, where)
                yield Picture(path, f"Counterpart of Figure {one}, {preset} preset, from the runs of this page.")


def _isolated(context: Context) -> Section:
    table = _complete(context, "printed")
    agreeing = table.groupby(["preset", "time_h"], sort=False)["agrees"].agg(["sum", "size"])
    said = fill(
        PROSE / "isolated.html",
        level=PRINTED_LEVEL,
        agreeing=[(preset, t, row["sum"], row["size"]) for (preset, t), row in agreeing.iterrows()],
        gaps=list(table[~table["agrees"]].itertuples()),
    )
    return Section(
        "Isolated cells",
        [
            Text(said["agreeing"]),
            Grid(_named(table, headings.PRINTED), said["table"], "emt_complete_printed"),
            *_pictures(context, 10, 11, 12, 13, 14),
        ],
    )


def _groups(context: Context) -> Section:
    table = _complete(context, "ratios")
    shown = table[table["study"].str.startswith("figure15") & (table["what"] == "basal")]
    said = fill(PROSE / "groups.html")
    return Section(
        "Groups of cells with the same events",
        [
            Text(said["effective"]),
            *_pictures(context, 15, 16),
            Grid(
                _named(shown, headings.RATIOS),
                said["table"],
                "emt_complete_ratios",
                folded=True,
            ),
        ],
    )


def _heterogeneous(context: Context) -> Section:
    table = _complete(context, "categories")
    return Section(
        "Heterogeneous groups",
        [
            *_pictures(context, 17, 18, 19),
            Grid(
                _named(table, headings.CATEGORIES),
                fill(PROSE / "groups.html")["categories"],
                "emt_complete_categories",
                folded=True,
            ),
        ],
    )


def _positions(context: Context) -> Section:
    ranking, outside = _complete(context, "ranking"), _complete(context, "outside")[["outside", "of"]].sum()
    said = fill(
        PROSE / "positions.html",
        fifth=_first_fifth(_complete(context, "conditional")),
        cells=outside["of"],
        outside=outside["outside"],
    )
    return Section(
        POSITIONS,
        [
            Text(said["first_fifth"]),
            Text(said["outside"]),
            *_pictures(context, 20, 21, 22),
            Grid(_named(ranking, headings.RANKING), said["table"], "emt_complete_ranking"),
        ],
    )


def _first_fifth(conditional: pd.DataFrame) -> list[dict[str, Any]]:
    """The ratios of the most basal cells, which the thesis has at 70 % to 80 %."""
    table = conditional[(conditional["given"] == "onset_ab") & (conditional["high_edge"] < 0.25)]
    return [
        {"study": study, "inm": MARKED[str(inm)], "count": part["count"].sum(), "of": part["of"].sum()}
        for (study, inm), part in table.groupby(["study", "inm"], sort=False)
    ]


def _questions(context: Context) -> Section:
    table = _complete(context, "answers")
    said = fill(PROSE / "questions.html", labels=LABELS, answers=list(table.itertuples()))
    sentences = table.assign(measured=table["measured"].str.split("\n")).explode("measured")
    return Section(
        "The eight questions",
        [
            Text(said["verdicts"]),
            Grid(_named(table, headings.ANSWERS), said["answers"], "emt_complete_answers"),
            Grid(
                _named(sentences[sentences["measured"] != ""], headings.COMPARISONS),
                said["comparisons"],
                "emt_complete_answers",
                folded=True,
            ),
        ],
    )


def _sensitivity(context: Context) -> Section:
    table = _complete(context, "sensitivity").sort_values("ST", ascending=False)
    said = fill(
        PROSE / "sensitivity.html",
        noise=table["noise"].iloc[0],
        deviation=table["deviation"].iloc[0],
        points=sensitivity.BASE_POINTS,
        replicates=sensitivity.HEAD["replicates"],
    )
    return Section(
        "Sensitivity to the mechanics",
        [
            Text(said["ratio"]),
            Grid(_named(table, headings.SENSITIVITY), said["table"], "emt_complete_sensitivity"),
        ],
    )


def _controls(context: Context) -> Section:
    said = fill(PROSE / "controls.html")
    grid = Grid(_named(_complete(context, "controls"), headings.CONTROLS), said["table"], "emt_complete_controls")
    return Section("Control cells", [Text(said["rim"]), grid])


def _short(context: Context) -> Section:
    """Whether the runs of this page agree with the complete studies."""
    both = context.tables["emt_ratios"].merge(
        _complete(context, "ratios"), on=["study", "scenario", "what"], suffixes=("", "_complete")
    )
    differences = [_difference(row) for _, row in both.iterrows()]
    p = corrected(pd.Series([one.p_value() for one in differences]))
    apart = both[(p < 1 - PRINTED_LEVEL).to_numpy()]
    said = fill(
        PROSE / "short.html",
        runs=sum(study.runs for study in studies.chosen(context.form(studies.SHORT)).values()),
        comparisons=len(both),
        level=PRINTED_LEVEL,
        apart=list(apart.itertuples()),
    )
    return Section(
        "The runs of this page beside the complete studies",
        [
            Text(said["runs"]),
            Grid(_named(context.tables["emt_ratios"], headings.RATIOS), said["table"], "emt_ratios", folded=True),
        ],
    )


def _difference(row: pd.Series) -> Difference:
    complete = row[["count_complete", "of_complete", "effective_complete"]].set_axis(["count", "of", "effective"])
    return Difference(as_ratio(row), as_ratio(complete))
