"""The commands: ``verification report``, ``claims``, ``check``, ``compare``, ``stability``, ``engines``."""

from __future__ import annotations

import math
import sys
import time
from pathlib import Path
from typing import Annotated

import pandas as pd
import typer
from rich.console import Console
from rich.table import Table
from rich.text import Text

from dincl.extras import need_thesis, needs
from verification.claims import Verdict

app = typer.Typer(
    help="Measure the methods, check the claims of the thesis, write the report.",
    no_args_is_help=True,
    context_settings={"help_option_names": ["-h", "--help"]},
)
Full = Annotated[
    bool, typer.Option("--full", help="Rerun the complete studies and report differences from the ones that ship.")
]
Out = Annotated[Path, typer.Option(help="Folder of the report, its tables and figures.")]
COLOURS = dict.fromkeys((Verdict.PROVED, Verdict.PROVED_INSTANCE, Verdict.HOLDS, Verdict.NOT_REFUTED), "green")
COLOURS |= {Verdict.CORRECTED: "yellow", Verdict.REFUTED: "red", Verdict.OPEN: "dim"}


@app.command()
def report(
    full: Full = False,
    out: Out = Path("report"),
    strict: Annotated[bool, typer.Option("--strict", help="Fail if a page has a fault.")] = False,
) -> None:
    """Write the site, <out>/index.html, from the complete studies that ship, and rerun parts of them to compare.

    An interrupted call resumes where it stopped.
    """
    need_thesis("verification report")
    from dincl.study import workers
    from verification.audit import PAGES, STUDIES
    from verification.site.context import Context
    from verification.site.report import write_report
    from verification.site.store import DATA

    start = time.monotonic()
    with workers() as executor:
        path = write_report(PAGES, Context(out, full, executor, STUDIES, complete=DATA), strict)
    print(f"{path}, {time.monotonic() - start:.0f} s")


@app.command()
def claims(
    name: Annotated[
        list[str] | None,
        typer.Option("--id", help="Only these claims, such as c3.update or c3.*; the page of claims has all ids."),
    ] = None,
    chapter: Annotated[list[int] | None, typer.Option(help="Only claims of this chapter of the thesis.")] = None,
    full: Full = False,
    out: Out = Path("report"),
) -> None:
    """Decide the claims of the thesis; the exit code is 1 if a verdict differs from the recorded one.

    Studies that are in <out>/tables are not recomputed: an interrupted call can be repeated.
    """
    need_thesis("verification claims")
    from dincl.study import workers
    from verification.audit import STUDIES
    from verification.claims.decide import decide_all, differing
    from verification.site.context import Context
    from verification.site.store import DATA
    from verification.thesis.register import FILE, errata, register, select_claims, tables_for

    try:
        chosen = select_claims(register(), chapter or (), name or ())
    except ValueError as error:
        raise typer.BadParameter(str(error)) from None
    with workers() as executor:
        context = Context(out, full, executor, STUDIES, complete=DATA)
        tables = tables_for(chosen, context)
        table = decide_all(chosen, tables, executor)
    _list_claims(table)
    print(f"{len(errata())} errata, each with the reason that settles it, are in {FILE}")
    raise typer.Exit(0 if differing(table).empty else 1)


def _list_claims(table: pd.DataFrame) -> None:
    """Print each claim with place, quotation, choices, verdict and measured numbers, then the verdicts not recorded."""
    from verification.claims.decide import differing

    listed = Table(show_lines=True)
    listed.add_column("claim and verdict", min_width=20, max_width=28)
    listed.add_column("printed and measured", ratio=1)
    for row in table.itertuples():
        verdict = Text.assemble(f"{row.id}\n{row.source}\n", (row.verdict, COLOURS[Verdict(row.verdict)]))
        corrected = f"\nCorrected: {row.correction}" if row.correction else ""
        chosen = f"\nChosen here: {row.chosen}" if row.chosen else ""
        listed.add_row(verdict, Text(f"“{row.quote}”{corrected}{chosen}\n{row.measured}"))
    console = Console(highlight=False)
    console.print(listed)
    other = differing(table)
    console.print(f"{len(table)} decided, {len(other)} with another verdict than the recorded one")
    for row in other.itertuples():
        console.print(f"{row.id}: {row.verdict}, recorded is {row.recorded}")


