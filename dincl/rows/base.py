"""Rows, which are scalar constraints g_k(x) >= 0: base classes, tables for compiled code, what PBD projects onto."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from dincl.matrices import stacked

if TYPE_CHECKING:
    from numpy.typing import NDArray
    from scipy.sparse import csr_array

    from dincl.errors import StepFailure
    from dincl.mobility import Scaling


class TableRows(NamedTuple):
    """m rows of one kind, as compiled code reads them; row k has ``entries[k]`` columns and coefficients.

    ``numbers`` maps fields of ``dincl.rows.table.ROW`` to arrays (m,) or to one number for all rows; other fields are
    zero.
    """

    numbers: dict[str, Any]
    entries: NDArray[np.int64]
    column: NDArray[np.int64]
    coefficient: NDArray[np.float64]


class Rows(ABC):
    """Scalar constraints g_k(x) >= 0, k = 1 ... m, on positions x of shape (N, d)."""

    @abstractmethod
    def values(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
        """Compute g(x), shape (m,)."""

    @abstractmethod
    def jacobian(self, x: NDArray[np.float64]) -> csr_array:
        """Compute dg/dx at x, m rows and N*d columns; StepFailure where it is not defined."""

    @abstractmethod
    def by_kind(self) -> tuple[RowsOfOneKind, ...]:
        """Return the same rows in blocks of one kind."""


class RowsOfOneKind(Rows):
    """Rows that share one formula; ``len(rows)`` is m.

    A kind defines the abstract methods, here and in Rows. The others are optional: they make a kind faster.
    """

    # Whether the rows are their own linearisation.
    affine = False

    @property
    def equal(self) -> bool:
        """Whether this is an equality: the second half of the rows are the negatives of the first half."""
        return False

    @property
    def concave(self) -> bool:
        """Whether g is known to be concave, so that its linearisations hold wherever g >= 0."""
        return self.affine

    @abstractmethod
    def __len__(self) -> int: ...

    @abstractmethod
    def take(self, keep: NDArray[np.bool_]) -> RowsOfOneKind:
        """Return the rows where ``keep`` (m,) is true, in their order."""

    def placed(self, turn: NDArray[np.float64] | None, shift: NDArray[np.float64]) -> RowsOfOneKind:
        """Return the rows g(R^T (x - b)) of the set carried by X -> R X + b, R (d, d) a rotation or None, b (d,)."""
        return MappedRows(self, None, shift, turn)

    def scaled(self, scaling: Scaling) -> RowsOfOneKind:
        """Return the rows g(origin + root z) for scaled coordinates z, see ``dincl.mobility``."""
        return MappedRows(self, scaling.root, -scaling.origin)

    @abstractmethod
    def keys(self) -> NDArray[np.int64]:
        """Return two numbers below 2^53 for each row, shape (m, 2), that no other row of its constraint has."""

    @abstractmethod
    def label(self, k: int, d: int) -> str:
        """Describe row k for messages about particles in dimension d."""

    def by_kind(self) -> tuple[RowsOfOneKind, ...]:
        return (self,)

    def tabulated(self, d: int) -> TableRows | None:
        """Return the rows for compiled code, for particles in dimension d; None if compiled code is to call Python."""
        return None

    def squared_steepness(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
        """Compute |grad h| / |grad g| at x, (m,), for h >= 0 where g >= 0 but without roots: 2 |X_i - X_j|."""
        return np.ones(len(self))

    def squared_values(self, values: NDArray[np.float64], steepness: NDArray[np.float64]) -> NDArray[np.float64]:
        """Compute h(x), shape (m,), from g(x) and ``squared_steepness``; h = g if g has no root."""
        return values

    def squared_jacobian(self, x: NDArray[np.float64]) -> csr_array:
        """Compute dh/dx at x."""
        return self.jacobian(x)


@dataclass(frozen=True, eq=False)
class StackedRows(Rows):
    """Rows of several kinds, one block below the other; ``size`` is N*d."""

    blocks: tuple[RowsOfOneKind, ...]
    size: int

    def by_kind(self) -> tuple[RowsOfOneKind, ...]:
        return self.blocks

    def values(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.concatenate([np.zeros(0), *(block.values(x) for block in self.blocks)])

    def jacobian(self, x: NDArray[np.float64]) -> csr_array:
        return stacked([block.jacobian(x) for block in self.blocks], self.size)


@dataclass(frozen=True, eq=False)
class MappedRows(RowsOfOneKind):
    """g((root_i X_i - shift_i) turn) >= 0 for rows g: ``root`` (N,) and ``turn`` (d, d), None for 1."""

    rows: RowsOfOneKind
    root: NDArray[np.float64] | None
    shift: NDArray[np.float64]
    turn: NDArray[np.float64] | None = None

    def __len__(self) -> int:
        return len(self.rows)

    @property
    def equal(self) -> bool:
        return self.rows.equal

    @property
    def concave(self) -> bool:
        return self.rows.concave

    def values(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
        return self.rows.values(self._points(x))

    def jacobian(self, x: NDArray[np.float64]) -> csr_array:
        found = self.rows.jacobian(self._points(x))
        if self.turn is not None:
            from scipy.sparse import csr_array, eye_array, kron

            found = csr_array(found @ kron(eye_array(len(x)), self.turn.T, format="csr"))
            found.sort_indices()
        if self.root is not None:
            found = found.copy()
            found.data *= np.repeat(self.root, x.shape[1])[found.indices]
        return found

    def take(self, keep: NDArray[np.bool_]) -> MappedRows:
        return replace(self, rows=self.rows.take(keep))

    def keys(self) -> NDArray[np.int64]:
        return self.rows.keys()

    def label(self, k: int, d: int) -> str:
        return self.rows.label(k, d)

    def coincidence(self, k: int) -> StepFailure:
        """Return the failure of row k, which has no gradient."""
        rows: Any = self.rows
        failure: StepFailure = rows.coincidence(k)
        return failure

    def _points(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
        points: NDArray[np.float64] = (x if self.root is None else self.root[:, None] * x) - self.shift
        return points if self.turn is None else points @ self.turn


class DiscPairs(NamedTuple):
    """All pairs of discs, i ascending, then j < i ascending, to be separated one after another.

    ``radius`` has shape (m,); ``among`` (m,) are the particles that are discs, None if all particles are. ``scaling``
    and ``box`` are as for ``dincl.rows.kinds.DistanceRows``.
    """

    radius: NDArray[np.float64]
    among: NDArray[np.int64] | None
    box: NDArray[np.float64] | None = None
    scaling: Scaling | None = None

    def scaled(self, scaling: Scaling) -> DiscPairs:
        """Return the discs of scaled coordinates."""
        return self._replace(scaling=scaling)


def nearest_image(arrows: NDArray[np.float64], box: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the shortest of the arrows (m, d) that a periodic box (d,) makes equal; 0: the axis does not repeat."""
    lengths = np.where(box > 0, box, np.inf)
    return arrows - np.where(box > 0, box * np.rint(arrows / lengths), 0.0)


def coordinates(particles: NDArray[np.int64], d: int) -> NDArray[np.int64]:
    """Return the places of particles (m, p) in a flat state, shape (m, p d)."""
    m, p = particles.shape
    return (d * particles[:, :, None] + np.arange(d)).reshape(m, p * d)
