"""What a scene needs: the bias of simpler models against their cost, for questions on isolated cells and the height."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import pandas as pd

from dincl.equivalence.paired import ERROR, LOOKS
from tissue.pictures.bias import draw_bias
from verification.beyond.needs import answers
from verification.page.columns import headed, read_columns
from verification.page.context import Context
from verification.page.parts import Follows, Grid, Picture, Section, Text
from verification.page.prose import fill
from verification.page.report import Chapter, Finding

PROSE = Path(__file__).parent / "prose" / "needs.html"
COLUMNS = read_columns(Path(__file__).parent / "columns.toml")
TITLES, ABOUT = COLUMNS["sections"], COLUMNS["about"]


def run(context: Context) -> None:
    """Read the kept table."""
    rows = answers.table()
    failed = rows["reason"] != ""  # such runs end early, so their cost says nothing
    rows[["cpu", "work"]] = rows[["cpu", "work"]].mask(failed)
    context.keep("needs_answers", rows[rows["verdict"] != "left out"].reset_index(drop=True))


def _rows(context: Context, name: str) -> pd.DataFrame:
    table = context.tables["needs_answers"]
    return table[table["question"] == name]


def _unit(rows: pd.DataFrame) -> tuple[str, float]:
    """Return the unit of a question, and its size in the table."""
    return ("points", 100.0) if rows["shares"].iloc[0] else ("um", 1.0)


def _said(context: Context, name: str) -> dict[str, str]:
    rows = _rows(context, name)
    unit, scale = _unit(rows)
    found = rows[rows["answer"]]
    alone = rows[rows["step"] == "alone"]
    cheapest = alone[alone["verdict"] == "enough"].sort_values("cpu").iloc[0]
    cost = {"cpu": 1.0, "work": 1.0} if found.empty else found[["cpu", "work"]].iloc[0].to_dict()
    return fill(
        PROSE,
        question=name[0].upper() + name[1:],
        about=ABOUT[name],
        tolerance=scale * rows["tolerance"].iloc[0],
        unit=unit,
        enough=int((alone["verdict"] == "enough").sum()),
        tried=len(alone),
        most=int(rows["runs"].max()),
        answer="" if found.empty else found["model"].iloc[0].replace(" + ", ", "),
        **cost,
        alone=cheapest["model"] if cheapest["cpu"] < cost["cpu"] else "",
        alone_cpu=cheapest["cpu"],
        error=ERROR,
        looks=len(LOOKS),
    )


def _section(context: Context, number: int, name: str) -> Section:
    rows, said = _rows(context, name), _said(context, name)
    unit, scale = _unit(rows)
    answer = "".join(rows.loc[rows["answer"], "model"])
    figure = context.draw(f"needs_{number}", draw_bias, rows, float(rows["tolerance"].iloc[0]), unit, answer)
    values = (scale * rows[["bias", "low", "high"]]).itertuples(index=False)
    said_of = [
        ("", "") if pd.isna(b) else (f"{b:+.2f} {unit}", f"[{low:+.2f}, {high:+.2f}]") for b, low, high in values
    ]
    missing = ["" if pd.isna(runs) else str(runs) for runs in rows["missing"]]
    named = rows.assign(
        missing=missing, bias=[bias for bias, _ in said_of], interval=[interval for _, interval in said_of]
    )
    grid = Grid(headed(named, COLUMNS["verdicts"]), said["table"], "needs_answers")
    texts = [Text(said[block]) for block in (("asked", "method") if number == 1 else ("asked",))]
    return Section(TITLES[name], [Picture(figure, said["picture"]), *texts, grid, Follows(said["follows"])])


def sections(context: Context) -> Sequence[Section]:
    """Write about each question: bias against cost, verdicts, answer."""
    return [_section(context, number, name) for number, name in enumerate(answers.QUESTIONS, start=1)]


def findings(context: Context) -> Sequence[Finding]:
    """Return the answer of the first question."""
    first = next(iter(answers.QUESTIONS))
    return [Finding(_said(context, first)["follows"], TITLES[first])]


CHAPTER = Chapter(
    "needs",
    "What a scene needs",
    "Which parts of the tissue model does an answer need?",
    run,
    sections,
    findings,
    place=10,
    tables=("needs_",),
)
