"""The complete studies that ship: ``python -m verification.thesis.studies FOLDER [CHAPTER ...]``.

It makes the runs that are missing in FOLDER/tables/made, 100 minutes of two cores for all chapters, can be stopped at
any time and called again, and writes ``verification/data/studies/*.parquet``. Chapters go by the names of their
pages.
"""

from __future__ import annotations

import sys
from collections.abc import Collection
from pathlib import Path

from dincl.checks import describe
from dincl.errors import InvalidProblem
from dincl.files import write_bytes
from dincl.study import workers
from verification.page.chapters import CHAPTERS
from verification.page.context import Context
from verification.page.kept import STUDIES

MAKES_NO_NUMBERS = True
# Those of EMT and of curved layers keep sums only, by commands of their own.
NAMES = ("experiments", "moving", "speed", "iterations", "failures", "geometry", "tissue", "space", "meanfield")


def main(folder: Path, names: Collection[str] = NAMES) -> None:
    """Complete the studies of some chapters, and keep their tables.

    Raises
    ------
    InvalidProblem
        For a name that no chapter has.
    """
    for name in names:
        if name not in NAMES:
            raise InvalidProblem(f"chapter {describe(name)}: must be one of {', '.join(NAMES)}")
    with workers() as executor:
        context = Context(folder, True, executor)
        for chapter in CHAPTERS:
            if chapter.name in names:
                chapter.run(context)
    STUDIES.mkdir(parents=True, exist_ok=True)
    for name in context.studies:
        write_bytes(STUDIES / f"{name}.parquet", (context.made / f"{name}.parquet").read_bytes())


if __name__ == "__main__":
    main(Path(sys.argv[1]), sys.argv[2:] or NAMES)
