"""Work handed to an executor a few pieces at a time, whose results are kept as they come."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable
from concurrent.futures import FIRST_COMPLETED, Executor, Future, ProcessPoolExecutor, wait
from contextlib import suppress
from multiprocessing import connection, get_context, parent_process
from threading import Thread
from typing import TypeVar

from dincl.study.stopped import StudyStopped

MAKES_NO_NUMBERS = True
Piece = TypeVar("Piece")
Result = TypeVar("Result")
WORKERS = 2
# Pieces under way at once for each worker of an executor, so that none waits for the next; and for an executor that
# does not say how many it has.
AHEAD = 2
WORKERS_UNTOLD = 32


def carry_out(
    pieces: Iterable[Piece],
    submit: Callable[[Piece], Future[Result]],
    keep: Callable[[Piece, Result], None],
    executor: Executor,
) -> None:
    """Make the results of all pieces, begun in this order, and keep each as soon as it is there.

    After an error, of a piece or of ``keep``, or Ctrl-C, no other piece is begun; those that can not be called back are
    waited for and kept, too; a result that could not be kept is tried once more.

    Parameters
    ----------
    pieces
        What is to be done.
    submit
        Hands a piece to the executor.
    keep
        Takes a piece and its result, in this thread.
    executor
        Says how many workers there are.
    """
    todo = list(pieces)[::-1]
    at_once = AHEAD * int(getattr(executor, "_max_workers", WORKERS_UNTOLD))
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
    """Two processes, each with libraries that keep to one thread: more would only take turns.

    They end with the process that started them, however that ends: by SIGTERM or SIGKILL, too.
    """
    for library in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
        os.environ.setdefault(library, "1")
    return ProcessPoolExecutor(WORKERS, get_context("spawn"), _end_with_parent)


def _end_with_parent() -> None:
    """Begin to watch the process that started this one."""
    parent = parent_process()
    if parent is not None:
        Thread(target=_watch, args=(parent.sentinel,), name="watches the parent", daemon=True).start()


def _watch(parent: int) -> None:
    """Wait for the end of the parent; then nobody wants the result of this process."""
    connection.wait([parent])
    os._exit(0)
