"""Up to eight runs of the first-order model side by side, from their starts to the output times."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from itertools import count, repeat, takewhile

import numpy as np

from dincl.callables import UserFunction
from dincl.checks import function, instance
from dincl.errors import FunctionFailed
from dincl.status import Status
from tissue.files.parameters import Parameters
from tissue.frames.frame import Frame
from tissue.kernels.workspace import LOST, RUNNING
from tissue.model.emt import CHECKED
from tissue.plugins import DivisionRule, EmtEvent, Force, registered
from tissue.runs.group import Group
from tissue.runs.resume import checkpoint_of, resumed, steps_made
from tissue.runs.run import Run
from tissue.runs.stability import LOOKS, stability_fault, surely_stable, swings
from tissue.runs.start import started
from tissue.state.cells import COORDINATES, DEPTHS, KINDS, Cells
from tissue.state.checkpoint import Separation, Streams, TissueCheckpoint, generator_states, streams
from tissue.state.mesh import kept
from tissue.state.running import CELLS, COUNTERS, NEXT_ID, TissueState, contents, copied
from tissue.step.advance import find_lost

WATCH = UserFunction("watch", ("t",), Status.FUNCTION_FAILED)
RULES = UserFunction("a function of an event, a force or a rule", ("state", "..."), Status.FUNCTION_FAILED)
# Steps of one cell between two questions whether to go on: a tenth of a second.
ASKED = 10_000
# What the points of a cell do not tell of.
LASTING = tuple(name for name in Cells._fields if name not in (*COORDINATES, *DEPTHS, *KINDS))
NON_NEGATIVE = CHECKED[2:]


class Batch:
    """Runs of the same parameters and of up to WIDTH seeds, from t = 0 or from saved states of one time."""

    def __init__(self, parameters: Parameters, seeds: Sequence[int], starts: Sequence[Frame] = ()) -> None:
        instance("parameters", parameters, Parameters, "tissue.Parameters, made by load, preset or changed")
        self.parameters, self.seeds = parameters, seeds
        self.fault: FunctionFailed | None = None
        self._unstable: dict[int, str] = {}  # what showed that, by run
        self._begin = steps_made(parameters, starts[0]) if starts else 0
        if starts:
            states, random = zip(*map(resumed, repeat(parameters), starts, seeds), strict=True)
            self._separation: Sequence[Separation] = [checkpoint_of(start).separation for start in starts]
        else:
            random = tuple(streams(seed) for seed in seeds)
            states, self._separation = zip(*map(started, repeat(parameters), random), strict=True)
        self._random = random
        rule, forces, named = parameters.division_rule(), parameters.forces.acting(), parameters.named_numbers()
        size = 1 if parameters.in_space else len(states)  # in space they are not side by side
        parts = [slice(k, k + size) for k in range(0, len(states), size)]
        self._surely_stable = surely_stable(parameters)
        self._groups = [Group(states[k], parameters.numbers(), random[k], rule, forces, named) for k in parts]

    def times(self, ask: Callable[[], None] | None = None) -> Iterator[float]:
        """Yield the output times [h], the first that of the start; when one is given, the runs are there.

        ``ask`` is called before and every now and then, however far these are apart; what it raises ends the work.
        """
        made, dt = self._begin, self.parameters.numerics.dt.value
        yield made * dt
        for step in output_steps(self.parameters):
            looked = made
            while made < step:
                end = step
                if ask is not None:
                    ask()
                    end = min(step, made + max(1, ASKED // sum(self._cells())))
                self._advance(made, end)
                made = end
                if made == step:
                    self._end_unstable(looked, step)
                    yield step * dt

    def _end_unstable(self, before: int, step: int) -> None:
        """End the runs whose steps are unstable, at an output time; ``before``: the steps to the one before it.

        Swings are looked for a few times in a run, where steps are not far from the limit.
        """
        last = round(self.parameters.t_end / self.parameters.numerics.dt.value)
        floored = self.parameters.rules.floor_rest_length
        looks = step == last or step * LOOKS // last > before * LOOKS // last
        for first, group in zip(range(0, len(self.seeds), len(self._groups[0].states)), self._groups, strict=True):
            running = group.ended == RUNNING
            if not running.any():
                continue
            swing = swings(group) if looks and not self._surely_stable else np.zeros(len(group.states))
            for lane, state in enumerate(group.states):
                fault = stability_fault(state, swing[lane], floored=floored) if running[lane] else ""
                if fault:
                    self._unstable[first + lane], group.ended[lane] = fault, step

    def runs(self, watch: Callable[[float], None] | None = None) -> list[Run]:
        """Make the runs to their ends; ``watch`` gets the time [h] of each saved state of the first one.

        Where a function of a user fails, all that go on end with what they have: which of them it was, is not known.
        """
        if watch is not None:
            function("watch", watch, "a function of the time")
        frames: list[list[Frame]] = [[] for _ in self.seeds]
        try:
            for number, t in enumerate(self.times()):
                for k, mine in enumerate(frames):
                    frame = self.frame(k, t)
                    if not mine or mine[-1].t < frame.t:  # a run that has failed stays where it is
                        mine.append(frame)
                if watch is not None and number:
                    WATCH.call(watch, frames[0][-1].t)
                if not any(map(self.goes_on, range(len(self.seeds)))):
                    break
        except FunctionFailed as error:
            self.fault = error
        return [self.run(k, mine) for k, mine in enumerate(frames)]

    def _cells(self) -> Iterator[int]:
        """Yield the number of cells of each run."""
        return (int(self.state(k).sizes[CELLS]) for k in range(len(self.seeds)))

    def state(self, k: int) -> TissueState:
        """Run k at the present time."""
        group, lane = self._at(k)
        return group.states[lane]

    def goes_on(self, k: int) -> bool:
        """Return whether run k did not fail."""
        group, lane = self._at(k)
        return bool(group.ended[lane] == RUNNING)

    def frame(self, k: int, t: float) -> Frame:
        """Return a copy of run k at the present time t, or of the state that failed, at its time."""
        state, random = self.state(k), self._random[k]
        checkpoint = checkpoint_at(state, self.seeds[k], random, self._separation[k], self.parameters)
        time = t if self.goes_on(k) else self._stopped(k)
        sheets = kept(state.space, int(state.sizes[CELLS])) if self.parameters.in_space else None
        return Frame(time, *contents(state), self.parameters.curve(), checkpoint, sheets)

    def status(self, k: int) -> Status:
        """Return how run k ended, or that it goes on."""
        if self.goes_on(k):
            return Status.SUCCESS if self.fault is None else self.fault.status
        if k in self._unstable:
            return Status.UNSTABLE
        if find_lost(self.state(k)) >= 0:
            return Status.NON_FINITE
        return Status.NETWORK_TORN if self.state(k).space.torn[0] else Status.LUMEN_CLOSED

    def failure(self, k: int) -> str:
        """Say when and where run k failed, "" if it did not."""
        if self.goes_on(k):
            return "" if self.fault is None else self.fault.detail
        state = self.state(k)
        if k in self._unstable:
            return f"t = {self._stopped(k):g} h: {self._unstable[k]}."
        if self.status(k) is Status.LUMEN_CLOSED:
            return f"t = {self._stopped(k):g} h: opposite parts of the apical layer cross."
        if self.status(k) is Status.NETWORK_TORN:
            return f"t = {self._stopped(k):g} h: points of a layer coincide, or have no way past each other."
        lost = f"cell {state.cells.id[find_lost(state)]} has a coordinate that is not finite, or beyond {LOST:g} R_soft"
        return f"t = {self._stopped(k):g} h: {lost}."

    def run(self, k: int, frames: Sequence[Frame]) -> Run:
        """Run k with these frames."""
        stats = dict(zip(COUNTERS, self.state(k).counts.tolist(), strict=True))
        return Run(
            self.parameters, self.seeds[k], tuple(frames), self.status(k), self.failure(k), stats, self._separation[k]
        )

    def _advance(self, made: int, step: int) -> None:
        """Make steps; where a function of a user fails in them, they did not end a run."""
        before = [group.ended.copy() for group in self._groups]
        try:
            for group in self._groups:
                group.advance(made, step)
            self._refuse_lost(step * self.parameters.numerics.dt.value)
        except FunctionFailed:
            for group, ended in zip(self._groups, before, strict=True):
                group.ended[:] = ended
            raise

    def _refuse_lost(self, t: float) -> None:
        """Raise FunctionFailed for a number of a cell that is negative, or not finite while its points are.

        Our own rules make none, so runs without rules of users are not asked. What an event leaves of its own cell is
        checked at once (``tissue.model.emt.check_cell``); this finds other cells, and what rules of divisions leave.
        """
        if not any(map(registered, (EmtEvent, DivisionRule, Force))):
            return
        for k in range(len(self.seeds)):
            state = self.state(k)
            n = state.sizes[CELLS]
            for name in LASTING:
                values = getattr(state.cells, name)[:n]
                wrong = ~np.isfinite(values) if self.goes_on(k) else np.zeros(n, np.bool_)
                if name in NON_NEGATIVE:  # where it is negative the points may be lost by it
                    wrong |= values < 0.0
                if len(bad := np.flatnonzero(wrong)):
                    must = "finite and at least 0" if name in NON_NEGATIVE else "finite"
                    made = f"set cells.{name} of cell {state.cells.id[bad[0]]} to {values[bad[0]]:g}"
                    RULES.refuse(f"{made}, until t = {t:g} h: must be {must}.")

    def _stopped(self, k: int) -> float:
        """Return when run k failed [h]."""
        group, lane = self._at(k)
        return float(group.ended[lane] * self.parameters.numerics.dt.value)

    def _at(self, k: int) -> tuple[Group, int]:
        """Return the group of run k, and its place there."""
        group = self._groups[k // len(self._groups[0].states)]
        return group, k % len(group.states)


def checkpoint_at(
    state: TissueState, seed: int, random: Streams, separation: Separation, parameters: Parameters
) -> TissueCheckpoint:
    """Return a copy of what a run is besides its cells, at the present time."""
    states, types = generator_states(random), tuple(parameters.types.named())
    next_id, unit = int(state.sizes[NEXT_ID]), parameters.cell.soft_radius.value
    return TissueCheckpoint(seed, next_id, copied(state.emt), state.counts.copy(), states, separation, unit, types)


def output_steps(parameters: Parameters) -> Iterator[int]:
    """Yield the numbers of steps to the output times: every so often or at the times listed, and at the end."""
    dt, keep = parameters.numerics.dt.value, parameters.numerics.keep
    last = round(parameters.t_end / dt)
    times = (time.value for time in keep) if isinstance(keep, tuple) else (keep.value * k for k in count(1))
    yield from takewhile(lambda step: step < last, (round(time / dt) for time in times))
    yield last
