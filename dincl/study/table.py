"""Tables that survive an interruption and never mix rows of different making."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from dincl.files import replacing
from dincl.provenance import differences
from dincl.study.sealed import DamagedTable, read_sealed, write_sealed

if TYPE_CHECKING:
    import pandas as pd

MAKES_NO_NUMBERS = True
# Settings that are powers differ in their last digit from processor to processor: one run has one name.
DIGITS = 12
Row = Mapping[str, Any]
# In the attributes of a table, which Parquet keeps.
ATTRIBUTE = "provenance"


def rounded(value: Any) -> Any:
    """A number that names a run, to DIGITS; anything else as it is."""
    return float(f"{value:.{DIGITS}g}") if isinstance(value, float) else value


def run_names(rows: pd.DataFrame, key: Sequence[str]) -> list[tuple[Any, ...]]:
    """Of each row the name of its run, by the columns of a key."""
    found = rows[list(key)].itertuples(index=False, name=None)
    return [tuple(map(rounded, name)) for name in found]


@dataclass(frozen=True)
class Table:
    """Rows of runs, kept as Parquet with a CSV beside it.

    Attributes
    ----------
    path
        The Parquet file.
    key
        Columns that name a run; one run may have several rows, which are appended together.
    provenance
        What the rows depend on besides their key, see ``dincl.provenance``. It is kept in the file.
    """

    path: Path
    key: tuple[str, ...]
    provenance: Mapping[str, str]

    def read(self) -> pd.DataFrame:
        """All rows, sorted by key; empty if there are none yet.

        Raises
        ------
        ValueError
            If the file has another provenance; DamagedTable if it is not as it was written.
        """
        import pandas as pd

        if not self.path.exists():
            return pd.DataFrame(columns=list(self.key))
        rows = read_sealed(self.path)
        changes = self._changes(rows)
        if changes:
            raise ValueError(
                f"{self.path.name} was made by something else ({'; '.join(changes)}): rows of different making are not "
                "mixed; set the file aside"
            )
        return rows

    def changes(self) -> list[str]:
        """A line for each thing in which the provenance of the file differs, or for what is wrong with the file."""
        try:
            return self._changes(read_sealed(self.path)) if self.path.exists() else []
        except DamagedTable as error:
            return [str(error)]

    def _changes(self, rows: pd.DataFrame) -> list[str]:
        return differences(rows.attrs.get(ATTRIBUTE, {}), self.provenance)

    def done(self) -> set[tuple[Any, ...]]:
        """The keys of the runs that the table has."""
        return set(run_names(self.read(), self.key))

    def append(self, rows: Iterable[Row]) -> None:
        """Add the rows of a run, so that the file holds either all of them or none, whatever happens meanwhile."""
        import pandas as pd

        table = pd.DataFrame([*self.read().to_dict("records"), *rows])
        table = table.sort_values(list(self.key), kind="stable", ignore_index=True)
        table.attrs[ATTRIBUTE] = dict(self.provenance)
        write(table, self.path)

    def set_aside(self) -> Path:
        """Move the file to the folder ``superseded``; return where it went."""
        old = self.path.parent / "superseded"
        old.mkdir(exist_ok=True)
        for suffix in (".csv", ".parquet") if self.path.with_suffix(".csv").exists() else (".parquet",):
            os.replace(self.path.with_suffix(suffix), old / self.path.with_suffix(suffix).name)
        return old / self.path.name


def write(table: pd.DataFrame, path: Path) -> None:
    """Write Parquet, which ``read_sealed`` reads, and a CSV beside it; each is put in place at once."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with replacing(path.with_suffix(".csv")) as partial:
        table.to_csv(partial, index=False)
    write_sealed(table, path.with_suffix(".parquet"))


def digest(value: object) -> str:
    """A short name for numbers."""
    return hashlib.sha256(repr(value).encode()).hexdigest()[:16]
