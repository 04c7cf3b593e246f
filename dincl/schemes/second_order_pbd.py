"""Position based dynamics in its original, second-order form."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from dincl.checks import array, integer
from dincl.errors import InvalidProblem
from dincl.rows.table import MOST_SWEPT
from dincl.run.bound import Stepper, StepState
from dincl.schemes.base import FixedStep
from dincl.schemes.pbd import MOST_SWEEPS, SweepThrough

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from dincl.problem import Problem


@dataclass(frozen=True, eq=False)
class SecondOrderPBD(FixedStep):
    """v~ = v_k + dt F(t_k, x_k), x~ = x_k + dt v~, x_{k+1} = P_{S_M} ... P_{S_1} x~, v_{k+1} = (x_{k+1} - x_k)/dt.

    Method 2.2 for x'' = F(t, x), x in S, with unit masses: the drift of the problem is an acceleration here
    [length / time^2]. Impacts are inelastic. It approximates Newton's equation, not the first-order inclusion that
    the other schemes solve.

    Parameters
    ----------
    dt
        Step [time].
    v0
        Velocity at the start, shape (N, d) [length / time]; None: at rest.
    sweeps
        As in PBD.
    """

    v0: ArrayLike | None = None
    sweeps: int = 1

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.v0 is not None:
            object.__setattr__(self, "v0", array("v0", self.v0))
        object.__setattr__(self, "sweeps", integer("sweeps", self.sweeps, least=1, most=MOST_SWEEPS))

    def stepper(self, problem: Problem) -> Stepper:
        v0 = np.zeros_like(problem.x0) if self.v0 is None else np.asarray(self.v0)
        if v0.shape != problem.x0.shape:
            raise InvalidProblem(f"v0 of shape {v0.shape}: must have the shape of x0, {problem.x0.shape}")
        if len(problem.x0) <= MOST_SWEPT:
            from dincl.run.compiled_sweeps import CompiledSweeps

            compiled = CompiledSweeps.of(problem, self.sweeps, v0)
            if compiled is not None:
                return compiled
        return SecondOrderStepper(problem, v0, self.sweeps)


class SecondOrderStepper(Stepper):
    """The method for any number of particles, and sets with projections of their own."""

    def __init__(self, problem: Problem, v0: NDArray[np.float64], sweeps: int) -> None:
        super().__init__(problem)
        self._v0 = v0
        self._projections = SweepThrough(problem, sweeps)

    def start(self) -> StepState:
        return StepState(self.problem.x0, self._v0)

    def step(self, t: float, h: float, state: StepState) -> StepState:
        before = self._v0 if state.v is None else state.v
        x = state.x + h * (before + h * self.velocity(t, state.x))
        self._projections.apply(t + h, x, self)
        return StepState(x, (x - state.x) / h)
