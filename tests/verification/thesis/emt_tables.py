"""The kept tables of the EMT studies, and ways in which they could have come out."""

from __future__ import annotations

from collections.abc import Collection, Mapping

import pandas as pd

from verification.site.store import shipped
from verification.thesis.chapter4.ensembles import PRESETS, preset_of
from verification.thesis.chapter4.frequencies import GROUPS, IN_TIME, OUTCOMES, RANKING, RATIOS
from verification.thesis.chapter4.groups import EDGES

KEPT = {name: shipped(name) for name in (RATIOS, IN_TIME, GROUPS, RANKING)}

Frames = Mapping[str, pd.DataFrame]


def without_early_extrusion() -> Frames:
    """As if no cell with an event before 12 h left."""
    table = KEPT[GROUPS]
    early = table["given"].str.startswith("t_") & (table["high_edge"] <= 12)
    return {**KEPT, GROUPS: table.assign(count=table["count"].where(~early, 0))}


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


def reversed_rows(*given: str) -> Frames:
    """As if the ratios of the rows that are by these were in the opposite order, in each group and kind."""
    numbers = ["count", "of", "effective", "value", "low", "high"]
    table = KEPT[GROUPS].copy()
    names = ["study", "given"] if given == ("events",) else ["study", "given", "kind"]
    for _, rows in table[table["given"].isin(given)].groupby(names):
        table.loc[rows.index, numbers] = rows[numbers].to_numpy()[::-1]
    return {**KEPT, GROUPS: table}


def by_position_or_time() -> Frames:
    """As if the ratios by each position or time were in the opposite order."""
    return reversed_rows(*EDGES)


def with_counts(name: str, share: float, given: Collection[str] = ()) -> Frames:
    """As if this share of the cells of each row, or of those that are by ``given``, were hits, of many more cells."""
    table = KEPT[name]
    mine = table["given"].isin(given) if given else pd.Series(True, table.index)
    cells = 10_000 * table["of"]
    changed = {"count": (share * cells).astype(int), "of": cells, "effective": cells.astype(float)}
    return {**KEPT, name: table.assign(**{column: table[column].mask(mine, new) for column, new in changed.items()})}


def printed_as_published() -> Frames:
    """As if isolated cells left in the model as printed as they do in the published runs."""
    table = KEPT[RATIOS]
    isolated = table["study"].isin(["figure10", "figure12"])
    published = table[table["study"].isin(["figure10_published", "figure12_published"])]
    mine = published.assign(study=published["study"].str.removesuffix("_published"))
    return {**KEPT, RATIOS: pd.concat([table[~isolated], mine], ignore_index=True)}
