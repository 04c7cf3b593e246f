"""First-order position based dynamics."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from dincl.checks import integer
from dincl.rows.table import MOST_SWEPT
from dincl.run.bound import Stepper, StepState
from dincl.schemes.base import FixedStep

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from dincl.problem import Problem

# Sweeps that converge are done long before; more of them look like a run that does not end.
MOST_SWEEPS = 1_000_000


@dataclass(frozen=True)
class PBD(FixedStep):
    """x_{k+1} = P_{S_M} ... P_{S_1} (x_k + dt F(t_k, x_k))  (Method 2.3).

    Parameters
    ----------
    dt
        Step [time].
    sweeps
        How often the row of projections is run through in a step; the method has one.

    The S_j come in the order of the problem's constraints and, within one of them, of its rows: for NonOverlap i
    ascending, then j < i ascending; particles, pairs, links of a chain as numbered or given. Each P_{S_j} is exact.
    Steps of few particles are compiled, with the same order and the same formulas.
    """

    sweeps: int = 1

    def __post_init__(self) -> None:
        super().__post_init__()
        object.__setattr__(self, "sweeps", integer("sweeps", self.sweeps, least=1, most=MOST_SWEEPS))

    def stepper(self, problem: Problem) -> Stepper:
        if len(problem.x0) <= MOST_SWEPT:
            from dincl.run.compiled_sweeps import CompiledSweeps

            compiled = CompiledSweeps.of(problem, self.sweeps)
            if compiled is not None:
                return compiled
        return PBDStepper(problem, self.sweeps)


class PBDStepper(Stepper):
    """The method for any number of particles, and sets with projections of their own."""

    def __init__(self, problem: Problem, sweeps: int) -> None:
        super().__init__(problem)
        self._projections = SweepThrough(problem, sweeps)

    def step(self, t: float, h: float, state: StepState) -> StepState:
        x = h * self.velocity(t, state.x)
        x += state.x
        self._projections.apply(t + h, x, self)
        return StepState(x)


class SweepThrough:
    """P_{S_M} ... P_{S_1} for all constraints of a problem, ``sweeps`` times."""

    def __init__(self, problem: Problem, sweeps: int) -> None:
        self._sweeps = sweeps
        sweepers = [constraint.sweeper(problem.x0) for constraint in problem.constraints]
        self._sweepers = [sweeper for sweeper in sweepers if not sweeper.idle]

    def apply(self, t: float, x: NDArray[np.float64], stepper: Stepper) -> None:
        """Project x in place onto the sets at time t, counting the work of ``stepper``."""
        for _ in range(self._sweeps):
            for sweeper in self._sweepers:
                sweeper.sweep(t, x, stepper.work)
