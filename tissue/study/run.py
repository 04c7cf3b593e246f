"""Run a study: piece by piece, on this machine's cores or any executor, and go on where it was stopped."""

from __future__ import annotations

import logging
import math
import os
import time
from collections.abc import Callable, Iterator
from concurrent.futures import BrokenExecutor, CancelledError, Executor, Future, ThreadPoolExecutor
from contextlib import contextmanager
from threading import Event, Thread
from typing import TYPE_CHECKING, Any

from dincl.checks import function
from dincl.checks import path as checked_path
from dincl.errors import InvalidProblem
from dincl.extras import needs
from dincl.study import StudyStopped, execute
from tissue.study.identity import code, code_differences, house_code, processor
from tissue.study.plan import Piece, TissueStudy, load_study, run_seeds
from tissue.study.read import Results
from tissue.study.store import StudyStore, opened

if TYPE_CHECKING:
    from distributed import Client

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
        Computes the pieces; None: threads on the cores of this machine. For Dask see ``tissue.study.run``.
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
    """Submit a piece; return its future outcomes."""
    seeds = run_seeds(study.seed, piece.scenario, piece.replicates)
    whole = [number for number in study.trajectories if number in piece.replicates]
    return executor.submit(_outcomes, code(), study.scenarios[piece.scenario], list(piece.replicates), seeds, whole)


def _outcomes(wanted: dict[str, str], *piece: Any) -> Outcomes:
    """Compute the outcomes of a piece on a worker, which must have the code that is required."""
    from tissue.study.outcomes import outcomes

    if code() != wanted:
        raise StudyStopped(f"a worker has other code: {'; '.join(code_differences(wanted, code()))}")
    return outcomes(*piece)


def _nobody(_: int) -> None:
    """Watch nothing."""


log = logging.getLogger("tissue.study")
# Seconds within which a scheduler has to answer.
PATIENCE = 10
# Seconds without workers until it is said, until it is said again, and between two looks.
FIRST, AGAIN, LOOK = 10, 60, 1


class Absence:
    """Since when a scheduler has had no workers; said after FIRST seconds, then every AGAIN seconds."""

    def __init__(self, address: str) -> None:
        self._address = address
        self._since, self._next = 0.0, math.inf

    def look(self, workers: int, now: float) -> str:
        """Return the message that is due, "" if none; ``now`` [s] does not decrease."""
        if workers:
            self._next = math.inf
        elif self._next == math.inf:
            self._since, self._next = now, now + FIRST
        if now < self._next:
            return ""
        self._next += AGAIN
        since = f"has had no workers for {now - self._since:.0f} s, and nothing is computed"
        return f"scheduler {self._address}: {since}; start some: dask worker {self._address}"


@contextmanager
def watched(executor: Executor) -> Iterator[None]:
    """Log meanwhile if an executor of Dask has no workers: it would wait for them without a word."""
    client, ended = getattr(executor, "_client", None), Event()
    if not hasattr(client, "nthreads"):
        yield
        return
    watcher = Thread(target=_watch, args=(client, ended), name="watches the workers", daemon=True)
    watcher.start()
    try:
        yield
    finally:
        ended.set()
        watcher.join(PATIENCE)


def _watch(client: Any, ended: Event) -> None:
    absence = Absence(client.scheduler.address)
    while not ended.wait(LOOK):
        try:
            workers = len(client.nthreads())
        except (OSError, RuntimeError, TimeoutError, CancelledError):
            return  # the scheduler is lost, which ends the study with a message
        if said := absence.look(workers, time.monotonic()):
            log.warning(said)


@contextmanager
def cluster(address: str) -> Iterator[Executor]:
    """Give an executor for ``run_study`` that computes on the workers of a scheduler, such as tcp://host:8786.

    Pieces of a worker that dies are computed by the others, or by those that come. Workers that join later are used,
    too; how many pieces are under way at once is fixed by those that are there at the beginning.

    Raises
    ------
    InvalidProblem
        If no scheduler answers there, it has no workers, or one of them has other code than this machine.
    StudyStopped
        At the end of the block, if the scheduler is lost, or a piece brought down one worker after the other.
    """
    with needs("a Dask cluster", "cluster"):
        from distributed import KilledWorker
        from distributed.comm.core import CommClosedError

    logging.getLogger("distributed").setLevel(logging.CRITICAL)  # what happens is told in one message
    with _connected(address) as client:
        executor = client.get_executor(pure=False)
        executor._max_workers = _threads(client, address)
        try:
            yield executor
        except (CancelledError, CommClosedError) as error:
            raise StudyStopped(f"the connection to the scheduler {address} is lost") from error
        except KilledWorker as error:
            raise StudyStopped(f"workers of {address} died again and again: {error}") from error


def _connected(address: str) -> Client:
    from distributed import Client

    try:
        return Client(address, timeout=PATIENCE, set_as_default=False)
    except (OSError, ValueError) as error:
        allowed = "must be the address of a Dask scheduler that answers, such as tcp://host:8786"
        raise InvalidProblem(f"scheduler {address}: {allowed}: {error}") from error


def _threads(client: Client, address: str) -> int:
    """Count the pieces that the workers compute at once; refuse workers that would not make the same rows."""
    found = client.run(house_code, on_error="return")
    if not found:
        raise InvalidProblem(f"scheduler {address}: has no workers; start some: dask worker {address}")
    for worker, answer in found.items():
        if answer != house_code():
            what = "; ".join(code_differences(house_code(), answer)) if isinstance(answer, dict) else repr(answer)
            raise InvalidProblem(f"worker {worker}: must have the code of this machine, but has other: {what}")
    others = set(client.run(processor).values()) - {processor()}
    if others:
        log.warning(
            "%s: workers with %s, here %s: last bits may differ", address, ", ".join(sorted(others)), processor()
        )
    return sum(client.nthreads().values())
