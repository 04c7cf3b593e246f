"""Run a study: part by part, on this machine's cores or any executor, and go on where it was stopped."""

from __future__ import annotations

import os
from collections.abc import Callable
from concurrent.futures import BrokenExecutor, CancelledError, Executor, Future, ThreadPoolExecutor
from contextlib import nullcontext
from typing import TYPE_CHECKING, Any

from dincl.checks import function
from dincl.checks import path as checked_path
from dincl.study import StudyStopped, execute
from dincl.study.table import write_csv
from tissue.runs.columns import dictionary, labelled
from tissue.study.parts import Part, Parts, missing
from tissue.study.plan import TissueStudy, load_study, part_size
from tissue.study.read import Results
from tissue.study.store import code, opened

if TYPE_CHECKING:
    from tissue.study.outcomes import Outcomes

Watch = Callable[[int], None]


def run_study(
    study: TissueStudy | str | os.PathLike[str],
    out: str | os.PathLike[str],
    executor: Executor | None = None,
    watch: Watch | None = None,
) -> Results:
    """Make all runs of a study that are not in its folder yet.

    The same call goes on after any interruption. The rows are the same, on one kind of processor, for any executor, any
    order in which it finishes and any number of interruptions: a run is a function of (parameters, seed).

    Parameters
    ----------
    study
        Its file, the name of one that comes with this package, or what ``load_study`` made of either.
    out
        The folder of the results: new, empty or of this study.
    executor
        Computes the parts, such as ``client.get_executor()`` of Dask; None: threads on the cores of this machine.
    watch
        Called with the number of runs that are stored, first with those that were there before.

    Returns
    -------
    Results
        The stored tables.

    Raises
    ------
    InvalidProblem
        If the study is not in order, or ``out`` is in use, cannot be written to or holds something else: results of
        other parameters or of another version, too.
    StudyStopped
        If it cannot go on, because the disk is full or the workers are lost. What was computed is kept. Any other error
        and Ctrl-C leave with what is under way stored, too.
    """
    folder = checked_path("out", out)
    if executor is not None:
        function("executor.submit", getattr(executor, "submit", None), "a method of the executor")
    if watch is not None:
        function("watch", watch, "a function of the number of runs")
    plan = study if isinstance(study, TissueStudy) else load_study(study)
    threads = ThreadPoolExecutor(len(os.sched_getaffinity(0))) if executor is None else nullcontext(executor)
    with opened(plan, folder) as parts, threads as workers:
        _compute(plan, parts, workers, watch)
        write_csv(dictionary(parts.columns(plan.scenarios)), folder / "columns.csv")
    return Results(folder)


def _compute(study: TissueStudy, parts: Parts, executor: Executor, watch: Watch | None) -> None:
    """Compute and store what is missing."""
    todo = [
        part
        for name, parameters in study.scenarios.items()
        for part in missing(parts.stored(name), name, study.replicates, part_size(parameters))
    ]
    done, here = study.runs - sum(part.runs for part in todo), code()

    def submit(part: Part) -> Future[Outcomes]:
        return executor.submit(_outcomes, here, study.scenarios[part.scenario], part.replicates, study.seeds(part))

    def keep(part: Part, made: Outcomes) -> None:
        nonlocal done
        try:
            about = {"seed": study.seed, "scenario": part.scenario}
            parts.write(part, {kind: labelled(table, kind, about) for kind, table in made._asdict().items()})
        except OSError as error:
            raise StudyStopped(f"{parts.folder} cannot be written to: {error}") from error
        done += part.runs
        if watch is not None:
            watch(done)

    if watch is not None:
        watch(done)
    try:
        execute.carry_out(todo, submit, keep, executor)
    except (BrokenExecutor, CancelledError) as error:
        raise StudyStopped(f"the workers are lost: {error}") from error


def _outcomes(wanted: dict[str, str], *of_part: Any) -> Outcomes:
    """Compute the outcomes of a part on a worker, which must have the same code."""
    from tissue.study.outcomes import outcomes

    if code() != wanted:
        raise StudyStopped(f"a worker has other code, {code()}: must be {wanted}, as here")
    return outcomes(*of_part)
