"""The commands ``tissue study``, ``tissue summary``, ``tissue page`` and ``tissue figures``."""

from __future__ import annotations

import time
from contextlib import nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from dincl.errors import InvalidProblem
from dincl.study import progress
from tissue.cli.forecast import forecast_text
from tissue.cli.messages import GOES_ON, INTERRUPTED, messages, table

if TYPE_CHECKING:
    from collections.abc import Iterator

    import pandas as pd

    from tissue.files.parameters import Parameters
    from tissue.study.read import Results

MAKES_NO_NUMBERS = True

SHIPPED = ", ".join(sorted(file.stem for file in (Path(__file__).parents[1] / "studies").glob("*.toml")))
File = Annotated[
    str, typer.Argument(metavar="FILE", help=f"A study file, or one that comes with the program: {SHIPPED}.")
]
Out = Annotated[Path | None, typer.Option(help="Folder of the results: new, empty, or of this study to go on with it.")]
Forecast = Annotated[bool, typer.Option("--plan", help="Make no runs; say what the study can decide and its time.")]
Scheduler = Annotated[str | None, typer.Option(metavar="ADDRESS", help="Of a Dask cluster, such as tcp://host:8786.")]


def study(file: File, out: Out = None, scheduler: Scheduler = None, forecast: Forecast = False) -> None:
    """Make all runs of a study that are not in its folder yet, on this machine's cores or a Dask cluster.

    A study file has title, base, replicates and seed, then scenarios or factors, and on request overrides,
    trajectories, compare and simplify; the tutorial "An EMT study" shows each. The keys of overrides and scenarios are
    those that "tissue parameters" lists. After any interruption the same command goes on.

    Exit codes: 0 all runs are stored, failed ones with their status; 2 bad input; 3 the study could not go on, as on a
    full disk; 130 Ctrl-C.
    """
    from tissue.study.plan import in_scenarios, load_study
    from tissue.study.run import carry_out, cluster

    with messages():
        plan = load_study(file)
        idle = in_scenarios({name: idle_events(one) for name, one in plan.scenarios.items()})
        for remark in [*plan.remarks, *idle]:
            print(remark)
        if forecast:
            print(forecast_text(plan))
            return
        if out is None:
            raise InvalidProblem("--out is missing: must be the folder of the results, or --plan")
        start = time.monotonic()
        stored: list[int] = []
        try:
            with (
                cluster(scheduler) if scheduler is not None else nullcontext() as executor,
                progress(plan.title, plan.runs, "runs") as watch,
            ):

                def told(runs: int) -> None:
                    stored.append(runs)
                    watch(runs)

                results = carry_out(plan, out, executor, told)
        except KeyboardInterrupt:
            typer.echo(f"Interrupted: {GOES_ON}", err=True)
            raise typer.Exit(INTERRUPTED) from None
    print(_summary(results, stored[-1] - stored[0], time.monotonic() - start))


def idle_events(parameters: Parameters) -> list[str]:
    """Return a sentence for each event of a group without cells: a file that sets emt.a alone has no EMT cell."""
    from tissue.events.known import events

    empty = {one.section: one.scenario.times for one in parameters.groups() if not one.scenario.cells}
    return [
        f"[{event.mark}] has no cells: {section}.cells = 0"
        for section, times in empty.items()
        for event in events()
        if event.name in times and times[event.name].ever
    ]


def _summary(results: Results, runs: int, seconds: float) -> str:
    """Return one line: what was done, how fast, how many runs failed, and where the results are."""
    stored = results.summary()
    now = f"{runs} of them now in {seconds:.1f} s, {runs / seconds:.3g} runs/s"
    return f"{stored['runs'].sum()} runs, {now}; {stored['failed'].sum()} failed; {results.folder}"


Folder = Annotated[Path, typer.Argument(metavar="DIR", help="Results of a study, or a folder with such folders in it.")]
Trust = Annotated[
    bool, typer.Option("--trust", help="Run the files of Python that the study names: they may do all that you may.")
]


def summarise(
    folder: Folder,
    csv: Annotated[bool, typer.Option("--csv", help="Also write the tables into the folder csv of each.")] = False,
    trust: Trust = False,
) -> None:
    """Say what studies found: answers to their comparisons, ratios of EMT cells with 95 % intervals, control cells."""
    from tissue.study.export import write_csv
    from tissue.study.figures.catalogue import found

    with messages():
        studies = found(folder, trust=trust)
        texts = [_said(results) for results in studies.values()]
        files = [str(file) for results in studies.values() for file in write_csv(results)] if csv else []
    print("\n".join([*texts, *files]))


def page(folder: Folder, trust: Trust = False) -> None:
    """Write one HTML page of each study, page.html in its folder, that opens offline and can be sent to others.

    Answers come first, each with a picture and a small movie of a run of each group; then tables, parameters, origin.
    """
    from tissue.study.figures.catalogue import found
    from tissue.study.figures.page import write_page

    with messages():
        for results in found(folder, trust=trust).values():
            path = write_page(results)
            print(f"{path}: {path.stat().st_size / 1e6:.1f} MB", flush=True)


