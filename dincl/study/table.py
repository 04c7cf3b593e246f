"""A study: runs that are named by keys, made in parallel, in a table that can be resumed.

Tables survive an interruption, and never mix rows of different settings or versions of this package.
"""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, field
from functools import partial
from itertools import count
from pathlib import Path
from typing import TYPE_CHECKING, Any

from dincl.checks import describe
from dincl.errors import InvalidProblem
from dincl.files import replacing
from dincl.study.execute import carry_out, locked, progress
from dincl.study.record import bound_in, differences, digest_of, record
from dincl.study.sealed import DamagedTable, read_sealed, write_sealed

if TYPE_CHECKING:
    import pandas as pd

# Settings that are powers differ in their last digit from processor to processor: one run has one name.
DIGITS = 12
MOST_DIFFERENCES = 12
# Rows of brief runs are written together, so that writing takes at most a part of the time; a kill loses what was not.
WRITING = 5.0
# Contents of a column by the NumPy kinds of its values; nothing else is stored.
KINDS = {"b": "a flag", "i": "a number", "u": "a number", "f": "a number", "U": "a text"}
# Key of the record in the attributes of a table, which Parquet stores.
ATTRIBUTE = "made"
Key = Mapping[str, Any]
Row = Mapping[str, Any]


@dataclass(frozen=True)
class Study:
    """A table of runs.

    Attributes
    ----------
    name, title
        Name of the file; title of the progress.
    key
        Columns that name a run; numbers that agree to 12 digits are one name.
    runs
        The keys of the runs, each once, the longest first, so that no worker is left alone with it at the end.
    run
        key -> rows of that run, which carry the key; picklable, if an executor with processes makes the runs. Each
        value is a number, a flag, a text or None, and a column has one of these kinds.
    settings
        Values that the rows depend on besides their keys; if there are none, those that ``run`` binds: the arguments
        of a partial, the fields of a callable dataclass; or the code of a function that binds nothing.
    columns
        Column -> its heading with the unit, of those that a page shows.
    by
        Columns that name a row of a run beside the key; none: rows of one run stand in the same order.
    prepare
        Called before the first run that is missing, such as to compute a reference that all runs share.
    unit
        Of the progress, where a key names a batch of runs.

    Raises
    ------
    InvalidProblem
        If a run lacks a column of the key, or two runs have one name; later, if a row cannot be stored: what was made
        before is.
    """

    name: str
    title: str
    key: tuple[str, ...]
    runs: tuple[Key, ...]
    run: Callable[[Key], list[Row]]
    settings: Mapping[str, Any] = field(default_factory=dict)
    columns: Mapping[str, str] = field(default_factory=dict)
    by: tuple[str, ...] = ()
    prepare: Callable[[], object] | None = None
    unit: str = "runs"

    def __post_init__(self) -> None:
        names: set[tuple[Any, ...]] = set()
        for key in self.runs:
            if lacking := [column for column in self.key if column not in key]:
                raise InvalidProblem(f"study {self.name}: run {dict(key)} has no {lacking[0]!r}: must have {self.key}")
            name = self.name_of(key)
            if name in names:
                raise InvalidProblem(f"study {self.name}: two runs are {dict(key)}: must differ in {self.key}")
            names.add(name)

    def made(self) -> dict[str, str]:
        """Return what the rows are made by."""
        bound = self.settings or bound_in(self.run)
        return record(bound) if bound else record({"run": self.run})

    def complete(self, folder: Path, executor: Executor | None = None) -> pd.DataFrame:
        """Make the runs that the table in ``folder`` lacks; return the rows of this study's runs, sorted by key.

        Rows of other settings, or of another version of this package, are set aside first. An interruption loses only
        the runs under way. Without an executor the runs are made here, one after the other.

        Raises
        ------
        InvalidProblem
            If another process is making the same table.
        """
        path, made = folder / f"{self.name}.parquet", self.made()
        with locked(folder, f"{self.name}.lock"):
            rows = self._stored(path, made)
            done = set(run_names(rows, self.key))
            if missing := [key for key in self.runs if self.name_of(key) not in done]:
                self._make(missing, path, made, executor)
                rows = self._stored(path, made)
        names = {self.name_of(key) for key in self.runs}
        mine = [name in names for name in run_names(rows, self.key)]
        return rows.loc[mine].reset_index(drop=True)  # all columns, even without rows

    def rows(self, executor: Executor | None = None) -> pd.DataFrame:
        """Make all runs, and keep their rows in memory alone, in the order of the runs."""
        import pandas as pd

        if self.prepare is not None:
            self.prepare()
        made: dict[tuple[Any, ...], list[Row]] = {}
        kinds: dict[str, str] = {}

        def keep(key: Key, rows: list[Row]) -> None:
            self._check(key, rows, kinds)
            made[self.name_of(key)] = rows

        self._run(self.runs, keep, executor)
        return pd.DataFrame([row for key in self.runs for row in made[self.name_of(key)]])

    def _run(self, keys: Sequence[Key], keep: Callable[[Key, list[Row]], None], executor: Executor | None) -> None:
        """Make runs, by the executor or here, and keep the rows of each as soon as they are there."""
        if executor is not None:
            carry_out(keys, lambda key: executor.submit(self.run, key), keep, executor)
            return
        for key in keys:
            keep(key, self.run(key))

    def _stored(self, path: Path, made: Mapping[str, str]) -> pd.DataFrame:
        """Read the rows that there are; a file of other settings, or a damaged one, is set aside."""
        import pandas as pd

        none = pd.DataFrame(columns=list(self.key))
        if not path.exists():
            return none
        try:
            rows = read_sealed(path)
            changes = differences(rows.attrs.get(ATTRIBUTE, {}), made)
        except DamagedTable as error:
            changes = [str(error)]
        if not changes:
            return rows
        more = [f"and {len(changes) - MOST_DIFFERENCES} more"] if len(changes) > MOST_DIFFERENCES else []
        print(f"{self.title}: the table starts anew, the old one is {set_aside(path)}. What differs:")
        print("\n".join(f"  {line}" for line in changes[:MOST_DIFFERENCES] + more))
        return none

    def _make(self, missing: list[Key], path: Path, made: dict[str, str], executor: Executor | None) -> None:
        """Make runs, and add their rows to the file as they come: it has all rows of a run or none."""
        import pandas as pd

        if self.prepare is not None:
            self.prepare()
        pending: dict[tuple[Any, ...], list[Row]] = {}
        kinds: dict[str, str] = {}
        stored, took, last = 0, 0.0, time.monotonic()

        def store() -> None:
            nonlocal stored, took, last
            if not pending:
                return
            start = time.monotonic()
            new = (row for rows in pending.values() for row in rows)
            table = pd.DataFrame([*self._stored(path, made).to_dict("records"), *new])
            table = table.sort_values(list(self.key), kind="stable", ignore_index=True)
            table.attrs = {ATTRIBUTE: made}
            write(table, path)
            stored += len(pending)
            pending.clear()
            last = time.monotonic()
            took = last - start

        with progress(self.title, len(missing), self.unit) as show:

            def keep(key: Key, rows: list[Row]) -> None:
                self._check(key, rows, kinds)
                pending[self.name_of(key)] = rows
                if time.monotonic() - last >= WRITING * took:
                    store()
                show(stored + len(pending))

            show(0)
            try:
                self._run(missing, keep, executor)
            finally:
                store()

    def _check(self, key: Key, rows: list[Row], kinds: dict[str, str]) -> None:
        """Refuse rows of a run that carry another key, or values that a table does not hold; ``kinds``: so far."""
        name = self.name_of(key)
        for row in rows:
            if any(column not in row for column in self.key) or self.name_of(row) != name:
                mine = {column: row.get(column) for column in self.key}
                raise InvalidProblem(f"study {self.name}: run {dict(key)} returned a row of {mine}: must carry its key")
            for column, value in row.items():
                kind = kind_of(value)
                if kind != kinds.setdefault(column, kind) if kind else value is not None:
                    allowed = f"{kinds[column]}, as before" if kind else "a number, flag, text or None"
                    at = f"study {self.name}: run {dict(key)}: {column} = {describe(value)}"
                    raise InvalidProblem(f"{at}: must be {allowed}")

    def name_of(self, key: Key) -> tuple[Any, ...]:
        """Return the name of a run."""
        return tuple(rounded(key[column]) for column in self.key)


