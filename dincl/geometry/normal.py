"""The normal cone at a point, and the support function of what it does to a velocity."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from dincl.checks import array, describe, number
from dincl.constraints.selection import select
from dincl.errors import InvalidProblem, StepFailure
from dincl.geometry.active import checked, closed, failures_told, of_shape
from dincl.matrices import combined, divided, row_squares
from dincl.norms import length
from dincl.projection.cone import TOLERANCE, nearest, split
from dincl.rows.affine import AffineRows

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray
    from scipy.sparse import csr_array

    from dincl.constraints.selection import Name
    from dincl.problem import Problem

# A vector this much shorter than u counts as zero: ten times the accuracy of the projections onto cones.
NEGLIGIBLE = 10 * TOLERANCE


@dataclass(frozen=True, eq=False, repr=False)
class NormalCone:
    """N = {-sum_k lambda_k grad g_k(x) : lambda >= 0} over the m active rows: the outward normals of S at x.

    Vectors u have the shape (N, d) of x. All numbers are accurate to 1e-10 |u|; ProjectionFailed if that is missed.

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
        """lambda (m,) >= 0 of the nearest point of the cone to u, -sum_k lambda_k grad g_k.

        They are unique only where the gradients that push are independent.
        """
        return self._split(u)[0]

    def normal_part(self, u: ArrayLike) -> NDArray[np.float64]:
        """P_N(u), shape (N, d): the nearest point of the cone to u."""
        weights = self._split(u)[0]
        return -combined(self.matrix, weights).reshape(self.shape)

    def tangent_part(self, u: ArrayLike) -> NDArray[np.float64]:
        """P_T(u) = u - P_N(u), shape (N, d), with T = {v : grad g_k . v >= 0 for all k}, the polar cone of N."""
        return self._split(u)[1]

    def distance(self, u: ArrayLike) -> float:
        """min |u - n| over the n of the cone."""
        return _length(self._split(u)[1])

    def contains(self, u: ArrayLike) -> bool:
        """Whether u lies in the cone, to 1e-9 |u|."""
        rest = self._split(u)[1]
        return _length(rest) <= NEGLIGIBLE * _length(np.asarray(u, dtype=np.float64))

    def inverse_triangle(self) -> float:
        """gamma = min |sum_k lambda_k grad g_k| over lambda >= 0 with sum_k lambda_k |grad g_k| = 1, in [0, 1].

        1 for at most one row. Its dual is a least distance, 1/gamma = min |v| with n_k . v >= 1 for the unit gradients
        n_k, which is solved; 0 if there is no such v: then some gradients cancel.
        """
        length = np.sqrt(row_squares(self.matrix))
        if not len(length):
            return 1.0
        if length.min() == 0:
            return 0.0
        unit = divided(self.matrix, length)
        try:
            point = nearest(AffineRows(unit, np.ones(unit.shape[0])), np.zeros(unit.shape[1]), 1.0).rest
        except StepFailure:
            return 0.0
        return 1.0 / _length(point)

    def _split(self, u: ArrayLike) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        vector = array("u", u)
        if vector.shape != self.shape:
            raise InvalidProblem(f"u = {describe(u)}: must be finite numbers of shape {self.shape}")
        with failures_told():
            parts = split(-vector.ravel(), self.matrix)
        return parts.multipliers, -parts.rest.reshape(self.shape)

    def __repr__(self) -> str:
        return f"NormalCone({len(self.names)} active rows, N = {self.shape[0]}, d = {self.shape[1]})"


def normal_cone(problem: Problem, t: float, x: ArrayLike, tol: float) -> NormalCone:
    """N(S(t), x) = {-sum_k lambda_k grad g_k(x) : lambda_k >= 0, lambda_k g_k(x) = 0}.

    Parameters
    ----------
    problem
        Whose constraints are meant.
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
    with failures_told():
        return cone_at(problem, *checked(problem, t, x, tol))


def cone_at(problem: Problem, t: float, x: NDArray[np.float64], tol: float) -> NormalCone:
    """The same for checked input; StepFailure where a gradient is not defined."""
    near = select(problem.constraints, t, x, tol)
    rows = near.at(t)
    matrix = rows.jacobian(x)
    length = np.sqrt(row_squares(matrix))
    keep = closed(rows.values(x) / np.where(length == 0, 1.0, length), tol)
    count, d = x.shape
    return NormalCone(near.take(keep).names, matrix[keep], (count, d))


def support(
    problem: Problem, t: float, x: ArrayLike, direction: ArrayLike, tol: float, radius: float = math.inf
) -> float:
    """sigma(-N(S(t), x) ∩ B_radius(0), w) = sup of v . w over the v of -N with |v| <= radius.

    It is radius |P_{-N}(w)|. Without a radius the cone is unbounded: 0 where w . v <= 0 on all of -N, else inf.

    Parameters
    ----------
    problem, t, x, tol
        As in ``normal_cone``.
    direction
        w, shape (N, d).
    radius
        Of the ball, > 0, or inf.

    Raises
    ------
    InvalidProblem, ProjectionFailed
        As in ``normal_cone``.

    Source: (1.29), used for these sets in Proposition 1.28 and Definition 2.7.
    """
    cone = normal_cone(problem, t, x, tol)
    w = of_shape("direction", direction, problem)
    size = radius if radius == math.inf else number("radius", radius, positive=True)
    along = _length(cone.normal_part(-w))
    if along <= NEGLIGIBLE * _length(w):
        return 0.0
    return size * along


def _length(vector: NDArray[np.float64]) -> float:
    return length(vector.ravel())
