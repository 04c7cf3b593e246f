"""Moreau's catch-up scheme, with the projection onto S itself or onto its inner convex approximation."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

from dincl.projection.base import Projection, check_projection
from dincl.schemes.base import FixedStep

if TYPE_CHECKING:
    from dincl.problem import Problem
    from dincl.run.stepper import Stepper


@dataclass(frozen=True)
class CatchUp(FixedStep):
    """x_{k+1} = P_S (x_k + dt F(t_k, x_k)), with S = S(t_{k+1}) where it moves  (1.39).

    Parameters
    ----------
    dt
        Step [time].
    projection
        Computes the nearest point of S, e.g. ``Ipopt(tol=1e-11)``.
    """

    projection: Projection
    linearised: ClassVar[bool] = False

    def __post_init__(self) -> None:
        super().__post_init__()
        check_projection(self.projection)

    def stepper(self, problem: Problem) -> Stepper:
        from dincl.steps.catch_up import catch_up
        from dincl.steps.stepper import CompiledStepper

        self.projection.check(problem)
        solver, tol = self.projection.solver(), self.projection.tol
        return CompiledStepper.projecting(problem, catch_up, solver, tol, linearised=self.linearised)


@dataclass(frozen=True)
class LinearisedCatchUp(CatchUp):
    """x_{k+1} = P_{S~(x_k)} (x_k + dt F(t_k, x_k)), S~(x) = {z : g(x) + dg/dx (z - x) >= 0}

    Source: section 1.1.2 of chapter 2.

    One convex quadratic program a step. For discs g is convex in x, so S~(x) lies inside S and x_{k+1} is feasible.
    """

    linearised: ClassVar[bool] = True
