"""The simplest models that answer questions on cells of chapter 4, isolated and in groups, and on the height.

``python -m verification.beyond.needs.answers`` makes the table again, in a quarter of an hour of two cores, and writes
``verification/data/needs_answers.parquet``. Interrupted, it goes on from the runs in FOLDER.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pandas as pd

from dincl.study import read_sealed
from tissue.study.simplify import simplify
from verification.page.kept import DATA, keep

FILE, FOLDER = DATA / "needs_answers.parquet", Path("results/needs")
# A study that comes with the program, in the model as printed, and what is asked of it; shares are parts, heights um.
QUESTIONS: dict[str, tuple[str, dict[str, Any]]] = {
    "basal extrusion after [A]": ("figure10", {"outcome": "basal", "scenarios": ["[A]"], "tolerance": 0.03}),
    "apical extrusion after [A]": (
        "figure10",
        {"outcome": "apical", "scenarios": ["[A]"], "tolerance": 0.05, "runs": 2048},
    ),
    "basal extrusion of a group": (
        "questions",
        {"outcome": "basal", "scenarios": ["[A] and [B] at any time, 10 cells"], "tolerance": 0.05},
    ),
    "effect of INM on a group": (
        "questions",
        {
            "outcome": "basal",
            "scenarios": ["[A] and [B] at any time no INM, 10 cells", "[A] and [B] at any time, 10 cells"],
            "tolerance": 0.05,
        },
    ),
    "height at 48 h": (
        "figure10",
        {"outcome": "height_um", "scenarios": ["[B]"], "tolerance": 2.0, "at": "48 h"},
    ),
}


def main() -> None:
    """Answer the questions and keep the table."""
    keep(pd.concat([answer(name) for name in QUESTIONS]), FILE, main)


def answer(name: str) -> pd.DataFrame:
    """Return the table of ``simplify`` for a question; ``answer``: whether a row is the simplest model."""
    study, asked = QUESTIONS[name]
    found = simplify(study, out=FOLDER / name.replace(" ", "_"), **asked)
    question, rows = found.question, found.table
    is_answer = (rows["model"] == found.model) & (rows["step"] == "together")
    what = {"question": name, "tolerance": question.tolerance, "shares": question.shares}
    return rows.assign(**what, answer=is_answer)


def table() -> pd.DataFrame:
    """Return the kept table."""
    return read_sealed(FILE)


if __name__ == "__main__":
    main()
