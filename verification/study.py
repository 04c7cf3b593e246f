"""A study: runs that are named by keys, made in parallel, and kept as a table that can be taken up again."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from concurrent.futures import Executor, Future, ProcessPoolExecutor, as_completed
from dataclasses import dataclass
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import pandas as pd

from verification.progress import Ticker
from verification.table import Row, Table

Key = Mapping[str, Any]
WORKERS = 2


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
    fingerprint
        See ``Table``.
    """

    name: str
    title: str
    key: tuple[str, ...]
    runs: tuple[Key, ...]
    run: Callable[[Key], list[Row]]
    fingerprint: Mapping[str, str]

    def complete(self, folder: Path, executor: Executor) -> pd.DataFrame:
        """Make the runs that the table in ``folder`` lacks; return the rows of this study's runs, sorted by key.

        Rows of another fingerprint are set aside first. An interruption loses only the runs under way.
        """
        table = Table(folder / f"{self.name}.parquet", self.key, self.fingerprint)
        stale = table.set_aside_if_stale()
        if stale is not None:
            print(f"{self.title}: the table was made by other code or settings and starts anew; the old one: {stale}")
        done = table.done()
        missing = [key for key in self.runs if self._name(key) not in done]
        if missing:
            self._make(missing, table, executor)
        rows = table.read()
        wanted = {self._name(key) for key in self.runs}
        mine = [name in wanted for name in rows[list(self.key)].itertuples(index=False, name=None)]
        return rows[mine].reset_index(drop=True)

    def _make(self, missing: list[Key], table: Table, executor: Executor) -> None:
        futures: dict[Future[list[Row]], Key] = {}
        try:
            futures = {executor.submit(self.run, key): key for key in missing}
            with Ticker(self.title, len(missing)) as progress:
                for future in as_completed(futures):
                    table.append(future.result())
                    progress.finished(", ".join(str(futures[future][name]) for name in self.key))
        finally:
            for future in futures:
                future.cancel()

    def _name(self, key: Key) -> tuple[Any, ...]:
        return tuple(key[name] for name in self.key)


def workers() -> ProcessPoolExecutor:
    """Two processes, each with libraries that keep to one thread: more would only take turns."""
    for library in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
        os.environ.setdefault(library, "1")
    return ProcessPoolExecutor(WORKERS, mp_context=get_context("spawn"))
