"""The third dimension: how sheets grow, whether isolated cells go where they go in slices, and what is left open."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pandas as pd

from verification.beyond.space import choices, edge, figures, growth, heights, isolated, strip
from verification.beyond.space.sections import catch_up, substeps
from verification.page.columns import headed, read_columns
from verification.page.context import Context
from verification.page.parts import Follows, Grid, Picture, Section, Text, number
from verification.page.prose import fill, interval, percents
from verification.page.report import Chapter, Finding

GROWTH, ISOLATED = "Does a sheet grow as its slice does?", "Do the answers for isolated cells survive?"
PARTS = (substeps.PART, catch_up.PART)
PAGE = Path(__file__).parents[1]
PROSE, COLUMNS = PAGE / "prose", read_columns(PAGE / "columns.toml")

# A column for each tissue.
VERDICTS = {**COLUMNS["verdicts"], **{one: one for one in isolated.TISSUES}}
# Rerun beside the complete studies.
GROWN_AGAIN = growth.SheetForm(2, growth.LAYERS[-3:-1])
CHOSEN_AGAIN = choices.ChoicesForm(1, (choices.AS_SHIPPED,))
STRIPPED_AGAIN = strip.StripForm(2, ("[A]",))


def run(context: Context) -> None:
    """Take over the studies, and the kept ratios."""
    grow(context)
    chosen = context.rows_of(choices.study(context.form(choices.FULL)), choices.study(CHOSEN_AGAIN), ("cell",))
    context.keep("space_choices_ratios", choices.ratios(chosen))
    context.keep("space_choices_means", choices.means(chosen))
    stripped = context.rows_of(strip.study(context.form(strip.FULL)), strip.study(STRIPPED_AGAIN))
    context.keep("space_strip_differences", strip.differences(stripped))
    for part in PARTS:
        part.run(context)
    ratios = isolated.table()
    context.keep("space_isolated", ratios)
    context.keep("space_compared", isolated.compared(ratios))


def grow(context: Context) -> None:
    """Take over the study of growing sheets."""
    grown = context.rows_of(growth.study(context.form(growth.FULL)), growth.study(GROWN_AGAIN), ("t",))
    context.keep("space_heights", heights.means(grown))


def sections(context: Context) -> Sequence[Section]:
    """Return growth, isolated cells and choices left open, then the checks of the model in space."""
    own = [section(context) for section in (_growth, _isolated, _choices, _strip)]
    return own + [part.section(context) for part in PARTS]


def _growth(context: Context) -> Section:
    table = context.tables["space_heights"]
    last = table[table["t"] == table["t"].max()]
    said = fill(PROSE / "growth.html", **_heights(last))
    chart = context.draw("space_growth", figures.draw_growth, table)
    return Section(
        GROWTH,
        [
            Text(said["answer"]),
            Picture(chart, said["chart"]),
            Grid(headed(last, COLUMNS["heights"]), said["table"], "space_heights"),
            Follows(said["follows"]),
        ],
    )


def _heights(last: pd.DataFrame) -> dict[str, Any]:
    """Return the heights at the end by tissue, cells and share of divisions, with intervals, and the other means."""
    rows = {(row.layer, row.cells, row.both): row for row in last.itertuples()}

    def height_of(*name: Any) -> str:
        row = rows[name]
        return with_interval(row.height, row.height_low, row.height_high)

    def stay(*name: Any) -> str:
        row = rows[name]
        return percents((row.stay, row.stay_low, row.stay_high))

    known = {"some": growth.SOME, "all": growth.ALL, "seeds": int(last["runs"].max()), "end": growth.END}
    return {"rows": rows, "tall": height_of, "stay": stay} | known


def _isolated(context: Context) -> Section:
    ratios, compared = context.tables["space_isolated"], context.tables["space_compared"]
    said = fill(PROSE / "isolated.html", **_facts(ratios, compared))
    chart = context.draw("space_isolated", figures.draw_isolated, ratios)
    return Section(
        ISOLATED,
        [
            Text(said["answer"]),
            Picture(chart, said["chart"]),
            Grid(headed(compared, VERDICTS), said["verdicts"], "space_compared"),
            Text(said["differs"]),
            Text(said["periodic"]),
            Grid(headed(ratios, COLUMNS["ratios"]), said["table"], "space_isolated", folded=True),
            Follows(said["follows"]),
        ],
    )


def _facts(ratios: pd.DataFrame, compared: pd.DataFrame) -> dict[str, Any]:
    """Return how many comparisons hold in each tissue, and any ratio with its interval."""
    parts = ratios.set_index(["tissue", "scenario", "what"])[["value", "low", "high"]]
    counts = {one: compared[f"{one}_verdict"].value_counts().to_dict() for one in isolated.TISSUES}
    effects = ratios.groupby("tissue")["effect"].first()
    return {
        "effects": [f"{effects[one]:.2f}" for one in isolated.TISSUES[1:]],
        "sheets": isolated.TISSUES[1:],
        "ratio": lambda *name: tuple(parts.loc[name]),
        "counts": counts,
        "held": lambda tissue: counts[tissue].get("holds", 0),
        "opposite": lambda tissue: counts[tissue].get("does not hold", 0),
        "of": len(compared),
        "edge": edge.EDGE,
    }


def _choices(context: Context) -> Section:
    ratios, means = context.tables["space_choices_ratios"], context.tables["space_choices_means"]
    parts = ratios.set_index(["choice", "events", "part", "side"])[["value", "low", "high"]]
    rows = {row.choice: row for row in means.itertuples()}

    def tall(choice: str) -> str:
        return with_interval(rows[choice].height, rows[choice].height_low, rows[choice].height_high)

    def wide(choice: str) -> str:
        return with_interval(rows[choice].basal, rows[choice].basal_low, rows[choice].basal_high)

    def ends(choice: str, events: str, side: str = "basal", part: str = edge.WHOLE) -> str:
        return percents(tuple(parts.loc[(choice, events, part, side)]))

    said = fill(PROSE / "choices.html", rows=rows, tall=tall, wide=wide, ends=ends, edge=edge.EDGE)
    return Section(
        "What depends on choices that the thesis leaves open?",
        [
            Text(said["answer"]),
            Text(said["room"]),
            Text(said["size"]),
            Grid(headed(means, COLUMNS["means"]), said["means"], "space_choices_means"),
            Grid(headed(ratios, COLUMNS["choices"]), said["ratios"], "space_choices_ratios", folded=True),
            Follows(said["follows"]),
        ],
    )


def _strip(context: Context) -> Section:
    table = context.tables["space_strip_differences"]
    rows = {(row.of, row.events): row for row in table.itertuples()}

    def away(of: str, events: str = "all") -> str:
        row = rows[(of, events)]
        return with_interval(row.difference, row.low, row.high)

    said = fill(
        PROSE / "strip.html", rows=rows, away=away, far=_far(table), compared=len(table), first=strip.FIRST_SEED
    )
    return Section(
        "A strip one cell wide is the slice",
        [
            Text(said["answer"]),
            Grid(
                headed(table.replace({"of": strip.NAMES}), COLUMNS["differences"]),
                said["table"],
                "space_strip_differences",
            ),
            Follows(said["follows"]),
        ],
    )


def _far(table: pd.DataFrame) -> list[str]:
    """List the differences of strip and ring that lie beyond their intervals."""
    apart = table[(table["low"] > 0.0) | (table["high"] < 0.0)]
    after = apart["events"].map(lambda events: "" if events == "all" else f" after {events}")
    return list(apart["of"].map(strip.NAMES) + after)


def with_interval(value: float, low: float, high: float) -> str:
    """Write a number with its interval."""
    return f"{number(value)} {interval((low, high))}"


def findings(context: Context) -> Sequence[Finding]:
    """State how many findings for isolated cells hold in a sheet."""
    facts = _facts(context.tables["space_isolated"], context.tables["space_compared"])
    return [Finding(fill(PROSE / "learned.html", **facts)["isolated"], ISOLATED)]


CHAPTER = Chapter(
    "space",
    "Third dimension",
    "Does a tissue in three dimensions grow, and lose cells, as its slice does?",
    run,
    sections,
    findings,
    place=12,
    tables=("space_",),
)
