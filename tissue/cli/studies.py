"""The commands ``tissue study``, ``tissue summary``, ``tissue page`` and ``tissue simplify``."""

from __future__ import annotations

import time
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from dincl.errors import InvalidProblem
from dincl.study import progress
from tissue.cli.messages import messages, table

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    import pandas as pd

    from tissue.study.read import Results


SHIPPED = ", ".join(sorted(file.stem for file in (Path(__file__).parents[1] / "studies").glob("*.toml")))
# Of layers that bend.
STEEP = """Inside an arc the apical layer is steep near the ends, and y_AB = h(X) / h(A) takes the nearest point A:
cells that the layer covers count as apical there. docs/howto/explore.md has the numbers.
"""
File = Annotated[
    str, typer.Argument(metavar="FILE", help=f"A study file, or one that comes with the program: {SHIPPED}.")
]
Out = Annotated[Path, typer.Option(help="Folder of the results: new, empty, or of this study to go on with it.")]


def study(file: File, out: Out) -> None:
    """Make all runs of a study that are not in its folder yet, on this machine's cores.

    A study file has title, base, replicates and seed, then scenarios or factors, and on request overrides, paired and
    compare; the tutorial "An EMT study" shows each. The keys of overrides and scenarios are
    those that "tissue parameters" lists. After any interruption the same command goes on.

    Exit codes: 0 all runs are stored, failed ones with their status; 2 bad input; 3 the study could not go on, as on a
    full disk; 130 Ctrl-C.
    """
    from tissue.study.answers import folded_remarks
    from tissue.study.plan import load_study
    from tissue.study.run import run_study

    with messages(resumes=True):
        plan = load_study(file)
        for remark in plan.remarks:
            print(remark)
        start = time.monotonic()
        stored: list[int] = []
        with progress(plan.title, plan.runs, "runs") as watch:

            def told(runs: int) -> None:
                stored.append(runs)
                watch(runs)

            results = run_study(plan, out, watch=told)
        for remark in folded_remarks(results):
            print(f"Folded: {remark}.")
        print(_summary(results, stored[-1] - stored[0], time.monotonic() - start))


def _summary(results: Results, runs: int, seconds: float) -> str:
    """Return one line: what was done, how fast, how many runs failed, and where the results are."""
    stored = results.summary()
    now = f"{runs} of them now in {seconds:.1f} s, {runs / seconds:.3g} runs/s"
    return f"{stored['runs'].sum()} runs, {now}; {stored['failed'].sum()} failed; {results.folder}"


OUTCOMES = (
    "A share: basal, apical, below, controls_apical, controls_basal; or a number of a run: height_um, "
    "nucleus_height_um, apical_width_um, basal_width_um, nuclei_width_um, or an observable of your own."
)
Folder = Annotated[Path, typer.Argument(metavar="DIR", help="Results of a study, or a folder with such folders in it.")]
Trust = Annotated[
    bool, typer.Option("--trust", help="Run the files of Python that the study names: they may do all that you may.")
]
Figures = Annotated[
    Literal["png", "svg", "pdf"] | None,
    typer.Option(help="Also write each figure as a file of this kind into the folder figures of each."),
]


def summarise(
    folder: Folder,
    csv: Annotated[bool, typer.Option("--csv", help="Also write the tables into the folder csv of each.")] = False,
    trust: Trust = False,
) -> None:
    """Say what studies found: answers to their comparisons, shares of EMT cells and control cells with intervals."""
    with messages():
        studies = _found(folder, trust)
        texts = [_said(results) for results in studies]
        files = [str(file) for results in studies for file in _write_csv(results)] if csv else []
    print("\n".join([*texts, *files]))


def page(folder: Folder, figures: Figures = None, trust: Trust = False) -> None:
    """Write one HTML page of each study, page.html in its folder, that opens offline and can be sent to others.

    Answers come first, each with a picture and a small movie of a run of each group; then tables, figures, examples of
    stored runs, parameters, origin.
    """
    from tissue.report.page import write_figures, write_page

    with messages():
        for results in _found(folder, trust):
            path = write_page(results)
            print(f"{path}: {path.stat().st_size / 1e6:.1f} MB", flush=True)
            for file in write_figures(results, figures) if figures is not None else ():
                print(file, flush=True)


def _found(folder: Path, trust: bool) -> list[Results]:
    """Open the results in a folder, or in its folders."""
    from tissue.study.read import Results
    from tissue.study.store import about

    inside = sorted(path for path in folder.glob("*") if path.is_dir())
    folders = [path for path in ([folder] if about(folder) is not None else inside) if about(path) is not None]
    if not folders:
        raise InvalidProblem(f"{folder}: must be the results of a study, or a folder with such folders in it")
    return [Results(path, trust=trust) for path in folders]


