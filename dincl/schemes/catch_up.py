"""Moreau's catch-up scheme: with the projection onto S itself, onto its linearisation, and of second order."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from dincl.projection.certificate import Projection, check_projection
from dincl.projection.compiled import ActiveSet
from dincl.projection.feasible import CatchUpStepper
from dincl.schemes.base import FixedStep

if TYPE_CHECKING:
    from dincl.problem import Problem
    from dincl.steps.grid import Stepper


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

    def __post_init__(self) -> None:
        super().__post_init__()
        check_projection(self.projection)

    def stepper(self, problem: Problem) -> Stepper:
        return bind(problem, self.projection, linearised=False)


@dataclass(frozen=True)
class LinearisedCatchUp(CatchUp):
    """x_{k+1} = P_{S~(x_k)} (x_k + dt F(t_k, x_k)), S~(x) = {z : g(x) + dg/dx (z - x) >= 0}

    Source: section 1.1.2 of chapter 2.

    One convex quadratic program a step. For discs g is convex in x, so S~(x) lies inside S and x_{k+1} is feasible.
    """

    def stepper(self, problem: Problem) -> Stepper:
        return bind(problem, self.projection, linearised=True)


@dataclass(frozen=True)
class MidpointCatchUp(CatchUp):
    r"""x_{k+1} = P_{S~(m)} (x_k + dt F(t_k + dt/2, m)), S~(m) = {z : g(m) + dg/dx (m) (z - m) >= 0}.

    The midpoint rule, with the inner convex approximation of section 1.1.2 of chapter 2 made at m = (x_k + x^)/2, where
    x^ = P_{S~(x_k)} (x_k + dt F(t_k, x_k)) is a step of ``LinearisedCatchUp``. Where S moves, S~(m) is made at
    t_k + dt/2 and carried to t_{k+1}.

    While the contacts stay, the normals in the middle make the step as accurate as the midpoint rule: x_{k+1} has the
    error O(dt^3), and a gap of O(dt^2) that does not add up, as g is imposed and not g'. A contact or a release inside
    of a step costs O(dt^2), once: order 2. The order is 1 where contacts decide over contacts: where a contact made in
    a step moves the particles away from another one that was active in the same step. For discs g is convex in x, so
    S~(m) lies inside S and x_{k+1} is feasible.

    Parameters
    ----------
    dt
        Step [time].
    projection
        Computes the nearest point of S~, e.g. ``ActiveSet(tol=1e-9)``.
        To keep order 2, tol = O(dt^3). For x^ the geometric mean of tol and the length of the move is good enough.
    """

    def stepper(self, problem: Problem) -> Stepper:
        return bind(problem, self.projection, linearised=True, midpoint=True)


def bind(problem: Problem, projection: Projection, *, linearised: bool, midpoint: bool = False) -> Stepper:
    """Bind a catch-up scheme: to compiled steps if its projection is compiled, too, else to steps in Python."""
    if not isinstance(projection, ActiveSet):
        return CatchUpStepper(problem, projection, linearised=linearised, midpoint=midpoint)
    from dincl.steps.catch_up import run_catch_up, run_linearised
    from dincl.steps.loop import Settings
    from dincl.steps.stepper import CompiledStepper

    run = run_linearised if linearised else run_catch_up
    return CompiledStepper.projecting(problem, run, projection, Settings(midpoint=midpoint), exact=not linearised)
