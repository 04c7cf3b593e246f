"""What the chapters of a report share: where to write, the tables so far, and the complete studies that ship."""

from __future__ import annotations

import pickle
from collections.abc import Callable, Iterable, Mapping, Sequence
from concurrent.futures import Executor, Future
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from pkgutil import resolve_name
from typing import Any

import pandas as pd

from dincl.study import Study, digest, read_sealed, write
from verification.claims import Table
from verification.site.agreement import Agreement, compare_studies

# In the attributes of the rows of a study: the name of its file.
FILE = "file"


@dataclass
class Context:
    """What the chapters share: where to write, on what to run, and the tables so far, by name.

    Attributes
    ----------
    out
        The folder of the report.
    full
        Whether complete studies are made anew.
    executor
        Makes the runs and draws.
    known
        Name of a table -> the function that makes its study, complete or in its ``smallest`` form.
    complete
        The folder of complete studies that ship; None: there are none.
    smallest
        Whether studies that do not ship are made in their smallest form, for tests.
    agreements
        What came of making parts of complete studies again, by the name of the study.
    studies
        The complete studies that were asked for, by name.
    waiting
        Make the parts again.
    """

    out: Path
    full: bool
    executor: Executor
    known: Mapping[str, Callable[..., Study]] = field(default_factory=dict)
    complete: Path | None = None
    smallest: bool = False
    tables: dict[str, pd.DataFrame] = field(default_factory=dict)
    drawings: list[Future[Path]] = field(default_factory=list)
    agreements: dict[str, Agreement] = field(default_factory=dict)
    studies: dict[str, Study] = field(default_factory=dict)
    waiting: list[Callable[[], None]] = field(default_factory=list)
    _drawn: dict[str, str] = field(default_factory=dict)

    @property
    def folder(self) -> Path:
        """Where the tables are."""
        return self.out / "tables"

    @property
    def made(self) -> Path:
        """Where the complete studies are that were made here."""
        return self.folder / "made"

    def rows(self, name: str) -> pd.DataFrame:
        """Return the rows of a study: as they ship, or made here if it does not ship or ``full`` is set.

        What ships is laid beside its smallest form, made again, once ``waiting`` is called.
        """
        study = self.known[name](smallest=self.smallest)
        self.tables[name] = self.rows_of(study, self.known[name](smallest=True), study.by)
        return self.tables[name]

    def headed(self, name: str, table: pd.DataFrame) -> pd.DataFrame:
        """Return the columns of a table that the study ``name`` has headings for, under these."""
        columns = self.known[name](smallest=True).columns
        return table[[column for column in columns if column in table]].rename(columns=columns)

    def rows_of(self, study: Study, again: Study, by: Sequence[str] = ()) -> pd.DataFrame:
        """Return the rows of a complete study: as it ships, or computed here if it does not ship or ``full`` is set.

        Parameters
        ----------
        study
            The complete one.
        again
            The part of it that is made again beside the rows that ship, once ``waiting`` is called.
        by
            Columns that name a row of a run, see ``compare_studies``.
        """
        file = None if self.complete is None else self.complete / f"{study.name}.parquet"
        shipped = read_sealed(file) if file is not None and file.exists() else None
        rows = study.complete(self.made, self.executor) if shipped is None or self.full else shipped
        if shipped is not None and again.runs and study.name not in self.agreements:
            self.waiting.append(partial(self._repeat, study, rows if self.full else again, by, shipped))
        self.studies[study.name] = study
        write(rows, self.folder / f"{study.name}.parquet")
        rows.attrs[FILE] = study.name
        return rows

    def table(self, wanted: Table) -> pd.DataFrame:
        """Return a table that a claim reads; it is made if it is not there."""
        if wanted not in self.tables:
            resolve_name(wanted.made_by)(self)
        return self.tables[wanted]

    def files_of(self, names: Iterable[str]) -> list[str]:
        """Return the names of the files of some tables; without tables that were only read."""
        files = (str(self.tables[name].attrs.get(FILE, name)) for name in names if name in self.tables)
        return [file for file in files if (self.folder / f"{file}.csv").exists()]

    def _repeat(self, study: Study, again: Study | pd.DataFrame, by: Sequence[str], shipped: pd.DataFrame) -> None:
        """Make a part again, unless its rows are there, and lay it over what ships."""
        # Parts lie apart: they may be of a form of their own.
        made = again.complete(self.folder / "again", self.executor) if isinstance(again, Study) else again
        self.agreements[study.name] = compare_studies(made, shipped, study, by)

    def agreements_of(self, beginnings: tuple[str, ...]) -> dict[str, Agreement]:
        """Return the agreements of the studies whose names begin so."""
        return {name: found for name, found in self.agreements.items() if name.startswith(beginnings)}

    def keep(self, name: str, table: pd.DataFrame) -> None:
        """Share a table that was derived from others, and write it beside them."""
        self.tables[name] = table
        write(table, self.folder / f"{name}.parquet")

    def draw(self, name: str, figure: Callable[..., Path], *arguments: Any, ending: str = ".png") -> Path:
        """Let a worker draw ``figure(*arguments, path)``; the path, where it is once the drawings are done.

        What was drawn of the same arguments before is left.
        """
        path, wanted = self.out / "figures" / f"{name}{ending}", digest(pickle.dumps((figure, arguments)))
        if self._drawn.get(name) != wanted:
            path.parent.mkdir(parents=True, exist_ok=True)
            self.drawings.append(self.executor.submit(figure, *arguments, path))
            self._drawn[name] = wanted
        return path

    def finish_drawings(self) -> None:
        """Wait until all figures are there; raises what went wrong with one."""
        for drawing in self.drawings:
            drawing.result()