def _said(results: Results) -> str:
    """Return all of one study."""
    from tissue.study import answers

    study, stored = results.study, results.summary()
    paired = ", paired: replicate k of each has the same random numbers" if study.paired else ""
    plan = f"{study.replicates} runs of each of {len(study.scenarios)} scenarios, seed {study.seed}{paired}"
    there = "" if results.complete else f", {stored['runs'].sum()} of them are stored"
    if without := ", ".join(stored.loc[stored["runs"] == 0, "scenario"]):
        there += f", none yet of {without}"
    remarks = "".join(f"Folded: {remark}.\n" for remark in answers.folded_remarks(results))
    said = [f"{study.title} ({results.folder})\n{remarks}{plan}{there}; {stored['failed'].sum()} failed\n"]
    shown = answers.scenario_changes(results).replace("nan", "not set")
    said.append(table("Scenarios", shown.columns, shown.itertuples(index=False)))
    said.append(table("Failed runs", ("scenario", "status", "runs"), failures(results, stored)))
    if (compare := answers.plan_of(results)) is not None:
        found = answers.answers_shown(results)
        said.append(table(f"Answers: {answers.how_text(results, compare)}", found.columns, found.to_numpy()))
    ends = answers.shares_shown(results)
    title = "EMT cells and control cells at the end, mean over runs of the share of a run"
    said.append(table(title, ends.columns, ends.to_numpy()))
    if ends.empty:
        said.append("No run that did not fail.\n" if stored["runs"].any() else "No run yet.\n")
    if any(results.parameters(name).layer.shape != "line" for name in study.scenarios):
        said.append(STEEP)
    return "\n".join(filter(None, said))


def failures(results: Results, stored: pd.DataFrame) -> Iterator[tuple[str, str, str]]:
    """Give for each scenario how many runs ended with which status, but those that did not fail."""
    for scenario in stored.loc[stored["failed"] > 0, "scenario"]:
        counts = results.runs(scenario, ["status"])["status"].value_counts()
        yield from ((scenario, status, str(runs)) for status, runs in counts.items() if runs and status != "SUCCESS")


def _write_csv(results: Results) -> Iterator[Path]:
    """Write answers, means of scenarios, parameters that differ, runs and EMT cells into the folder csv of a study.

    A missing value is empty, a time that is never reached is inf. Tables without rows are left out.
    """
    import pandas as pd

    from dincl.study.table import write_csv
    from tissue.study.answers import answer_table, scenario_changes, scenario_means

    stored = list(results.summary().query("runs > 0")["scenario"])

    def joined(read: Callable[[str], pd.DataFrame]) -> pd.DataFrame:
        parts = [read(name).assign(scenario=name) for name in stored]
        return pd.concat(parts, ignore_index=True) if parts else pd.DataFrame()

    tables = {
        "answers": answer_table(results),
        "means": scenario_means(results),
        "parameters": scenario_changes(results).replace("nan", ""),
        "runs": joined(results.runs),
        "cells": joined(results.cells),
        "series": joined(results.series),
    }
    for name, rows in tables.items():
        if len(rows):
            path = results.folder / "csv" / f"{name}.csv"
            write_csv(rows, path)
            yield path


def simplify(
    file: File,
    tolerance: Annotated[float, typer.Option(help="Difference that does not matter; 0.03: 3 points.")],
    outcome: Annotated[str, typer.Option(help=OUTCOMES)] = "basal",
    scenario: Annotated[list[str] | None, typer.Option(help="One of the study, or two: first minus second.")] = None,
    at: Annotated[str | None, typer.Option(metavar="TIME", help='When, such as "48 h"; else at the end.')] = None,
    runs: Annotated[int, typer.Option(help="Of each model.")] = 256,
    out: Annotated[Path | None, typer.Option(help="Folder to write to.", show_default="results/simplify_FILE")] = None,
) -> None:
    """Find the simplest model that answers a question of a study as the full one does, within a tolerance.

    Fewer substeps, no noise, fewer cells and others run beside the full model with the same seeds; equivalence tests
    decide. Writes answer.csv, and columns.csv, which says what columns mean. After any interruption the same command
    goes on.
    """
    from dincl.study.table import write_csv
    from tissue.runs.columns import TABLES, dictionary
    from tissue.study.simplify import simplify as find

    folder = out or Path("results") / f"simplify_{Path(file).stem}"
    with messages(resumes=True):
        found = find(file, tolerance, outcome=outcome, scenarios=scenario or (), at=at, runs=runs, out=folder)
        write_csv(found.table, folder / "answer.csv")
        write_csv(dictionary({"simplify": TABLES["simplify"], "answer": found.table}), folder / "columns.csv")
    heads = ("model", "verdict", "difference", "work", "runs")
    rows = (
        (
            row.model,
            row.verdict,
            row.reason or f"{row.difference:+.3g} [{row.low:+.3g}, {row.high:+.3g}]",
            f"{row.work:.2f}",
            row.runs,
        )
        for row in found.table.itertuples()
    )
    print(table(f"Simpler minus full model, within {tolerance:g}; work over that of the full model", heads, rows))
    print(table("Left out", ("model", "why"), found.left_out.items()))
    if found.answer:
        print(f"Enough: {', '.join(found.answer)}. A run takes {found.saving:.1f} times less work.")
    else:
        print("No simplification is shown to be enough: take the full model.")
    print(f"{folder}: answer.csv, columns.csv")
