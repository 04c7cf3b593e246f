"""The command ``tissue study``."""

from __future__ import annotations

import time
from contextlib import nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from dincl.study import progress
from tissue.cli.messages import GOES_ON, INTERRUPTED, messages

if TYPE_CHECKING:
    from tissue.study.read import Results

MAKES_NO_NUMBERS = True

File = Annotated[str, typer.Argument(metavar="FILE", help="A study file, or a study that comes with the program.")]
Out = Annotated[Path, typer.Option(help="Folder of the results: new, empty, or of this study to go on with it.")]
Scheduler = Annotated[str | None, typer.Option(metavar="ADDRESS", help="Of a Dask cluster, such as tcp://host:8786.")]


def study(file: File, out: Out, scheduler: Scheduler = None) -> None:
    """Make all runs of a study that are not in its folder yet, on this machine's cores or a Dask cluster.

    After any interruption the same command goes on. Exit codes: 0 all runs are stored, failed ones with their status; 2
    bad input; 3 the study could not go on, as on a full disk; 130 Ctrl-C.
    """
    from tissue.study.cluster import cluster
    from tissue.study.plan import load_study
    from tissue.study.run import carry_out

    with messages():
        plan = load_study(file)
        for remark in plan.remarks:
            print(remark)
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


def _summary(results: Results, runs: int, seconds: float) -> str:
    """One line: what was done, how fast, how many runs failed, and where the results are."""
    stored = results.summary()
    now = f"{runs} of them now in {seconds:.1f} s, {runs / seconds:.3g} runs/s"
    return f"{stored['runs'].sum()} runs, {now}; {stored['failed'].sum()} failed; {results.folder}"
