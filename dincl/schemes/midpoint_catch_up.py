"""Catch-up of second order: the drift and the linearisation are taken in the middle of the step."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from dincl.projection.base import Projection, check_projection
from dincl.schemes.base import FixedStep

if TYPE_CHECKING:
    from dincl.problem import Problem
    from dincl.run.stepper import Stepper


@dataclass(frozen=True)
class MidpointCatchUp(FixedStep):
    r"""x_{k+1} = P_{S~(m)} (x_k + dt F(t_k + dt/2, m)), S~(m) = {z : g(m) + dg/dx (m) (z - m) >= 0}.

    The midpoint rule, with the inner convex approximation of section 1.1.2 of chapter 2 made at m = (x_k + x^)/2, where
    x^ = P_{S~(x_k)} (x_k + dt F(t_k, x_k)) is a step of ``LinearisedCatchUp``. Where S moves, S~(m) is made at
    t_k + dt/2 and carried to t_{k+1}.

    While the contacts stay, the normals in the middle make the step as accurate as the midpoint rule: x_{k+1} has the
    error O(dt^3), and a gap of O(dt^2) that does not add up, as g is imposed and not g'. A contact or a release inside
    of a step costs O(dt^2), once: order 2. Order 1 is left where contacts decide over contacts: where one made in a
    step moves the particles away from another one that pushed in the same step. For discs g is convex in x, so S~(m)
    lies inside S and x_{k+1} is feasible.

    Parameters
    ----------
    dt
        Step [time].
    projection
        Computes the nearest point of S~, e.g. ``Daqp(tol=1e-9)`` or, for many particles, ``ProjectedNewton(tol=1e-7)``.
        To keep order 2, tol = O(dt^3). For x^ the geometric mean of tol and the length of the move is good enough.
    """

    projection: Projection

    def __post_init__(self) -> None:
        super().__post_init__()
        check_projection(self.projection)

    def stepper(self, problem: Problem) -> Stepper:
        from dincl.steps.catch_up import midpoint_catch_up
        from dincl.steps.stepper import CompiledStepper

        self.projection.check(problem)
        solver, tol = self.projection.solver(), self.projection.tol
        return CompiledStepper.projecting(problem, midpoint_catch_up, solver, tol, linearised=True)
