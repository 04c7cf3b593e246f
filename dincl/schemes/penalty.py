"""The penalty method: overlap is allowed and pushed back."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from dincl.checks import integer, number
from dincl.schemes.base import FixedStep

if TYPE_CHECKING:
    from dincl.problem import Problem
    from dincl.steps.grid import Stepper


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
        object.__setattr__(self, "exponent", integer("exponent", self.exponent, least=1, most=2))

    def stepper(self, problem: Problem) -> Stepper:
        from dincl.steps.loop import Settings
        from dincl.steps.stepper import CompiledStepper
        from dincl.steps.sweeping import run_penalty

        settings = Settings(strength=self.strength, exponent=self.exponent)
        return CompiledStepper.sweeping(problem, run_penalty, settings, of_any=run_penalty)
