"""Distances of two particles, or of a particle and a fixed point, with a least or a greatest value, or both."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from dincl.errors import StepFailure
from dincl.matrices import from_equal_rows
from dincl.norms import norms
from dincl.rows.base import RowsOfOneKind, TableRows, coordinates, nearest_image
from dincl.status import Status

if TYPE_CHECKING:
    from numpy.typing import NDArray
    from scipy.sparse import csr_array

    from dincl.mobility import Scaling


@dataclass(frozen=True, eq=False)
class DistanceRows(RowsOfOneKind):
    """g(x) = sign (|s_i X_i - s_j X_j - anchor| - length) >= 0; without ``j`` there is no X_j.

    ``sign`` is +1 (keep apart) or -1 (hold together), one or one each; ``i``, ``j``, ``length`` have shape (m,),
    ``anchor`` (m, d), None for 0. ``scale`` (m, 2) are s_i and s_j, None for 1: see ``dincl.mobility``. In a
    periodic ``box`` (d,), 0 for axes that do not repeat, the arrow is the shortest one to an image.
    """

    i: NDArray[np.int64]
    j: NDArray[np.int64] | None
    length: NDArray[np.float64]
    sign: Any
    anchor: NDArray[np.float64] | None = None
    scale: NDArray[np.float64] | None = None
    box: NDArray[np.float64] | None = None

    def __len__(self) -> int:
        return len(self.i)

    @property
    def concave(self) -> bool:
        return bool(np.all(self.sign < 0)) and self.box is None

    @property
    def plain(self) -> bool:
        """Whether both scales are 1 and nothing is periodic."""
        return self.scale is None and self.box is None

    @property
    def equal(self) -> bool:
        """Whether the second half of the rows are the negatives of the first half."""
        half = len(self) // 2
        return bool(np.ndim(self.sign) and half and (self.sign[:half] > 0).all() and (self.sign[half:] < 0).all())

    def arrows(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
        """Compute s_i X_i - s_j X_j - anchor, shape (m, d)."""
        found, other = x.take(self.i, axis=0), None if self.j is None else x.take(self.j, axis=0)
        if self.scale is not None:
            found = found * self.scale[:, :1]
            other = None if other is None else other * self.scale[:, 1:]
        found = found if other is None else found - other
        found = found if self.anchor is None else found - self.anchor
        return found if self.box is None else nearest_image(found, self.box)

    def values(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
        found: NDArray[np.float64] = self.sign * (norms(self.arrows(x)) - self.length)
        return found

    def jacobian(self, x: NDArray[np.float64]) -> csr_array:
        """Compute the unit vectors along the distances; StepFailure where two that are kept apart coincide."""
        arrows = self.arrows(x)
        distance = norms(arrows)
        coincident = distance == 0
        stuck = coincident & (self.sign > 0)
        if stuck.any():
            raise self.coincidence(int(np.flatnonzero(stuck)[0]))
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
        anchor, scale = (None if one is None else one[keep] for one in (self.anchor, self.scale))
        sign = self.sign[keep] if np.ndim(self.sign) else self.sign
        return DistanceRows(self.i[keep], j, self.length[keep], sign, anchor, scale, self.box)

    def placed(self, turn: NDArray[np.float64] | None, shift: NDArray[np.float64]) -> DistanceRows:
        if self.j is not None:
            return self
        anchor: NDArray[np.float64] = np.asarray(self.anchor)
        return replace(self, anchor=(anchor if turn is None else anchor @ turn.T) + shift)

    def scaled(self, scaling: Scaling) -> DistanceRows:
        anchor = np.zeros((len(self), scaling.origin.shape[1])) if self.anchor is None else self.anchor
        anchor, scale = anchor - scaling.origin[self.i], np.ones((len(self), 2))
        scale[:, 0] = scaling.root[self.i]
        if self.j is not None:
            anchor, scale[:, 1] = anchor + scaling.origin[self.j], scaling.root[self.j]
        return replace(self, anchor=anchor, scale=scale)

    def keys(self) -> NDArray[np.int64]:
        """Rows of one pair with opposite signs have keys of opposite order."""
        found = np.column_stack((self.i, self.i if self.j is None else self.j))
        return np.where((np.ndim(self.sign) > 0) & (np.reshape(self.sign, (-1, 1)) < 0), found[:, ::-1], found)

    def label(self, k: int, d: int) -> str:
        return f"particle {self.i[k]}" + ("" if self.j is None else f" and {self.j[k]}")

    def tabulated(self, d: int) -> TableRows:
        from dincl.rows.table import DISTANCE

        ends = 1 if self.j is None else 2
        coefficient = np.zeros((len(self), ends * d))
        if self.anchor is not None:
            coefficient[:, :d] = self.anchor
        scale = np.ones((len(self), ends)) if self.scale is None else self.scale[:, :ends]
        numbers = {
            "kind": DISTANCE,
            "i": self.i,
            "j": -1 if self.j is None else self.j,
            "length": self.length,
            "sign": self.sign,
            "square": (scale**2).sum(axis=1),
            # Scaled particles move less, but sets as before.
            "lipschitz": float(ends),
            "one": scale[:, 0],
            "other": scale[:, -1],
            "plain": self.plain,
        }
        return TableRows(numbers, np.full(len(self), ends * d), self._columns(d).ravel(), coefficient.ravel())

    def squared_steepness(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
        return 2 * norms(self.arrows(x))

    def squared_values(self, values: NDArray[np.float64], steepness: NDArray[np.float64]) -> NDArray[np.float64]:
        """With r = |X_i - X_j|, sign (r^2 - L^2) = g (r + L) = g (2 r - sign g)."""
        found: NDArray[np.float64] = values * (steepness - self.sign * values)
        return found

    def squared_jacobian(self, x: NDArray[np.float64]) -> csr_array:
        return self._matrix(2 * np.reshape(self.sign, (-1, 1)) * self.arrows(x), x.size)

    def _columns(self, d: int) -> NDArray[np.int64]:
        """The coordinates of both ends, or of the free end, shape (m, 2 d) or (m, d)."""
        return coordinates(self.i[:, None] if self.j is None else np.column_stack((self.i, self.j)), d)

    def _matrix(self, vectors: NDArray[np.float64], columns: int) -> csr_array:
        """Rows that hold s_i ``vectors`` (m, d) at particle i and -s_j ``vectors`` at particle j."""
        one, other = (vectors, vectors) if self.scale is None else (vectors * self.scale[:, k, None] for k in range(2))
        data = one if self.j is None else np.hstack((one, -other))
        return from_equal_rows(self._columns(vectors.shape[1]), data, columns)
