"""Rows of several kinds."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from dincl.matrices import stacked
from dincl.rows.base import Rows, RowsOfOneKind

if TYPE_CHECKING:
    from numpy.typing import NDArray
    from scipy.sparse import csr_array


@dataclass(frozen=True, eq=False)
class RowsTogether(Rows):
    """Rows of several kinds, one block below the other; ``size`` is N*d."""

    blocks: tuple[RowsOfOneKind, ...]
    size: int

    def by_kind(self) -> tuple[RowsOfOneKind, ...]:
        return self.blocks

    def values(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.concatenate([np.zeros(0), *(block.values(x) for block in self.blocks)])

    def jacobian(self, x: NDArray[np.float64]) -> csr_array:
        return stacked([block.jacobian(x) for block in self.blocks], self.size)

    @property
    def structure(self) -> tuple[Any, ...]:
        return tuple(block.structure for block in self.blocks)
