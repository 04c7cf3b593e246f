"""Distances of two particles, or of a particle and a fixed point, with a least or a greatest value."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from dincl.errors import StepFailure
from dincl.matrices import from_equal_rows
from dincl.norms import norms
from dincl.rows.base import RowsOfOneKind, TableRows, coordinates
from dincl.status import Status

if TYPE_CHECKING:
    from numpy.typing import NDArray
    from scipy.sparse import csr_array


@dataclass(frozen=True, eq=False)
class DistanceRows(RowsOfOneKind):
    """g(x) = sign (|X_i - X_j| - length) >= 0; without ``j`` the fixed point ``anchor`` takes the place of X_j.

    ``sign`` is +1 (keep apart) or -1 (hold together); ``i``, ``j``, ``length`` of shape (m,), ``anchor`` of (m, d).
    """

    i: NDArray[np.int64]
    j: NDArray[np.int64] | None
    length: NDArray[np.float64]
    sign: float
    anchor: NDArray[np.float64] | None = None

    def __len__(self) -> int:
        return len(self.i)

    @property
    def concave(self) -> bool:
        return self.sign < 0

    def arrows(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
        """Compute X_i - X_j, or X_i - anchor, shape (m, d)."""
        own = x.take(self.i, axis=0)
        return own - (np.asarray(self.anchor) if self.j is None else x.take(self.j, axis=0))

    def values(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
        return self.sign * (norms(self.arrows(x)) - self.length)

    def jacobian(self, x: NDArray[np.float64]) -> csr_array:
        """Compute the unit vectors along the distances; StepFailure where two that are kept apart coincide."""
        arrows = self.arrows(x)
        distance = norms(arrows)
        coincident = distance == 0
        if coincident.any() and self.sign > 0:
            raise self.coincidence(int(np.flatnonzero(coincident)[0]))
        # Where two that are held together coincide, zero is a subgradient.
        return self._matrix(arrows * (self.sign / np.where(coincident, 1.0, distance))[:, None], x.size)

    def coincidence(self, k: int) -> StepFailure:
        """Return the failure of row k, which has no gradient, because its ends coincide."""
        other = "a fixed centre" if self.j is None else f"particle {self.j[k]}"
        return StepFailure(Status.COINCIDENT_CENTRES, f"Particle {self.i[k]} lies on {other}.")

    def take(self, keep: NDArray[np.bool_]) -> DistanceRows:
        if keep.all():
            return self
        j = None if self.j is None else self.j[keep]
        anchor = None if self.anchor is None else self.anchor[keep]
        return DistanceRows(self.i[keep], j, self.length[keep], self.sign, anchor)

    def shifted(self, displacement: NDArray[np.float64]) -> DistanceRows:
        return self if self.anchor is None else replace(self, anchor=self.anchor + displacement)

    def placed(self, turn: NDArray[np.float64], shift: NDArray[np.float64]) -> DistanceRows:
        return self if self.anchor is None else replace(self, anchor=self.anchor @ turn.T + shift)

    def keys(self) -> NDArray[np.int64]:
        return np.column_stack((self.i, self.i if self.j is None else self.j))

    def label(self, k: int, d: int) -> str:
        return f"particle {self.i[k]}" + ("" if self.j is None else f" and {self.j[k]}")

    def tabulated(self, d: int) -> TableRows:
        from dincl.rows.table import DISTANCE

        ends = 1 if self.j is None else 2
        coefficient = np.zeros((len(self), 2 * d)) if self.anchor is None else np.asarray(self.anchor)
        numbers = {
            "kind": DISTANCE,
            "i": self.i,
            "j": -1 if self.j is None else self.j,
            "length": self.length,
            "sign": self.sign,
            "square": ends,
            "lipschitz": ends,
        }
        return TableRows(numbers, np.full(len(self), ends * d), self._columns(d).ravel(), coefficient.ravel())

    def squared_steepness(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
        return 2 * norms(self.arrows(x))

    def squared_values(self, values: NDArray[np.float64], steepness: NDArray[np.float64]) -> NDArray[np.float64]:
        """With r = |X_i - X_j|, sign (r^2 - L^2) = g (r + L) = g (2 r - sign g)."""
        return values * (steepness - self.sign * values)

    def squared_jacobian(self, x: NDArray[np.float64]) -> csr_array:
        return self._matrix(2 * self.sign * self.arrows(x), x.size)

    def _columns(self, d: int) -> NDArray[np.int64]:
        """The coordinates of both ends, or of the free end, shape (m, 2 d) or (m, d)."""
        return coordinates(self.i[:, None] if self.j is None else np.column_stack((self.i, self.j)), d)

    def _matrix(self, vectors: NDArray[np.float64], columns: int) -> csr_array:
        """Rows that hold ``vectors`` (m, d) at particle i and, with the other sign, at particle j."""
        data = vectors if self.j is None else np.hstack((vectors, -vectors))
        return from_equal_rows(self._columns(vectors.shape[1]), data, columns)
