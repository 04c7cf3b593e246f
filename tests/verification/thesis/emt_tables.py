"""The kept tables of the EMT studies, and ways in which they could have come out."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import pandas as pd

from verification.thesis.chapter4 import kept
from verification.thesis.chapter4.frequencies import CONDITIONAL, OUTCOMES
from verification.thesis.chapter4.studies import PRESETS, preset_of

READ = ("categories", "conditional", "orders", "outside", "printed", "ranking", "ratios", "since")
KEPT = {f"emt_complete_{name}": kept.read(name) for name in READ}

Frames = Mapping[str, pd.DataFrame]


def without_early_extrusion() -> Frames:
    """As if no cell with an event before 12 h left."""
    table = KEPT[CONDITIONAL]
    early = table["given"].str.startswith("t_") & (table["high_edge"] <= 12)
    return {**KEPT, CONDITIONAL: table.assign(count=table["count"].where(~early, 0))}


def deciding_as(tables: Frames, preset: str) -> Frames:
    """As if the reading that decides of outcomes gave what another one does."""
    ending = PRESETS[preset]

    def changed(table: pd.DataFrame) -> pd.DataFrame:
        if "study" not in table:
            return table
        owner = table["study"].map(preset_of)
        mine = table[owner == preset]
        as_deciding = mine.assign(study=mine["study"].str.removesuffix(ending) + PRESETS[OUTCOMES])
        return pd.concat([table[owner != OUTCOMES], as_deciding], ignore_index=True)

    return {name: changed(table) for name, table in tables.items()}


def of_more_cells(tables: Frames, times: int) -> Frames:
    """As if the same ratios had come out of so many times the cells."""
    counted = ["count", "of", "effective"]
    return {
        name: table.assign(**{column: times * table[column] for column in counted}) if "effective" in table else table
        for name, table in tables.items()
    }


def renamed(column: str, **names: str) -> Frames:
    """As if some outcomes or categories had been mixed up."""
    return {
        name: table.assign(**{column: table[column].replace(names)}) if column in table else table
        for name, table in KEPT.items()
    }


def exchanged(column: str, first: str, second: str) -> Frames:
    return renamed(column, **{first: second, second: first})


def reversed_rows(name: str, *groups: str) -> Frames:
    """As if the ratios of each group of rows were in the opposite order."""
    numbers = ["count", "of", "effective", "value", "low", "high"]
    table = KEPT[name].copy()
    for _, rows in table.groupby(list(groups)):
        table.loc[rows.index, numbers] = rows[numbers].to_numpy()[::-1]
    return {**KEPT, name: table}


def with_counts(name: str, share: float) -> Frames:
    """As if this share of the cells of each row were hits, of many more cells."""
    cells = 10_000 * KEPT[name]["of"]
    counts = (share * cells).astype(int)
    return {**KEPT, name: KEPT[name].assign(count=counts, of=cells, effective=cells.astype(float))}


def one_value(name: str, column: str, value: Any) -> Frames:
    return {**KEPT, name: KEPT[name].assign(**{column: value})}
