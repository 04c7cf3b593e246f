"""A study: runs that are named by keys, made in parallel, and kept as a table that can be taken up again."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from concurrent.futures import Executor
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from dincl.provenance import provenance
from dincl.study.bar import progress
from dincl.study.execute import carry_out
from dincl.study.table import Row, Table, rounded, run_names

if TYPE_CHECKING:
    import pandas as pd

MAKES_NO_NUMBERS = True
MOST_DIFFERENCES = 12
Key = Mapping[str, Any]


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
        The keys of the runs wanted, the longest first, so that no worker is left alone with it at the end.
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
        """What the rows are made by."""
        return provenance(self.run, *self.calls, **self.settings)

    def only(self, wanted: Callable[[Key], bool]) -> Study:
        """The same study with those of its runs whose keys are wanted."""
        return replace(self, runs=tuple(key for key in self.runs if wanted(key)))

    def some(self, most: int) -> Study:
        """The same study with so many of its runs at most, spread evenly over them."""
        return replace(self, runs=self.runs[:: max(1, -(-len(self.runs) // most))])

    def complete(self, folder: Path, executor: Executor) -> pd.DataFrame:
        """Make the runs that the table in ``folder`` lacks; return the rows of this study's runs, sorted by key.

        Rows of another provenance are set aside first. An interruption loses only the runs under way.
        """
        table = Table(folder / f"{self.name}.parquet", self.key, self.provenance())
        changes = table.changes()
        if changes:
            print(f"{self.title}: the table starts anew, the old one is {table.set_aside()}. What differs:")
            more = [f"and {len(changes) - MOST_DIFFERENCES} more"] if len(changes) > MOST_DIFFERENCES else []
            print("\n".join(f"  {line}" for line in changes[:MOST_DIFFERENCES] + more))
        done = table.done()
        missing = [key for key in self.runs if self.name_of(key) not in done]
        if missing:
            self._make(missing, table, executor)
        rows = table.read()
        wanted = {self.name_of(key) for key in self.runs}
        mine = [name in wanted for name in run_names(rows, self.key)]
        return rows.loc[mine].reset_index(drop=True)  # of no rows, too, all columns

    def _make(self, missing: list[Key], table: Table, executor: Executor) -> None:
        stored = 0
        with progress(self.title, len(missing), "runs") as watch:

            def keep(_: Key, rows: list[Row]) -> None:
                nonlocal stored
                table.append(rows)
                stored += 1
                watch(stored)

            watch(0)
            carry_out(missing, lambda key: executor.submit(self.run, key), keep, executor)

    def name_of(self, key: Key) -> tuple[Any, ...]:
        """The name of a run."""
        return tuple(rounded(key[name]) for name in self.key)
