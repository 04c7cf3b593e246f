"""What a scene needs: the difference of simpler models and their work, for thirteen questions on cells and tissues."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import pandas as pd

from tissue.files.parameters import preset
from tissue.study.simplify import AND, ERROR
from verification.site import cards
from verification.site.context import Context
from verification.site.parts import Follows, Grid, HowMeasured, Part, Picture, Section, Text
from verification.site.prose import listed, percent, percent_up
from verification.site.report import Card, Chapter, Finding
from verification.site.sheet import GREY, legend_below, sheet
from verification.site.store import shipped
from verification.tissues.needs.study import EIGHT, NAME, QUESTIONS

TITLE = "How simple a model answers which question?"
SUMMARY = {
    "name": "Question",
    "full": "Full model",
    "tolerance": "Tolerance",
    "model": "Simplest model",
    "work": "Work over that of the full model",
    "remark": "Remark",
    "enough": "Simplifications that are equivalent alone",
    "open": "Not decided",
}
METHOD = (
    "Each simplification ran beside the full model with the same seeds. The paired differences of runs decide by two "
    "one-sided tests, corrected by Holm. Those that are equivalent are combined, first those that save the most work, "
    "while their differences add up to at most half of the tolerance; the combination runs with fresh seeds. If it is "
    "not shown to be equivalent, the simplest model is the single simplification that saves the most. An answer is "
    f"wrong in at most {percent_up(ERROR)} of the cases. Work is the number of substeps times that of cells. What "
    "a question needs depends on its tolerance: a smaller difference needs more of the model."
)
LISTED = "The simplest model for each question. “Not decided”: the difference may be within the tolerance or outside."
VERDICTS = "Verdicts: each simplification alone, then their combination."
COLOURS = {"equivalent": "#009e73", "open": GREY, "different": "#d55e00"}


def run(context: Context) -> None:
    """Read the table, and sum it up, a row for each question."""
    if context.full:
        context.rows(NAME)
    else:
        context.keep(NAME, shipped(NAME))
    context.keep("needs_summary", pd.DataFrame([summed(_rows(context, name)) for name in QUESTIONS]))


def _rows(context: Context, name: str) -> pd.DataFrame:
    """Return the models that were tried for a question."""
    table = context.tables[NAME]
    return table[table["question"] == name].reset_index(drop=True)


def summed(rows: pd.DataFrame) -> dict[str, object]:
    """Sum up a question: what the full model answers, the simplest model, and what is not decided."""
    name, (unit, scale) = str(rows["question"].iloc[0]), _unit(rows)
    alone, found = rows[rows["step"] == "alone"], rows[rows["answer"]]
    undecided = alone.loc[alone["verdict"] == "open", "model"]
    above = abs(rows["tolerance"].iloc[0]) >= abs(rows["full"].iloc[0])
    return {
        "id": name,
        "name": QUESTIONS[name].name,
        "full": f"{scale * rows['full'].iloc[0]:.3g} {unit}",
        "tolerance": f"{scale * rows['tolerance'].iloc[0]:g} {unit}",
        "model": "".join(found["model"]).replace(AND, ", ") or ("not decided" if len(undecided) else "the full model"),
        "work": None if found.empty else float(found["work"].iloc[0]),
        "remark": "the tolerance is above the effect: a model without any effect is enough" if above else "",
        "enough": f"{(alone['verdict'] == 'equivalent').sum()} of {len(alone)}",
        "open": ", ".join(undecided),
    }


def _unit(rows: pd.DataFrame) -> tuple[str, float]:
    """Return the unit of a question, and its size in the table."""
    return ("µm", 1.0) if "height" in rows["question"].iloc[0] else ("points", 100.0)


def draw(rows: pd.DataFrame, unit: str, scale: float, path: Path) -> Path:
    """Draw the difference of each model with its interval beside the tolerance, and its work."""
    shown = rows[rows["difference"].notna()].iloc[::-1].reset_index(drop=True)
    names = shown["model"].mask(shown["step"] == "together", "together, fresh seeds")
    with sheet(path, 1.0 + 0.25 * len(shown)) as figure:
        work, difference = figure.subplots(1, 2, sharey=True, width_ratios=(1, 1.6))
        work.barh(names, shown["work"], color=[COLOURS[verdict] for verdict in shown["verdict"]])
        work.set(xlabel="work / full model")
        tolerance = scale * float(rows["tolerance"].iloc[0])
        difference.axvspan(-tolerance, tolerance, color=COLOURS["equivalent"], alpha=0.12, linewidth=0)
        for verdict, colour in COLOURS.items():
            mine = shown[shown["verdict"] == verdict]
            ends = (scale * (mine["difference"] - mine["low"]), scale * (mine["high"] - mine["difference"]))
            mean = scale * mine["difference"]
            difference.errorbar(mean, mine.index, xerr=ends, fmt="o", color=colour, label=verdict)
        difference.set(xlabel=f"simpler minus full model [{unit}]; shaded: the tolerance")
        legend_below(figure, [difference], 3)
    return path


def sections(context: Context) -> Sequence[Section]:
    """Write about all questions together, then about each: bias against cost, and verdicts."""
    table = context.tables["needs_summary"]
    grid = Grid(table[list(SUMMARY)].rename(columns=SUMMARY), LISTED, "needs_summary")
    parts: list[Part] = [
        Follows(_said(table)),
        Text(_limit()),
        grid,
        Text(_never(context)),
        HowMeasured([Text(METHOD)]),
    ]
    first = Section(TITLE, parts)
    return [first, *(_section(context, name) for name in QUESTIONS)]


def _said(table: pd.DataFrame) -> str:
    """Say what the questions of chapter 4 cost."""
    eight = table[table["id"].isin(EIGHT)]
    least, greatest = percent(eight["work"].min()), percent(eight["work"].max())
    return (
        f"Of {len(eight)} questions of chapter 4, {(eight['work'] < 0.5).sum()} are answered with less than half of "
        f"the work: the simplest model that is enough takes {least} to {greatest} of that of the full one."
    )


def _limit() -> str:
    """Say how far the full model is from its own limit of small steps: heights at the end of its runs."""
    steps, full = shipped("tissue_substeps"), preset("thesis")
    mine = steps[(steps["preset"] == "thesis") & (steps["substeps"] == full.numerics.substeps)]
    last = mine[mine["t"] == mine["t"].max()]
    return (
        f"“Full model” is the model as printed in the thesis, with its {full.numerics.substeps} substeps. After "
        f"{last['t'].iloc[0]:g} h its tissue is {percent(last['deviation'].mean(), 1)} higher than in its own limit of "
        "small steps. A bias is measured from the full model, not from that limit, so it may be smaller than the error "
        "of the full model itself."
    )


def _never(context: Context) -> str:
    """Name what no question can do without, and what each can."""
    rows = context.tables[NAME]
    alone = rows[rows["step"] == "alone"]
    enough = alone[alone["verdict"] == "equivalent"].groupby("model")["question"].nunique()
    never = sorted(set(alone["model"]) - set(enough.index))
    always = sorted(enough.index[enough == len(QUESTIONS)])
    return f"Enough for no question, alone: {listed(never)}. Enough for each question, alone: {listed(always)}."


def _section(context: Context, name: str) -> Section:
    rows = _rows(context, name)
    unit, scale = _unit(rows)
    chart = context.draw(f"needs_{list(QUESTIONS).index(name) + 1}", draw, rows, unit, scale)
    ends = (scale * rows[["difference", "low", "high"]]).itertuples(index=False)
    shown = rows.assign(
        difference=["" if pd.isna(d) else f"{d:+.2f} [{low:+.2f}, {high:+.2f}] {unit}" for d, low, high in ends]
    )
    parts: list[Part] = [
        Text(QUESTIONS[name].about),
        Picture(chart, "Work and difference of simpler models."),
        Grid(context.headed(NAME, shown), VERDICTS, NAME, folded=True),
    ]
    return Section(f"How simple a model answers {QUESTIONS[name].name}?", parts)


def findings(context: Context) -> Sequence[Finding]:
    """Return what the eight questions of chapter 4 cost in the simplest model."""
    table = context.tables["needs_summary"]
    known = table[table["work"].notna() & table["id"].isin(EIGHT)]
    costs = list(100 * known["work"])
    label = "work of the simplest model that answers [% of the full one]"
    picture = context.draw("card_needs", cards.bars, list(known["id"]), costs, [(cost, cost) for cost in costs], label)
    said = _said(table)
    return [Finding(said, TITLE, Card(picture, said, 6))]


CHAPTER = Chapter(
    "needs",
    "What a scene needs",
    "Which parts of the tissue model does an answer need?",
    run,
    sections,
    findings,
    tables=("needs_",),
)
