"""The pairs of discs that are near each other, and the sweep over those that overlap."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from dincl import kernels
from dincl.errors import StepFailure
from dincl.rows.distance import DistanceRows
from dincl.rows.sweeper import Sweeper, SweptRows
from dincl.status import Status

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from dincl.work import Work

# First width of the neighbour list beyond contact, in smallest radii; then adapted so that a list serves
# FEWEST ... MOST sweeps, by doubling and halving.
FIRST_SKIN = 0.05
WIDEST_SKIN = 1.0
FEWEST, MOST = 16, 128


def near_pairs(x: NDArray[np.float64], reach: NDArray[np.float64]) -> tuple[NDArray[np.int64], NDArray[np.int32]]:
    """All (i, j < i) with |X_i - X_j| <= reach_i + reach_j, by rows, as in ``kernels.neighbours.near_pairs``."""
    try:
        found: tuple[NDArray[np.int64], NDArray[np.int32]] = kernels.neighbours.near_pairs(x, reach)
    except kernels.neighbours.TooManyPairs:
        most = kernels.neighbours.MOST_PAIRS
        raise StepFailure(Status.CROWDED, f"More than {most:,} pairs of particles are near each other.") from None
    return found


def all_pairs(radius: NDArray[np.float64], among: NDArray[np.int64] | None = None) -> DistanceRows:
    """|X_i - X_j| >= r_i + r_j for all pairs of discs, i ascending, for each i its j < i ascending.

    ``radius`` is that of the discs, shape (n,), ``among`` names them; None: they are all particles.
    """
    i, j = np.tril_indices(len(radius), -1)
    length = radius[i] + radius[j]
    return DistanceRows(i, j, length, 1.0) if among is None else DistanceRows(among[i], among[j], length, 1.0)


def coincidence(i: int, j: int) -> StepFailure:
    """Why two discs with one centre cannot be parted."""
    return StepFailure(Status.COINCIDENT_CENTRES, f"Particles {i} and {j} lie on one point.")


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

    @property
    def swept(self) -> SweptRows:
        return SweptRows("pairs", all_pairs(self._radius, self._among))

    def sweep(self, t: float, x: NDArray[np.float64], work: Work) -> None:
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
            raise coincidence(int(i), int(j))

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
