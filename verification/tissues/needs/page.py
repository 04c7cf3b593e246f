"""What a scene needs: the difference of simpler models and their work, for thirteen questions on cells and tissues."""

from __future__ import annotations

from pathlib import Path

import pandas as pd

from tissue.study.simplify import AND
from verification.site.context import Context
from verification.site.sheet import GREY, legend_below, sheet
from verification.site.store import shipped
from verification.tissues.needs.study import EIGHT, NAME, QUESTIONS

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


def show(context: Context) -> None:
    """Give all questions together, then for each bias against cost, and verdicts."""
    table = context.tables["needs_summary"]
    context.show("needs_summary", table[list(SUMMARY)].rename(columns=SUMMARY))
    for number, name in enumerate(QUESTIONS, start=1):
        rows, (unit, scale) = _rows(context, name), _unit(_rows(context, name))
        context.draw(f"needs_{number}", draw, rows, unit, scale)
        ends = (scale * rows[["difference", "low", "high"]]).itertuples(index=False)
        shown = rows.assign(
            difference=["" if pd.isna(d) else f"{d:+.2f} [{low:+.2f}, {high:+.2f}] {unit}" for d, low, high in ends]
        )
        context.show(f"needs_{number}", context.headed(NAME, shown), NAME)
    eight = table[table["work"].notna() & table["id"].isin(EIGHT)]
    context.numbers["needs"] = f"{(eight['work'] < 0.5).sum()} of {len(EIGHT)}"
