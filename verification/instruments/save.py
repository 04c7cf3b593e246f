"""A page of results: the picture and the short tables of each, and the files beside it."""

from __future__ import annotations

import base64
from collections.abc import Sequence
from dataclasses import dataclass, replace
from datetime import datetime
from pathlib import Path
from typing import Any

from dincl import InvalidProblem
from dincl.checks import describe
from dincl.files import write_text
from verification.instruments.result import Result
from verification.site.cells import grid, machine, render


@dataclass(frozen=True)
class _Shown:
    """What the template reads of one result."""

    title: str
    file: str
    picture: str
    tables: dict[str, str]


def save(results: Sequence[Result] | Result, folder: str | Path) -> Path:
    """Write the tables and pictures of results, and a page ``index.html`` that shows them; return its path.

    Two results of one name get numbers. The page opens offline and links nothing outside of the folder.

    Raises
    ------
    InvalidProblem
        For an object that is no result.
    """
    given = [results] if isinstance(results, Result) else list(results)
    for result in given:
        if not isinstance(result, Result):
            raise InvalidProblem(f"results holds {describe(result)}: must be results of the instruments")
    out = Path(folder)
    shown = [_shown(result, result.save(out)) for result in _named(given)]
    out.mkdir(parents=True, exist_ok=True)
    made = datetime.now().astimezone().strftime("%Y-%m-%d %H:%M")
    write_text(out / "index.html", render("results.html", results=shown, facts=list(machine()), made=made))
    return out / "index.html"


def _named(results: Sequence[Any]) -> list[Any]:
    """Return the results with different names: the second one of a name gets the number 2."""
    seen: dict[str, int] = {}
    found = []
    for result in results:
        seen[result.name] = seen.get(result.name, 0) + 1
        count = seen[result.name]
        found.append(result if count == 1 else replace(result, name=f"{result.name}_{count}"))
    return found


def _shown(result: Result, folder: Path) -> _Shown:
    picture = base64.b64encode((folder / f"{result.name}.png").read_bytes()).decode("ascii")
    tables = {caption: grid(rows) for caption, rows in result.summaries().items()}
    return _Shown(result.title, result.name, f"data:image/png;base64,{picture}", tables)
