"""Position based dynamics: of first order, in its original second-order form, and extended by multipliers (XPBD)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from dincl.checks import array, integer, number, shaped
from dincl.schemes.base import FixedStep

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from dincl.problem import Problem
    from dincl.steps.grid import Stepper

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
    """

    sweeps: int = 1

    def __post_init__(self) -> None:
        super().__post_init__()
        object.__setattr__(self, "sweeps", integer("sweeps", self.sweeps, least=1, most=MOST_SWEEPS))

    def stepper(self, problem: Problem) -> Stepper:
        return _sweeping(problem, "run_pbd", self.sweeps)


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
        v0 = np.zeros_like(problem.x0) if self.v0 is None else shaped("v0", self.v0, problem.x0.shape)
        if problem.scaling is not None:
            v0 = problem.scaling.velocities(v0)
        return _sweeping(problem, "run_pbd", self.sweeps, v0=v0)


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
        return _sweeping(problem, "run_xpbd", self.sweeps, compliance=self.compliance)


def _sweeping(
    problem: Problem, run: str, sweeps: int, compliance: float = 0.0, v0: NDArray[np.float64] | None = None
) -> Stepper:
    """Bind the kernel of this name to a problem; of second order if there is a velocity at the start."""
    from dincl.steps import sweeping
    from dincl.steps.loop import Settings
    from dincl.steps.stepper import CompiledStepper

    settings = Settings(sweeps=sweeps, compliance=compliance)
    plain, of_any = getattr(sweeping, run), getattr(sweeping, f"{run}_of_any")
    return CompiledStepper.sweeping(problem, plain, settings, of_any=of_any, multipliers=run == "run_xpbd", v0=v0)
