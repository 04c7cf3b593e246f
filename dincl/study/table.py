"""A study: runs that are named by keys, made in parallel, in a table that can be resumed.

Tables survive an interruption and never mix rows made by different code.
"""

from __future__ import annotations

import hashlib
import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from dincl.files import replacing
from dincl.provenance import differences, provenance
from dincl.study.execute import carry_out, progress
from dincl.study.parts import locked
from dincl.study.sealed import DamagedTable, read_sealed, write_sealed

if TYPE_CHECKING:
    import pandas as pd

MAKES_NO_NUMBERS = True
# Settings that are powers differ in their last digit from processor to processor: one run has one name.
DIGITS = 12
MOST_DIFFERENCES = 12
# In the attributes of a table, which Parquet stores.
ATTRIBUTE = "provenance"
Key = Mapping[str, Any]
Row = Mapping[str, Any]


@dataclass(frozen=True)
class Study:
    """A table of runs.

    Attributes
    ----------
    name, title
        Of the file; for the progress.
    key
        Columns that name a run.
    runs
        The keys of the runs, the longest first, so that no worker is left alone with it at the end.
    run
        key -> rows of that run; picklable.
    settings
        What the rows depend on besides their keys; if there are none, what ``run`` binds: the arguments of a partial,
        the fields of a callable dataclass.
    calls
        Functions that ``run`` finds at run time, where no import statement names their modules.
    """

    name: str
    title: str
    key: tuple[str, ...]
    runs: tuple[Key, ...]
    run: Callable[[Key], list[Row]]
    settings: Mapping[str, Any] = field(default_factory=dict)
    calls: tuple[Callable[..., Any], ...] = ()

    def provenance(self) -> dict[str, str]:
        """Return what the rows are made by."""
        return provenance(self.run, *self.calls, **self.settings)

    def only(self, condition: Callable[[Key], bool]) -> Study:
        """Return the same study with the runs whose keys meet a condition."""
        return replace(self, runs=tuple(key for key in self.runs if condition(key)))

    def some(self, most: int) -> Study:
        """Return the same study with at most so many of its runs, spread evenly over them."""
        return replace(self, runs=self.runs[:: max(1, -(-len(self.runs) // most))])

    def complete(self, folder: Path, executor: Executor) -> pd.DataFrame:
        """Make the runs that the table in ``folder`` lacks; return the rows of this study's runs, sorted by key.

        Rows of another provenance are set aside first. An interruption loses only the runs under way.

        Raises
        ------
        InvalidProblem
            If another process is making the same table.
        """
        table = Table(folder / f"{self.name}.parquet", self.key, self.provenance())
        with locked(folder, f"{self.name}.lock"):
            self._resume(table, executor)
        rows, names = table.read(), {self.name_of(key) for key in self.runs}
        mine = [name in names for name in run_names(rows, self.key)]
        return rows.loc[mine].reset_index(drop=True)  # all columns, even without rows

    def _resume(self, table: Table, executor: Executor) -> None:
        """Make the runs that a table lacks."""
        if changes := table.changes():
            print(f"{self.title}: the table starts anew, the old one is {table.set_aside()}. What differs:")
            more = [f"and {len(changes) - MOST_DIFFERENCES} more"] if len(changes) > MOST_DIFFERENCES else []
            print("\n".join(f"  {line}" for line in changes[:MOST_DIFFERENCES] + more))
        done = table.done()
        missing = [key for key in self.runs if self.name_of(key) not in done]
        if missing:
            self._make(missing, table, executor)

    def _make(self, missing: list[Key], table: Table, executor: Executor) -> None:
        """Make runs, and append their rows to the table."""
        stored = 0
        with progress(self.title, len(missing), "runs") as show:

            def keep(_: Key, rows: list[Row]) -> None:
                nonlocal stored
                table.append(rows)
                stored += 1
                show(stored)

            show(0)
            carry_out(missing, lambda key: executor.submit(self.run, key), keep, executor)

    def name_of(self, key: Key) -> tuple[Any, ...]:
        """Return the name of a run."""
        return tuple(rounded(key[column]) for column in self.key)


@dataclass(frozen=True)
class Table:
    """Rows of runs, stored as Parquet with a CSV beside it.

    Attributes
    ----------
    path
        The Parquet file.
    key
        Columns that name a run; one run may have several rows, which are appended together.
    provenance
        What the rows depend on besides their key, see ``dincl.provenance``. It is stored in the file, if it is known.
    notes
        Further attributes of the file, such as the command that makes it.
    """

    path: Path
    key: tuple[str, ...]
    provenance: Mapping[str, str]
    notes: Mapping[str, str] = field(default_factory=dict)

    def read(self) -> pd.DataFrame:
        """Read all rows, sorted by key; none if there is no file yet.

        Raises
        ------
        ValueError
            If the file has another provenance; DamagedTable if it is not as it was written.
        """
        import pandas as pd

        if not self.path.exists():
            return pd.DataFrame(columns=list(self.key))
        rows = read_sealed(self.path)
        if changes := differences(rows.attrs.get(ATTRIBUTE, {}), self.provenance):
            raise ValueError(
                f"{self.path.name} was made by other code or settings ({'; '.join(changes)}), and its rows cannot be "
                "mixed with new ones: set the file aside"
            )
        return rows

    def changes(self) -> list[str]:
        """List in what the provenance of the file differs, a line each, or what is wrong with the file."""
        try:
            rows = read_sealed(self.path) if self.path.exists() else None
        except DamagedTable as error:
            return [str(error)]
        return [] if rows is None else differences(rows.attrs.get(ATTRIBUTE, {}), self.provenance)

    def done(self) -> set[tuple[Any, ...]]:
        """Return the names of the runs that the table has."""
        return set(run_names(self.read(), self.key))

    def append(self, rows: Iterable[Row]) -> None:
        """Add the rows of a run, so that the file has either all of them or none, whatever happens meanwhile."""
        import pandas as pd

        table = pd.DataFrame([*self.read().to_dict("records"), *rows])
        table = table.sort_values(list(self.key), kind="stable", ignore_index=True)
        write_csv(table, self.path)
        self.replace(table)

    def replace(self, rows: pd.DataFrame) -> None:
        """Write all rows, in place of those that are there."""
        rows.attrs = {**self.notes, **({ATTRIBUTE: dict(self.provenance)} if self.provenance else {})}
        self.path.parent.mkdir(parents=True, exist_ok=True)
        write_sealed(rows, self.path)

    def set_aside(self) -> Path:
        """Move the file to the folder ``superseded``; return where it went."""
        old = self.path.parent / "superseded"
        old.mkdir(exist_ok=True)
        for suffix in (".csv", ".parquet") if self.path.with_suffix(".csv").exists() else (".parquet",):
            os.replace(self.path.with_suffix(suffix), old / self.path.with_suffix(suffix).name)
        return old / self.path.name


def run_names(rows: pd.DataFrame, key: Sequence[str]) -> list[tuple[Any, ...]]:
    """Return for each row the name of its run: the values in the columns of a key."""
    found = rows[list(key)].itertuples(index=False, name=None)
    return [tuple(map(rounded, name)) for name in found]


def rounded(value: Any) -> Any:
    """Round a number that names a run to DIGITS; return anything else as it is."""
    return float(f"{value:.{DIGITS}g}") if isinstance(value, float) else value


def write(table: pd.DataFrame, path: Path) -> None:
    """Write Parquet, which ``read_sealed`` reads, and a CSV beside it; each is put in place at once."""
    write_csv(table, path)
    write_sealed(table, path.with_suffix(".parquet"))


def write_csv(table: pd.DataFrame, path: Path) -> None:
    """Write the CSV beside a Parquet file, with their folder."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with replacing(path.with_suffix(".csv")) as partial:
        table.to_csv(partial, index=False)


def digest(value: object) -> str:
    """Return a short name for a value, from its representation as text."""
    return hashlib.sha256(repr(value).encode()).hexdigest()[:16]
