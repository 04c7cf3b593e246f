"""The search for the pair of points of a set at which a ratio is largest: by chance, by curvature, by climbing."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from dincl.errors import InvalidProblem, StepFailure
from dincl.geometry.active import closed
from dincl.geometry.bending import Bending
from dincl.geometry.normal import NEGLIGIBLE, cone_at
from dincl.matrices import row_squares
from dincl.projection.cone import DENSE
from dincl.projection.daqp import Daqp
from dincl.projection.feasible import FeasibleSet
from dincl.projection.piqp import Piqp
from dincl.work import Work

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from dincl.problem import Problem

# Points of S are found to this part of the gap that counts as closed.
PROJECTED_TO = 0.1
# Pairs closer than this part of the reach are left out: their ratio is rounding over almost nothing.
CLOSEST = 0.1
# Of the samples, the share that climbs from the worst pair so far, and the first length of its steps over the reach.
CLIMBING, FIRST_STEP = 0.5, 10.0
# How the length of a step of the climb changes after success and failure: 1 in 5 successes keep it (Rechenberg).
LONGER, SHORTER = 1.5, 1.5**-0.25
# How hard the contacts of the pair are pressed in a step, over its random part, so that they stay closed.
PRESS = 3.0
# Random multipliers at each of the points given.
STARTS = 4

Ratio = Callable[[float, float, float], float]


class Pair(NamedTuple):
    """Two points of S, (N, d) each, and the ratio there."""

    ratio: float
    x: NDArray[np.float64]
    y: NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Search:
    """Looks at pairs of points of S(t).

    ``ratio`` is a function of |P_{N(x)}(y - x)|, |P_{N(y)}(x - y)| and |y - x|.
    """

    problem: Problem
    t: float
    reach: float
    tol: float
    ratio: Ratio
    rng: np.random.Generator

    def worst(self, points: NDArray[np.float64], samples: int) -> tuple[Pair, int]:
        """The pair of largest ratio from points (K, N, d), and how many pairs there were.

        InvalidProblem if no pair could be made.
        """
        pairs: list[Pair] = []
        for x in points:
            for _ in range(STARTS):
                pairs += self._tried(self._bent, x)
        for sample in range(round((1 - CLIMBING) * samples)):
            pairs += self._tried(self._random, points[sample % len(points)])
        best = max(pairs, key=lambda pair: pair.ratio, default=None)
        if best is None:
            raise InvalidProblem("points: no pair of points of S could be made from them; use another reach")
        return self._climbed(best, pairs, samples)

    def outward(self, x: NDArray[np.float64], y: NDArray[np.float64]) -> tuple[NDArray[np.float64], float]:
        """The unit normal n at x that points to y the most, and n . (y - x); zero both where none does.

        Where that is no more than the errors of x, y and the projection onto the cone, it counts as zero.
        """
        normal = cone_at(self.problem, self.t, x, self.tol).normal_part(y - x)
        size = float(np.sqrt((normal**2).sum()))
        if size <= self.tol + NEGLIGIBLE * float(np.sqrt(((y - x) ** 2).sum())):
            return np.zeros_like(x), 0.0
        return normal / size, size

    def _climbed(self, best: Pair, pairs: list[Pair], samples: int) -> tuple[Pair, int]:
        count, step = len(pairs), FIRST_STEP * self.reach
        for _ in range(round(CLIMBING * samples)):
            made = self._tried(self._moved, best, step)
            count += len(made)
            better = max(made, key=lambda pair: pair.ratio, default=best)
            step *= LONGER if better.ratio > best.ratio else SHORTER
            best = max(best, better, key=lambda pair: pair.ratio)
        return best, count

    def _tried(self, make: Callable[..., list[Pair]], *arguments: object) -> list[Pair]:
        """What ``make`` returns; nothing where a projection fails: such a sample is left out."""
        try:
            return make(*arguments)
        except StepFailure:
            return []

    def _random(self, centre: NDArray[np.float64]) -> list[Pair]:
        """Two points around a centre, as far from each other as the reach, and what the first one bends to."""
        x = self._nearest(centre + self.reach * self._noise())
        return self._pair(x, self._nearest(x + self.reach * self._noise())) + self._bent(x)

    def _moved(self, pair: Pair, step: float) -> list[Pair]:
        """A pair around a point near x, whose contacts have been pressed."""
        press = PRESS * self.outward(pair.x, pair.y)[0]
        return self._bent(self._nearest(pair.x + step * (self._noise() + press)), pair)

    def _bent(self, x: NDArray[np.float64], like: Pair | None = None) -> list[Pair]:
        rows = self.problem.rows_within(self.t, x, self.tol)
        lengths = np.sqrt(row_squares(rows.jacobian(x)))
        keep = closed(rows.values(x) / np.where(lengths == 0, 1.0, lengths), self.tol)
        if not keep.any():
            return []
        weights = self.rng.exponential(size=int(keep.sum()))
        if like is not None:
            along = cone_at(self.problem, self.t, x, self.tol).multipliers(like.y - like.x)
            weights = along if along.max() > 0 else weights
        found = Bending(rows, keep, x).climb(weights, self.reach, self._nearest)
        return [pair for y in found for pair in self._pair(x, y)]

    def _pair(self, x: NDArray[np.float64], y: NDArray[np.float64]) -> list[Pair]:
        apart = float(np.sqrt(((y - x) ** 2).sum()))
        if apart < CLOSEST * self.reach:
            return []
        return [Pair(self.ratio(self.outward(x, y)[1], self.outward(y, x)[1], apart), x, y)]

    def _nearest(self, y: NDArray[np.float64]) -> NDArray[np.float64]:
        solver = (Daqp if y.size <= DENSE else Piqp)(PROJECTED_TO * self.tol).solver()
        feasible = FeasibleSet(self.problem, solver, Work(), linearised=False)
        return feasible.nearest(self.t, y, y, 2 * self.problem.violation(self.t, y)).point

    def _noise(self) -> NDArray[np.float64]:
        """A random direction, of unit length."""
        noise = self.rng.normal(size=self.problem.x0.shape)
        return np.array(noise / np.sqrt((noise**2).sum()))