def _run_of(runs: Mapping[str, Callable[[Key], list[Row]]], column: str, key: Key) -> list[Row]:
    """Make a run of one of several studies, which a column of its key names."""
    name = key[column]
    return [{column: name} | dict(row) for row in runs[name](key)]


def joined(name: str, title: str, studies: Mapping[str, Study], column: str = "problem") -> Study:
    """Join studies with the same key into one, whose first column says which of them a row is of.

    Raises
    ------
    InvalidProblem
        If there are none, or they differ in ``key`` or ``by``, or have a column of that name in their key.
    """
    several = list(studies.values())
    if not several or len({(study.key, study.by) for study in several}) > 1 or column in several[0].key:
        keys = "; ".join(f"{label}: {study.key}" for label, study in studies.items()) or "none"
        raise InvalidProblem(f"studies {name}: {keys}: must be one or more, of the same key and by, without {column!r}")

    def prepare() -> None:
        for study in several:
            if study.prepare is not None:
                study.prepare()

    columns = {column: column.capitalize()}
    for study in several:
        columns |= study.columns
    return Study(
        name,
        title,
        (column, *several[0].key),
        tuple({column: label} | dict(key) for label, study in studies.items() for key in study.runs),
        partial(_run_of, {label: study.run for label, study in studies.items()}, column),
        {label: study.settings or bound_in(study.run) for label, study in studies.items()},
        columns,
        several[0].by,
        prepare,
    )


