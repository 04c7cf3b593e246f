"""What the pages of results share: the tables so far, the complete studies that ship, and what pages show."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Executor, Future
from dataclasses import asdict, dataclass, field
from functools import partial
from pathlib import Path
from pkgutil import resolve_name
from typing import Any

import pandas as pd

from dincl.files import write_text
from dincl.study import Study, read_sealed
from verification.claims import Table
from verification.site.agreement import Agreement, compare_studies
from verification.site.cells import grid

# The file of what pages show, in the folder of the tables; the Sphinx extension reads it.
SHOWN = "shown.json"
LARGEST = 600_000  # letters of a CSV


@dataclass
class Context:
    """What the pages share: where to write, on what to run, and the tables so far, by name.

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
    grids, numbers, charts
        What pages show by name: tables as HTML with their file and number of rows, numbers as text, charts as HTML.
    agreements
        What came of rerunning parts of complete studies, by the name of the study.
    waiting
        Rerun the parts.
    """

    out: Path
    full: bool
    executor: Executor
    known: Mapping[str, Callable[..., Study]] = field(default_factory=dict)
    complete: Path | None = None
    smallest: bool = False
    tables: dict[str, pd.DataFrame] = field(default_factory=dict)
    drawings: list[Future[Path]] = field(default_factory=list)
    grids: dict[str, dict[str, Any]] = field(default_factory=dict)
    numbers: dict[str, str] = field(default_factory=dict)
    charts: dict[str, str] = field(default_factory=dict)
    agreements: dict[str, Agreement] = field(default_factory=dict)
    waiting: list[Callable[[], None]] = field(default_factory=list)

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
        study, again = (self.known[name](smallest=few) for few in (self.smallest, True))
        file = None if self.complete is None else self.complete / f"{name}.parquet"
        shipped = read_sealed(file) if file is not None and file.exists() else None
        rows = study.complete(self.made, self.executor) if shipped is None or self.full else shipped
        if shipped is not None and again.runs and name not in self.agreements:
            self.waiting.append(partial(self._repeat, study, rows if self.full else again, shipped))
        self.keep(name, rows)
        return rows

    def headed(self, name: str, table: pd.DataFrame) -> pd.DataFrame:
        """Return the columns of a table that the study ``name`` has headings for, under these."""
        columns = self.known[name](smallest=True).columns
        return table[[column for column in columns if column in table]].rename(columns=columns)

    def table(self, wanted: Table) -> pd.DataFrame:
        """Return a table that a claim reads; it is made if it is not there."""
        if wanted not in self.tables:
            resolve_name(wanted.made_by)(self)
        return self.tables[wanted]

    def _repeat(self, study: Study, again: Study | pd.DataFrame, shipped: pd.DataFrame) -> None:
        """Make a part again, unless its rows are there, and lay it over what ships."""
        # Parts lie apart: they may be of a form of their own.
        made = again.complete(self.folder / "again", self.executor) if isinstance(again, Study) else again
        self.agreements[study.name] = compare_studies(made, shipped, study)

    def keep(self, name: str, table: pd.DataFrame) -> None:
        """Share a table; a CSV for readers is written, with six digits, unless it is large."""
        self.tables[name] = table
        text = table.to_csv(index=False, float_format="%.6g")
        if len(text) <= LARGEST:
            self.folder.mkdir(parents=True, exist_ok=True)
            write_text(self.folder / f"{name}.csv", text)

    def show(self, name: str, table: pd.DataFrame, file: str = "") -> None:
        """Give pages a table, ``{{ table("name") }}``; ``file`` names the table that it was taken from."""
        self.grids[name] = {"html": grid(table), "rows": len(table), "file": file or name}

    def draw(self, name: str, figure: Callable[..., Path], *arguments: Any) -> None:
        """Let a worker draw ``figure(*arguments, path)`` for pages, ``{{ figure("name") }}``."""
        path = self.out / "figures" / f"{name}.png"
        path.parent.mkdir(parents=True, exist_ok=True)
        self.drawings.append(self.executor.submit(figure, *arguments, path))

    def finish_drawings(self) -> None:
        """Wait until all figures are there; raises what went wrong with one."""
        for drawing in self.drawings:
            drawing.result()

    def publish(self, facts: Sequence[tuple[str, str]]) -> None:
        """Write what pages show."""
        found = {name: asdict(one) for name, one in self.agreements.items()}
        shown = {"grids": self.grids, "numbers": self.numbers, "charts": self.charts}
        self.folder.mkdir(parents=True, exist_ok=True)
        write_text(self.folder / SHOWN, json.dumps(shown | {"agreements": found, "facts": list(facts)}))
