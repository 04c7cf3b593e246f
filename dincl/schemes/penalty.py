"""The penalty method: overlap is allowed and pushed back."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from dincl.checks import describe, number
from dincl.errors import InvalidProblem
from dincl.rows.near import Near
from dincl.rows.table import MOST_PARTICLES
from dincl.run.bound import Stepper, StepState
from dincl.schemes.base import FixedStep

if TYPE_CHECKING:
    from dincl.problem import Problem


@dataclass(frozen=True)
class Penalty(FixedStep):
    """x_{k+1} = x_k + dt (F + strength sum_k max(0, -g_k)^(exponent - 1) grad g_k), explicit Euler for (2.2).

    Parameters
    ----------
    dt
        Step [time].
    strength
        The penalty parameter > 0 [1 / time for exponent 2, length / time for exponent 1].
    exponent
        2: the potential strength/2 sum max(0, -g)^2, a spring, stiff as the strength grows: explicit Euler is
        stable for dt strength |J J^T| <= 2. 1: the potential strength sum max(0, -g) of (1.7), whose force is what
        section 1.1.3 of chapter 2 prints: constant in size and discontinuous, not stiff; it chatters by about
        dt strength.

    Section 1.1.3 of chapter 2 describes the stiff one and prints the other, so both are here.
    """

    strength: float
    exponent: int = 2

    def __post_init__(self) -> None:
        super().__post_init__()
        object.__setattr__(self, "strength", number("strength", self.strength, positive=True))
        if not isinstance(self.exponent, (int, np.integer)) or self.exponent not in (1, 2):
            raise InvalidProblem(f"exponent = {describe(self.exponent)}: must be 1 or 2")

    def stepper(self, problem: Problem) -> Stepper:
        if len(problem.x0) <= MOST_PARTICLES:
            from dincl.run.compiled_sweeps import CompiledPenalty

            compiled = CompiledPenalty.of(problem, self.strength, self.exponent)
            if compiled is not None:
                return compiled
        return PenaltyStepper(problem, self)


class PenaltyStepper(Stepper):
    """The method for any number of particles, and sets of which only their functions are known."""

    def __init__(self, problem: Problem, scheme: Penalty) -> None:
        super().__init__(problem)
        self._near = Near(problem.constraints, self.work)
        self._scheme = scheme

    def step(self, t: float, h: float, state: StepState) -> StepState:
        """x_k + dt (F + penalty force), both at t_k."""
        velocity = self.velocity(t, state.x)
        reach = h * float(np.abs(velocity).max())
        rows = self._near.rows(t, state.x, reach)
        values = rows.values(state.x)
        if (values < 0).any():
            overlap = np.maximum(-values, 0.0)
            push = overlap if self._scheme.exponent == 2 else np.sign(overlap)
            force = rows.jacobian(state.x).transposed_times(push).reshape(state.x.shape)
            velocity = velocity + self._scheme.strength * force
        return StepState(state.x + h * velocity)
