"""Lists of the reference: ``python -m docs.building.lists`` writes keys of files and columns of tables."""

from __future__ import annotations

from pathlib import Path

from dincl.files import write_text
from tissue.cli.parameters import presets, spread
from tissue.files.keys import all_keys, heading, sections
from tissue.files.parameters import Parameters
from tissue.runs.columns import TABLES, UNITS

FOLDER = Path(__file__).parents[1] / "reference"
KEYS = """# The keys of parameter files

`tissue parameters` lists them, too; `tissue parameters numerics.mu` and `tissue parameters emt` say more of a key or a
section. A value is that of all presets, or of those in brackets. A key with a default may be left out in any file.
Each value of a preset cites its source in `tissue/files/presets`. The [source](../../SOURCE.md) of a key is
its place in the thesis, or a row of the table of model variants. `python -m docs.building.lists` makes this page
from `tissue/files/sections.py`.
"""
COLUMNS = """# The columns of all tables

`{t}` stands for an output time, as in `height_um_12h`, and `{event}` for the name of an event. Lengths are in um, times
in h, and the names say so. What users register, [observables](../tutorials/own_event.md) and
[variables](../howto/own_rules.md), has columns of its own behind these. Parquet files have this list, the seed and the
version in the metadata of their schema, and each folder of results has it as `columns.csv`.
`python -m docs.building.lists` makes this page from `tissue/runs/columns.toml`.
"""
HEADS = {
    "table": """`Run.table`, `table.parquet`: one row for each output time and cell, by time, then along the tissue.""",
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
    "simplify": "`simplify.parquet` of `tissue simplify`: one row for each model, scenario and run.",
    "answer": "`Simplified.table`, `answer.csv` of `tissue simplify`: one row for each simplification.",
}


def keys_page() -> str:
    """Write the page of all keys of parameter files, in Markdown."""
    values, keys, parts = presets(), all_keys(Parameters).values(), [KEYS]
    for section, fields in sections(Parameters).items():
        about, rows = heading(fields), [("key", "meaning", "symbol", "unit, or what is allowed", "value", "source")]
        for facts in keys:
            if facts.section == section:
                symbol = f"`{facts.symbol}`" if facts.symbol else ""
                value = spread(facts, values)
                rows.append((f"`{facts.name}`", facts.meaning, symbol, facts.unit, value, facts.source))
        parts += [f"## [{section}]\n", f"{about[0].upper()}{about[1:]}\n"]
        if len(rows) > 1:
            parts.append(_table(rows))
    return "\n".join(parts)


def columns_page() -> str:
    """Write the page of all columns of tables, in Markdown."""
    parts = [COLUMNS]
    for name, head in HEADS.items():
        rows = [("column", "unit", "meaning")]
        for column, meaning in TABLES[name].items():
            rows.append((f"`{column}`", UNITS.get(column.removesuffix("_{t}h").rpartition("_")[2], ""), meaning))
        parts += [f"## {name}\n", f"{head}\n", _table(rows)]
    return "\n".join(parts)


def _table(rows: list[tuple[str, ...]]) -> str:
    lines = [rows[0], ("---",) * len(rows[0]), *rows[1:]]
    return "".join(f"| {' | '.join(cells)} |\n" for cells in lines)


PAGES = {FOLDER / "parameters.md": keys_page, FOLDER / "columns.md": columns_page}
if __name__ == "__main__":
    for path, page in PAGES.items():
        write_text(path, page())
