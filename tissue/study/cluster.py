"""Studies on a Dask cluster."""

from __future__ import annotations

import logging
import math
import time
from collections.abc import Iterator
from concurrent.futures import CancelledError, Executor
from contextlib import contextmanager
from threading import Event, Thread
from typing import TYPE_CHECKING, Any

from dincl.errors import InvalidProblem
from dincl.study import StudyStopped
from tissue.study.identity import code_differences, house_code, processor

if TYPE_CHECKING:
    from distributed import Client

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
        """What is to be said, "" if nothing; ``now`` [s] does not decrease."""
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
    """Meanwhile say it if an executor of Dask has no workers: it would wait for them without a word."""
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
    """An executor for ``run_study`` that computes on the workers of a scheduler, at ``address`` such as tcp://host:8786.

    Pieces of a worker that dies are computed by the others, or by those that come. Workers that join later are used,
    too; how many pieces are under way at once is fixed by those that are there at the beginning.

    Raises
    ------
    InvalidProblem
        If no scheduler answers there, it has no workers, or one of them has other code than this machine.
    StudyStopped
        At the end of the block, if the scheduler is lost, or a piece brought down one worker after the other.
    """
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
    """How many pieces the workers compute at once; refuses workers that would not make the same rows."""
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
