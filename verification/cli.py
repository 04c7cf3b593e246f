"""The commands: ``verification report``, ``claims``, ``stability`` and ``bench``."""

from __future__ import annotations

import time
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.table import Table

from verification.claim import Kind

app = typer.Typer(
    help="Measure the methods, check the statements of the thesis, write the report.", no_args_is_help=True
)
Full = Annotated[bool, typer.Option("--full", help="The complete studies instead of the short ones.")]
Out = Annotated[Path, typer.Option(help="Folder of the page, its tables and figures.")]
COLOURS = {Kind.HOLDS: "green", Kind.CORRECTED: "yellow", Kind.FAILS: "red", Kind.OPEN: "dim"}


@app.command()
def report(full: Full = False, out: Out = Path("report")) -> None:
    """Run the studies that are missing and write <out>/index.html; an interrupted call is taken up again."""
    from verification.chapters import CHAPTERS
    from verification.report import Context, write_report
    from verification.study import workers

    start = time.monotonic()
    with workers() as executor:
        path = write_report(CHAPTERS, Context(out, full, executor))
    print(f"{path}, {time.monotonic() - start:.0f} s")


@app.command()
def claims(full: Full = False, out: Out = Path("report")) -> None:
    """Print every claim with its verdict; studies that are missing in <out>/tables are run first."""
    from verification.chapters import CHAPTERS
    from verification.report import Context
    from verification.study import workers

    with workers() as executor:
        context = Context(out, full, executor)
        for chapter in CHAPTERS:
            chapter.run(context)
    shown = Table(show_lines=True)
    for name in ("claim", "source", "verdict"):
        shown.add_column(name, no_wrap=name != "source")
    shown.add_column("measured", ratio=1)
    for row in context.tables["claims"].itertuples():
        colour = COLOURS[Kind(row.verdict)]
        shown.add_row(row.id, row.source, f"[{colour}]{row.verdict}[/]", row.measured)
    Console().print(shown)


@app.command()
def stability(full: Full = False, out: Out = Path("report")) -> None:
    """Map where each method fails, print the failures that theory predicts, write tables and figures to <out>."""
    from verification.chapters.stability import CHAPTER
    from verification.report import Context
    from verification.study import workers

    with workers() as executor:
        context = Context(out, full, executor)
        CHAPTER.run(context)
        CHAPTER.sections(context)
        context.finish_drawings()
    shown = Table(show_lines=True)
    for name in ("case", "to be expected", "predicted", "found", "agrees"):
        shown.add_column(name)
    for row in context.tables["stability_verdicts"].itertuples():
        agrees = "[green]yes[/]" if row.agrees else "[red]no[/]"
        shown.add_row(row.title, row.theory, f"{row.expected:.5g}", f"{row.found:.5g}", agrees)
    Console().print(shown)
    print(f"tables in {context.folder}, figures in {out / 'figures'}")


@app.command()
def bench(out: Out = Path("report")) -> None:
    """Measure the time of PBD per disc and step, and of each projection; the tables are kept in <out>."""
    from verification import timing

    timing.main(out)
