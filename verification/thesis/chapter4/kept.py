"""The tables of the complete studies, computed once: ``python -m verification.thesis.chapter4.kept FOLDER [PRESET]``.

It makes the runs that are missing in FOLDER, some 350,000 in an hour on two cores, can be stopped at
any time and called again, and writes ``verification/data/emt_*.parquet``. With a preset, "published"
(25,000 runs) or "thesis", it makes the runs and rows of that one and leaves those of the other.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Mapping
from importlib import import_module
from pathlib import Path

import pandas as pd

from dincl.checks import describe
from dincl.errors import InvalidProblem
from dincl.study import read_sealed, workers
from tissue.study.read import Results
from verification.page.context import Context
from verification.page.kept import DATA, keep
from verification.thesis.chapter4 import differences, effects, printed, sensitivity, studies, summaries
from verification.thesis.chapter4.studies import PRESETS, preset_of

# By name: results of studies -> table.
TABLES: dict[str, Callable[[Mapping[str, Results]], pd.DataFrame]] = {
    "printed": printed.compared,
    "ratios": summaries.scenario_ratios,
    "since": summaries.since_a,
    "categories": summaries.category_ratios,
    "conditional": summaries.conditional,
    "outside": summaries.outside,
    "controls": summaries.controls,
    "orders": summaries.orders,
    "ranking": summaries.ranking,
}
# Only of the complete form, with the study that each is of.
FURTHER = {
    sensitivity.NAME: (sensitivity.NAME, sensitivity.indices),
    "changed": (f"{differences.NAME}_without", effects.changed_ratios),
    "effects": (f"{differences.NAME}_design", effects.average_effects),
}
COMPLETE = TABLES | {name: table for name, (_, table) in FURTHER.items()}
COMPLETE_PREFIX = "emt_complete_"


def read(name: str) -> pd.DataFrame:
    """A kept table of the complete studies."""
    return read_sealed(DATA / f"emt_{name}.parquet")


def tables() -> dict[str, pd.DataFrame]:
    """All kept tables, by the names that they have in the report."""
    return {f"{COMPLETE_PREFIX}{name}": read(name) for name in COMPLETE}


def take_over(context: Context) -> None:
    """Put the kept tables into a report, or those made anew."""
    if context.full:
        import_module("verification.thesis.chapter4.page").run(context)
    else:
        context.tables |= tables()


def main(folder: Path, preset: str | None = None) -> None:
    """Complete the studies, of one preset or of all, sum them up and keep the tables."""
    if preset not in {None, *PRESETS}:
        raise InvalidProblem(f"preset = {describe(preset)}: must be {' or '.join(PRESETS)}")
    chosen = {name: study for name, study in studies.chosen(studies.FULL).items() if preset in {None, preset_of(name)}}
    with workers() as executor:
        results = studies.watched(chosen, folder, executor)
    for name, table in COMPLETE.items():
        if name not in FURTHER or FURTHER[name][0] in results:
            made, before = table(results), [] if preset is None or name in FURTHER else [read(name)]
            rows = with_others(made, before[0], preset) if preset is not None and before else made
            keep(rows, DATA / f"emt_{name}.parquet", main, before)


def with_others(made: pd.DataFrame, before: pd.DataFrame, preset: str) -> pd.DataFrame:
    """The rows made for one preset, and of the table before those of the others, in the order of the presets."""
    owner = before["preset"] if "preset" in before else before["study"].map(preset_of)
    parts = [made if name == preset else before[owner == name] for name in PRESETS]
    return pd.concat(parts, ignore_index=True)[list(before)]


if __name__ == "__main__":
    main(Path(sys.argv[1]), *sys.argv[2:])