def _said(results: Results) -> str:
    """Return all of one study."""
    from tissue.study import answers, comparing
    from tissue.study.figures.page import NOT_SET

    study, stored = results.study, results.summary()
    plan = f"{study.replicates} runs of each of {len(study.scenarios)} scenarios, seed {study.seed}"
    there = "" if results.complete else f", {stored['runs'].sum()} of them are stored"
    said = [f"{study.title} ({results.folder})\n{plan}{there}; {stored['failed'].sum()} failed\n"]
    changes, ratios = answers.scenario_changes(results), answers.scenario_ratios(results)
    shown = changes.replace("nan", NOT_SET)
    said.append(table("Scenarios", shown.columns, shown.itertuples(index=False)))
    said.append(table("Failed runs", ("scenario", "status", "runs"), failures(results, stored)))
    if ratios.empty:
        none = "No run that did not fail." if 0 < stored["runs"].sum() == stored["failed"].sum() else "No EMT cells."
        return "\n".join([*filter(None, said), f"{none}\n"])
    if (compare := comparing.plan_of(results)) is not None:
        found, reason = comparing.answers_or_reason(results)
        rows = (_answered(row) for row in found.to_dict("records"))
        heads = ("question", "outcome", "effect [95 %]", "p", "answer", "runs needed")
        title = f"Answers: {comparing.correction_text(results, compare)}"
        said.append(f"{reason}\n" if reason else table(title, heads, rows))
    else:
        against = (_compared(row) for row in answers.scenario_differences(ratios, study.replicates).to_dict("records"))
        heads = ("outcome", "first - second", "points [95 %]", "p", "differ", "runs needed")
        said.append(table("Scenarios against each other; p of all these comparisons together (Holm)", heads, against))
    sound = {
        row.scenario: f"; of the runs that did not fail: {row.runs - row.failed} of {row.runs}"
        for row in stored[stored["failed"] > 0].itertuples()
    }
    ends = (_found(row, sound.get(row["scenario"], "")) for row in ratios.to_dict("records"))
    said.append(table(f"{_emt_cells(results)} at the end", ("scenario", "outcome", "ratio [95 %]", "cells"), ends))
    shares = (_share(row) for row in answers.control_shares(results).to_dict("records"))
    sides = ("scenario", "side", "part [95 %]", "runs")
    said.append(table("Control cells outside of the tissue at the end", sides, shares))
    if any(results.parameters(name).layer.shape != "line" for name in study.scenarios):
        said.append(STEEP)
    return "\n".join(filter(None, said))


def failures(results: Results, stored: pd.DataFrame) -> Iterator[tuple[str, str, str]]:
    """Give for each scenario how many runs ended with which status, but those that did not fail."""
    for scenario in stored.loc[stored["failed"] > 0, "scenario"]:
        counts = results.runs(scenario, ["status"])["status"].value_counts()
        yield from ((scenario, status, str(runs)) for status, runs in counts.items() if runs and status != "SUCCESS")


# Of layers that bend.
STEEP = """Inside an arc the apical layer is steep near the ends, and y_AB = h(X) / h(A) takes the nearest point A:
cells that the layer covers count as apical there. docs/howto/explore.md has the numbers.
"""


def _answered(row: dict[str, Any]) -> tuple[str, ...]:
    import pandas as pd

    from tissue.study.comparing import effect_text

    p = "" if pd.isna(row["p"]) else f"{row['p']:.2g}"
    needed = "" if pd.isna(row["needed"]) else str(row["needed"])
    return row["question"], row["outcome"], effect_text(row), p, row["answer"], needed


def _emt_cells(results: Results) -> str:
    """Name the EMT cells, with the types that are pooled."""
    groups = (one for name in results.study.scenarios for one in results.parameters(name).groups())
    names = dict.fromkeys(one.name for one in groups if one.may_leave and one.scenario.cells)
    return "EMT cells" if [*names] == ["emt"] else f"EMT cells ({', '.join(names)})"


def _found(row: dict[str, Any], sound: str) -> tuple[str, ...]:
    part = _part(row["value"], row["low"], row["high"])
    return row["scenario"], row["outcome"], part, f"{row['count']} of {row['of']}{sound}"


def _share(row: dict[str, Any]) -> tuple[str, ...]:
    return row["scenario"], row["side"], _part(row["mean"], row["low"], row["high"]), str(row["runs"])


def _compared(row: dict[str, Any]) -> tuple[str, ...]:
    import pandas as pd

    points = f"{100 * row['difference']:+.1f} [{100 * row['low']:+.1f}, {100 * row['high']:+.1f}]"
    needed = "" if pd.isna(row["needed"]) else str(row["needed"])
    names = f"{row['first']} - {row['second']}"
    return row["outcome"], names, points, f"{row['p']:.2g}", "yes" if row["differ"] else "not shown", needed


def _part(value: float, low: float, high: float) -> str:
    return f"{100 * value:.1f} % [{100 * low:.1f}, {100 * high:.1f}]"


def figures(folder: Folder, trust: Trust = False) -> None:
    """Draw studies, each into the folder figures in its own: answers, positions, ratios in time, at the end, examples.

    Of studies that come with the program also the counterparts of Figures 10 to 22 of chapter 4, into DIR/figures, both
    presets beside each other. A line for each file says what it shows, or why it cannot be drawn.
    """
    from tissue.study.figures.catalogue import draw_all

    with messages():
        for one in draw_all(folder, trust=trust):
            files = f"{one.files[0]} and {one.files[1].suffix}:" if one.files else one.name
            print(f"{files} {one.message}", flush=True)
