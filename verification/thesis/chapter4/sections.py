"""The chapter on EMT as sections of the page: it reads tables, and draws figures from the stored results."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pandas as pd

from tissue.statistics.comparisons import Difference
from tissue.statistics.proportions import corrected
from tissue.statistics.ratios import as_ratio
from verification.page.columns import headed
from verification.page.context import Context
from verification.page.parts import Follows, Grid, Section, Text
from verification.page.prose import fill
from verification.thesis.chapter4 import follows, kept, section_differences, sensitivity
from verification.thesis.chapter4.beside import COLUMNS, beside, printed, ranked, with_ratios
from verification.thesis.chapter4.figures import Pictures
from verification.thesis.chapter4.frequencies import RULE
from verification.thesis.chapter4.printed import PRINTED_LEVEL
from verification.thesis.chapter4.questions import ANSWERS, QUESTIONS

TITLES = COLUMNS["sections"]
PROSE = Path(__file__).parent / "prose"
MARKED = {"INM": "with INM", "no INM": "without INM"}


def folder(context: Context) -> Path:
    """Where the results of the studies are."""
    return context.out / "emt"


def sections(context: Context) -> list[Section]:
    """All sections, in their order; each ends with what follows from it."""
    pictures = Pictures(context, folder(context))
    return [
        _isolated(context, pictures),
        section_differences.section(context),
        _groups(context, pictures),
        _heterogeneous(context, pictures),
        _positions(context, pictures),
        _questions(context),
        _sensitivity(context),
        _controls(context),
        *([] if context.full else [_short(context, pictures)]),
    ]


def _complete(context: Context, name: str) -> pd.DataFrame:
    return context.tables[f"{kept.COMPLETE_PREFIX}{name}"]


def _isolated(context: Context, pictures: Pictures) -> Section:
    table = _complete(context, "printed")
    agreeing = table.groupby(["preset", "time_h"], sort=False)["agrees"].agg(["sum", "size"])
    said = fill(
        PROSE / "isolated.html",
        level=PRINTED_LEVEL,
        agreeing=[(preset, t, row["sum"], row["size"]) for (preset, t), row in agreeing.iterrows()],
        gaps=list(table[~table["agrees"]].itertuples()),
        basal=follows.isolated(_complete(context, "ratios")),
    )
    return Section(
        TITLES["isolated"],
        [
            Text(said["agreeing"]),
            Grid(beside(printed(table), "printed"), said["table"], "emt_complete_printed"),
            *pictures.of(10, 11, 12, 13, 14),
            Follows(said["follows"]),
        ],
    )


def _groups(context: Context, pictures: Pictures) -> Section:
    table = _complete(context, "ratios")
    shown = table[table["study"].str.startswith("figure15") & (table["what"] == "basal")]
    said = _said_of_groups(context)
    return Section(
        TITLES["groups"],
        [
            Text(said["effective"]),
            *pictures.of(15, 16),
            Grid(beside(with_ratios(shown), "programs"), said["table"], "emt_complete_ratios", folded=True),
            Follows(said["groups_follow"]),
        ],
    )


def _heterogeneous(context: Context, pictures: Pictures) -> Section:
    rows = beside(with_ratios(_complete(context, "categories")), "categories")
    said = _said_of_groups(context)
    return Section(
        TITLES["mixed"],
        [
            *pictures.of(17, 18, 19),
            Grid(rows, said["categories"], "emt_complete_categories", folded=True),
            Follows(said["heterogeneous_follow"]),
        ],
    )


def _said_of_groups(context: Context) -> dict[str, str]:
    ratios = _complete(context, "ratios")
    mixed = follows.heterogeneous(ratios, _complete(context, "categories"))
    return fill(PROSE / "groups.html", groups=follows.groups(ratios), mixed=mixed)


def _positions(context: Context, pictures: Pictures) -> Section:
    ranking, outside = _complete(context, "ranking"), _complete(context, "outside")[["outside", "of"]].sum()
    said = fill(
        PROSE / "positions.html",
        fifth=_first_fifth(_complete(context, "conditional")),
        cells=outside["of"],
        outside=outside["outside"],
        found=follows.positions(_complete(context, "conditional"), ranking),
    )
    return Section(
        TITLES["positions"],
        [
            Text(said["first_fifth"]),
            Text(said["outside"]),
            *pictures.of(20, 21, 22),
            Grid(beside(ranked(ranking), "ranking"), said["table"], "emt_complete_ranking"),
            Follows(said["follows"]),
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
    said = fill(PROSE / "questions.html", found=follows.questions(table), of=len(QUESTIONS), rule=RULE)
    whole = table.drop_duplicates(["preset", "id"])
    return Section(
        TITLES["questions"],
        [
            Text(said["verdicts"]),
            Grid(beside(whole, "answers"), said["answers"], ANSWERS),
            Grid(beside(table, "comparisons"), said["comparisons"], ANSWERS, folded=True),
            Follows(said["follows"]),
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
        names=list(table.loc[table["ST_low"] > 0, "parameter"]),
        all=len(table),
    )
    return Section(
        TITLES["sensitivity"],
        [
            Text(said["ratio"]),
            Grid(headed(table, COLUMNS["sensitivity"]), said["table"], "emt_complete_sensitivity"),
            Follows(said["follows"]),
        ],
    )


def _controls(context: Context) -> Section:
    table = _complete(context, "controls")
    said = fill(PROSE / "controls.html", found=follows.controls(table, _complete(context, "ratios")))
    parts = table.rename(columns={"apical": "value", "apical_low": "low", "apical_high": "high"})
    grid = Grid(beside(with_ratios(parts, 3), "controls"), said["table"], "emt_complete_controls")
    return Section(TITLES["controls"], [Text(said["rim"]), grid, Follows(said["follows"])])


def _short(context: Context, pictures: Pictures) -> Section:
    """Whether the runs of this page agree with the complete studies."""
    both = context.tables["emt_ratios"].merge(
        _complete(context, "ratios"), on=["study", "scenario", "what"], suffixes=("", "_complete")
    )
    differences = [_difference(row) for _, row in both.iterrows()]
    p = corrected(pd.Series([one.p_value() for one in differences]))
    apart = both[(p < 1 - PRINTED_LEVEL).to_numpy()]
    said = fill(
        PROSE / "short.html",
        runs=sum(study.runs for study in pictures.made.values()),
        comparisons=len(both),
        level=PRINTED_LEVEL,
        apart=list(apart.itertuples()),
    )
    rows = beside(with_ratios(context.tables["emt_ratios"]), "ratios")
    return Section(
        TITLES["short"],
        [Text(said["runs"]), Grid(rows, said["table"], "emt_ratios", folded=True), Follows(said["follows"])],
    )


def _difference(row: pd.Series) -> Difference:
    complete = row[["count_complete", "of_complete", "effective_complete"]].set_axis(["count", "of", "effective"])
    return Difference(as_ratio(row), as_ratio(complete))
