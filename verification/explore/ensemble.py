"""Runs of one setting that are made while someone looks, until there are enough or it is stopped."""

from __future__ import annotations

import os
import sys
import threading
from concurrent.futures import Executor, Future, ThreadPoolExecutor
from typing import TYPE_CHECKING, NamedTuple

from dincl.errors import InvalidProblem
from tissue.kernels.lanes import WIDTH
from tissue.study.plan import run_seeds

if TYPE_CHECKING:
    import pandas as pd

    from tissue.files.parameters import Parameters
    from tissue.study.outcomes import Outcomes


NICE = 10
FIRST = 2  # runs that are made one by one: they are there in a third of the time of eight, and two have an interval


class PartialResults(NamedTuple):
    """The tables of the first so many replicates, as ``Results`` has them."""

    cells: pd.DataFrame
    runs: pd.DataFrame


class Cancelled(Exception):
    """Nobody wants the result any more."""


class Ensemble:
    """The runs of a scenario of a study, in the order of its replicates.

    Parameters
    ----------
    parameters, seed, scenario
        What replicate k is: that of a study with this seed and a scenario of this name.
    most
        Runs after which it ends; the last batch of eight is made whole.
    pool
        Computes the batches, at most as many at a time as it has threads, so that visitors share them.
    """

    def __init__(self, parameters: Parameters, seed: int, scenario: str, most: int, pool: Executor) -> None:
        self.parameters, self.scenario, self.most = parameters, scenario, most
        self._seed, self._pool = seed, pool
        self._lock, self._stop = threading.Lock(), threading.Event()
        self._next, self._busy, self.fault = 0, 0, ""
        self._lots: dict[int, Outcomes] = {}  # by their first replicate, in whatever order they come

    @property
    def runs(self) -> int:
        """The number of replicates from the first one on, without a gap."""
        with self._lock:
            return sum(batch.runs.num_rows for batch in self._without_gap())

    @property
    def busy(self) -> int:
        """Batches under way."""
        return self._busy

    @property
    def over(self) -> bool:
        """Whether no more runs will come."""
        return self._busy == 0 and (self._stop.is_set() or self._next >= self.most or bool(self.fault))

    def start(self, most: int | None = None) -> None:
        """Begin, or go on up to another number of runs; there is no more than one batch for each core under way."""
        self.most = most or self.most
        for _ in range(cores()):
            self._submit()

    def stop(self) -> None:
        """Begin no more batches, and end those under way."""
        self._stop.set()

    def partial_results(self) -> PartialResults | None:
        """Return the replicates without a gap; None as long as there are none."""
        import pyarrow as pa

        with self._lock:
            batches = self._without_gap()
        if not batches:
            return None
        cells, runs = (pa.concat_tables(tables) for tables in zip(*(batch[:2] for batch in batches), strict=True))
        return PartialResults(cells.to_pandas(), runs.to_pandas())

    def _without_gap(self) -> list[Outcomes]:
        found, first = [], 0
        while first in self._lots:
            found.append(self._lots[first])
            first += self._lots[first].runs.num_rows
        return found

    def _submit(self) -> None:
        with self._lock:
            if self._stop.is_set() or self._next >= self.most or self.fault or self._busy >= cores():
                return
            batch = range(self._next, self._next + (1 if self._next < FIRST else WIDTH - self._next % WIDTH))
            self._next, self._busy = batch.stop, self._busy + 1
        self._pool.submit(self._batch, batch).add_done_callback(lambda made: self._keep(batch.start, made))

    def _batch(self, replicates: range) -> Outcomes:
        from tissue.study.outcomes import outcomes

        self._ask()
        seeds = run_seeds(self._seed, self.scenario, replicates)
        return outcomes(self.parameters, replicates, seeds, ask=self._ask)

    def _ask(self) -> None:
        if self._stop.is_set():
            raise Cancelled

    def _keep(self, first: int, batch: Future[Outcomes]) -> None:
        error = batch.exception()
        with self._lock:
            self._busy -= 1
            if error is None:
                self._lots[first] = batch.result()
            elif not isinstance(error, Cancelled):
                self.fault = str(error) if isinstance(error, InvalidProblem) else f"{type(error).__name__}: {error}"
        self._submit()


def cores() -> int:
    """Count the cores of this machine that this process may use."""
    return len(os.sched_getaffinity(0))


def workers() -> ThreadPoolExecutor:
    """Start threads for ensembles, one for each core, which give way to the picture that someone waits for."""
    return ThreadPoolExecutor(cores(), "ensemble", _give_way)


def _give_way() -> None:
    if sys.platform == "linux":  # where the priority is that of a thread
        os.setpriority(os.PRIO_PROCESS, threading.get_native_id(), NICE)
