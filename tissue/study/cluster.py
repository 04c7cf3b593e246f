"""Studies on a Dask cluster."""

from __future__ import annotations

import logging
from collections.abc import Iterator
from concurrent.futures import CancelledError, Executor
from contextlib import contextmanager
from typing import TYPE_CHECKING

from dincl.errors import InvalidProblem
from dincl.study.stopped import StudyStopped
from tissue.study.identity import code_differences, house_code, processor

if TYPE_CHECKING:
    from distributed import Client

log = logging.getLogger("tissue.study")
# Seconds within which a scheduler has to answer.
PATIENCE = 10


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
