"""Pieces of work done by an executor, whose results are kept as they come; their progress; a folder held alone."""

from __future__ import annotations

import fcntl
import os
import time
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, Executor, Future, ProcessPoolExecutor, wait
from contextlib import contextmanager, suppress
from datetime import timedelta
from multiprocessing import connection, get_context, parent_process
from pathlib import Path
from typing import TypeVar

from dincl.errors import InvalidProblem
from dincl.extras import needs

with needs("dincl.study", "report"):
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

Piece = TypeVar("Piece")
Result = TypeVar("Result")
WORKERS = 2
# Pieces under way at once for each worker, so that none waits for the next; workers of an executor that has no count.
AHEAD, UNKNOWN_WORKERS = 2, 32
# Seconds between two lines of progress where there is no terminal.
INTERVAL = 5.0


class StudyStopped(RuntimeError):
    """A study that ended before its last run: what it had computed is saved, and the same call resumes it."""


def carry_out(
    pieces: Iterable[Piece],
    submit: Callable[[Piece], Future[Result]],
    keep: Callable[[Piece, Result], None],
    executor: Executor,
) -> None:
    """Compute the results of all pieces, begun in this order, and keep each as soon as it is there.

    After an error, of a piece or of ``keep``, or Ctrl-C, no other piece is begun; pieces that cannot be cancelled are
    waited for and kept, too; a result that could not be kept is tried once more.

    Parameters
    ----------
    pieces
        The work.
    submit
        Passes a piece to the executor.
    keep
        Takes a piece and its result, in this thread.
    executor
        Has the number of workers.
    """
    todo = list(pieces)[::-1]
    at_once = AHEAD * int(getattr(executor, "_max_workers", UNKNOWN_WORKERS))
    under_way: dict[Future[Result], Piece] = {}
    try:
        while todo or under_way:
            while todo and len(under_way) < at_once:
                piece = todo.pop()
                under_way[submit(piece)] = piece
            finished = wait(under_way, return_when=FIRST_COMPLETED).done
            for future in [future for future in under_way if future in finished]:
                keep(under_way[future], future.result())
                del under_way[future]
    finally:
        for future in wait([future for future in under_way if not future.cancel()]).done:
            if future.exception() is None:
                with suppress(StudyStopped):  # the disk is still full
                    keep(under_way[future], future.result())


def workers() -> ProcessPoolExecutor:
    """Start two processes whose libraries use one thread each: more would only take turns.

    They end with the process that started them, however that ends: by SIGTERM or SIGKILL, too.
    """
    for library in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
        os.environ.setdefault(library, "1")
    return ProcessPoolExecutor(WORKERS, get_context("spawn"), _end_with_parent)


def _end_with_parent() -> None:
    """Let the kernel end this process when the process that started it ends.

    The write end of the pipe ``sentinel`` closes then, and SIGIO, sent on that account, ends a process. A thread that
    waits for the same would need the interpreter's lock, which a library may hold for minutes.
    """
    parent = parent_process()
    if parent is None:
        return
    pipe = parent.sentinel
    fcntl.fcntl(pipe, fcntl.F_SETOWN, os.getpid())
    fcntl.fcntl(pipe, fcntl.F_SETFL, fcntl.fcntl(pipe, fcntl.F_GETFL) | os.O_ASYNC)
    if connection.wait([pipe], 0):  # it ended before
        os._exit(0)


@contextmanager
def progress(title: str, total: float, unit: str) -> Iterator[Callable[[float], None]]:
    """Show a bar on a terminal, otherwise a line every few seconds, on stderr.

    The function that this gives is called with how much of ``total`` [unit] is done. Rate and remaining time are
    measured from the first call on, since what was there before took no time.
    """
    console = Console(stderr=True)
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        TextColumn(f"{{task.completed:g}} of {{task.total:g}} {unit}"),
        TimeElapsedColumn(),
        TextColumn("{task.fields[pace]}"),
    )
    start = last = time.monotonic()
    first: tuple[float, float] | None = None

    def done(amount: float) -> None:
        nonlocal first, last
        now = time.monotonic()
        first = first or (amount, now)
        rate = ""
        if amount > first[0] and now > first[1]:
            speed = (amount - first[0]) / (now - first[1])
            rate = f"{speed:.3g} {unit}/s, {timedelta(seconds=round((total - amount) / speed))} left"
        bar.update(task, completed=amount, pace=rate)
        if not console.is_terminal and now - last > INTERVAL:
            line = f"{title}: {amount:g} of {total:g} {unit}, {now - start:.0f} s{rate and ', '}{rate}"
            console.print(line, highlight=False, markup=False, soft_wrap=True)
            last = now

    with Progress(*columns, console=console, disable=not console.is_terminal) as bar:
        task = bar.add_task(title, total=total, pace="")
        yield done


@contextmanager
def locked(folder: Path, name: str) -> Iterator[None]:
    """Hold a folder, made if it is new, for this process alone.

    Parameters
    ----------
    folder
        The folder.
    name
        Name of the lock, a file in it that stays.

    Raises
    ------
    InvalidProblem
        If another process holds it.
    OSError
        If it cannot be written to.
    """
    with needs("dincl.study", "report"):
        from filelock import FileLock, Timeout

    folder.mkdir(parents=True, exist_ok=True)
    lock = FileLock(folder / name, timeout=0)
    try:
        lock.acquire()
    except Timeout as error:
        raise InvalidProblem(f"{folder}: another process works on it, and goes on undisturbed") from error
    try:
        yield
    finally:
        lock.release()
