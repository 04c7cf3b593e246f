"""The kinds of rows: affine ones, distances, functions in Python."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache, cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from dincl.callables import UserFunction
from dincl.errors import StepFailure
from dincl.matrices import applied, from_equal_rows, from_rows, row_squares
from dincl.norms import norms
from dincl.rows.base import RowsOfOneKind, TableRows, coordinates, nearest_image
from dincl.status import Status

if TYPE_CHECKING:
    from collections.abc import Callable

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
        return np.where(np.reshape(self.sign, (-1, 1)) < 0, found[:, ::-1], found)

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


@dataclass(frozen=True, eq=False)
class SmoothRows(RowsOfOneKind):
    """g(x) >= 0 for callables g: (N, d) -> (m,) and derivative: (N, d) -> (m, N*d), dense or sparse.

    ``index`` lists the rows taken of the ``total`` rows that g has; ``names`` are the names of the two callables in
    messages; ``negated`` says that the second half of the rows are the negatives of the first.
    """

    g: Callable[[NDArray[np.float64]], Any]
    derivative: Callable[[NDArray[np.float64]], Any]
    total: int
    index: NDArray[np.int64]
    names: tuple[str, str] = ("g", "jacobian")
    negated: bool = False

    def __len__(self) -> int:
        return len(self.index)

    @property
    def equal(self) -> bool:
        return self.negated

    def values(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
        return _function_of_x(self.names[0]).evaluated(self.g, x, shape=(self.total,))[self.index]

    def jacobian(self, x: NDArray[np.float64]) -> csr_array:
        """Check what ``derivative`` returns: real numbers of shape (m, N*d) or (m, N, d), or a sparse matrix."""
        function, shape = _function_of_x(self.names[1]), (self.total, x.size)
        raw = function.call(self.derivative, x)
        if hasattr(raw, "tocsr"):
            if raw.shape != shape:
                function.refuse(f"returned a sparse matrix of shape {raw.shape}: must have shape {shape}.")
            rows = raw.tocsr()[self.index]
            return from_rows(rows.indptr, rows.indices, function.numbers(rows.data), x.size)
        full = function.numbers(raw)
        full = function.numbers(full.reshape(shape) if full.size == self.total * x.size else full, shape)[self.index]
        # All coordinates of a particle that a row touches: rows of one particle are found by equal columns.
        touched = (full.reshape(len(full), *x.shape) != 0).any(axis=2)
        row, column = np.nonzero(np.repeat(touched, x.shape[1], axis=1))
        return from_rows(np.searchsorted(row, np.arange(len(full) + 1)), column, full[row, column], x.size)

    def take(self, keep: NDArray[np.bool_]) -> SmoothRows:
        return replace(self, index=self.index[keep], negated=self.negated and bool(keep.all()))

    def keys(self) -> NDArray[np.int64]:
        return np.column_stack((self.index, self.index))

    def label(self, k: int, d: int) -> str:
        return f"row {self.index[k]} of {self.names[0]}"


def all_rows(
    g: Callable[[NDArray[np.float64]], Any],
    derivative: Callable[[NDArray[np.float64]], Any],
    x: NDArray[np.float64],
    names: tuple[str, str] = ("g", "jacobian"),
    *,
    negated: bool = False,
) -> SmoothRows:
    """Return all rows of g, as many as g has at x (N, d)."""
    total = len(_function_of_x(names[0]).evaluated(g, x, shape=(None,)))
    return SmoothRows(g, derivative, total, np.arange(total), names=names, negated=negated)


@cache
def _function_of_x(name: str) -> UserFunction:
    return UserFunction(name, ("x",), Status.CONSTRAINT_FAILED)
