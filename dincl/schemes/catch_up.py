"""Moreau's catch-up scheme, with the projection onto S itself or onto its inner convex approximation."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from dincl.checks import describe
from dincl.errors import InvalidProblem, StepFailure
from dincl.near import Near
from dincl.projection.base import Projection
from dincl.schemes.base import Scheme, State, Stepper
from dincl.status import Status

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from dincl.problem import Problem

# A step whose solution lies farther than the rows reach is repeated with twice its distance, at most this often.
REACH_DOUBLINGS = 60


@dataclass(frozen=True)
class CatchUp(Scheme):
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
        if not isinstance(self.projection, Projection):
            raise InvalidProblem(
                f"projection = {describe(self.projection)}: must be a projection such as Daqp(tol=1e-9)"
            )

    def stepper(self, problem: Problem) -> Stepper:
        self.projection.check(problem)
        return _CatchUpStepper(problem, self)


@dataclass(frozen=True)
class LinearisedCatchUp(CatchUp):
    """x_{k+1} = P_{S~(x_k)} (x_k + dt F(t_k, x_k)), S~(x) = {z : g(x) + dg/dx (z - x) >= 0}  (section 1.1.2).

    One convex quadratic program a step. For discs g is convex in x, so S~(x) lies inside S and x_{k+1} is feasible.
    """

    linearised: ClassVar[bool] = True


class _CatchUpStepper(Stepper):
    def __init__(self, problem: Problem, scheme: CatchUp) -> None:
        super().__init__(problem)
        self._near = Near(problem, self.work)
        self._solver = scheme.projection.solver()
        self._linearised = scheme.linearised

    def step(self, t: float, h: float, state: State) -> State:
        """Project with the near rows; a point within their reach can violate no other, so it is the nearest of S."""
        move = h * self.velocity(t, state.x)
        reach = 2 * _longest(move)
        for _ in range(REACH_DOUBLINGS):
            rows = self._near.rows(t + h, state.x, reach)
            target = rows.linearised(state.x) if self._linearised else rows
            found = self._solver.nearest(target, state.x + move, state.x)
            self.work.count(found)
            moved = _longest(found.point - state.x)
            if moved <= reach:
                return State(found.point)
            reach = 2 * moved
        raise StepFailure(Status.NOT_CONVERGED, f"The projection moved a particle by more than {reach:g}.")


def _longest(moves: NDArray[np.float64]) -> float:
    return float(np.sqrt((moves * moves).sum(axis=1).max()))