@app.command()
def check(
    file: Annotated[Path, typer.Argument(help="A certificate written by Proof.save.")],
    trust: Annotated[
        list[str] | None, typer.Option(help="A module whose functions the file may name and this command may run.")
    ] = None,
) -> None:
    """Recompute every inequality of a certificate in interval arithmetic, and print what it proves.

    The file is data: nothing that it names is imported, unless --trust MODULE allows it. The exit code is 1 if the
    certificate does not prove its bound.
    """
    with needs("verification check", "proofs"):
        from verification.proofs.certificate import BadCertificate, read
        from verification.proofs.checker import check as checked
        from verification.proofs.words import theorem

    if trust:  # a module of the current folder is found, too, but never in place of an installed one
        sys.path.append(str(Path.cwd()))
    try:
        certificate = read(file)
        print(theorem(certificate, checked(certificate, trust or ())))
    except BadCertificate as wrong:
        print(f"Not proved: {wrong}")
        raise typer.Exit(1) from None


@app.command()
def make(
    names: Annotated[list[str] | None, typer.Argument(help="Names of studies; without any, they are listed.")] = None,
    smallest: Annotated[bool, typer.Option("--smallest", help="Make the shortened forms, in seconds.")] = False,
    out: Out = Path("report"),
) -> None:
    """Make studies anew, and write <out>/made/NAME.parquet and CSV; an interrupted call goes on where it stopped."""
    need_thesis("verification make")
    from dincl.study import workers
    from verification.audit import STUDIES

    if unknown := [name for name in names or () if name not in STUDIES]:
        raise typer.BadParameter(f"{', '.join(unknown)}: must be among {', '.join(STUDIES)}")
    if not names:
        for name, study in STUDIES.items():
            print(f"{name}: {study().title}, {len(study().runs)} runs")
        return
    with workers() as executor:
        for name in names:
            rows = STUDIES[name](smallest=smallest).complete(out / "made", executor)
            print(f"{out / 'made' / name}.parquet: {len(rows)} rows")


@app.command()
def stability(full: Full = False, out: Out = Path("report")) -> None:
    """Map where each method fails, print the predicted failures, write tables and figures to <out>."""
    need_thesis("verification stability")
    from dincl.study import workers
    from verification.audit import STUDIES
    from verification.methods.stability import page
    from verification.site.context import Context
    from verification.site.store import DATA

    with workers() as executor:
        context = Context(out, full, executor, STUDIES, complete=DATA)
        page.run(context)
        page.show(context)
        context.finish_drawings()
    shown = Table(show_lines=True)
    for name in ("case", "to be expected", "predicted", "found", "agrees"):
        shown.add_column(name)
    for row in context.tables["stability_verdicts"].itertuples():
        agrees = "[green]yes[/]" if row.agrees else "[red]no[/]"
        numbers = [f"{value:.5g}" if math.isfinite(value) else "" for value in (row.expected, row.found)]
        shown.add_row(row.title, row.theory, *numbers, agrees)
    Console().print(shown)
    print(f"tables in {context.folder}, figures in {out / 'figures'}")


@app.command()
def compare(
    file: Annotated[Path, typer.Argument(help="A Python file that names problem, methods, settings and t.")],
    out: Out = Path("comparison"),
) -> None:
    """Compare methods on a problem of your own: orders, speed against accuracy, and a page in <out>.

    FILE names problem, methods, settings and t, as verification.work_precision takes them. It may also name reference
    (default: verification.reference(problem, tol=1e-11)) and budget of one run (default: verification.CpuSeconds(2.0)).
    """
    from dincl import InvalidProblem
    from verification.instruments.compare import compare as compared

    try:
        page, results = compared(file, out)
    except InvalidProblem as wrong:
        raise typer.BadParameter(str(wrong)) from None
    print(*map(repr, results), page, sep="\n")


@app.command()
def engines(
    out: Out = Path("engines"),
    rows: Annotated[int, typer.Option(min=1, help="Only quadratic programs of about so many rows.")] = 10_000,
) -> None:
    """Write what authors of engines can test with: proved answers and their checker, and quadratic programs of contact.

    docs/howto/engines.md says what is in them.
    """
    from shutil import copyfile

    from verification.engines import check_answers, qp_set

    files = qp_set.make(out / "data", rows)
    checker = Path(check_answers.__file__)
    for file in (checker, checker.with_name("key.json")):
        copyfile(file, out / file.name)
    print(f"{out}: key.json, {checker.name}, {len(files)} quadratic programs in data")
