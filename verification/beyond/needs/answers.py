"""The simplest models that answer questions on an isolated cell of chapter 4, and on the height of the tissue.

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
# Isolated cells of Table 1 of chapter 4 with one event at 12 h, in the model as printed. Shares are parts, heights um.
STUDY = "figure10"
QUESTIONS: dict[str, dict[str, Any]] = {
    "basal extrusion after [A]": {"outcome": "basal", "scenarios": ["[A]"], "tolerance": 0.03},
    "apical extrusion after [A]": {"outcome": "apical", "scenarios": ["[A]"], "tolerance": 0.05, "runs": 2048},
    "height at 48 h": {"outcome": "height_um", "scenarios": ["[B]"], "tolerance": 2.0, "at": "48 h"},
}


def main() -> None:
    """Answer the questions and keep the table."""
    keep(pd.concat([answer(name) for name in QUESTIONS]), FILE, main)


def answer(name: str) -> pd.DataFrame:
    """Return the table of ``simplify`` for a question; ``answer``: whether a row is the simplest model."""
    found = simplify(STUDY, out=FOLDER / name.replace(" ", "_"), **QUESTIONS[name])
    question, rows = found.question, found.table
    is_answer = (rows["model"] == found.model) & (rows["step"] == "together")
    asked = {"question": name, "tolerance": question.tolerance, "shares": question.shares}
    return rows.assign(**asked, answer=is_answer)


def table() -> pd.DataFrame:
    """Return the kept table."""
    return read_sealed(FILE)


if __name__ == "__main__":
    main()
