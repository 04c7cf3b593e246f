r"""The three kinds of scalar constraint that every set in this package is made of.

A set S = {x : g_k(x) >= 0 for all k} reaches the schemes and projections as rows g_k of one of these kinds, so that
a new family of constraints needs no new solver. Positions x have shape (N, d); Jacobians have N*d columns, particle
by particle. Multipliers belong to g as written here: the reaction is ``sum_k multipliers_k grad g_k``  (1.26).
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from dincl.callables import call, numbers
from dincl.csr import Csr, csr, stack, uniform
from dincl.errors import StepFailure
from dincl.norms import norms
from dincl.status import Status

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray


class Rows(ABC):
    """Scalar constraints g_k(x) >= 0, k = 1 ... m, on positions x of shape (N, d)."""

    @abstractmethod
    def values(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
        """g(x), shape (m,)."""

    @abstractmethod
    def jacobian(self, x: NDArray[np.float64]) -> Csr:
        """dg/dx at x, m rows and N*d columns; StepFailure where it is not defined."""

    @property
    @abstractmethod
    def structure(self) -> tuple[Any, ...]:
        """A key that is equal for two Rows that differ in numbers only, not in which particles they tie."""

    def linearised(self, x: NDArray[np.float64]) -> AffineRows:
        r"""The inner convex approximation at x, g(x) + dg/dx (z - x) >= 0  (section 1.1.2 of chapter 2)."""
        matrix = self.jacobian(x)
        return AffineRows(matrix, matrix.times(x.ravel()) - self.values(x))


class RowsOfOneKind(Rows):
    """Rows that share one formula; ``len(rows)`` is m."""

    @abstractmethod
    def __len__(self) -> int: ...

    @abstractmethod
    def shifted(self, displacement: NDArray[np.float64]) -> RowsOfOneKind:
        """The rows of the set carried by a displacement of shape (d,)."""

    @abstractmethod
    def take(self, keep: NDArray[np.bool_]) -> RowsOfOneKind:
        """The rows where ``keep`` is true."""

    @abstractmethod
    def label(self, k: int, d: int) -> str:
        """Row k in words, for messages about particles in dimension d."""


@dataclass(frozen=True, eq=False)
class AffineRows(RowsOfOneKind):
    """g(x) = A x - bound >= 0 with x flattened; A sparse, bound of shape (m,)."""

    matrix: Csr
    bound: NDArray[np.float64]

    def __len__(self) -> int:
        return len(self.bound)

    def values(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
        return self.matrix.times(x.ravel()) - self.bound

    def jacobian(self, x: NDArray[np.float64]) -> Csr:
        return self.matrix

    def linearised(self, x: NDArray[np.float64]) -> AffineRows:
        return self

    def shifted(self, displacement: NDArray[np.float64]) -> AffineRows:
        everywhere = np.tile(displacement, self.matrix.columns // len(displacement))
        return replace(self, bound=self.bound + self.matrix.times(everywhere))

    def take(self, keep: NDArray[np.bool_]) -> AffineRows:
        return self if keep.all() else AffineRows(self.matrix.take(keep), self.bound[keep])

    def label(self, k: int, d: int) -> str:
        entries = self.matrix.indices[self.matrix.indptr[k] : self.matrix.indptr[k + 1]]
        return "particle " + " and ".join(str(i) for i in np.unique(entries // d))

    @property
    def structure(self) -> tuple[Any, ...]:
        return ("affine", self.matrix.indptr.tobytes(), self.matrix.indices.tobytes())


@dataclass(frozen=True, eq=False)
class DistanceRows(RowsOfOneKind):
    """g(x) = sign (|X_i - X_j| - length) >= 0, where without ``j`` the fixed point ``anchor`` takes the place of X_j.

    ``sign`` is +1 (keep apart) or -1 (hold together); ``i``, ``j``, ``length`` of shape (m,), ``anchor`` of (m, d).
    """

    i: NDArray[np.int64]
    j: NDArray[np.int64] | None
    length: NDArray[np.float64]
    sign: float
    anchor: NDArray[np.float64] | None = None

    def __len__(self) -> int:
        return len(self.i)

    def arrows(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
        """X_i - X_j, or X_i - anchor, shape (m, d)."""
        other = x[self.j] if self.anchor is None else self.anchor
        return x[self.i] - other

    def values(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
        return self.sign * (norms(self.arrows(x)) - self.length)

    def jacobian(self, x: NDArray[np.float64]) -> Csr:
        arrows = self.arrows(x)
        distance = norms(arrows)
        met = distance == 0
        if met.any() and self.sign > 0:
            raise self.coincidence(int(np.flatnonzero(met)[0]))
        # Held together, two that meet are farthest from violating: zero is a subgradient, and right there.
        return self.entries(arrows * (self.sign / np.where(met, 1.0, distance))[:, None], x.size)

    def coincidence(self, k: int) -> StepFailure:
        """Why row k, which keeps two centres apart, has no direction."""
        other = "a fixed centre" if self.j is None else f"particle {self.j[k]}"
        return StepFailure(Status.COINCIDENT_CENTRES, f"Particle {self.i[k]} lies on {other}.")

    def entries(self, vectors: NDArray[np.float64], columns: int) -> Csr:
        """Rows that hold ``vectors`` (m, d) at particle i and, with the other sign, at particle j."""
        axes = np.arange(vectors.shape[1])
        places = axes + len(axes) * self.i[:, None]
        if self.j is not None:
            places = np.hstack((places, axes + len(axes) * self.j[:, None]))
            vectors = np.hstack((vectors, -vectors))
        return uniform(places, vectors, columns)

    def shifted(self, displacement: NDArray[np.float64]) -> DistanceRows:
        return self if self.anchor is None else replace(self, anchor=self.anchor + displacement)

    def take(self, keep: NDArray[np.bool_]) -> DistanceRows:
        if keep.all():
            return self
        j = None if self.j is None else self.j[keep]
        anchor = None if self.anchor is None else self.anchor[keep]
        return DistanceRows(self.i[keep], j, self.length[keep], self.sign, anchor)

    def label(self, k: int, d: int) -> str:
        return f"particle {self.i[k]}" + ("" if self.j is None else f" and {self.j[k]}")

    @property
    def structure(self) -> tuple[Any, ...]:
        return ("distance", self.sign, self.i.tobytes(), None if self.j is None else self.j.tobytes())


@dataclass(frozen=True, eq=False)
class SmoothRows(RowsOfOneKind):
    """g(x - shift) >= 0 for callables g: (N, d) -> (m,) and jacobian: (N, d) -> (m, N*d), dense or sparse.

    ``total`` is m; ``index`` names the rows taken.
    """

    g: Callable[[NDArray[np.float64]], Any]
    derivative: Callable[[NDArray[np.float64]], Any]
    total: int
    index: NDArray[np.int64]
    shift: NDArray[np.float64] | float = 0.0

    def __len__(self) -> int:
        return len(self.index)

    def values(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
        raw = call("g", Status.CONSTRAINT_FAILED, self.g, x - self.shift)
        return numbers("g", Status.CONSTRAINT_FAILED, raw, (self.total,))[self.index]

    def jacobian(self, x: NDArray[np.float64]) -> Csr:
        from scipy.sparse import csr_array, issparse

        raw = call("jacobian", Status.CONSTRAINT_FAILED, self.derivative, x - self.shift)
        shape = (self.total, x.size)
        if not issparse(raw):
            raw = np.reshape(raw, shape) if np.size(raw) == self.total * x.size else raw
            raw = numbers("jacobian", Status.CONSTRAINT_FAILED, raw, shape)
        elif raw.shape != shape:
            found = f"jacobian returned a sparse matrix of shape {raw.shape}: must have shape {shape}."
            raise StepFailure(Status.CONSTRAINT_FAILED, found)
        rows = csr_array(raw)[self.index]
        data = numbers("jacobian", Status.CONSTRAINT_FAILED, rows.data)
        return csr(rows.indptr.astype(np.int64), rows.indices.astype(np.int64), data, x.size)

    def shifted(self, displacement: NDArray[np.float64]) -> SmoothRows:
        return replace(self, shift=self.shift + displacement)

    def take(self, keep: NDArray[np.bool_]) -> SmoothRows:
        return replace(self, index=self.index[keep])

    def label(self, k: int, d: int) -> str:
        return f"row {self.index[k]} of g"

    @property
    def structure(self) -> tuple[Any, ...]:
        return ("smooth", id(self.g), self.index.tobytes())


@dataclass(frozen=True, eq=False)
class RowsTogether(Rows):
    """Rows of several kinds, one block below the other; ``size`` is N*d."""

    blocks: tuple[RowsOfOneKind, ...]
    size: int

    def values(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.concatenate([np.zeros(0), *(block.values(x) for block in self.blocks)])

    def jacobian(self, x: NDArray[np.float64]) -> Csr:
        return stack([block.jacobian(x) for block in self.blocks], self.size)

    @property
    def structure(self) -> tuple[Any, ...]:
        return tuple(block.structure for block in self.blocks)
