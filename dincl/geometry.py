"""Normal cones and support functions  (chapter 1, section 4)."""

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
from dincl.matrices import combined
from dincl.norms import length
from dincl.problem import Problem
from dincl.projection.certificate import on_active_rows, row_lengths
from dincl.projection.quadratic import Daqp, Piqp
from dincl.rows.kinds import AffineRows

if TYPE_CHECKING:
    from numpy.typing import ArrayLike
    from scipy.sparse import csr_array

    from dincl.compiled.arrays import Floats
    from dincl.constraints.selection import Name

__all__ = ["NormalCone", "normal_cone", "support"]

# Accuracy relative to |u|, and the number of unknowns up to which a dense active-set method is the faster one.
TOLERANCE, DENSE = 1e-10, 60
# Length of a vector that counts as zero, relative to u.
NEGLIGIBLE = 10 * TOLERANCE
# Weight of multipliers beside distances, relative to the length of rows, where the shortest ones are looked for.
WEIGHT = 1e-4


def split(u: Floats, gradients: csr_array) -> tuple[Floats, Floats]:
    """Moreau's decomposition u = A^T lambda + rest of u (n,), to 1e-10 |u|: lambda (m,) >= 0, and rest (n,).

    The rest is orthogonal to A^T lambda, in the polar cone {z : A z <= 0} of that of the rows of A.
    """
    size, bounds = length(u), np.zeros(gradients.shape[0])
    if size == 0:
        return bounds, u
    projection = Daqp if u.size <= DENSE else Piqp
    target = u[:, None] / size
    found = projection(TOLERANCE).solver().nearest(AffineRows(-gradients, bounds), target, target)
    return size * found.multipliers, size * found.point.ravel()


def distance_to_cone(u: Floats, gradients: csr_array) -> float:
    """min |u - A^T lambda| over lambda >= 0, for u of shape (n,) and the rows of A; accurate to 1e-10 |u|."""
    return length(split(u, gradients)[1])


def shortest_multipliers(u: Floats, gradients: csr_array) -> Floats:
    """The shortest lambda (m,) >= 0 of the nearest point A^T lambda to u, which is unique also for dependent rows.

    The program min |A^T lambda - u|^2 + w^2 |lambda|^2 finds the rows with lambda > 0, and nearly their multipliers;
    the equations A A^T lambda = A u of these rows make A^T lambda exact.
    """
    from scipy.sparse import csr_array, eye_array, hstack

    m = gradients.shape[0]
    if m == 0 or not u.any():
        return np.zeros(m)
    weight = WEIGHT * max(float(np.abs(gradients.data).max(initial=0.0)), 1e-100)
    longer = csr_array(hstack((gradients, -weight * eye_array(m)), format="csr"))
    found, _ = split(np.concatenate((u, np.zeros(m))), longer)
    found[found <= TOLERANCE * found.max(initial=0.0)] = 0.0
    return on_active_rows(AffineRows(gradients, np.zeros(m)), -u, np.zeros(u.size), found)[1]


@dataclass(frozen=True, eq=False)
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
    def generators(self) -> Floats:
        """grad g_k, shape (m, N, d); they point into S, so the cone is spanned by their negatives."""
        generators: Floats = self.matrix.toarray().reshape(-1, *self.shape)
        return generators

    def multipliers(self, u: ArrayLike) -> Floats:
        """Compute lambda (m,) >= 0 of the nearest point of the cone to u, -sum_k lambda_k grad g_k.

        They are unique only if the gradients with lambda_k > 0 are independent.
        """
        return self._split(u)[0]

    def normal_part(self, u: ArrayLike) -> Floats:
        """Compute P_N(u), shape (N, d): the nearest point of the cone to u."""
        return -combined(self.matrix, self._split(u)[0]).reshape(self.shape)

    def tangent_part(self, u: ArrayLike) -> Floats:
        """Compute P_T(u) = u - P_N(u), shape (N, d), with the polar cone T = {v : grad g_k . v >= 0 for all k} of N."""
        return self._split(u)[1]

    def distance(self, u: ArrayLike) -> float:
        """Compute min |u - n| over the n of the cone."""
        return length(self._split(u)[1].ravel())

    def _split(self, u: ArrayLike) -> tuple[Floats, Floats]:
        """Compute the multipliers and the tangent part of u."""
        vector = shaped("u", u, self.shape)
        with _projection_failures():
            multipliers, rest = split(-vector.ravel(), self.matrix)
        return multipliers, -rest.reshape(self.shape)

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
    instance("problem", problem, Problem, "a dincl.Problem")
    time, allowed = number("t", t, non_negative=True), number("tol", tol, positive=True)
    state = shaped("x", x, problem.x0.shape)
    with _projection_failures():
        selection = select(problem.constraints, time, state, allowed)
        rows = selection.at(time)
        gradients = rows.jacobian(state)
        gaps = rows.values(state) / row_lengths(gradients)
    least = float(gaps.min(initial=0.0))
    if least < -allowed:
        raise InvalidProblem(
            f"x lies outside of S by {-least:.3g}, more than tol = {allowed:g}: there is no normal cone"
        )
    active = gaps <= allowed
    return NormalCone(selection.take(active).names, gradients[active], state.shape)


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


@contextmanager
def _projection_failures() -> Iterator[None]:
    """Turn a StepFailure into the public ProjectionFailed, and turn off NumPy's warnings: results are checked."""
    try:
        with np.errstate(all="ignore"):
            yield
    except StepFailure as failure:
        raise ProjectionFailed(failure.status, failure.detail) from failure
