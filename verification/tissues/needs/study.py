"""What a scene needs: the simplest models that answer the eight questions of chapter 4, and five others.

Each of the eight is asked by a difference of basal extrusion at the end of the runs that answers it: of two scenarios,
or of two kinds of cells of one scenario. The model is the one printed in the thesis.
"""

from __future__ import annotations

from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, NamedTuple

import pandas as pd

from dincl.study import Key, Row, Study, read_sealed
from tissue.study.categories import outcome
from tissue.study.simplify import AND, FRESH, FULL, simplify
from verification.site.context import Context
from verification.site.sheet import GREY, legend_below, sheet
from verification.site.store import shipped

NAME = "needs_answers"
# Programs at random times that no study of the program has.
PROGRAMS = str(Path(__file__).parent / "programs.toml")
ANY_TIME, GROUP = "[A] and [B] at any time", "[A] and [B] at any time, 10 cells"
# Q7: the most basal part of the apical-basal scale, and the share of cells of GROUP that begin EMT there in the full
# model: 0.07 of 640 cells of 64 runs.
BASAL_PART, THERE = 0.2, 0.07
SMALLEST = {"question": "height at 48 h", "runs": 128}
COLUMNS = {
    "model": "Model",
    "verdict": "Verdict",
    "difference": "Difference, with its interval",
    "work": "Work over that of the full model",
    "runs": "Runs",
    "reason": "Why not",
}


def placed(cells: pd.DataFrame, end: float) -> pd.Series:
    """Weigh basal extrusion by the place at the onset: 1/p below BASAL_PART, -1/(1 - p) elsewhere, p = THERE.

    The mean is basal extrusion of cells that begin EMT in the most basal fifth minus that of the others, as long as
    their share is p; a model that puts another share there is biased by this, too.
    """
    low = cells["onset_ab"] < BASAL_PART
    return outcome(cells, "basal", end) * (low / THERE - (~low) / (1 - THERE))


def without_protrusions(cells: pd.DataFrame, end: float) -> pd.Series:
    """Weigh basal extrusion so that the mean over a run is that of its cells without [P]; 0 if it has none."""
    chosen = (cells["t_p_h"] >= end).astype(float)
    share = chosen.groupby(cells["replicate"]).transform("mean")
    return outcome(cells, "basal", end) * (chosen / share).where(share > 0, 0.0)


class Asked(NamedTuple):
    """A question with its name, a study, by name or path, and what ``tissue.simplify`` is asked.

    Shares are parts, heights um.
    """

    name: str
    study: str
    what: dict[str, Any]


def _basal(study: str, tolerance: float, runs: int, *scenarios: str) -> tuple[str, dict[str, Any]]:
    return study, {"outcome": "basal", "scenarios": list(scenarios), "tolerance": tolerance, "runs": runs}


FIVE = {
    "basal extrusion after [A]": Asked("Basal extrusion after [A]", *_basal("figure10", 0.03, 512, "[A]")),
    "apical extrusion after [A]": Asked(
        "Apical extrusion after [A]",
        "figure10",
        {"outcome": "apical", "scenarios": ["[A]"], "tolerance": 0.05, "runs": 768},
    ),
    "basal extrusion of a group": Asked("Basal extrusion of a group", *_basal("questions", 0.05, 256, GROUP)),
    "effect of INM on a group": Asked(
        "Effect of INM on a group", *_basal("questions", 0.05, 256, f"{ANY_TIME} no INM, 10 cells", GROUP)
    ),
    "height at 48 h": Asked(
        "Height at 48 h",
        "figure10",
        {"outcome": "height_um", "scenarios": ["[B]"], "tolerance": 2.0, "at": "48 h", "runs": 128},
    ),
}
# By the names of ``verification.thesis.chapter4.questions``; all are of basal extrusion.
EIGHT = {
    "Q1": Asked("Q1, isolated cells against groups", *_basal(PROGRAMS, 0.07, 512, "35 % [P], alone", "35 % [P]")),
    "Q2": Asked("Q2, what [P] adds to [B]", *_basal("figure10", 0.1, 512, "[BP]", "[B]")),
    "Q3": Asked("Q3, early against late [A]", *_basal(PROGRAMS, 0.05, 512, "early [A]", "late [A]")),
    "Q4": Asked("Q4, [A] before [B] against [B] before [A]", *_basal("figure14", 0.1, 256, "[AxB]", "[BxA]")),
    "Q5": Asked("Q5, alone against in a group of its like", *_basal("questions", 0.1, 256, ANY_TIME, GROUP)),
    "Q6": Asked(
        "Q6, without against with INM", *_basal("questions", 0.07, 256, "[B] at any time no INM", "[B] at any time")
    ),
    "Q7": Asked(
        "Q7, effect of the place at the onset",
        "questions",
        {"outcome": placed, "scenarios": [GROUP], "tolerance": 0.25, "runs": 256},
    ),
    "Q8": Asked(
        "Q8, few against many cells with [P]",
        PROGRAMS,
        {"outcome": without_protrusions, "scenarios": ["7 % [P]", "63 % [P]"], "tolerance": 0.05, "runs": 128},
    ),
}
QUESTIONS = EIGHT | FIVE


def study(smallest: bool = False) -> Study:
    """Find the simplest model for each question; about an hour of one core."""
    keys = tuple({"question": name, "runs": asked.what["runs"]} for name, asked in QUESTIONS.items())
    key, runs = ("question", "runs"), (SMALLEST,) if smallest else keys
    return Study(NAME, "The simplest models", key, runs, answers, columns=COLUMNS, by=("step", "model"))


def answers(key: Key) -> list[Row]:
    """Return the table of ``simplify`` for a question, of so many runs of each model.

    ``step``: "alone" or "together"; ``answer``: whether a row is the simplest model; ``full``: what the full model
    answers, the mean of its runs that no combination was confirmed by.
    """
    asked = QUESTIONS[key["question"]]
    with TemporaryDirectory() as folder:
        found = simplify(asked.study, out=folder, **(asked.what | {"runs": key["runs"]}))
        runs = read_sealed(Path(folder) / "simplify.parquet")
    means = runs[(runs["model"] == FULL) & (runs["replicate"] < FRESH)].groupby("scenario")["value"].mean()
    first, *second = (float(means[scenario]) for scenario in asked.what["scenarios"])
    step = ["together" if AND in model else "alone" for model in found.table["model"]]
    answer = found.table["model"] == AND.join(found.answer)
    what = {"step": step, "tolerance": asked.what["tolerance"], "full": first - sum(second), "answer": answer}
    return [{**row, **key} for row in found.table.assign(**what).to_dict("records")]


# The page: differences of simpler models and their work.
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
