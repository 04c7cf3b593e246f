"""The user's verb for a single projection."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from dincl.checks import array, describe, number
from dincl.errors import InvalidProblem, ProjectionFailed, StepFailure
from dincl.norms import longest
from dincl.problem import Problem
from dincl.projection.base import Projection
from dincl.projection.feasible import FeasibleSet
from dincl.work import Work

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from dincl.projection.base import Projected


def project(
    problem: Problem,
    y: ArrayLike,
    projection: Projection,
    t: float = 0.0,
    linearised_at: ArrayLike | None = None,
) -> Projected:
    """P_{S(t)}(y) = argmin over x in S(t) of |x - y|, or the same for S~(x) = {z : g(x) + dg/dx (z - x) >= 0}.

    Parameters
    ----------
    problem
        Whose constraints are meant.
    y
        Point to project, shape (N, d) [length].
    projection
        How, e.g. ``Ipopt(tol=1e-11)``. S is curved in general: back ends return a local solution, found from y.
    t
        Time at which moving sets are taken [time].
    linearised_at
        The x of S~(x), shape (N, d); None for S itself  (section 1.1.2 of chapter 2).

    Raises
    ------
    InvalidProblem
        For wrong shapes or numbers, or constraints that the projection cannot serve.
    ProjectionFailed
        When no point is found to the tolerance; ``status`` says why.
    """
    if not isinstance(problem, Problem):
        raise InvalidProblem(f"problem = {describe(problem)}: must be a dincl.Problem")
    if not isinstance(projection, Projection):
        raise InvalidProblem(f"projection = {describe(projection)}: must be a projection such as Daqp(tol=1e-9)")
    target, time = _positions("y", y, problem), number("t", t)
    around = target if linearised_at is None else _positions("linearised_at", linearised_at, problem)
    projection.check(problem)
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
