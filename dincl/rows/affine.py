"""Affine rows: walls, orders, and the linearisation of every other kind."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from dincl.matrices import applied, from_equal_rows, row_squares
from dincl.rows.base import RowsOfOneKind, TableRows, coordinates

if TYPE_CHECKING:
    from numpy.typing import NDArray
    from scipy.sparse import csr_array

    from dincl.mobility import Scaling
    from dincl.rows.base import Rows


@dataclass(frozen=True, eq=False)
class AffineRows(RowsOfOneKind):
    """g(x) = A x - bound >= 0 with x flattened; A sparse, bound of shape (m,).

    ``lipschitz`` (m,) is how fast g changes at most while no particle and no set moves faster than 1, None for that of
    A: of scaled rows sets move as before, also those that hold back a heavy particle.
    """

    matrix: csr_array
    bound: NDArray[np.float64]
    lipschitz: NDArray[np.float64] | None = None
    affine = True

    def __len__(self) -> int:
        return len(self.bound)

    def values(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
        return applied(self.matrix, x.ravel()) - self.bound

    def jacobian(self, x: NDArray[np.float64]) -> csr_array:
        return self.matrix

    def take(self, keep: NDArray[np.bool_]) -> AffineRows:
        lipschitz = None if self.lipschitz is None else self.lipschitz[keep]
        return self if keep.all() else AffineRows(self.matrix[keep], self.bound[keep], lipschitz)

    def placed(self, turn: NDArray[np.float64] | None, shift: NDArray[np.float64]) -> RowsOfOneKind:
        if turn is not None:
            return super().placed(turn, shift)
        everywhere = np.tile(shift, self.matrix.shape[1] // len(shift))
        return replace(self, bound=self.bound + self.matrix @ everywhere)

    def scaled(self, scaling: Scaling) -> AffineRows:
        matrix, d = self.matrix.copy(), scaling.origin.shape[1]
        matrix.data *= np.repeat(scaling.root, d)[matrix.indices]
        bound = self.bound - applied(self.matrix, scaling.origin.ravel())
        return AffineRows(matrix, bound, lipschitz_constants(self.matrix, d))

    def keys(self) -> NDArray[np.int64]:
        starts = self.matrix.indptr
        return np.column_stack((self.matrix.indices[starts[:-1]], self.matrix.indices[starts[1:] - 1]))

    def label(self, k: int, d: int) -> str:
        entries = self.matrix.indices[self.matrix.indptr[k] : self.matrix.indptr[k + 1]]
        return "particle " + " and ".join(str(i) for i in np.unique(entries // d))

    def tabulated(self, d: int) -> TableRows:
        from dincl.rows.table import AFFINE

        matrix = self.matrix
        square = row_squares(matrix)
        # A normal of length 1 up to rounding counts as one of length 1, so that nothing is divided by its length.
        square[np.abs(square - 1) <= 4 * np.finfo(float).eps] = 1.0
        lipschitz = lipschitz_constants(matrix, d) if self.lipschitz is None else self.lipschitz
        numbers = {"kind": AFFINE, "j": -1, "length": self.bound, "square": square, "lipschitz": lipschitz}
        return TableRows(numbers, np.diff(matrix.indptr), matrix.indices.astype(np.int64), matrix.data)


def lipschitz_constants(matrix: csr_array, d: int) -> NDArray[np.float64]:
    """Compute sum_i |a_i| of each row a, with a_i the part of particle i: no x moves faster than 1, a . x than this."""
    m, count = matrix.shape[0], matrix.shape[1] // d
    row_of = np.repeat(np.arange(m), np.diff(matrix.indptr))
    parts, part_of = np.unique(row_of * count + matrix.indices // d, return_inverse=True)
    lengths = np.sqrt(np.bincount(part_of, matrix.data**2))
    return np.bincount(parts // count, lengths, minlength=m).astype(np.float64)


class HeightRows(AffineRows):
    """g_k(x) = n . X_i - bound_k >= 0 with a unit normal n (d,) for particles i = ``particle`` (m,), of ``count``."""

    normal: NDArray[np.float64]
    particle: NDArray[np.int64]
    count: int

    def __init__(
        self, normal: NDArray[np.float64], particle: NDArray[np.int64], bound: NDArray[np.float64], count: int
    ) -> None:
        # The base class is a frozen dataclass.
        self.__dict__.update(normal=normal, particle=particle, bound=bound, count=count)

    @cached_property
    def matrix(self) -> csr_array:
        """The normals, one for each row."""
        return from_equal_rows(*self._entries(), len(self.normal) * self.count)

    def values(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
        heights: NDArray[np.float64] = x[self.particle] @ self.normal - self.bound
        return heights

    def take(self, keep: NDArray[np.bool_]) -> HeightRows:
        return HeightRows(self.normal, self.particle[keep], self.bound[keep], self.count)

    def placed(self, turn: NDArray[np.float64] | None, shift: NDArray[np.float64]) -> HeightRows:
        normal = self.normal if turn is None else turn @ self.normal
        return HeightRows(normal, self.particle, self.bound + float(normal @ shift), self.count)

    def label(self, k: int, d: int) -> str:
        return f"particle {self.particle[k]}"

    def tabulated(self, d: int) -> TableRows:
        """Without the matrix, since ``scipy.sparse`` takes long to import."""
        from dincl.rows.table import AFFINE

        columns, normals = self._entries()
        lipschitz = float(np.sqrt(self.normal @ self.normal))
        numbers = {"kind": AFFINE, "j": -1, "length": self.bound, "square": 1.0, "lipschitz": lipschitz}
        return TableRows(numbers, np.full(len(self), d), columns.ravel(), normals.ravel())

    def _entries(self) -> tuple[NDArray[np.int64], NDArray[np.float64]]:
        """Columns and coefficients, shape (m, d)."""
        return coordinates(self.particle[:, None], len(self.normal)), np.tile(self.normal, (len(self), 1))


def linearised(rows: Rows, x: NDArray[np.float64]) -> AffineRows:
    """Return the inner convex approximation at x, g(x) + dg/dx (z - x) >= 0  (section 1.1.2 of chapter 2)."""
    if isinstance(rows, AffineRows):
        return rows
    matrix = rows.jacobian(x)
    return AffineRows(matrix, applied(matrix, x.ravel()) - rows.values(x))
