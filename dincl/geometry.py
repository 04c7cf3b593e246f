"""Normal cones, tangent velocities, support functions  (chapter 1, sections 4.1 to 4.4)."""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from dincl.checks import instance, number, shaped
from dincl.constraints.selection import select
from dincl.errors import InvalidProblem, ProjectionFailed, StepFailure
from dincl.matrices import combined, divided, row_squares
from dincl.norms import length, longest
from dincl.problem import Problem
from dincl.projection.cone import TOLERANCE, nearest, split
from dincl.rows.kinds import AffineRows

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray
    from scipy.sparse import csr_array

    from dincl.constraints.selection import Name, Selection

__all__ = ["NormalCone", "TangentVelocity", "normal_cone", "support", "tangent_velocity"]

# Length of a vector that counts as zero, relative to u: ten times the accuracy of the projections onto cones.
NEGLIGIBLE = 10 * TOLERANCE


@dataclass(frozen=True, eq=False, repr=False)
class NormalCone:
    """N = {-sum_k lambda_k grad g_k(x) : lambda >= 0} over the m active rows: the outward normals of S at x.

    Vectors u have the shape (N, d) of x. All numbers are accurate to 1e-10 |u|; else ProjectionFailed is raised.

    Attributes
    ----------
    names
        For each row the index of its constraint in the problem, and the row in words.
    matrix
        The gradients, m rows and N*d columns.
    shape
        (N, d).

    Source: Definition 1.24; for discs it is the proximal normal cone of Definition 1.23 (Theorem 1.25).
    """

    names: tuple[Name, ...]
    matrix: csr_array
    shape: tuple[int, int]

    @property
    def generators(self) -> NDArray[np.float64]:
        """grad g_k, shape (m, N, d); they point into S, so the cone is spanned by their negatives."""
        generators: NDArray[np.float64] = self.matrix.toarray().reshape(-1, *self.shape)
        return generators

    def multipliers(self, u: ArrayLike) -> NDArray[np.float64]:
        """Compute lambda (m,) >= 0 of the nearest point of the cone to u, -sum_k lambda_k grad g_k.

        They are unique only if the gradients with lambda_k > 0 are independent.
        """
        return self._split(u)[0]

    def normal_part(self, u: ArrayLike) -> NDArray[np.float64]:
        """Compute P_N(u), shape (N, d): the nearest point of the cone to u."""
        return -combined(self.matrix, self._split(u)[0]).reshape(self.shape)

    def tangent_part(self, u: ArrayLike) -> NDArray[np.float64]:
        """Compute P_T(u) = u - P_N(u), shape (N, d), with the polar cone T = {v : grad g_k . v >= 0 for all k} of N."""
        return self._split(u)[1]

    def distance(self, u: ArrayLike) -> float:
        """Compute min |u - n| over the n of the cone."""
        return length(self._split(u)[1].ravel())

    def contains(self, u: ArrayLike) -> bool:
        """Return whether u lies in the cone, to 1e-9 |u|."""
        rest = self._split(u)[1]
        return length(rest.ravel()) <= NEGLIGIBLE * length(np.asarray(u, dtype=np.float64).ravel())

    def inverse_triangle(self) -> float:
        """Compute gamma = min |sum_k lambda_k grad g_k| over lambda >= 0 with sum_k lambda_k |grad g_k| = 1, in [0, 1].

        It is 1 for at most one row. Its dual is a least distance, 1/gamma = min |v| with n_k . v >= 1 for the unit
        gradients n_k. If there is no such v, some gradients cancel, and gamma = 0.
        """
        lengths = np.sqrt(row_squares(self.matrix))
        if not len(lengths):
            return 1.0
        if lengths.min() == 0:
            return 0.0
        unit = divided(self.matrix, lengths)
        try:
            point = nearest(AffineRows(unit, np.ones(unit.shape[0])), np.zeros(unit.shape[1]), 1.0).rest
        except StepFailure:
            return 0.0
        return 1.0 / length(point)

    def _split(self, u: ArrayLike) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Compute the multipliers and the tangent part of u."""
        vector = shaped("u", u, self.shape)
        with _projection_failures():
            parts = split(-vector.ravel(), self.matrix)
        return parts.multipliers, -parts.rest.reshape(self.shape)

    def __repr__(self) -> str:
        return f"NormalCone({len(self.names)} active rows, N = {self.shape[0]}, d = {self.shape[1]})"


def normal_cone(problem: Problem, t: float, x: ArrayLike, tol: float) -> NormalCone:
    """Compute N(S(t), x) = {-sum_k lambda_k grad g_k(x) : lambda_k >= 0, lambda_k g_k(x) = 0}.

    Parameters
    ----------
    problem
        The problem with the constraints of S.
    t, x
        Time >= 0 [time]; point of S(t), shape (N, d) [length].
    tol
        Rows with |g_k| <= tol |grad g_k| are active; a point that violates more is refused [length].

    Raises
    ------
    InvalidProblem
        For wrong shapes or numbers, and where x is not in S(t): the cone is empty there.
    ProjectionFailed
        Where a gradient is not defined; ``status`` says why.

    Source: Definition 1.24.
    """
    with _projection_failures():
        return cone_at(problem, *_checked(problem, t, x, tol))


def support(
    problem: Problem, t: float, x: ArrayLike, direction: ArrayLike, tol: float, radius: float = math.inf
) -> float:
    """Compute sigma(-N(S(t), x) ∩ B_radius(0), w) = sup of v . w over the v of -N with |v| <= radius.

    It is radius |P_{-N}(w)|. Without a radius the cone is unbounded: 0 where w . v <= 0 on all of -N, else inf.

    Parameters
    ----------
    problem, t, x, tol
        As in ``normal_cone``.
    direction
        w, shape (N, d).
    radius
        Radius of the ball, > 0, or inf.

    Raises
    ------
    InvalidProblem, ProjectionFailed
        As in ``normal_cone``.

    Source: (1.29), used for these sets in Proposition 1.28 and Definition 2.7.
    """
    cone = normal_cone(problem, t, x, tol)
    w = shaped("direction", direction, problem.x0.shape)
    size = radius if radius == math.inf else number("radius", radius, positive=True)
    along = length(cone.normal_part(-w).ravel())
    return 0.0 if along <= NEGLIGIBLE * length(w.ravel()) else size * along


@dataclass(frozen=True, eq=False)
class TangentVelocity:
    """v = u + sum_k multipliers_k grad g_k, with mobilities u + B sum_k multipliers_k grad g_k.

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
    """Compute argmin |v - u| over v with grad g_k . v >= b_k for all active rows k: the velocity of the slow solution.

    b_k = grad g_k . c' with the velocity c' of the set of row k, 0 for sets that do not move. Where the solution of
    the inclusion has a right derivative, u = F(t, x) gives it. With mobilities distances are those of the metric of
    B^-1, particles of mobility 0 stay, and u = B F(t, x) gives it.

    Parameters
    ----------
    problem
        The problem with the drift and the constraints.
    t, x
        Time >= 0 [time]; point of S(t), shape (N, d) [length].
    u
        The velocity to project, shape (N, d); None: F(t, x), or B F(t, x) [length / time].
    tol
        Rows with |g_k| <= tol |grad g_k| are active [length].
    spacing
        Spacing of the differences of order 6 for c', short beside the time in which the path of a set bends [time].

    Raises
    ------
    InvalidProblem
        For wrong shapes or numbers, and where x is not in S(t).
    ProjectionFailed
        Where a function of the problem fails, or no velocity satisfies all rows; ``status`` says why.

    Source: (1.24), (1.26), (1.27).
    """
    from dincl.mobility import scaling_of

    time, state, allowed = _checked(problem, t, x, tol)
    step = number("spacing", spacing, positive=True)
    target = None if u is None else shaped("u", u, problem.x0.shape)
    with _projection_failures():
        mobility = np.ones(len(state)) if problem.mobility is None else problem.mobility
        target = mobility[:, None] * problem.velocity(time, state) if target is None else target
        rows, gradients = active_rows(problem, time, state, allowed)
        lengths = _lengths(gradients)
        unit = divided(gradients, lengths)
        least = rows.least_speeds(time, state, unit, step)
        # In coordinates in which all particles are equally mobile.
        scaling = scaling_of(state, mobility)
        unit.data *= np.repeat(scaling.root, state.shape[1])[unit.indices]
        scaled = _lengths(unit)
        unit, least, target = divided(unit, scaled), least / scaled, scaling.velocities(target)
        size = max(longest(target), float(np.abs(least).max(initial=0.0)))
        found = nearest(AffineRows(unit, least), target.ravel(), size)
    velocity, multipliers = scaling.root[:, None] * found.rest.reshape(target.shape), found.multipliers
    return TangentVelocity(velocity, multipliers / lengths / scaled / scaling.most, rows.names, size * found.residual)


