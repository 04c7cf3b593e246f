"""Up to eight runs of the first-order model side by side, from their starts to the kept times."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from dincl.status import Status
from tissue.files.parameters import Parameters
from tissue.first_order import failed_at, kept_steps
from tissue.kernels.advance import FULL
from tissue.kernels.batch.advance import advance
from tissue.kernels.batch.board import EMPTY, RUNNING, board_for
from tissue.kernels.batch.group import grouped, grown_group, replicate
from tissue.kernels.lanes import WIDTH
from tissue.kernels.scratch import DIVISIONS
from tissue.kernels.store import Store, contents
from tissue.model.frame import Frame
from tissue.model.streams import streams
from tissue.run import Run
from tissue.start import started


class Lot:
    """Runs of the same parameters and of up to WIDTH seeds.

    Attributes
    ----------
    group
        Their stores at the present time.
    ended
        Of each RUNNING, or the number of the step that failed; EMPTY where there is no run.
    """

    def __init__(self, parameters: Parameters, seeds: Sequence[int]) -> None:
        self.parameters, self.seeds = parameters, seeds
        self._random = [streams(seed) for seed in seeds]
        starts = [started(parameters, one) for one in self._random]
        self._parted = [parted for _, parted in starts]
        self.group = grouped([held for held, _ in starts])
        self.ended = np.where(np.arange(WIDTH) < len(seeds), RUNNING, EMPTY)

    def times(self) -> Iterator[float]:
        """The kept times [h], the first 0; when one is given, the runs are there."""
        yield 0.0
        numbers = self.parameters.numbers()
        everyone = self._random + self._random[-1:] * (WIDTH - len(self._random))
        draws, noise = tuple(one.cycle for one in everyone), tuple(one.noise for one in everyone)
        made, board = 0, board_for(self.group.cells.x.shape[1])
        for step in kept_steps(self.parameters):
            end = FULL
            while end == FULL:
                made, end = advance(self.group, board, self.ended, made, step, numbers, draws, noise)
                if end == FULL:
                    self.group = grown_group(self.group)
                    board = board_for(self.group.cells.x.shape[1])
            yield step * numbers.dt

    def store(self, k: int) -> Store:
        """A view of run k."""
        return replicate(self.group, k)

    def frame(self, k: int, t: float) -> Frame:
        """A copy of run k at the present time t, or of the state that failed, at its time."""
        stopped = self.ended[k] * self.parameters.numerics.dt.value
        return Frame(t if self.ended[k] == RUNNING else stopped, *contents(self.store(k)))

    def failure(self, k: int) -> str:
        """When and where run k failed, "" if it did not."""
        if self.ended[k] == RUNNING:
            return ""
        return failed_at(self.store(k), self.ended[k] * self.parameters.numerics.dt.value)

    def run(self, k: int, frames: Sequence[Frame]) -> Run:
        """Run k with these frames."""
        steps = round(frames[-1].t / self.parameters.numerics.dt.value)
        divisions = int(self.store(k).scratch.counts[DIVISIONS])
        stats = {"substeps": steps * self.parameters.numerics.substeps, "divisions": divisions}
        detail = self.failure(k)
        status = Status.NON_FINITE if detail else Status.SUCCESS
        return Run(self.parameters, self.seeds[k], tuple(frames), status, detail, stats, self._parted[k])
