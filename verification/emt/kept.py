"""The tables of the complete studies, computed once: ``python -m verification.emt.kept FOLDER``.

It makes the runs that are missing in FOLDER, some 215,000 in an hour on two cores, can be stopped at
any time and called again, and writes ``verification/data/emt_*.parquet``.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Mapping
from pathlib import Path

import pandas as pd

from tissue.study.read import Results
from verification.emt import printed, sensitivity, studies, summaries
from verification.study import workers

DATA = Path(__file__).parent.parent / "data"
# By name: results of studies -> table.
TABLES: dict[str, Callable[[Mapping[str, Results]], pd.DataFrame]] = {
    "printed": printed.compared,
    "ratios": summaries.scenario_ratios,
    "categories": summaries.category_ratios,
    "conditional": summaries.conditional,
    "outside": summaries.outside,
    "controls": summaries.controls,
    "answers": summaries.answered,
    "ranking": summaries.ranking,
}
# Only of the complete form.
COMPLETE = TABLES | {sensitivity.NAME: sensitivity.indices}
COMPLETE_PREFIX = "emt_complete_"


def read(name: str) -> pd.DataFrame:
    """A kept table of the complete studies."""
    return pd.read_parquet(DATA / f"emt_{name}.parquet")


def tables() -> dict[str, pd.DataFrame]:
    """All kept tables, by the names that they have in the report."""
    return {f"{COMPLETE_PREFIX}{name}": read(name) for name in COMPLETE}


def main(folder: Path) -> None:
    """Complete the studies, sum them up and keep the tables."""
    with workers() as executor:
        results = studies.watched(studies.chosen(full=True), folder, executor)
    for name, table in COMPLETE.items():
        table(results).to_parquet(DATA / f"emt_{name}.parquet", index=False)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
