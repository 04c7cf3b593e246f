"""All kept tables, made again by the present code: ``make kept``, or ``python -m verification.thesis.remake FOLDER``.

The commands that make them run one after the other. A table that the present code made is left, and interrupted runs
are in FOLDER, so the call can be repeated until all is done. The tables as they were at the first call are in
FOLDER/before; what differs from them is printed and written to FOLDER/changes.csv.
"""

from __future__ import annotations

import shutil
import subprocess
import sys
import time
from collections.abc import Sequence
from importlib import import_module
from inspect import signature
from pathlib import Path

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from dincl.files import replacing
from dincl.study import read_sealed
from verification.page.agreement import OF_THE_MACHINE, RELATIVE, relative
from verification.page.kept import DATA, changes, files, maker_of
from verification.thesis import studies

MAKES_NO_NUMBERS = True
# What others are made from comes first.
FIRST = ("verification.beyond.chart.pile_reference",)


def makers() -> list[str]:
    """List the modules whose ``main`` makes a kept table, in the order in which they can run."""
    found = {maker_of(file) for file in files()}
    return [*FIRST, *sorted(found.difference(FIRST))]


def commands(folder: Path) -> list[tuple[str, list[str]]]:
    """List what has to run, with its name: arguments of Python; no maker whose tables the present code made."""
    found = []
    for module in makers():
        stale = [file.stem for file in files() if maker_of(file) == module and changes(file)]
        if stale:
            takes_folder = "folder" in signature(import_module(module).main).parameters
            found.append((", ".join(stale), [module, str(folder / module)] if takes_folder else [module]))
    return [
        *found,
        *((f"studies of {name}", [studies.__name__, str(folder / "studies"), name]) for name in studies.NAMES),
    ]


def compared(before: Path) -> pd.DataFrame:
    """Return a row for each column of a table that differs from the one before, beyond three digits."""
    pairs = [(old, DATA / old.relative_to(before)) for old in sorted(before.rglob("*.parquet"))]
    rows = [
        row for old, new in pairs if new.exists() for row in differing(read_sealed(old), read_sealed(new), old.stem)
    ]
    return pd.DataFrame(rows, columns=["table", "column", "rows", "differ", "largest", "example"])


def differing(old: pd.DataFrame, new: pd.DataFrame, name: str) -> list[dict[str, object]]:
    """Return a row for each column that differs; rows are paired by their words if their number has changed.

    ``largest`` is the largest relative difference, infinite where a word or an empty place differs.
    """
    if len(old) != len(new):
        shared = old.columns.intersection(new.columns)
        words = [column for column in shared if not pd.api.types.is_numeric_dtype(old[column])]
        old, new = (_by_words(table, words) for table in (old, new))
        both = old.index.intersection(new.index)
        counts = f"{len(old)} rows before, {len(new)} now"
        found = [{"table": name, "column": "", "rows": len(both), "differ": 0, "largest": np.inf, "example": counts}]
        old, new = old.loc[both], new.loc[both]
    else:
        found = []
    for column in old.columns.union(new.columns, sort=False).difference(sorted(OF_THE_MACHINE), sort=False):
        if column not in old or column not in new:
            where = "new" if column not in old else "gone"
            found.append({"table": name, "column": column, "rows": len(old), "differ": len(old), "example": where})
            continue
        apart = _apart(old[column], new[column])
        if (apart > RELATIVE).any():
            worst = int(apart.argmax())
            told = f"{old[column].iloc[worst]} before, {new[column].iloc[worst]} now"
            differ = int((apart > RELATIVE).sum())
            found.append(
                {"table": name, "column": column, "rows": len(old), "differ": differ, "largest": apart.max()}
                | {"example": told}
            )
    return found


def _by_words(table: pd.DataFrame, words: Sequence[str]) -> pd.DataFrame:
    place = table.groupby(list(words), dropna=False).cumcount() if words else pd.RangeIndex(len(table))
    return table.assign(_place=np.asarray(place)).set_index([*words, "_place"], drop=False).drop(columns="_place")


def _apart(old: pd.Series, new: pd.Series) -> NDArray[np.float64]:
    """Return the relative difference of each pair of numbers; infinite for different words."""
    if pd.api.types.is_numeric_dtype(old) and pd.api.types.is_numeric_dtype(new):
        return np.asarray(relative(old, new))
    same = (old.astype(str).to_numpy() == new.astype(str).to_numpy()) | (old.isna() & new.isna()).to_numpy()
    return np.where(same, 0.0, np.inf)


def main(folder: Path) -> None:
    """Run all commands, and say what differs."""
    before, copying = folder / "before", folder / "before.part"
    if not before.exists():
        shutil.rmtree(copying, ignore_errors=True)
        shutil.copytree(DATA, copying)
        copying.rename(before)
    for name, arguments in commands(folder):
        began = time.monotonic()
        print(f"{name}:", flush=True)
        subprocess.run([sys.executable, "-m", *arguments], check=True)
        print(f"{name}: {(time.monotonic() - began) / 60:.1f} minutes", flush=True)
    found = compared(before)
    with replacing(folder / "changes.csv") as file:
        found.to_csv(file, index=False)
    print(found.to_string() if len(found) else "No number differs beyond three digits.")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
