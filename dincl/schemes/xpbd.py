"""Extended position based dynamics (XPBD) of first order."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from dincl.checks import integer, number
from dincl.schemes.base import FixedStep
from dincl.schemes.pbd import MOST_SWEEPS

if TYPE_CHECKING:
    from dincl.problem import Problem
    from dincl.steps.grid import Stepper


@dataclass(frozen=True)
class XPBD(FixedStep):
    """x_{k+1} = x_k + dt F(t_k, x_k) + sum_j mu_j grad g_j, with a multiplier mu_j >= 0 for each row.

    Gauss-Seidel sweeps start with x = x_k + dt F(t_k, x_k), visit the rows near x one after another and change

        mu_j by max(-mu_j, -(g_j(x) + (c/dt) mu_j) / (|grad g_j(x)|^2 + c/dt)),  x by this times grad g_j(x).

    All mu_j are 0 at the start of a step. For distances and half-spaces one sweep with compliance c = 0 is a step of
    PBD (Method 2.3). With c = 0 many sweeps converge to a nearest point of S(t_{k+1}), where S is convex to the nearest
    one, while the sweeps of PBD stop at some point of S. With c > 0 they converge to a step of the implicit Euler
    method for x' = F + (1/c) sum_j max(0, -g_j) grad g_j, the ``Penalty`` of strength 1/c and exponent 2, which is
    stable for all dt.

    Parameters
    ----------
    dt
        Step [time].
    sweeps
        Number of sweeps in a step.
    compliance
        c [time]; 0 for hard constraints.

    Source: Macklin, Mueller and Chentanez, "XPBD: position-based simulation of compliant constrained dynamics" (2016),
    equation (18), for velocity proportional to force instead of Newton's equation.
    """

    sweeps: int = 1
    compliance: float = 0.0

    def __post_init__(self) -> None:
        super().__post_init__()
        object.__setattr__(self, "sweeps", integer("sweeps", self.sweeps, least=1, most=MOST_SWEEPS))
        object.__setattr__(self, "compliance", number("compliance", self.compliance, non_negative=True))

    def stepper(self, problem: Problem) -> Stepper:
        from dincl.steps.loop import Settings
        from dincl.steps.stepper import CompiledStepper
        from dincl.steps.sweeping import run_xpbd

        settings = Settings(sweeps=self.sweeps, compliance=self.compliance)
        return CompiledStepper.sweeping(problem, run_xpbd, settings, multipliers=True)
