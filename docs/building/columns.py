"""The page docs/reference/columns.md: ``python -m docs.building.columns`` writes it from ``tissue.runs.columns``."""

from __future__ import annotations

from pathlib import Path

from dincl.files import write_text
from tissue.runs.columns import TABLES, UNITS

PAGE = Path(__file__).parents[1] / "reference" / "columns.md"
TOP = """# The columns of all tables

`{t}` stands for an output time, as in `height_um_12h`, and `{event}` for the name of an event. Lengths are in um, times
in h, and the names say so. What users register, [observables](../tutorials/own_event.md) and
[variables](../howto/own_rules.md), has columns of its own behind these. Parquet files have this list, the seed and the
version in the metadata of their schema, and each folder of results has it as `columns.csv`.
`python -m docs.building.columns` makes this page from `tissue/runs/columns.toml`.
"""
HEADS = {
    "table": """`Run.table`, `table.parquet`: one row for each output time and cell, by time, then along the tissue.
`Results.trajectory` and the folder `trajectories` of a study have the same, the latter with `replicate`.""",
    "summary": """`Run.summary`, `summary.csv`: one row for each output time. Where the apical layer is folded, what
means nothing is NaN.""",
    "networks": "`Run.networks` in three dimensions: one row for each output time and pair of neighbours.",
    "cells": """`Results.cells`, folder `cells` of a study: one row for each replicate that did not fail, and EMT cell
of the start.""",
    "runs": """`Results.runs`, folder `runs` of a study: one row for each replicate; what was not measured is NaN.
`Results.series` has a row for each output time in place of a column: `height_um` and `time_h` for `height_um_12h`.""",
    "sensitivity": """`tissue.sensitivity`, `sensitivity.csv`. Of a fit, `sample.csv` has a column for each parameter,
and `design.parquet` those of `runs` and `summary` that the data have, with `batch`, `point` and the shares of EMT cells
`basal_{t}h`, `apical_{t}h` and `below_{t}h`.""",
}


def page() -> str:
    """Write the page, in Markdown."""
    parts = [TOP]
    for name, head in HEADS.items():
        rows = [("column", "unit", "meaning"), ("---",) * 3]
        for column, meaning in TABLES[name].items():
            rows.append((f"`{column}`", UNITS.get(column.removesuffix("_{t}h").rpartition("_")[2], ""), meaning))
        parts += [f"## {name}\n", f"{head}\n", "".join(f"| {' | '.join(cells)} |\n" for cells in rows)]
    return "\n".join(parts)


if __name__ == "__main__":
    write_text(PAGE, page())
