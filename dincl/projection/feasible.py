"""The nearest point of S(t), with only the rows that matter; catch-up with a projection in Python; the user's verb."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from dincl.checks import array, describe, number, shaped
from dincl.constraints.selection import Candidates, Selection, transfer_multipliers
from dincl.errors import InvalidProblem, ProjectionFailed, StepFailure
from dincl.norms import longest
from dincl.problem import Problem, constraints_around
from dincl.projection.certificate import check_projection
from dincl.status import Status
from dincl.steps.grid import Stepper, StepState
from dincl.work import Work

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from dincl.constraints.base import Constraint
    from dincl.projection.certificate import Projected, Projection, Solver

# A projection that ends outside of the search radius is repeated with twice its distance, at most this often.
MOST_SEARCHES = 60


class FeasibleSet:
    """S(t), or its inner convex approximation, of one problem; it stores near rows and a solver for one run."""

    def __init__(self, problem: Problem, solver: Solver, work: Work, *, linearised: bool) -> None:
        self.solver, self._work, self._linearised = solver, work, linearised
        self._candidates = Candidates(problem.constraints, work)
        # The rows of the last projection, and their multipliers.
        self._near: Selection | None = None
        self._multipliers = np.zeros(0)
        solver.size = float(np.abs(problem.x0).max())

    def nearest(
        self,
        t: float,
        y: NDArray[np.float64],
        around: NDArray[np.float64],
        reach: float,
        *,
        carried_to: float | None = None,
    ) -> Projected:
        """P_S(y) at time t, searched from ``around`` (N, d), or P_{S~(around)}(y).

        The rows near ``around`` are used; a point within their ``reach`` can violate no other, so it is the nearest
        of the whole set. Else it is repeated with rows that reach twice as far as it ended. S~ of time t may be
        carried, each family along its own path, to a later time. StepFailure where there is none.
        """
        for _ in range(MOST_SEARCHES):
            near = self._candidates.select(t, around, reach)
            if self._near is None:
                self._multipliers = np.zeros(len(near))
            elif near is not self._near:
                self._multipliers = transfer_multipliers(self._near, self._multipliers, near)
            self._near = near
            rows = near.linearised(t, around, carried_to) if self._linearised else near.at(t)
            found = self.solver.nearest(rows, y, around, self._multipliers)
            self._multipliers = found.multipliers
            if found.solved:
                self._work.count_call(found.back_end, found.iterations)
            distance = longest(found.point - around)
            if carried_to is not None:
                distance += near.largest_change(t, carried_to, around, reach)
            if distance <= reach:
                return found
            reach = 2 * distance
        detail = "The projection moved a particle again and again beyond the rows looked at."
        raise StepFailure(Status.NOT_CONVERGED, detail)


class CatchUpStepper(Stepper):
    """A catch-up scheme whose projection is in Python; see ``dincl.steps.catch_up`` for the same in compiled code."""

    def __init__(self, problem: Problem, projection: Projection, *, linearised: bool, midpoint: bool = False) -> None:
        super().__init__(problem)
        self._set = FeasibleSet(problem, projection.solver(), self.work, linearised=linearised)
        self._tol, self._midpoint = projection.tol, midpoint

    def step(self, t: float, h: float, state: StepState) -> StepState:
        x, near, solver = state.x, self._set, self._set.solver
        rate = self.velocity(t, x)
        length = h * longest(rate)
        if not self._midpoint:
            return StepState(near.nearest(t + h, x + h * rate, x, 2 * length).point)
        # The middle may be less accurate.
        solver.tol = max(self._tol, float(np.sqrt(self._tol * length)))
        middle = 0.5 * (x + near.nearest(t + h, x + h * rate, x, 2 * length).point)
        solver.tol = self._tol
        rate = self.velocity(t + 0.5 * h, middle)
        return StepState(near.nearest(t + 0.5 * h, x + h * rate, middle, 2 * length, carried_to=t + h).point)


def project(
    problem: Problem | Sequence[Constraint],
    y: ArrayLike,
    projection: Projection,
    t: float = 0.0,
    linearised_at: ArrayLike | None = None,
) -> Projected:
    """P_{S(t)}(y) = argmin over x in S(t) of |x - y|, or the same for S~(x) = {z : g(x) + dg/dx (z - x) >= 0}.

    Parameters
    ----------
    problem
        Whose constraints are meant, not its mobilities; or a list of constraints alone, for which no feasible start is
        needed.
    y
        Point to project, shape (N, d) [length].
    projection
        How, e.g. ``Ipopt(tol=1e-11)``. S is curved in general: back ends return a local solution, found from y. Its
        tolerance holds for ``Projected.residual``: the violation is in units of g.
    t
        Time at which moving sets are taken [time].
    linearised_at
        The x of S~(x), shape (N, d); None for S itself  (section 1.1.2 of chapter 2).

    Raises
    ------
    InvalidProblem
        For wrong shapes or numbers.
    ProjectionFailed
        When no point is found to the tolerance; ``status`` says why. INFEASIBLE is proved, by multipliers mu >= 0 of
        sum 1 with A^T mu = 0 and mu . (b - A y) > 0 for the rows A x >= b, to 1e-14 and in a region of a million sizes
        of the problem. In a wedge of constraints that rounding or the tolerance keep from being resolved it is
        NOT_CONVERGED, and names the opening.
    """
    check_projection(projection)
    if isinstance(problem, Problem):
        target = shaped("y", y, problem.x0.shape)
    else:
        target = array("y", y)
        if target.ndim != 2 or 0 in target.shape:
            raise InvalidProblem(f"y of shape {target.shape}: must have shape (N, d) with N, d >= 1")
        if not isinstance(problem, Sequence):
            raise InvalidProblem(f"problem = {describe(problem)}: must be a dincl.Problem, or a list of constraints")
        problem = constraints_around(target, problem)
    time = number("t", t)
    around = target if linearised_at is None else shaped("linearised_at", linearised_at, problem.x0.shape)
    try:
        with np.errstate(all="ignore"):  # what overflows is found in the certificate
            feasible = FeasibleSet(problem, projection.solver(), Work(), linearised=linearised_at is not None)
            reach = 2 * (longest(target - around) + problem.violation(time, target))
            return feasible.nearest(time, target, around, reach)
    except StepFailure as failure:
        raise ProjectionFailed(failure.status, failure.detail) from failure
