"""Work for the visitor of the tab of inclusions: one run at a time, the visible ones first."""

from __future__ import annotations

import asyncio
import threading
from collections.abc import Callable, Sequence
from concurrent.futures import Executor

from nicegui import background_tasks

from dincl.errors import InvalidProblem
from verification.explore.inclusions.charts import COARSEST, FINEST, Compared
from verification.explore.inclusions.frames import box_of
from verification.explore.inclusions.problems import Inclusion, reference
from verification.explore.inclusions.runs import InclusionRun, Measured, measured


class InclusionWork:
    """Measures runs of several methods, at the present dt and then from coarse to fine steps, until all are known.

    Parameters
    ----------
    pool
        Makes the runs.
    changed
        Called when there is more to see.
    """

    def __init__(self, pool: Executor, changed: Callable[[], None]) -> None:
        self._pool, self._changed = pool, changed
        self._halt = threading.Event()
        self._known: dict[tuple[str, int], Measured] = {}
        self._task: asyncio.Task[None] | None = None
        self._inclusion: Inclusion | None = None
        self.words, self.size = "", 1.0
        self.methods: Sequence[str] = ()
        self._pictured = ""
        self.steps, self.end = 1, 1.0

    def compared(self) -> Compared:
        """Return what is known now."""
        return Compared(self._known, self.methods, self._pictured, self.steps, self.end, self.size)

    def look_at(self, inclusion: Inclusion, end: float, methods: Sequence[str], pictured: str, steps: int) -> None:
        """Go on with this; what is under way is stopped."""
        if (inclusion, end) != (self._inclusion, self.end):
            self._inclusion, self.end, self._known, self.words = inclusion, end, {}, ""
        self.methods, self._pictured, self.steps = methods, pictured, steps
        self.stop()
        if not self.words or self._next() is not None:
            self._halt = threading.Event()
            going = self._go(inclusion, end, self._known, self._halt, self._task)
            self._task = background_tasks.create(going, name="inclusions")
        self._changed()

    def stop(self) -> None:
        """End all work at the next output time."""
        self._halt.set()

    async def _go(
        self,
        inclusion: Inclusion,
        end: float,
        known: dict[tuple[str, int], Measured],
        halt: threading.Event,
        before: asyncio.Task[None] | None,
    ) -> None:
        """Fill ``known`` until it is halted, once what was under way before has ended."""
        if before is not None:
            await asyncio.wait([before])
        loop = asyncio.get_running_loop()
        if not halt.is_set() and not self.words:
            about = await loop.run_in_executor(self._pool, _about, inclusion, end)
            if known is self._known:
                self.words, self.size = about
        while not halt.is_set() and (job := self._next()) is not None:
            found = await loop.run_in_executor(self._pool, measured, InclusionRun(inclusion, *job, end), halt.is_set)
            if found is not None:
                known[job] = found
            if not halt.is_set():
                self._changed()

    def _next(self) -> tuple[str, int] | None:
        """Choose the next run: the present dt, twice that for the order, then from coarse to fine."""
        wanted = [self.steps, max(1, self.steps // 2), *(2**k for k in range(COARSEST, FINEST + 1))]
        jobs = ((method, steps) for steps in wanted for method in self.methods)
        return next((job for job in jobs if job not in self._known), None)


def _about(inclusion: Inclusion, end: float) -> tuple[str, float]:
    """Return what is known of the solution, and how large the scene is."""
    try:
        left, right, low, high = box_of(inclusion, end)
    except InvalidProblem as error:
        return f"unknown. {error}", 1.0
    return reference(inclusion.problem, end).words, max(right - left, high - low)
