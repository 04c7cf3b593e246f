"""Tables with too many rows for one file: a folder of parts, which one process at a time adds to.

A part is consecutive replicates of a scenario. It has a Parquet file for each kind of table, such as runs and their
cells, and is there once all of its files are; each file is put in place as a whole.
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from itertools import groupby
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple
from urllib.parse import quote

from dincl.errors import InvalidProblem
from dincl.files import PARTIAL
from dincl.study.sealed import read_arrow, write_arrow

if TYPE_CHECKING:
    import pandas as pd
    import pyarrow as pa

# Tables of a part: of its runs, and of their EMT cells.
KINDS = ("runs", "cells")
NAME = re.compile(r"replicates-([0-9]{5,8})-([0-9]{5,8})\.parquet")


class Part(NamedTuple):
    """Consecutive replicates of one scenario, which are computed and stored together."""

    scenario: str
    first: int
    runs: int

    @property
    def replicates(self) -> range:
        """The numbers of its replicates."""
        return range(self.first, self.first + self.runs)


def missing(stored: Sequence[Part], scenario: str, replicates: int, size: int) -> list[Part]:
    """List the parts of a scenario that are to be computed beside those that are stored.

    They have all missing replicates, and end at multiples of ``size``, so that equal studies have equal files.
    """
    done = {number for part in stored for number in part.replicates}
    left = [number for number in range(replicates) if number not in done]
    blocks = groupby(enumerate(left), lambda pair: (pair[1] - pair[0], pair[1] // size))
    numbers = ([number for _, number in block] for _, block in blocks)
    return [Part(scenario, block[0], len(block)) for block in numbers]


@dataclass(frozen=True)
class Parts:
    """Stored parts: ``folder/KIND/scenario=SCENARIO/replicates-FIRST-LAST.parquet``, which other programs read, too.

    Attributes
    ----------
    folder
        Folder of all kinds.
    """

    folder: Path

    def file(self, kind: str, part: Part) -> Path:
        """Return the file of a table of a part."""
        name = f"replicates-{part.first:05d}-{part.replicates[-1]:05d}.parquet"
        return self._folder(kind, part.scenario) / name

    def stored(self, scenario: str) -> list[Part]:
        """List the parts of a scenario that are there, in the order of their replicates."""
        files = self._folder(KINDS[0], scenario).glob("replicates-*.parquet")
        ends = sorted((int(name[1]), int(name[2])) for name in (NAME.fullmatch(file.name) for file in files) if name)
        found: list[Part] = []
        begin = 0
        for first, last in ends:
            part = Part(scenario, first, last - first + 1)
            # The first one counts of parts that overlap, which somebody put there by hand.
            if begin <= first <= last and all(self.file(kind, part).exists() for kind in KINDS):
                found.append(part)
                begin = last + 1
        return found

    def write(self, part: Part, tables: Mapping[str, pa.Table]) -> None:
        """Write the tables of a part, by their kinds."""
        for kind in KINDS:
            write_arrow(tables[kind], self.file(kind, part))

    def read(self, kind: str, parts: Sequence[Part], columns: Sequence[str] | None = None) -> pd.DataFrame:
        """Read the tables of one kind of some parts, in this order; ``columns``: those to read, all if None.

        Raises
        ------
        InvalidProblem
            If there is no such column; DamagedTable if a file is not as it was written.
        """
        import pyarrow as pa

        with ThreadPoolExecutor(len(os.sched_getaffinity(0))) as threads:
            tables = list(threads.map(lambda part: read_arrow(self.file(kind, part), columns), parts))
        try:
            found: pd.DataFrame = pa.concat_tables(tables).unify_dictionaries().to_pandas()
        except pa.ArrowException as error:
            raise InvalidProblem(f"{self.folder / kind}: files must have the same columns: {error}") from error
        return found

    def columns(self, scenarios: Iterable[str]) -> dict[str, list[str]]:
        """Return the columns of each kind of table in the files of these scenarios, in their order."""
        import pyarrow.parquet as pq

        first = [part for name in scenarios for part in self.stored(name)[:1]]
        found: dict[str, dict[str, None]] = {kind: {} for kind in KINDS}
        for kind, names in found.items():
            for file in (self.file(kind, part) for part in first):
                names.update(dict.fromkeys(pq.read_schema(file).names))
        return {kind: [*names] for kind, names in found.items()}

    def remove_partial(self) -> None:
        """Remove what killed processes left half written, in a folder that this process holds."""
        for partial in self.folder.rglob(f"{PARTIAL}*"):
            partial.unlink()

    def _folder(self, kind: str, scenario: str) -> Path:
        return self.folder / kind / f"scenario={quote(scenario, safe='')}"
