"""Tables that survive an interruption and never mix rows of different making."""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path
from typing import Any

import pandas as pd

Row = Mapping[str, Any]
# Packages whose version can change a number in a table.
PACKAGES = ("numpy", "scipy", "numba", "casadi", "clarabel", "cvxpy", "daqp", "piqp")
ATTRIBUTE = "fingerprint"
ROOT = Path(__file__).parent.parent
# What the numbers of a package are made by: its code, and the parameters it brings.
CODE = (".py", ".toml")


@dataclass(frozen=True)
class Table:
    """Rows of runs, kept as Parquet with a CSV beside it.

    Attributes
    ----------
    path
        The Parquet file.
    key
        Columns that name a run; one run may have several rows, which are appended together.
    fingerprint
        What the rows depend on besides their key: parameters, code, versions. It is kept in the file.
    """

    path: Path
    key: tuple[str, ...]
    fingerprint: Mapping[str, str]

    def read(self) -> pd.DataFrame:
        """All rows, sorted by key; empty if there are none yet.

        Raises
        ------
        ValueError
            If the file was made with another fingerprint.
        """
        if not self.path.exists():
            return pd.DataFrame(columns=list(self.key))
        rows = pd.read_parquet(self.path)
        found = rows.attrs.get(ATTRIBUTE, {})
        if found != dict(self.fingerprint):
            names = sorted(
                name for name in {*found, *self.fingerprint} if found.get(name) != self.fingerprint.get(name)
            )
            raise ValueError(
                f"{self.path.name} was made with other values of {', '.join(names)}: rows of different making are "
                "not mixed; set the file aside"
            )
        return rows

    def done(self) -> set[tuple[Any, ...]]:
        """The keys of the runs that the table has."""
        return set(self.read()[list(self.key)].itertuples(index=False, name=None))

    def append(self, rows: Iterable[Row]) -> None:
        """Add the rows of a run, so that the file holds either all of them or none, whatever happens meanwhile."""
        table = pd.DataFrame([*self.read().to_dict("records"), *rows])
        table = table.sort_values(list(self.key), kind="stable", ignore_index=True)
        table.attrs[ATTRIBUTE] = dict(self.fingerprint)
        write(table, self.path)

    def set_aside_if_stale(self) -> Path | None:
        """Move a file of another fingerprint to the folder ``superseded``; return where it went, or None."""
        if not self.path.exists() or pd.read_parquet(self.path).attrs.get(ATTRIBUTE, {}) == dict(self.fingerprint):
            return None
        old = self.path.parent / "superseded"
        old.mkdir(exist_ok=True)
        for suffix in (".csv", ".parquet"):
            os.replace(self.path.with_suffix(suffix), old / self.path.with_suffix(suffix).name)
        return old / self.path.name


def write(table: pd.DataFrame, path: Path) -> None:
    """Write Parquet and the CSV beside it under temporary names, then put each in place at once."""
    path.parent.mkdir(parents=True, exist_ok=True)
    for suffix, save in ((".csv", lambda to: table.to_csv(to, index=False)), (".parquet", table.to_parquet)):
        temporary = path.with_name(f".{path.stem}{suffix}.new")
        save(temporary)
        os.replace(temporary, path.with_suffix(suffix))


def fingerprint(*sources: str, packages: Sequence[str] = ("dincl",), **parameters: Any) -> dict[str, str]:
    """What rows depend on: the code of ``packages`` and of ``sources`` in verification, versions, parameters."""
    files = [file for package in packages for file in sorted((ROOT / package).rglob("*")) if file.suffix in CODE]
    code = hashlib.sha256()
    for file in files + sorted((ROOT / "verification").rglob("*.py")):
        code.update(file.read_bytes())
    found = {"code": code.hexdigest()[:16]}
    found.update({name: version(name) for name in PACKAGES})
    found.update({name: json.dumps(value, sort_keys=True, default=str) for name, value in parameters.items()})
    return found


def digest(value: object) -> str:
    """A short name for numbers."""
    return hashlib.sha256(repr(value).encode()).hexdigest()[:16]
