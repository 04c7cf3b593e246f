"""The report: one page that opens offline, its tables and figures beside it."""

from __future__ import annotations

import base64
import os
import platform
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Executor, Future
from dataclasses import dataclass, field
from datetime import datetime
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
import pandas as pd
from jinja2 import Environment, PackageLoader, StrictUndefined, select_autoescape
from markupsafe import Markup

from dincl.provenance import closure, libraries
from dincl.study import write
from verification.evidence import Kind

Form = TypeVar("Form")
# Numbers smaller than this are written with an exponent.
PLAIN = 1e-2
VERDICTS = {kind.value: kind.name.lower() for kind in Kind}


@dataclass(frozen=True)
class Text:
    """A paragraph; HTML."""

    html: str
    kind: str = field(default="text", init=False)


@dataclass(frozen=True)
class Picture:
    """A figure file with its caption; it is embedded into the page."""

    path: Path
    caption: str
    kind: str = field(default="picture", init=False)

    @property
    def data(self) -> str:
        """The file as a data URI."""
        return f"data:image/png;base64,{base64.b64encode(self.path.read_bytes()).decode('ascii')}"


@dataclass(frozen=True)
class Grid:
    """A table on the page; ``file`` is the table it was taken from; a ``folded`` one opens on a click."""

    rows: pd.DataFrame
    caption: str
    file: str
    folded: bool = False
    kind: str = field(default="grid", init=False)

    @property
    def cells(self) -> list[list[tuple[str, str]]]:
        """Text and CSS class of every cell."""
        return [[cell(value) for value in row] for row in self.rows.itertuples(index=False, name=None)]


@dataclass(frozen=True)
class SearchField:
    """A field that hides the statements below it that lack a word that is typed, or have another verdict."""

    kind: str = field(default="search", init=False)
    verdicts: tuple[str, ...] = tuple(VERDICTS)


@dataclass(frozen=True)
class Statements:
    """Claims, one below the other; the rows of ``verification.decide.decide_all``, with their chapter."""

    table: pd.DataFrame
    kind: str = field(default="statements", init=False)

    @property
    def rows(self) -> list[dict[str, Any]]:
        """One dictionary for each claim, with the CSS class of its verdict as ``look``."""
        return [row | {"look": VERDICTS[row["verdict"]]} for row in self.table.to_dict("records")]


@dataclass(frozen=True)
class Section:
    """A heading with its parts."""

    title: str
    parts: Sequence[Text | Picture | Grid | SearchField | Statements]


@dataclass
class Context:
    """What the chapters share: where to write, which form to run and on what, and the tables so far, by name.

    ``forms`` are run instead of the short or full ones of their classes.
    """

    out: Path
    full: bool
    executor: Executor
    forms: Sequence[object] = ()
    tables: dict[str, pd.DataFrame] = field(default_factory=dict)
    drawings: list[Future[Path]] = field(default_factory=list)

    def form(self, short: Form, full: Form | None = None) -> Form:
        """The form of a study: the one given for its class, or else the short or full one; some have one only."""
        given = [form for form in self.forms if type(form) is type(short)]
        if given:
            return given[0]
        return full if self.full and full is not None else short

    @property
    def folder(self) -> Path:
        """Where the tables are."""
        return self.out / "tables"

    def keep(self, name: str, table: pd.DataFrame) -> None:
        """Share a table that was derived from others, and write it beside them."""
        self.tables[name] = table
        write(table, self.folder / f"{name}.parquet")

    def draw(self, name: str, figure: Callable[..., Path], *arguments: Any) -> Path:
        """Let a worker draw ``figure(*arguments, path)``; the path, where it is once the drawings are done."""
        path = self.out / "figures" / f"{name}.png"
        self.drawings.append(self.executor.submit(figure, *arguments, path))
        return path

    def finish_drawings(self) -> None:
        """Wait until all figures are there; raises what went wrong with one."""
        for drawing in self.drawings:
            drawing.result()


@dataclass(frozen=True)
class Chapter:
    """``run`` completes the studies and fills ``context.tables``; ``sections`` writes about them, and only reads.

    The pages stand in the order of ``place``. ``tables`` says how the names of its tables begin, so that one can be had
    without the other chapters. ``prepare`` is done by one worker while the others begin with the chapters before: two
    that come to the same kernels at the same time would both compile them.
    """

    title: str
    run: Callable[[Context], None]
    sections: Callable[[Context], Sequence[Section]]
    place: int
    prepare: Callable[[], None] | None = None
    tables: tuple[str, ...] = ()


def write_report(chapters: Sequence[Chapter], context: Context) -> Path:
    """Run all chapters and write ``index.html``; return its path."""
    for chapter in chapters:
        if chapter.prepare is not None:
            context.executor.submit(chapter.prepare)
    written = []
    for chapter in chapters:
        chapter.run(context)
        # At once, so that the figures of a chapter are drawn while the next one runs.
        written.append((chapter.title, list(chapter.sections(context))))
    context.finish_drawings()
    facts = list(_facts(chapters, context))
    return render_page("report.html", context.out / "index.html", chapters=written, facts=facts, safe=Markup)


def render_page(template: str, path: Path, **values: Any) -> Path:
    """Fill a template of this folder and put the page in place at once; ``made`` is the time."""
    environment = Environment(
        loader=PackageLoader("verification.page"),
        autoescape=select_autoescape(),
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    made = datetime.now().astimezone().strftime("%Y-%m-%d %H:%M")
    new = path.with_name(f".{path.name}.new")
    new.write_text(environment.get_template(template).render(made=made, **values), "utf-8")
    os.replace(new, path)
    return path


def _facts(chapters: Sequence[Chapter], context: Context) -> Iterator[tuple[str, str]]:
    """What a number depends on besides the code."""
    yield (
        "Form",
        "complete" if context.full else "short: fewer and coarser steps (make report FULL=1 runs the complete one)",
    )
    yield from machine(*(chapter.run for chapter in chapters))
    yield "Times", "seconds of CPU time with two runs at once, after a warm-up; building of solvers included"


def machine(*makers: Callable[..., Any]) -> Iterator[tuple[str, str]]:
    """The machine, and the versions of the libraries that the makers of the numbers import."""
    yield "Processor", f"{_processor()}, {os.cpu_count()} cores"
    yield "System", f"{platform.system()} {platform.release()}, Python {platform.python_version()}"
    yield "Versions", ", ".join(map(" ".join, libraries(closure(*makers)).items()))


def _processor() -> str:
    """The model, from the system where it tells."""
    information = Path("/proc/cpuinfo")
    lines = information.read_text("utf-8").splitlines() if information.exists() else []
    models = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return models[0] if models else platform.processor() or platform.machine()


def cell(value: object) -> tuple[str, str]:
    """Text of a value in a table, and its CSS class."""
    if isinstance(value, bool | np.bool_):
        return ("yes" if value else "no"), ""
    if isinstance(value, float | np.floating):
        return number(float(value)), "number"
    if isinstance(value, int | np.integer):
        return str(value), "number"
    return str(value), VERDICTS.get(str(value), "")


def number(value: float) -> str:
    """Three digits, with an exponent where it is small or large."""
    if np.isnan(value):
        return "—"
    if value == 0:
        return "0"
    if PLAIN <= abs(value) < 1e4:
        return f"{value:.3g}" if abs(value) < 1e3 else f"{value:.0f}"
    mantissa, exponent = f"{value:.1e}".split("e")
    raised = str(int(exponent)).translate(str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"))
    return f"{mantissa}·10{raised}"
