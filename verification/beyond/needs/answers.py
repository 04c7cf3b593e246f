"""The simplest models that answer the questions of ``verification.beyond.needs.questions``: the kept table.

``python -m verification.beyond.needs.answers`` makes it again, in twenty minutes of two cores, and writes
``verification/data/needs_answers.parquet``; with names of questions behind it, such as Q1 Q2, it makes their rows
alone. Interrupted, it goes on from the runs in FOLDER.
"""

from __future__ import annotations

import sys
from pathlib import Path

import pandas as pd

from dincl.study import read_sealed
from tissue.study.simplify import FRESH, FULL, simplify
from verification.beyond.needs.questions import QUESTIONS
from verification.page.kept import DATA, keep

FILE, FOLDER = DATA / "needs_answers.parquet", Path("results/needs")


def main(*names: str) -> None:
    """Answer questions, all if none are named, and keep their rows in place of the former ones."""
    before = table() if FILE.exists() and names else None
    for name in names or QUESTIONS:
        others = [] if before is None else [before[before["question"] != name]]
        rows = pd.concat([*others, answer(name)])
        order = rows["question"].map(list(QUESTIONS).index)
        rows = rows.iloc[order.argsort(kind="stable")]
        rows.attrs = {}
        keep(rows, FILE, main, [] if before is None else [before])
        before = table()


def answer(name: str) -> pd.DataFrame:
    """Return the table of ``simplify`` for a question.

    ``answer``: whether a row is the simplest model; ``full``: what the full model answers, the mean of its runs that no
    combination was confirmed by.
    """
    asked, folder = QUESTIONS[name], FOLDER / name.replace(" ", "_")
    found = simplify(asked.study, out=folder, **asked.what)
    question, rows = found.question, found.table
    runs = read_sealed(folder / "simplify.parquet")
    means = runs[(runs["model"] == FULL) & (runs["replicate"] < FRESH)].groupby("scenario")["value"].mean()
    first, *second = (float(means[scenario]) for scenario in question.scenarios)
    is_answer = (rows["model"] == found.model) & (rows["step"] == "together")
    what = {"question": name, "tolerance": question.tolerance, "shares": question.shares, "full": first - sum(second)}
    return rows.assign(**what, answer=is_answer)


def table() -> pd.DataFrame:
    """Return the kept table."""
    return read_sealed(FILE)


if __name__ == "__main__":
    main(*sys.argv[1:])