def set_aside(path: Path) -> Path:
    """Move a table to the folder ``superseded``, beside those that are there; return where it went."""
    old = path.parent / "superseded"
    old.mkdir(exist_ok=True)
    names = (old / f"{path.stem}{f'_{k}' if k else ''}.parquet" for k in count())
    to = next(name for name in names if not name.exists() and not name.with_suffix(".csv").exists())
    for suffix in (".csv", ".parquet") if path.with_suffix(".csv").exists() else (".parquet",):
        os.replace(path.with_suffix(suffix), to.with_suffix(suffix))
    return to


def run_names(rows: pd.DataFrame, key: Sequence[str]) -> list[tuple[Any, ...]]:
    """Return for each row the name of its run: the values in the columns of a key."""
    found = rows[list(key)].itertuples(index=False, name=None)
    return [tuple(map(rounded, name)) for name in found]


def kind_of(value: Any) -> str:
    """Return what a value of a row is, as KINDS has it; "" for what a table does not hold."""
    import numpy as np

    if isinstance(value, str):
        return KINDS["U"] if value.isascii() or value.encode("utf-8", "replace").decode() == value else ""
    kind = np.asarray(value).dtype.kind if np.isscalar(value) else ""
    return KINDS.get(kind, "")


def rounded(value: Any) -> Any:
    """Round a number that names a run to DIGITS; return anything else as it is."""
    return float(f"{value:.{DIGITS}g}") if isinstance(value, float) else value


def write(table: pd.DataFrame, path: Path) -> None:
    """Write Parquet, which ``read_sealed`` reads, and a CSV beside it; each is put in place at once."""
    path.parent.mkdir(parents=True, exist_ok=True)
    write_sealed(table, path.with_suffix(".parquet"))
    write_csv(table, path)


def write_csv(table: pd.DataFrame, path: Path) -> None:
    """Write the CSV beside a Parquet file, with their folder."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with replacing(path.with_suffix(".csv")) as partial:
        table.to_csv(partial, index=False)


def digest(value: object) -> str:
    """Return a short name for a value, from its representation as text."""
    return digest_of(repr(value).encode())
