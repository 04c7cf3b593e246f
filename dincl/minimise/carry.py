"""Multipliers carried from one list of near rows to the next."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from dincl.rows.base import RowsOfOneKind


def left_over(
    near: RowsOfOneKind, before: Sequence[RowsOfOneKind], multipliers: NDArray[np.float64]
) -> tuple[tuple[RowsOfOneKind, ...], NDArray[np.float64]]:
    """The rows ``near``, then those of ``before`` that have a multiplier and are not near; and the multipliers of all.

    ``multipliers`` (m,) belong to the rows ``before``, block after block.
    """
    carried = np.zeros(len(near))
    names = row_names(near)
    kept, kept_multipliers = [], []
    first = 0
    for block in before:
        own = multipliers[first : first + len(block)]
        first += len(block)
        held = block.take(own > 0)
        own = own[own > 0]
        _, here, there = np.intersect1d(row_names(held), names, return_indices=True)
        carried[there] = own[here]
        missing = np.ones(len(own), dtype=bool)
        missing[here] = False
        if missing.any():
            kept.append(held.take(missing))
            kept_multipliers.append(own[missing])
    return (near, *kept), np.concatenate((carried, *kept_multipliers))


def row_names(rows: RowsOfOneKind) -> NDArray[Any]:
    """One comparable name for each row of a constraint, shape (m,): the particles that it ties, or its number."""
    pairs = rows.keys().astype(np.int64)
    return np.ascontiguousarray(pairs).view([("first", np.int64), ("last", np.int64)]).ravel()
