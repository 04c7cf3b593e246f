"""Run a study: piece by piece, on this machine's cores or any executor, and go on where it was stopped."""

from __future__ import annotations

import os
from collections.abc import Callable
from concurrent.futures import BrokenExecutor, Executor, Future, ThreadPoolExecutor
from typing import TYPE_CHECKING, Any

from dincl.checks import function
from dincl.checks import path as checked_path
from dincl.study import StudyStopped, execute
from tissue.study.cluster import watched
from tissue.study.identity import code, code_differences
from tissue.study.plan import Piece, TissueStudy, load_study, run_seeds
from tissue.study.read import Results
from tissue.study.store import StudyStore, opened

if TYPE_CHECKING:
    from tissue.study.outcomes import Outcomes

Watch = Callable[[int], None]


def run_study(
    study: str | os.PathLike[str],
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
        Its file, see ``load_study``, or the name of one that comes with this package.
    out
        The folder of the results: new, empty or of this study.
    executor
        Computes the pieces; None: threads on the cores of this machine. For Dask see ``tissue.study.cluster``.
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
        other parameters or of other code, too.
    StudyStopped
        If it cannot go on, because the disk is full or the workers are lost. What was computed is kept. Any other error
        and Ctrl-C leave with what is under way stored, too.
    """
    folder = checked_path("out", out)
    if executor is not None:
        function("executor.submit", getattr(executor, "submit", None), "a method of the executor")
    if watch is not None:
        function("watch", watch, "a function of the number of runs")
    return carry_out(load_study(study), folder, executor, watch)


def carry_out(
    study: TissueStudy, out: str | os.PathLike[str], executor: Executor | None = None, watch: Watch | None = None
) -> Results:
    """Make the runs of a study that is loaded; see ``run_study``."""
    with opened(study, out) as store:
        if executor is not None:
            with watched(executor):
                _compute(store, executor, watch or _nobody)
        else:
            with ThreadPoolExecutor(len(os.sched_getaffinity(0))) as threads:
                _compute(store, threads, watch or _nobody)
    return Results(out)


def _compute(store: StudyStore, executor: Executor, watch: Watch) -> None:
    """Compute and store what is missing."""
    todo = store.missing()
    done = store.study.runs - sum(piece.runs for piece in todo)
    watch(done)

    def keep(piece: Piece, outcomes: Outcomes) -> None:
        nonlocal done
        store.write(piece, outcomes)
        done += piece.runs
        watch(done)

    try:
        execute.carry_out(todo, lambda piece: _submitted(executor, store.study, piece), keep, executor)
    except BrokenExecutor as error:
        raise StudyStopped(f"the workers are lost: {error}") from error


def _submitted(executor: Executor, study: TissueStudy, piece: Piece) -> Future[Outcomes]:
    """The outcomes to come of a piece."""
    seeds = run_seeds(study.seed, piece.scenario, piece.replicates)
    whole = [number for number in study.trajectories if number in piece.replicates]
    return executor.submit(_outcomes, code(), study.scenarios[piece.scenario], list(piece.replicates), seeds, whole)


def _outcomes(wanted: dict[str, str], *piece: Any) -> Outcomes:
    """The outcomes of a piece on a worker, which must have the code that is wanted."""
    from tissue.study.outcomes import outcomes

    if code() != wanted:
        raise StudyStopped(f"a worker has other code: {'; '.join(code_differences(wanted, code()))}")
    return outcomes(*piece)


def _nobody(_: int) -> None:
    """Watch nothing."""