def cone_at(problem: Problem, t: float, x: NDArray[np.float64], tol: float) -> NormalCone:
    """Compute the normal cone for checked input; StepFailure where a gradient is not defined."""
    rows, gradients = active_rows(problem, t, x, tol)
    count, d = x.shape
    return NormalCone(rows.names, gradients, (count, d))


def active_rows(problem: Problem, t: float, x: NDArray[np.float64], tol: float) -> tuple[Selection, csr_array]:
    """Select the rows with |g_k| <= tol |grad g_k|, and compute their gradients; InvalidProblem if x is not in S(t)."""
    selection = select(problem.constraints, t, x, tol)
    rows = selection.at(t)
    gradients = rows.jacobian(x)
    gaps = rows.values(x) / _lengths(gradients)
    least = float(gaps.min(initial=0.0))
    if least < -tol:
        raise InvalidProblem(f"x lies outside of S by {-least:.3g}, more than tol = {tol:g}: there is no normal cone")
    active = gaps <= tol
    return selection.take(active), gradients[active]


def _lengths(gradients: csr_array) -> NDArray[np.float64]:
    """Compute |grad g_k|, shape (m,), and 1 for a gradient that vanishes."""
    lengths = np.sqrt(row_squares(gradients))
    lengths[lengths == 0] = 1.0
    return lengths


def _checked(problem: Problem, t: float, x: ArrayLike, tol: float) -> tuple[float, NDArray[np.float64], float]:
    """Check a time >= 0, a state of the shape of x0, and a tolerance > 0."""
    instance("problem", problem, Problem, "a dincl.Problem")
    time, allowed = number("t", t, non_negative=True), number("tol", tol, positive=True)
    return time, shaped("x", x, problem.x0.shape), allowed


@contextmanager
def _projection_failures() -> Iterator[None]:
    """Turn a StepFailure into the public ProjectionFailed, and turn off NumPy's warnings: results are checked."""
    try:
        with np.errstate(all="ignore"):
            yield
    except StepFailure as failure:
        raise ProjectionFailed(failure.status, failure.detail) from failure
