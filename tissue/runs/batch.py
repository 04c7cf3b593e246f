"""Up to eight runs of the first-order model side by side, from their starts to the output times."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from itertools import count, takewhile
from typing import Any

import numpy as np

from dincl.callables import UserFunction
from dincl.checks import function, instance
from dincl.errors import FunctionFailed, InvalidProblem
from dincl.status import Status
from tissue.files.parameters import Parameters
from tissue.files.sections import show
from tissue.frames.frame import Frame
from tissue.kernels.workspace import LOST, RUNNING
from tissue.model.measures import Measures, measure
from tissue.runs.compiled_rules import together
from tissue.runs.group import Group, OwnNumbers
from tissue.runs.resume import resumed, steps_made
from tissue.runs.run import Run
from tissue.runs.stability import LOOKS, stability_fault, surely_stable, swings
from tissue.runs.start import started
from tissue.state.cells import COORDINATES, DEPTHS, DTYPES, VARIABLES, Cells
from tissue.state.checkpoint import Streams, TissueCheckpoint, generator_states, streams
from tissue.state.running import APICAL, CELLS, COUNTERS, NEXT_ID, TissueState, contents, copied
from tissue.state.space import kept
from tissue.step.advance import find_lost

WATCH = UserFunction("watch", ("t",), Status.FUNCTION_FAILED)
# Steps of one cell between two questions whether to go on: a tenth of a second.
ASKED = 10_000
# Numbers of a cell that are not its points, and those of them that rules set without its points.
LASTING = tuple(name for name in Cells._fields[:-1] if name not in (*COORDINATES, *DEPTHS, *DTYPES))
GIVEN = ("stiff_ax", "stiff_bx", "stiff_axb", "stiff_aa", "radius")


class Batch:
    """Runs of up to WIDTH seeds, from t = 0 or from saved states of one time.

    Attributes
    ----------
    parameters
        Of all runs, or of the first one.
    each
        Those of each run. dt and output times are the same; where kernels cannot make all of them side by side, see
        ``OwnNumbers.shared``, each run is alone, with the same bits.
    """

    def __init__(
        self, parameters: Parameters | Sequence[Parameters], seeds: Sequence[int], starts: Sequence[Frame] = ()
    ) -> None:
        several: Any = parameters if isinstance(parameters, (list, tuple)) else [parameters] * len(seeds)
        self.each: list[Parameters] = list(several)
        for one in self.each:
            instance("parameters", one, Parameters, "tissue.Parameters, made by load, preset or changed")
        _require_same_times(self.each, len(seeds))
        self.parameters, self.seeds = self.each[0], seeds
        self._texts: dict[int, str] = {}  # of parameters, made where they are asked for
        self.fault: FunctionFailed | None = None
        # How runs ended that an output time showed to be unstable, or folded.
        self._ended: dict[int, tuple[Status, str]] = {}
        # When [h] and how the apical layer was folded first, by run; see ``tissue.model.measures``.
        self.folded: dict[int, tuple[float, str]] = {}
        # What was measured of each run at the present output time; None of one that failed, or has no apical layer.
        self.measures: list[Measures | None] = [None] * len(seeds)
        self._begin = steps_made(self.parameters, starts[0]) if starts else 0
        if starts:
            states, random = zip(*map(resumed, self.each, starts, seeds), strict=True)
        else:
            random = tuple(streams(seed) for seed in seeds)
            states = tuple(map(started, self.each, random))
        self._random = random
        # In space they are not side by side.
        own, size = [own_numbers(one) for one in self.each], len(states)
        if self.parameters.in_space or len(set(map(_structure, self.each, own))) > 1:
            size = 1
        self._surely_stable = [surely_stable(one) for one in self.each]
        self._groups = []
        for k in range(0, len(states), size):
            some, first = slice(k, k + size), self.each[k]
            rule, forces = first.division_rule(), first.forces.acting()
            self._groups.append(Group(states[some], own[k].numbers, random[some], rule, forces, own=own[some]))

    def times(self, ask: Callable[[], None] | None = None) -> Iterator[float]:
        """Yield the output times [h], the first that of the start; when one is given, the runs are there.

        ``ask`` is called before and every now and then, however far these are apart; what it raises ends the work.
        """
        made, dt = self._begin, self.parameters.numerics.dt.value
        self._measure(made)
        yield made * dt
        for step in output_steps(self.parameters):
            before = made
            while made < step:
                end = step
                if ask is not None:
                    ask()
                    cells = sum(int(self.state(k).sizes[CELLS]) for k in range(len(self.seeds)))
                    end = min(step, made + max(1, ASKED // cells))
                self._advance(made, end)
                made = end
            if before < step:
                self._end_unstable(before, step)
                self._measure(step)
                yield step * dt

    def _measure(self, step: int) -> None:
        """Measure the runs that go on, at an output time; note where the apical layer is folded first, also in the last
        state of a run that failed, and end those that go on if so wanted.
        """
        for k in range(len(self.seeds)):
            state, goes_on = self.state(k), self.goes_on(k)
            self.measures[k] = None
            if not state.sizes[APICAL] or find_lost(state) >= 0 or not (goes_on or k not in self.folded):
                continue
            found = measure(state)
            if goes_on:
                self.measures[k] = found
            if found.fold and k not in self.folded:
                t = step * self.parameters.numerics.dt.value if goes_on else self._stopped(k)
                self.folded[k] = t, found.fold
                if goes_on and self.each[k].numerics.folded == "stop":
                    self._end(k, step, Status.FOLDED, found.fold)

    def _end_unstable(self, before: int, step: int) -> None:
        """End the runs whose steps are unstable, at an output time; ``before``: the steps to the one before it.

        Swings are looked for a few times in a run, where steps are not far from the limit.
        """
        last = round(self.parameters.t_end / self.parameters.numerics.dt.value)
        looks = step == last or step * LOOKS // last > before * LOOKS // last
        size = len(self._groups[0].states)
        for first, group in zip(range(0, len(self.seeds), size), self._groups, strict=True):
            running, sure = group.ended == RUNNING, self._surely_stable[first : first + size]
            swing = swings(group) if looks and running.any() and not all(sure) else np.zeros(len(group.states))
            for lane, state in enumerate(group.states):
                floored = self.each[first + lane].rules.floor_rest_length
                mine = 0.0 if sure[lane] else swing[lane]
                if running[lane] and (fault := stability_fault(state, mine, floored=floored)):
                    self._end(first + lane, step, Status.UNSTABLE, fault)

    def _end(self, k: int, step: int, status: Status, why: str) -> None:
        """End run k at a step."""
        group, lane = self._at(k)
        group.ended[lane] = step
        self._ended[k] = status, why

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
        state, random, mine = self.state(k), self._random[k], self.each[k]
        if id(mine) not in self._texts:
            self._texts[id(mine)] = mine.as_toml()
        checkpoint = checkpoint_at(state, self.seeds[k], random, self._texts[id(mine)])
        time = t if self.goes_on(k) else self._stopped(k)
        sheets = kept(state.space) if self.parameters.in_space else None
        return Frame(time, *contents(state), mine.curve(), checkpoint, sheets)

    def status(self, k: int) -> Status:
        """Return how run k ended, or that it goes on."""
        return self._how_it_ended(k)[0]

    def failure(self, k: int) -> str:
        """Say when and where run k failed, "" if it did not."""
        if self.goes_on(k):
            return "" if self.fault is None else self.fault.detail
        return f"t = {self._stopped(k):g} h: {self._how_it_ended(k)[1]}."

    def _how_it_ended(self, k: int) -> tuple[Status, str]:
        """Return the status of run k, and of one that failed the particulars."""
        if self.goes_on(k):
            return Status.SUCCESS if self.fault is None else self.fault.status, ""
        if k in self._ended:
            return self._ended[k]
        state = self.state(k)
        if (lost := find_lost(state)) >= 0:
            where = f"cell {state.cells.id[lost]} has a coordinate that is not finite, or beyond {LOST:g} R_soft"
            group, lane = self._at(k)
            return Status.NON_FINITE, f"{blamed}; {where}" if (blamed := group.blamed(lane)) else where
        if self.parameters.in_space:
            return (
                Status.NETWORK_TORN,
                "points of a layer coincide, or are too few for a network",
            )
        return Status.LUMEN_CLOSED, "opposite parts of the apical layer cross"

    def remark(self, k: int) -> str:
        """Say when and how the apical layer of run k was folded first, "" if it never was."""
        t, how = self.folded.get(k, (0.0, ""))
        return f"t = {t:g} h: {how}" if how else ""

    def run(self, k: int, frames: Sequence[Frame]) -> Run:
        """Run k with these frames."""
        stats = dict(zip(COUNTERS, self.state(k).counts.tolist(), strict=True))
        ended = self.status(k), self.failure(k), stats, self.remark(k)
        return Run(self.each[k], self.seeds[k], tuple(frames), *ended)

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
        """Raise FunctionFailed where functions of users left a number of a cell that cannot be.

        Numbers must be finite; where points are lost, this is asked of those alone that do not follow from points.
        Stiffness, radius and the rest length of a junction must not be negative.
        """
        for group in (group for group in self._groups if group.users):
            for state, ended, own in zip(group.states, group.ended, group.own, strict=False):
                kind, most = state.cells.kind[: state.sizes[CELLS]], len(own.kinds)
                if len(bad := np.flatnonzero((kind < 0) | (kind > most))):
                    made = f"set cells.kind of cell {state.cells.id[bad[0]]} to {kind[bad[0]]}, until t = {t:g} h"
                    together(group.users).refuse(f"{made}: must be from 0 to {most}, 2 being the first of [types].")
                for name in (*LASTING, *VARIABLES):
                    values = getattr(state.cells, name)[: state.sizes[CELLS]]
                    wrong = ~np.isfinite(values) & (ended == RUNNING or name in GIVEN)
                    if length := name in (*GIVEN, "rest_aa"):
                        wrong |= values < 0.0
                    if len(bad := np.flatnonzero(wrong)):
                        made = f"set cells.{name} of cell {state.cells.id[bad[0]]} to {values[bad[0]]:g}"
                        must = "finite and at least 0" if length else "finite"
                        together(group.users).refuse(f"{made}, until t = {t:g} h: must be {must}.")

    def _stopped(self, k: int) -> float:
        """Return when run k failed [h]."""
        group, lane = self._at(k)
        return float(group.ended[lane] * self.parameters.numerics.dt.value)

    def _at(self, k: int) -> tuple[Group, int]:
        """Return the group of run k, and its place there."""
        group = self._groups[k // len(self._groups[0].states)]
        return group, k % len(group.states)


def own_numbers(parameters: Parameters) -> OwnNumbers:
    """Return the numbers that a group has of a run with these parameters."""
    strengths = tuple(strength for _, strength in parameters.forces.acting())
    return OwnNumbers(parameters.numbers(), parameters.named_numbers(), strengths)


def _structure(parameters: Parameters, own: OwnNumbers) -> tuple[Any, ...]:
    """Return what must be the same for runs side by side."""
    forces = tuple(force.name for force, _ in parameters.forces.acting())
    return *own.shared, forces, parameters.division.rule, parameters.curve()


def _require_same_times(each: Sequence[Parameters], runs: int) -> None:
    """Refuse another number of parameters than of runs, or other output times; a dt."""
    if len(each) != runs:
        raise InvalidProblem(f"parameters = {len(each)} of them: must be one, or one for each of {runs} seeds")
    for key in ("numerics.dt", "numerics.t_end", "numerics.keep", "tissue.dimension"):
        section, _, name = key.partition(".")
        if len(values := {getattr(getattr(one, section), name) for one in each}) > 1:
            found = " and ".join(sorted(map(show, values))[:2])
            raise InvalidProblem(f"parameters: {key} = {found}: must be the same for runs side by side")


def checkpoint_at(state: TissueState, seed: int, random: Streams, text: str) -> TissueCheckpoint:
    """Return a copy of what a run is besides its cells, at the present time; ``text``: of its parameters."""
    numbers = int(state.sizes[NEXT_ID]), copied(state.emt), state.counts.copy(), generator_states(random)
    return TissueCheckpoint(seed, *numbers, text)


def output_steps(parameters: Parameters) -> Iterator[int]:
    """Yield the numbers of steps to the output times: every so often or at the times listed, and at the end."""
    dt, keep = parameters.numerics.dt.value, parameters.numerics.keep
    last = round(parameters.t_end / dt)
    times = (time.value for time in keep) if isinstance(keep, tuple) else (keep.value * k for k in count(1))
    yield from takewhile(lambda step: step < last, (round(time / dt) for time in times))
    yield last
