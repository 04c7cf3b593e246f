"""Lengths of the vectors of many particles."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray


def norms(vectors: NDArray[np.float64]) -> NDArray[np.float64]:
    """|v_i| for vectors (m, d), shape (m,)."""
    lengths: NDArray[np.float64] = np.sqrt((vectors * vectors).sum(axis=1))
    return lengths


def longest(vectors: NDArray[np.float64]) -> float:
    """max_i |v_i| for vectors (m, d), 0 if there are none."""
    return float(norms(vectors).max(initial=0.0))
