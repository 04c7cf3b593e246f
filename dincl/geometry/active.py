"""Which rows are active at a point, and the checks that all of this package begins with."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

import numpy as np

from dincl.checks import array, describe, number
from dincl.errors import InvalidProblem, ProjectionFailed, StepFailure
from dincl.problem import Problem

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray


def closed(gap: NDArray[np.float64], tol: float) -> NDArray[np.bool_]:
    """Which gaps g / |grad g|, shape (m,), are at most ``tol``; InvalidProblem if one is below -tol."""
    least = float(gap.min(initial=0.0))
    if least < -tol:
        raise InvalidProblem(f"x lies outside of S by {-least:.3g}, more than tol = {tol:g}: there is no normal cone")
    chosen: NDArray[np.bool_] = gap <= tol
    return chosen


def checked(problem: Problem, t: float, x: ArrayLike, tol: float) -> tuple[float, NDArray[np.float64], float]:
    """Time >= 0, state of the shape of x0, tolerance > 0."""
    if not isinstance(problem, Problem):
        raise InvalidProblem(f"problem = {describe(problem)}: must be a dincl.Problem")
    time = number("t", t, non_negative=True)
    return time, of_shape("x", x, problem), number("tol", tol, positive=True)


def of_shape(name: str, value: ArrayLike, problem: Problem) -> NDArray[np.float64]:
    """A state or a velocity."""
    found = array(name, value)
    if found.shape != problem.x0.shape:
        raise InvalidProblem(f"{name} of shape {found.shape}: must have the shape of x0, {problem.x0.shape}")
    return found


@contextmanager
def failures_told() -> Iterator[None]:
    """Turn a StepFailure into the public ProjectionFailed; what overflows in a function is found in what it returns."""
    try:
        with np.errstate(all="ignore"):
            yield
    except StepFailure as failure:
        raise ProjectionFailed(failure.status, failure.detail) from failure
