"""The user's verb for a single projection."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from dincl.checks import array, describe, number
from dincl.errors import InvalidProblem, ProjectionFailed, StepFailure
from dincl.norms import longest
from dincl.problem import Problem, constraints_around
from dincl.projection.certificate import Projection
from dincl.projection.feasible import FeasibleSet
from dincl.work import Work

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from dincl.constraints.base import Constraint
    from dincl.projection.certificate import Projected


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
        Whose constraints are meant; or a list of constraints alone, for which no feasible start is needed.
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
    if not isinstance(projection, Projection):
        raise InvalidProblem(f"projection = {describe(projection)}: must be a projection such as Daqp(tol=1e-9)")
    if isinstance(problem, Problem):
        target = _positions("y", y, problem)
    else:
        target = array("y", y)
        if target.ndim != 2 or 0 in target.shape:
            raise InvalidProblem(f"y of shape {target.shape}: must have shape (N, d) with N, d >= 1")
        if not isinstance(problem, Sequence):
            raise InvalidProblem(f"problem = {describe(problem)}: must be a dincl.Problem, or a list of constraints")
        problem = constraints_around(target, problem)
    time = number("t", t)
    around = target if linearised_at is None else _positions("linearised_at", linearised_at, problem)
    try:
        with np.errstate(all="ignore"):  # what overflows is found in the certificate
            feasible = FeasibleSet(problem, projection.solver(), Work(), linearised=linearised_at is not None)
            reach = 2 * (longest(target - around) + problem.violation(time, target))
            return feasible.nearest(time, target, around, reach)
    except StepFailure as failure:
        raise ProjectionFailed(failure.status, failure.detail) from failure


def _positions(name: str, value: ArrayLike, problem: Problem) -> NDArray[np.float64]:
    checked = array(name, value)
    if checked.shape != problem.x0.shape:
        raise InvalidProblem(f"{name} of shape {checked.shape}: must have the shape of x0, {problem.x0.shape}")
    return checked
