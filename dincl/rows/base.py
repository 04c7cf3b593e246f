"""What rows are, and what a kind of row has to offer."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray
    from scipy.sparse import csr_array

    from dincl.rows.polynomial import Polynomial


class TableRows(NamedTuple):
    """Rows of one kind as compiled code reads them, m of them; ``entries`` counts those of each row.

    ``numbers`` maps names of fields of ``kernels.table.ROW`` to arrays (m,); what is missing is zero.
    """

    numbers: dict[str, Any]
    entries: NDArray[np.int64]
    column: NDArray[np.int64]
    coefficient: NDArray[np.float64]


class Rows(ABC):
    """Scalar constraints g_k(x) >= 0, k = 1 ... m, on positions x of shape (N, d)."""

    @abstractmethod
    def values(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
        """g(x), shape (m,)."""

    @abstractmethod
    def jacobian(self, x: NDArray[np.float64]) -> csr_array:
        """dg/dx at x, m rows and N*d columns; StepFailure where it is not defined."""

    @abstractmethod
    def by_kind(self) -> tuple[RowsOfOneKind, ...]:
        """The same rows, in blocks of one kind."""

    @property
    @abstractmethod
    def structure(self) -> tuple[Any, ...]:
        """A key that is equal for two Rows whose nonlinear programs differ in numbers only."""


class RowsOfOneKind(Rows):
    """Rows that share one formula; ``len(rows)`` is m.

    A kind must have the abstract methods, here and in Rows. The others say what else is known of its formula; they may
    stay as they are, which costs speed and not correctness.
    """

    # Rows that are their own linearisation.
    affine = False
    # Whether ``project`` has a formula.
    closed_form = False

    @abstractmethod
    def __len__(self) -> int: ...

    @abstractmethod
    def take(self, keep: NDArray[np.bool_]) -> RowsOfOneKind:
        """The rows where ``keep`` (m,) is true, in their order."""

    @abstractmethod
    def shifted(self, displacement: NDArray[np.float64]) -> RowsOfOneKind:
        """The rows g(x - displacement) of the set carried by a displacement of shape (d,)."""

    @abstractmethod
    def keys(self) -> NDArray[np.int64]:
        """Two numbers below 2^53, shape (m, 2), that identify a row among all rows of its constraint."""

    @abstractmethod
    def label(self, k: int, d: int) -> str:
        """Row k in words, for messages about particles in dimension d."""

    def by_kind(self) -> tuple[RowsOfOneKind, ...]:
        return (self,)

    @property
    def structure(self) -> tuple[Any, ...]:
        return (type(self).__name__, len(self))

    def polynomial(self, y: NDArray[np.float64], scale: float) -> Polynomial | None:
        """Quadratic polynomials that are >= 0 just where g is, around y (N, d); None if g itself is to be called.

        A kind that has them says in ``structure`` which particles they tie: a program is compiled once for each.
        """
        return None

    def steepness(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
        """Length of the gradient of ``polynomial`` over that of g at x, shape (m,)."""
        return np.ones(len(self))

    def squared_steepness(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
        """The same for the form h >= 0 without a root that minimisers may take: 2 |X_i - X_j| for distances."""
        return np.ones(len(self))

    def squared_values(self, values: NDArray[np.float64], steepness: NDArray[np.float64]) -> NDArray[np.float64]:
        """h(x), shape (m,), from g(x) and ``squared_steepness``; h = g where there is no root."""
        return values

    def squared_jacobian(self, x: NDArray[np.float64]) -> csr_array:
        """dh/dx at x."""
        return self.jacobian(x)

    def tabulated(self, d: int) -> TableRows | None:
        """The rows as compiled code reads them, for particles in dimension d; None if g itself is to be called."""
        return None

    def longest_length(self) -> float:
        """The largest length that a row compares with, by which rounding is measured; 0 if there is none."""
        return 0.0

    def used(self, count: int) -> NDArray[np.int64]:
        """How many of the rows tie each of ``count`` particles, shape (count,); asked for with ``closed_form`` only."""
        raise NotImplementedError(f"{type(self).__name__} has no closed form")

    def project(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
        """Move x (N, d) in place to its nearest point, for rows that share no particle; the multipliers (m,)."""
        raise NotImplementedError(f"{type(self).__name__} has no closed form")
