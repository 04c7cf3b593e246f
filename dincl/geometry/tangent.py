"""The right-hand side of the inclusion: the slow solution's velocity."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from dincl.checks import number
from dincl.geometry.active import checked, closed, failures_told, of_shape
from dincl.geometry.contacts import near
from dincl.norms import longest
from dincl.projection.cone import nearest
from dincl.rows.affine import AffineRows

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from dincl.constraints.selection import Name
    from dincl.problem import Problem


@dataclass(frozen=True, eq=False)
class TangentVelocity:
    """v = u + sum_k multipliers_k grad g_k.

    Attributes
    ----------
    velocity
        v, shape (N, d) [length / time].
    multipliers
        Shape (m,), >= 0, one for each active row.
    names
        For each active row the index of its constraint in the problem, and the row in words.
    residual
        The certified residual of the projection [length / time].
    """

    velocity: NDArray[np.float64]
    multipliers: NDArray[np.float64]
    names: tuple[Name, ...]
    residual: float


def tangent_velocity(
    problem: Problem, t: float, x: ArrayLike, u: ArrayLike | None = None, *, tol: float, spacing: float = 1e-3
) -> TangentVelocity:
    """argmin |v - u| over the v with grad g_k . v >= b_k for all active rows k: the velocity of the slow solution.

    b_k = grad g_k . c' with the velocity c' of the set of row k, 0 for a set at rest. Where the solution of the
    inclusion has a right derivative, u = F(t, x) gives it.

    Parameters
    ----------
    problem
        Whose drift and constraints are meant.
    t, x
        Time >= 0 [time]; point of S(t), shape (N, d) [length].
    u
        The velocity to project, shape (N, d); F(t, x) if it is not given [length / time].
    tol
        Rows with |g_k| <= tol |grad g_k| are active [length].
    spacing
        Of the differences of order 6 for c', short against the time in which the path of a set bends [time].

    Raises
    ------
    InvalidProblem
        For wrong shapes or numbers, and where x is not in S(t).
    ProjectionFailed
        Where a function of the problem fails, or no velocity keeps all rows; ``status`` says why.

    Source: (1.24), (1.26), (1.27).
    """
    time, state, allowed = checked(problem, t, x, tol)
    step = number("spacing", spacing, positive=True)
    given = None if u is None else of_shape("u", u, problem)
    with failures_told():
        wanted = problem.velocity(time, state) if given is None else given
        rows = near(problem, time, state, allowed, step)
        unit, length, least = rows.gradients(time, state)
        keep = closed(rows.values(time, state) / length, allowed)
        unit, length, least = unit[keep], length[keep], least[keep]
        size = max(longest(wanted), float(np.abs(least).max(initial=0.0)))
        found = nearest(AffineRows(unit, least), wanted.ravel(), size)
    names = tuple(name for name, kept in zip(rows.names, keep, strict=True) if kept)
    return TangentVelocity(found.rest.reshape(wanted.shape), found.multipliers / length, names, size * found.residual)
