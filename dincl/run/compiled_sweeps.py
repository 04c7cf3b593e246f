"""Position based dynamics and the penalty method with compiled steps."""

from __future__ import annotations

from abc import abstractmethod
from typing import TYPE_CHECKING, Any

import numpy as np

from dincl.compiled.structs import written
from dincl.kernels import penalty_steps, sweep_steps
from dincl.kernels.pair_list import BUILDS, CORRECTIONS, LOOKED_AT
from dincl.kernels.system import COINCIDENT
from dincl.rows.distance import DistanceRows
from dincl.rows.near import select
from dincl.rows.pairs import coincidence
from dincl.rows.sweeper import SweptRows
from dincl.run.bound import Reached, StepState
from dincl.run.compiled import CompiledStepper
from dincl.run.few_rows import FewRows, few_rows

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from dincl.errors import StepFailure
    from dincl.kernels.system import Steps
    from dincl.problem import Problem
    from dincl.rows.base import RowsOfOneKind
    from dincl.run.grid import TimeGrid


class _WithoutSolver(CompiledStepper):
    """Steps that look at one row after another."""

    def __init__(self, problem: Problem, rows: FewRows) -> None:
        super().__init__(problem, rows.selection)
        self._blocks, self.families = rows.blocks, rows.families(self.system.place)
        self._words = written(self.families)
        self.place, self.room = int(self._words.ctypes.data), np.zeros((2, problem.x0.size))
        self._counted = np.zeros_like(rows.pairs.number)

    def count(self) -> None:
        done = self.families.pairs.number - self._counted
        self._counted += done
        self.work.neighbour_builds += int(done[BUILDS])
        self.work.candidate_pairs += int(done[LOOKED_AT])
        self.work.constraint_projections += int(done[CORRECTIONS])
        super().count()

    def fail(self, code: int) -> None:
        if code == COINCIDENT:
            family, place = self.families.blamed
            rows: Any = self._blocks[family]
            if self.families.formula[family] != sweep_steps.PAIRS:
                raise rows.coincidence(int(place))
            pairs, d = self.families.pairs, self.problem.x0.shape[1]
            raise self.met(rows, int(pairs.near_one[place]) // d, int(pairs.near_other[place]) // d)
        super().fail(code)

    @abstractmethod
    def met(self, rows: DistanceRows, i: int, j: int) -> StepFailure:
        """What to say of two centres on one point."""


class CompiledSweeps(_WithoutSolver):
    """PBD, or SecondOrderPBD if there are velocities ``v0`` (N, d) at the start."""

    def __init__(self, problem: Problem, rows: FewRows, sweeps: int, v0: NDArray[np.float64] | None = None) -> None:
        super().__init__(problem, rows)
        self._sweeps, self._v0 = sweeps, v0

    @classmethod
    def of(cls, problem: Problem, sweeps: int, v0: NDArray[np.float64] | None = None) -> CompiledSweeps | None:
        """Bind to a problem; None if a set has projections that only Python knows."""
        rows = few_rows(problem, [one.sweeper(problem.x0).swept for one in problem.constraints])
        return None if rows is None else cls(problem, rows, sweeps, v0)

    def start(self) -> StepState:
        return StepState(self.problem.x0, self._v0)

    def call(self, steps: Steps, x: NDArray[np.float64], v: NDArray[np.float64]) -> tuple[int, int]:
        return sweep_steps.advance(self.place, self._sweeps, steps, x, v, self.room)

    def met(self, rows: DistanceRows, i: int, j: int) -> StepFailure:
        return coincidence(i, j)

    def _go(self, origin: float, on: TimeGrid, k: int, end: int, state: StepState) -> Reached:
        return super()._go(origin, on, k, end, StepState(state.x, self._v0) if state.v is None else state)


class CompiledPenalty(_WithoutSolver):
    """The penalty method."""

    def __init__(self, problem: Problem, rows: FewRows, strength: float, exponent: int) -> None:
        super().__init__(problem, rows)
        self._strength, self._spring = strength, exponent == 2

    @classmethod
    def of(cls, problem: Problem, strength: float, exponent: int) -> CompiledPenalty | None:
        """Bind to a problem; None if a set has rows that only Python knows."""
        blocks = select(problem.constraints, 0.0, problem.x0, np.inf).blocks
        rows = few_rows(problem, [SweptRows(_formula(block), block) for block in blocks])
        return None if rows is None else cls(problem, rows, strength, exponent)

    def call(self, steps: Steps, x: NDArray[np.float64], v: NDArray[np.float64]) -> tuple[int, int]:
        return penalty_steps.advance(self.place, self._strength, self._spring, steps, x, self.room)

    def met(self, rows: DistanceRows, i: int, j: int) -> StepFailure:
        return rows.coincidence(int(np.flatnonzero((rows.i == i) & (rows.j == j))[0]))


def _formula(rows: RowsOfOneKind) -> str:
    """Which rows are listed when they are near; of the others, the table knows the formula."""
    listed = isinstance(rows, DistanceRows) and rows.j is not None and rows.sign > 0
    return "pairs" if listed else "affine"
