"""Search for the constants of prox-regularity and hypomonotonicity of a set, at pairs of its points.

S is eta-prox-regular if and only if n . (y - x) <= |y - x|^2 / (2 eta) for all x, y of S and unit normals n at x
(Definition 1.21, in the equivalent form that (1.28) has with w = 0). The n worst for a pair is the direction of
P_{N(x)}(y - x). Pairs give an upper bound of eta, and a lower bound of the least c with (n_x - n_y) . (x - y) >=
-c |x - y|^2 for normals of length <= 1, which is at most 1/eta. A bottleneck of S that is wider than the distance of
the pairs is not found. Half of the samples are random pairs, each followed by the points to which S bends away the
fastest (the largest eigenvalue of the Hessian of the Lagrangian); the other half climbs on from the worst pair.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from dincl import Problem
from dincl.errors import StepFailure
from dincl.geometry import NEGLIGIBLE, active_rows, cone_at
from dincl.projection.cone import DENSE, split
from dincl.projection.feasible import FeasibleSet
from dincl.projection.quadratic import Daqp, Piqp
from dincl.rows.base import Rows
from dincl.work import Work

Floats = NDArray[np.float64]
# Distance of the pairs [length]: the ratio is off by about its square, and by the tolerance of gaps over that.
DISTANCE, TOL = 1e-3, 1e-12

# Points of S are computed to this part of the tolerance of active rows.
PROJECTED_TO = 0.1
# Pairs closer than this part of the distance are left out: their ratio is rounding over almost nothing.
CLOSEST = 0.1
# The share of the samples that climb from the worst pair so far, and their first step over the distance.
CLIMBING, FIRST_STEP = 0.5, 10.0
# Factors of the step of the climb after success and failure: 1 in 5 successes keep it (Rechenberg).
LONGER, SHORTER = 1.5, 1.5**-0.25
# How far a step goes along the normal, over its random part, so that the contacts stay closed.
PRESS = 3.0
# Random multipliers at each of the points given.
STARTS = 4

# Central differences of the gradients, with this step relative to the largest coordinate: the cube root of rounding.
STEP = float(np.cbrt(np.finfo(float).eps))
# Alternations between the direction and its multipliers; two or three are enough, more polish.
ALTERNATIONS = 6
# Newton steps onto the active rows; from a distance squared three are enough.
NEWTON = 3
# Multipliers below this part of the largest count as zero.
LEAST = 1e-6


class Pair(NamedTuple):
    """Two points of S, (N, d) each, and their ratio."""

    ratio: float
    x: Floats
    y: Floats


def prox_constant(problem: Problem, samples: int, seed: int) -> float:
    """Search around x0 for an upper bound of eta [length]; inf if no pair has n . (y - x) > 0."""
    ratio = Search(problem, two_sided=False, rng=np.random.default_rng(seed)).worst(samples).ratio
    return 1 / (2 * ratio) if ratio else np.inf


def hypomonotonicity(problem: Problem, samples: int, seed: int) -> float:
    """Search around x0 for a lower bound of the constant of hypomonotonicity [1 / length]."""
    return Search(problem, two_sided=True, rng=np.random.default_rng(seed)).worst(samples).ratio


@dataclass(frozen=True, eq=False)
class Search:
    """Search among pairs of points x, y of S at about ``DISTANCE``, near the start of a problem.

    The ratio is |P_{N(x)}(y - x)| / |y - x|^2, if ``two_sided`` (|P_{N(x)}(y - x)| + |P_{N(y)}(x - y)|) / |y - x|^2.
    """

    problem: Problem
    two_sided: bool
    rng: np.random.Generator

    def worst(self, samples: int) -> Pair:
        """Find the pair of largest ratio."""
        x0, pairs = self.problem.x0, list[Pair]()
        for _ in range(STARTS):
            pairs += self._tried(self._bent, x0)
        for _ in range(round((1 - CLIMBING) * samples)):
            pairs += self._tried(self._random, x0)
        best, step = max(pairs, key=lambda pair: pair.ratio), FIRST_STEP * DISTANCE
        for _ in range(round(CLIMBING * samples)):
            better = max(self._tried(self._moved, best, step), key=lambda pair: pair.ratio, default=best)
            step *= LONGER if better.ratio > best.ratio else SHORTER
            best = max(best, better, key=lambda pair: pair.ratio)
        return best

    def outward(self, x: Floats, y: Floats) -> tuple[Floats, float]:
        """Compute the unit normal n at x with the largest n . (y - x), and this product; both 0 if it is not > 0.

        A product no larger than the errors of x, y and the projection onto the cone counts as zero.
        """
        normal = cone_at(self.problem, 0.0, x, TOL).normal_part(y - x)
        size = float(np.sqrt((normal**2).sum()))
        if size <= TOL + NEGLIGIBLE * float(np.sqrt(((y - x) ** 2).sum())):
            return np.zeros_like(x), 0.0
        return normal / size, size

    def _tried(self, make: Callable[..., list[Pair]], *arguments: object) -> list[Pair]:
        """The pairs that ``make`` returns; none if a projection fails."""
        try:
            return make(*arguments)
        except StepFailure:
            return []

    def _random(self, centre: Floats) -> list[Pair]:
        """Two points near a centre, and the first one with the points to which S bends away from it."""
        x = self._nearest(centre + DISTANCE * self._noise())
        return self._pair(x, self._nearest(x + DISTANCE * self._noise())) + self._bent(x)

    def _moved(self, pair: Pair, step: float) -> list[Pair]:
        """Pairs of a point near x, at which the contacts of x are closed, too."""
        press = PRESS * self.outward(pair.x, pair.y)[0]
        return self._bent(self._nearest(pair.x + step * (self._noise() + press)), pair)

    def _bent(self, x: Floats, like: Pair | None = None) -> list[Pair]:
        """Pairs of x, with random multipliers to start with, or with the multipliers of another pair."""
        selection, gradients = active_rows(self.problem, 0.0, x, TOL)
        if not len(selection):
            return []
        multipliers = self.rng.exponential(size=len(selection))
        if like is not None:
            along = cone_at(self.problem, 0.0, x, TOL).multipliers(like.y - like.x)
            multipliers = along if along.max() > 0 else multipliers
        found = climb(selection.at(0.0), gradients, x, multipliers, self._nearest)
        return [pair for y in found for pair in self._pair(x, y)]

    def _pair(self, x: Floats, y: Floats) -> list[Pair]:
        apart = float(np.sqrt(((y - x) ** 2).sum()))
        if apart < CLOSEST * DISTANCE:
            return []
        along = self.outward(x, y)[1] + (self.outward(y, x)[1] if self.two_sided else 0.0)
        return [Pair(along / apart**2, x, y)]

    def _nearest(self, y: Floats) -> Floats:
        solver = (Daqp if y.size <= DENSE else Piqp)(PROJECTED_TO * TOL).solver()
        feasible = FeasibleSet(self.problem, solver, Work(), linearised=False)
        return feasible.nearest(0.0, y, y, 2 * self.problem.violation(0.0, y)).point

    def _noise(self) -> Floats:
        """A random direction, of unit length."""
        noise = self.rng.normal(size=self.problem.x0.shape)
        return np.array(noise / np.sqrt((noise**2).sum()))


def climb(
    rows: Rows,
    gradients: csr_array,
    x: Floats,
    multipliers: Floats,
    nearest: Callable[[Floats], Floats],
) -> list[Floats]:
    r"""Find points of S at about a distance from x to which S bends away from a normal the fastest.

    Along w with |w| = 1 and grad g_k . w = 0 for the rows with lambda_k > 0, the set leaves the tangent plane of the
    normal n = -sum_k lambda_k grad g_k, |n| = 1, by half of c = sum_k lambda_k w^T (Hess g_k) w: a point y of S near x
    has n . (y - x) = |y - x|^2 / (2 eta), 1/eta = max over w of c. This w and the multipliers of the nearest point to
    x + DISTANCE w are improved in turn; each turn raises the ratio.

    Parameters
    ----------
    rows, gradients, multipliers
        The m active rows at x, their gradients, and the multipliers to start with, shape (m,).
    nearest
        The projection onto S.
    """
    dense, hessians = gradients.toarray(), _hessians(rows, x)
    found = []
    for _ in range(ALTERNATIONS):
        active = multipliers > LEAST * multipliers.max()
        w = _direction(dense, hessians, multipliers, active).reshape(x.shape)
        y = x + DISTANCE * w
        for _ in range(NEWTON):
            matrix = rows.jacobian(y).toarray()[active]
            y = y - np.linalg.lstsq(matrix, rows.values(y)[active], rcond=LEAST)[0].reshape(y.shape)
        y = nearest(y)
        found.append(y)
        multipliers = split((x - y).ravel(), gradients).multipliers
        if not multipliers.max(initial=0.0) > 0:
            break
    return found


def _direction(
    gradients: Floats,
    hessians: Floats,
    multipliers: Floats,
    active: NDArray[np.bool_],
) -> Floats:
    """The w (N d,) for multipliers (m,), of unit length."""
    _, sizes, right = np.linalg.svd(gradients[active])
    rank = int((sizes > LEAST * sizes[0]).sum())
    free = right[rank:].T
    if not free.size:
        return np.array(right[-1])
    curvature = free.T @ np.tensordot(multipliers, hessians, 1) @ free
    w: Floats = free @ np.linalg.eigh((curvature + curvature.T) / 2)[1][:, -1]
    return w


def _hessians(rows: Rows, x: Floats) -> Floats:
    """Hess g_k at x, shape (m, N d, N d)."""
    step = STEP * max(1.0, float(np.abs(x).max()))
    columns = []
    for shift in step * np.eye(x.size).reshape(-1, *x.shape):
        ahead, behind = (rows.jacobian(x + sign * shift).toarray() for sign in (1, -1))
        columns.append((ahead - behind) / (2 * step))
    return np.stack(columns, axis=2)
