"""Up to eight runs of the first-order model side by side, from their starts to the kept times."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from itertools import count, takewhile

from dincl.status import Status
from tissue.files.parameters import Parameters
from tissue.kernels.advance import find_lost
from tissue.kernels.board import LOST, RUNNING
from tissue.kernels.group import Group
from tissue.kernels.store import COUNTERS, Store, contents
from tissue.model.frame import Frame
from tissue.model.streams import streams
from tissue.run import Run
from tissue.start import started


class Lot:
    """Runs of the same parameters and of up to WIDTH seeds."""

    def __init__(self, parameters: Parameters, seeds: Sequence[int]) -> None:
        self.parameters, self.seeds = parameters, seeds
        random = [streams(seed) for seed in seeds]
        starts = [started(parameters, one) for one in random]
        self._parted = [parted for _, parted in starts]
        self._group = Group([held for held, _ in starts], parameters.numbers(), random)

    def times(self) -> Iterator[float]:
        """The kept times [h], the first 0; when one is given, the runs are there."""
        yield 0.0
        made = 0
        for step in kept_steps(self.parameters):
            self._group.advance(made, step)
            made = step
            yield step * self.parameters.numerics.dt.value

    def runs(self, watch: Callable[[float], None] | None = None) -> list[Run]:
        """The runs to their ends; ``watch`` gets the time [h] of each state of the first one as it is kept."""
        frames: list[list[Frame]] = [[] for _ in self.seeds]
        for t in self.times():
            for k, mine in enumerate(frames):
                frame = self.frame(k, t)
                if not mine or mine[-1].t < frame.t:  # a run that has failed stays where it is
                    mine.append(frame)
            if watch is not None and t > 0.0:
                watch(frames[0][-1].t)
            if not any(map(self.goes_on, range(len(self.seeds)))):
                break
        return [self.run(k, mine) for k, mine in enumerate(frames)]

    def store(self, k: int) -> Store:
        """Run k at the present time."""
        return self._group.stores[k]

    def goes_on(self, k: int) -> bool:
        """Whether run k did not fail."""
        return bool(self._group.ended[k] == RUNNING)

    def frame(self, k: int, t: float) -> Frame:
        """A copy of run k at the present time t, or of the state that failed, at its time."""
        return Frame(t if self.goes_on(k) else self._stopped(k), *contents(self.store(k)), self.parameters.curve())

    def status(self, k: int) -> Status:
        """How run k ended, or goes on."""
        if self.goes_on(k):
            return Status.SUCCESS
        return Status.NON_FINITE if find_lost(self.store(k)) >= 0 else Status.LUMEN_CLOSED

    def failure(self, k: int) -> str:
        """When and where run k failed, "" if it did not."""
        if self.goes_on(k):
            return ""
        held = self.store(k)
        if self.status(k) is Status.LUMEN_CLOSED:
            return f"t = {self._stopped(k):g} h: opposite parts of the apical layer cross."
        lost = f"cell {held.cells.id[find_lost(held)]} has a coordinate that is not finite, or beyond {LOST:g} R_soft"
        return f"t = {self._stopped(k):g} h: {lost}."

    def run(self, k: int, frames: Sequence[Frame]) -> Run:
        """Run k with these frames."""
        stats = dict(zip(COUNTERS, self.store(k).counts.tolist(), strict=True))
        return Run(
            self.parameters, self.seeds[k], tuple(frames), self.status(k), self.failure(k), stats, self._parted[k]
        )

    def _stopped(self, k: int) -> float:
        """When run k failed [h]."""
        return float(self._group.ended[k] * self.parameters.numerics.dt.value)


def kept_steps(parameters: Parameters) -> Iterator[int]:
    """The numbers of steps after which a state is kept: every so often or at the times listed, and at the end."""
    dt, keep = parameters.numerics.dt.value, parameters.numerics.keep
    last = round(parameters.t_end / dt)
    times = (time.value for time in keep) if isinstance(keep, tuple) else (keep.value * k for k in count(1))
    yield from takewhile(lambda step: step < last, (round(time / dt) for time in times))
    yield last
