"""The theta = 1/2 form of catch-up, which is of second order while no contact begins or ends."""

from __future__ import annotations

from dataclasses import dataclass

import dincl
from dincl import Stepper, StepState
from dincl.norms import longest
from dincl.projection.feasible import FeasibleSet


@dataclass(frozen=True)
class MoreauJean(dincl.CatchUp):
    """x_{k+1} = 2 z - x_k, z = P_S (x_k + dt/2 F(t_k + dt/2, m)), m = P_S (x_k + dt/2 F(t_k, x_k)).

    The form of (1.39) with theta = 1/2: up to F(m) for F(z), (x_{k+1} - x_k)/dt lies in F(z) - N(S, z) at the middle z
    of the step. The set is met there and not at the end: a disc that meets a wall within a step overshoots it by up to
    half the step, and swings about contact undamped.
    """

    def stepper(self, problem: dincl.Problem) -> Stepper:
        """Bind to a problem."""
        return _MoreauJeanStepper(problem, self)


class _MoreauJeanStepper(Stepper):
    def __init__(self, problem: dincl.Problem, scheme: MoreauJean) -> None:
        super().__init__(problem)
        self._set = FeasibleSet(problem, scheme.projection.solver(), self.work, linearised=False)

    def step(self, t: float, h: float, state: StepState) -> StepState:
        middle = state.x
        for time in (t, t + h / 2):
            move = h / 2 * self.velocity(time, middle)
            middle = self._set.nearest(t + h / 2, state.x + move, state.x, 2 * longest(move)).point
        return StepState(2 * middle - state.x)
