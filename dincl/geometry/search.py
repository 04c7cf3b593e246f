"""The search for the pair of points of a set at which a ratio is largest: random, by curvature, by climbing."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from dincl.errors import InvalidProblem, StepFailure
from dincl.geometry.cones import NEGLIGIBLE, active_rows, cone_at
from dincl.projection.cone import DENSE, split
from dincl.projection.daqp import Daqp
from dincl.projection.feasible import FeasibleSet
from dincl.projection.piqp import Piqp
from dincl.work import Work

if TYPE_CHECKING:
    from numpy.typing import NDArray
    from scipy.sparse import csr_array

    from dincl.problem import Problem
    from dincl.rows.base import Rows

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
    x: NDArray[np.float64]
    y: NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Search:
    """Search among pairs of points x, y of S(t) at about the given distance.

    The ratio is |P_{N(x)}(y - x)| / |y - x|^2, if ``two_sided`` (|P_{N(x)}(y - x)| + |P_{N(y)}(x - y)|) / |y - x|^2.
    """

    problem: Problem
    t: float
    distance: float
    tol: float
    two_sided: bool
    rng: np.random.Generator

    def worst(self, points: NDArray[np.float64], samples: int) -> tuple[Pair, int]:
        """Find the pair of largest ratio from points (K, N, d); return it and the number of pairs.

        InvalidProblem if there is no pair.
        """
        pairs: list[Pair] = []
        for x in points:
            for _ in range(STARTS):
                pairs += self._tried(self._bent, x)
        for sample in range(round((1 - CLIMBING) * samples)):
            pairs += self._tried(self._random, points[sample % len(points)])
        best = max(pairs, key=lambda pair: pair.ratio, default=None)
        if best is None:
            raise InvalidProblem("points: no pair of points of S could be made from them; use another distance")
        count, step = len(pairs), FIRST_STEP * self.distance
        for _ in range(round(CLIMBING * samples)):
            made = self._tried(self._moved, best, step)
            count += len(made)
            better = max(made, key=lambda pair: pair.ratio, default=best)
            step *= LONGER if better.ratio > best.ratio else SHORTER
            best = max(best, better, key=lambda pair: pair.ratio)
        return best, count

    def outward(self, x: NDArray[np.float64], y: NDArray[np.float64]) -> tuple[NDArray[np.float64], float]:
        """Compute the unit normal n at x with the largest n . (y - x), and this product; both 0 if it is not > 0.

        A product no larger than the errors of x, y and the projection onto the cone counts as zero.
        """
        normal = cone_at(self.problem, self.t, x, self.tol).normal_part(y - x)
        size = float(np.sqrt((normal**2).sum()))
        if size <= self.tol + NEGLIGIBLE * float(np.sqrt(((y - x) ** 2).sum())):
            return np.zeros_like(x), 0.0
        return normal / size, size

    def _tried(self, make: Callable[..., list[Pair]], *arguments: object) -> list[Pair]:
        """The pairs that ``make`` returns; none if a projection fails."""
        try:
            return make(*arguments)
        except StepFailure:
            return []

    def _random(self, centre: NDArray[np.float64]) -> list[Pair]:
        """Two points near a centre, and the first one with the points to which S bends away from it."""
        x = self._nearest(centre + self.distance * self._noise())
        return self._pair(x, self._nearest(x + self.distance * self._noise())) + self._bent(x)

    def _moved(self, pair: Pair, step: float) -> list[Pair]:
        """Pairs of a point near x, at which the contacts of x are closed, too."""
        press = PRESS * self.outward(pair.x, pair.y)[0]
        return self._bent(self._nearest(pair.x + step * (self._noise() + press)), pair)

    def _bent(self, x: NDArray[np.float64], like: Pair | None = None) -> list[Pair]:
        """Pairs of x, with random multipliers to start with, or with the multipliers of another pair."""
        selection, gradients = active_rows(self.problem, self.t, x, self.tol)
        if not len(selection):
            return []
        multipliers = self.rng.exponential(size=len(selection))
        if like is not None:
            along = cone_at(self.problem, self.t, x, self.tol).multipliers(like.y - like.x)
            multipliers = along if along.max() > 0 else multipliers
        found = climb(selection.at(self.t), gradients, x, multipliers, self.distance, self._nearest)
        return [pair for y in found for pair in self._pair(x, y)]

    def _pair(self, x: NDArray[np.float64], y: NDArray[np.float64]) -> list[Pair]:
        apart = float(np.sqrt(((y - x) ** 2).sum()))
        if apart < CLOSEST * self.distance:
            return []
        along = self.outward(x, y)[1] + (self.outward(y, x)[1] if self.two_sided else 0.0)
        return [Pair(along / apart**2, x, y)]

    def _nearest(self, y: NDArray[np.float64]) -> NDArray[np.float64]:
        solver = (Daqp if y.size <= DENSE else Piqp)(PROJECTED_TO * self.tol).solver()
        feasible = FeasibleSet(self.problem, solver, Work(), linearised=False)
        return feasible.nearest(self.t, y, y, 2 * self.problem.violation(self.t, y)).point

    def _noise(self) -> NDArray[np.float64]:
        """A random direction, of unit length."""
        noise = self.rng.normal(size=self.problem.x0.shape)
        return np.array(noise / np.sqrt((noise**2).sum()))


def climb(
    rows: Rows,
    gradients: csr_array,
    x: NDArray[np.float64],
    multipliers: NDArray[np.float64],
    distance: float,
    nearest: Callable[[NDArray[np.float64]], NDArray[np.float64]],
) -> list[NDArray[np.float64]]:
    r"""Find points of S at about a distance from x to which S bends away from a normal the fastest.

    Along w with |w| = 1 and grad g_k . w = 0 for the rows with lambda_k > 0, the set leaves the tangent plane of the
    normal n = -sum_k lambda_k grad g_k, |n| = 1, by half of c = sum_k lambda_k w^T (Hess g_k) w: a point y of S near x
    has n . (y - x) = |y - x|^2 / (2 eta), 1/eta = max over w of c. This w and the multipliers of the nearest point to
    x + distance w are improved in turn; each turn raises the ratio.

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
        y = x + distance * w
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
    gradients: NDArray[np.float64],
    hessians: NDArray[np.float64],
    multipliers: NDArray[np.float64],
    active: NDArray[np.bool_],
) -> NDArray[np.float64]:
    """The w (N d,) for multipliers (m,), of unit length."""
    _, sizes, right = np.linalg.svd(gradients[active])
    rank = int((sizes > LEAST * sizes[0]).sum())
    free = right[rank:].T
    if not free.size:
        return np.array(right[-1])
    curvature = free.T @ np.tensordot(multipliers, hessians, 1) @ free
    w: NDArray[np.float64] = free @ np.linalg.eigh((curvature + curvature.T) / 2)[1][:, -1]
    return w


def _hessians(rows: Rows, x: NDArray[np.float64]) -> NDArray[np.float64]:
    """Hess g_k at x, shape (m, N d, N d)."""
    step = STEP * max(1.0, float(np.abs(x).max()))
    columns = []
    for shift in step * np.eye(x.size).reshape(-1, *x.shape):
        ahead, behind = (rows.jacobian(x + sign * shift).toarray() for sign in (1, -1))
        columns.append((ahead - behind) / (2 * step))
    return np.stack(columns, axis=2)
