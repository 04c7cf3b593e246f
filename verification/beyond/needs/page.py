"""What a scene needs: the bias of simpler models against their cost, for thirteen questions on cells and tissues."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import pandas as pd

from tissue.statistics.equivalence import ERROR, LOOKS
from tissue.study.elimination import AND
from verification.beyond.needs import answers
from verification.beyond.needs.figures import draw_models, draw_tissues
from verification.beyond.needs.questions import EIGHT, FIVE
from verification.page import cards
from verification.page.columns import headed, read_columns
from verification.page.context import Context
from verification.page.parts import Follows, Grid, HowMeasured, Picture, Section, Text
from verification.page.prose import fill
from verification.page.report import Card, Chapter, Finding

PROSE = Path(__file__).parent / "prose" / "needs.html"
COLUMNS = read_columns(Path(__file__).parent / "columns.toml")
TITLES, NAMES, ABOUT = COLUMNS["sections"], COLUMNS["names"], COLUMNS["about"]


def run(context: Context) -> None:
    """Read the kept table, and sum it up, a row for each question."""
    rows = answers.table()
    failed = rows["reason"] != ""  # such runs end early, so their cost says nothing
    rows[["cpu", "work"]] = rows[["cpu", "work"]].mask(failed)
    context.keep("needs_answers", rows[rows["verdict"] != "left out"].reset_index(drop=True))
    context.keep("needs_summary", pd.DataFrame([_summed(context, name) for name in answered()]))


def answered() -> list[str]:
    """Return the questions that the kept table answers: the eight of chapter 4 first, then the others."""
    kept = set(answers.table()["question"])
    return [name for name in (*EIGHT, *FIVE) if name in kept]


def _summed(context: Context, name: str) -> dict[str, object]:
    rows = _rows(context, name)
    unit, scale = _unit(rows)
    alone, found = rows[rows["step"] == "alone"], _cheapest(rows)
    undecided = alone[alone["verdict"] == "open"]
    return {
        "id": name,
        "question": NAMES[name],
        "full": f"{scale * rows['full'].iloc[0]:.3g} {unit}",
        "tolerance": f"{scale * rows['tolerance'].iloc[0]:g} {unit}",
        "model": _listed("".join(found["model"])) or ("the full model" if undecided.empty else "not decided"),
        "cpu": None if found.empty else float(found["cpu"].iloc[0]),
        "enough": f"{(alone['verdict'] == 'enough').sum()} of {len(alone)}",
        "open": ", ".join(undecided["model"]),
        "missing": "" if undecided.empty else f"{undecided['missing'].max():,}",
    }


def _rows(context: Context, name: str) -> pd.DataFrame:
    table = context.tables["needs_answers"]
    return table[table["question"] == name]


def _cheapest(rows: pd.DataFrame) -> pd.DataFrame:
    """Return the row of the cheapest model that is enough, of combinations and of single ones; none: the full model.

    Times are no more exact than a percent: of models within one, the combination with fresh seeds is taken.
    """
    enough = rows[(rows["verdict"] == "enough") & (rows["cpu"] < 1)]
    return enough.assign(cost=enough["cpu"].round(2)).sort_values(["cost", "answer"], ascending=[True, False]).head(1)


def _unit(rows: pd.DataFrame) -> tuple[str, float]:
    """Return the unit of a question, and its size in the table."""
    return ("µm", 1.0) if rows["question"].iloc[0] == "height at 48 h" else ("points", 100.0)


def _listed(model: str) -> str:
    return model.replace(AND, ", ")


def _said(context: Context, name: str) -> dict[str, str]:
    rows = _rows(context, name)
    unit, scale = _unit(rows)
    found, alone = _cheapest(rows), rows[rows["step"] == "alone"]
    return fill(
        PROSE,
        question=NAMES[name],
        about=ABOUT[name],
        full=scale * rows["full"].iloc[0],
        tolerance=scale * rows["tolerance"].iloc[0],
        unit=unit,
        enough=int((alone["verdict"] == "enough").sum()),
        tried=len(alone),
        most=int(rows["runs"].max()),
        answer=[_listed(model) for model in found["model"]],
        cost=found[["cpu", "work"]].to_dict("records"),
        undecided=alone.loc[alone["verdict"] == "open", ["model", "missing"]].to_dict("records"),
        error=ERROR,
        looks=len(LOOKS),
        **_counts(context),
    )


def _counts(context: Context) -> dict[str, object]:
    """Return what the section of all questions says."""
    table = context.tables["needs_summary"]
    rows = context.tables["needs_answers"]
    enough = rows[(rows["step"] == "alone") & (rows["verdict"] == "enough")].groupby("model")["question"].nunique()
    never = sorted(set(rows.loc[rows["step"] == "alone", "model"]) - set(enough.index))
    eight = table[table["id"].isin(EIGHT)]
    return {
        "questions": len(table),
        "halved": int((eight["cpu"] < 0.5).sum()),
        "eight": len(eight),
        "no_answer": eight.loc[eight["cpu"].isna(), "id"].tolist(),
        "waiting": [name for name in EIGHT if name not in set(eight["id"])],
        "least": eight["cpu"].min(),
        "greatest": eight["cpu"].max(),
        "always": sorted(model for model, count in enough.items() if count == len(table)),
        "never": never,
    }


def _section(context: Context, name: str) -> Section:
    rows, said = _rows(context, name), _said(context, name)
    number = answered().index(name) + 1
    unit, scale = _unit(rows)
    answer = "".join(_cheapest(rows)["model"])
    tissues = context.draw(f"needs_tissues_{number}", draw_tissues, name, answer)
    figure = context.draw(f"needs_{number}", draw_models, rows, float(rows["tolerance"].iloc[0]), unit, answer)
    values = (scale * rows[["bias", "low", "high"]]).itertuples(index=False)
    said_of = [
        ("", "") if pd.isna(b) else (f"{b:+.2f} {unit}", f"[{low:+.2f}, {high:+.2f}]") for b, low, high in values
    ]
    missing = ["" if pd.isna(runs) else str(runs) for runs in rows["missing"]]
    named = rows.assign(
        missing=missing, bias=[bias for bias, _ in said_of], interval=[interval for _, interval in said_of]
    )
    grid = Grid(headed(named, COLUMNS["verdicts"]), said["table"], "needs_answers", folded=True)
    pictures = [Picture(tissues, said["tissues"]), Picture(figure, said["picture"])]
    return Section(TITLES[name], [*pictures, Follows(said["follows"]), grid])


def sections(context: Context) -> Sequence[Section]:
    """Write about all questions together, then about each: both tissues, bias against cost, answer, verdicts."""
    table = context.tables["needs_summary"]
    said = _said(context, answered()[0])
    eight = table["id"].isin(EIGHT)
    grids = [
        Grid(headed(table[mine], COLUMNS["summary"]), said[caption], "needs_summary")
        for mine, caption in ((eight, "eight"), (~eight, "five"))
    ]
    method = HowMeasured([Text(said["method"])])
    first = Section(TITLES["all"], [Follows(said["all"]), *grids, Text(said["whole"]), method])
    return [first, *(_section(context, name) for name in answered())]


def findings(context: Context) -> Sequence[Finding]:
    """Return what the eight questions of chapter 4 cost in the simplest model."""
    table = context.tables["needs_summary"]
    known = table[table["cpu"].notna()]
    costs = dict(zip(known["id"], 100 * known["cpu"], strict=True))
    label = "CPU time of the simplest model that answers [% of the full one]"
    names = [name for name in costs if name in EIGHT]
    values = [costs[name] for name in names]
    picture = context.draw("card_needs", cards.bars, names, values, [(value, value) for value in values], label)
    said = _said(context, answered()[0])
    return [Finding(said["all"], TITLES["all"], Card(picture, said["card"], 6))]


CHAPTER = Chapter(
    "needs",
    "What a scene needs",
    "Which parts of the tissue model does an answer need?",
    run,
    sections,
    findings,
    place=3,
    tables=("needs_",),
)
