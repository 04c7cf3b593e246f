"""Gauss-Seidel sweeps: exact projections onto the single constraints of one family, one after another, in place.

This is (2.5) and (2.9), ``P_{S_M} ... P_{S_1}``; the order is that of the rows. A sweeper belongs to one run: it may
keep a neighbour list, on which its result does not depend.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from dincl import kernels
from dincl.errors import StepFailure
from dincl.pairs import near_pairs
from dincl.status import Status

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from dincl.constraints.rows import AffineRows, DistanceRows, SmoothRows
    from dincl.work import Work

# First width of the neighbour list beyond contact, in smallest radii; then adapted so that a list serves
# FEWEST ... MOST sweeps, by doubling and halving.
FIRST_SKIN = 0.05
WIDEST_SKIN = 1.0
FEWEST, MOST = 16, 128
# A smooth row is projected until a step moves less than this, relative to the first or to x; never more than LIMIT.
NEWTON_TOLERANCE = 1e-13
NEWTON_LIMIT = 50


class Sweeper(ABC):
    """The projections onto the rows of one family; an ``idle`` one has no rows, and need not be asked."""

    idle = False

    @abstractmethod
    def sweep(self, x: NDArray[np.float64], work: Work) -> None:
        """Project x (N, d) onto row after row, in place; StepFailure where a projection has no direction."""


class PairSweeper(Sweeper):
    """Example 2.5 for discs: i ascending, then j < i ascending; each overlapping pair parts by half the overlap each.

    The neighbour list holds all pairs closer than the sum of their radii plus 2 ``skin``. It is complete while no
    disc is farther than ``skin`` from where the list was made, also in the middle of a sweep; when one is, the sweep
    is undone and repeated with a new list. So the result is that of looking at all pairs.

    ``among`` names the particles that are the discs, for which ``radius`` is given, shape (n,); None: all of them.
    """

    def __init__(self, radius: NDArray[np.float64], among: NDArray[np.int64] | None = None) -> None:
        smallest = float(radius.min(initial=np.inf))
        self._radius, self._among = radius, among
        self._skin = FIRST_SKIN * smallest
        self._widest = WIDEST_SKIN * smallest
        self._served = 0
        self._pairs: _Pairs | None = None

    def sweep(self, x: NDArray[np.float64], work: Work) -> None:
        if self._among is None:
            self._sweep(x, work)
        else:
            discs = x[self._among]
            self._sweep(discs, work)
            x[self._among] = discs

    def _sweep(self, x: NDArray[np.float64], work: Work) -> None:
        pairs = self._pairs
        if pairs is None or kernels.sweeps.drifted(x, pairs.reference, self._skin, pairs.backup):
            pairs = self._renewed(x, work)
        while True:
            corrections, code, i, j = kernels.sweeps.sweep_pairs(
                x, pairs.start, pairs.partner, self._radius, pairs.reference, self._skin
            )
            if code != kernels.sweeps.STALE:
                break
            x[:] = pairs.backup
            pairs = self._renewed(x, work)
        work.candidate_pairs += len(pairs.partner)
        work.constraint_projections += corrections
        self._served += 1
        if code == kernels.sweeps.COINCIDENT:
            if self._among is not None:
                i, j = self._among[i], self._among[j]
            raise StepFailure(Status.COINCIDENT_CENTRES, f"Particles {i} and {j} lie on one point.")

    def _renewed(self, x: NDArray[np.float64], work: Work) -> _Pairs:
        """A new list around x; the width aims at FEWEST ... MOST sweeps, and doubles when it did not last for one."""
        if self._pairs is not None:
            if self._served == 0 or (self._served < FEWEST and 2 * self._skin <= self._widest):
                self._skin *= 2
            elif self._served > MOST:
                self._skin /= 2
        start, partner = near_pairs(x, self._radius + self._skin)
        self._pairs, self._served = _Pairs(start, partner, x.copy(), x.copy()), 0
        work.neighbour_builds += 1
        return self._pairs


class _Pairs(NamedTuple):
    """Near pairs in rows, the positions for which they were listed, and room for the positions before a sweep."""

    start: NDArray[np.int64]
    partner: NDArray[np.int32]
    reference: NDArray[np.float64]
    backup: NDArray[np.float64]


class WallSweeper(Sweeper):
    """One wall n . X_i >= bound_i, i ascending."""

    def __init__(self, normal: NDArray[np.float64], bound: NDArray[np.float64]) -> None:
        self._normal, self._bound = normal, bound

    def sweep(self, x: NDArray[np.float64], work: Work) -> None:
        work.constraint_projections += kernels.sweeps.sweep_half_space(x, self._normal, self._bound)


class AffineSweeper(Sweeper):
    """Rows a . x >= b in their order: a violated one moves x by (b - a . x) a / |a|^2."""

    def __init__(self, rows: AffineRows) -> None:
        self._matrix, self._bound = rows.matrix, rows.bound
        self.idle = len(rows.bound) == 0
        self._norm2 = rows.matrix.norms_squared()

    def sweep(self, x: NDArray[np.float64], work: Work) -> None:
        matrix = self._matrix
        work.constraint_projections += kernels.sweeps.sweep_affine(
            x.reshape(-1), matrix.indptr, matrix.indices, matrix.data, self._bound, self._norm2
        )


class DistanceSweeper(Sweeper):
    """Distance rows in their order: both ends move half the way, or the free end the whole way from an anchor."""

    def __init__(self, rows: DistanceRows, d: int) -> None:
        self._rows = rows
        self.idle = len(rows.i) == 0
        self._j = np.full(len(rows.i), -1) if rows.j is None else rows.j
        self._anchor = np.zeros((0, d)) if rows.anchor is None else rows.anchor

    def sweep(self, x: NDArray[np.float64], work: Work) -> None:
        rows = self._rows
        corrections, code, row = kernels.sweeps.sweep_distance(x, rows.i, self._j, rows.length, rows.sign, self._anchor)
        work.constraint_projections += corrections
        if code == kernels.sweeps.COINCIDENT:
            raise rows.coincidence(row)


class SmoothSweeper(Sweeper):
    """Nearest point of {g_k >= 0} for one row k after another, by relinearising at the point reached.

    The fixed point x = y + multiplier grad g_k(x) with g_k(x) = 0 is the nearest point of a violated set; the
    footnote to Method 2.2 stops after the first of these Gauss-Newton steps, which is exact for affine rows only.
    """

    def __init__(self, rows: SmoothRows) -> None:
        self._rows = [rows.take(rows.index == k) for k in rows.index]

    def sweep(self, x: NDArray[np.float64], work: Work) -> None:
        for row in self._rows:
            if row.values(x)[0] < 0:
                x[:] = _nearest(row, x.copy())
                work.constraint_projections += 1


def _nearest(row: SmoothRows, y: NDArray[np.float64]) -> NDArray[np.float64]:
    x, first = y, 0.0
    for _ in range(NEWTON_LIMIT):
        linear = row.linearised(x)
        gradient = linear.matrix.dense()
        norm2 = float((gradient * gradient).sum())
        if norm2 == 0:
            raise StepFailure(Status.CONSTRAINT_FAILED, "A violated Smooth constraint has gradient zero.")
        lack = max(float(linear.bound[0] - gradient[0] @ y.ravel()), 0.0)
        nearer = y + (lack / norm2 * gradient).reshape(y.shape)
        moved = float(np.abs(nearer - x).max())
        first = first or moved
        x = nearer
        if moved <= NEWTON_TOLERANCE * max(first, float(np.abs(x).max())):
            return x
    raise StepFailure(
        Status.NOT_CONVERGED, f"The projection onto a Smooth constraint took more than {NEWTON_LIMIT} steps."
    )
