"""Who is cheapest, kept for the results page: ``python -m verification.thesis.chapter2.kept_winners FOLDER``.

It makes the runs of the complete form that are missing in FOLDER, which may be ``report/tables``, can be stopped at any
time and called again, and writes ``verification/thesis/data/work_winners.parquet``.
"""

from __future__ import annotations

import sys
from pathlib import Path

import pandas as pd

from dincl.study import workers
from verification.thesis.chapter2 import cheapest, work_precision
from verification.thesis.chapter2.work_references import SCENES
from verification.thesis.kept import DATA, keep

FILE = DATA / "work_winners.parquet"


def main(folder: Path) -> None:
    """Complete the references and the study, and keep the table of winners."""
    with workers() as executor:
        _, table = work_precision.complete(work_precision.FULL, folder, executor)
    keep(cheapest.winners(table, work_precision.FULL), FILE, main)


def sentences() -> list[str]:
    """What the kept table says: all scenes together, then each by its title; nothing if none is kept."""
    if not FILE.exists():
        return []
    winners = pd.read_parquet(FILE)
    rows = {make().title: winners[winners["scene"] == name] for name, make in SCENES.items()}
    said = (f"{title}: {cheapest.sentence(mine)}" for title, mine in rows.items() if len(mine))
    return [cheapest.summary(winners), *said]


if __name__ == "__main__":
    main(Path(sys.argv[1]))
