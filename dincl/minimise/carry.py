"""Multipliers carried from one list of near rows to the next."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from dincl.constraints.rows import AffineRows, DistanceRows, SmoothRows

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from dincl.constraints.rows import RowsOfOneKind


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
    columns: list[NDArray[np.int64]]
    match rows:
        case DistanceRows():
            columns = [rows.i, rows.i if rows.j is None else rows.j]
        case AffineRows():
            starts = rows.matrix.indptr
            columns = [rows.matrix.indices[starts[:-1]], rows.matrix.indices[starts[1:] - 1]]
        case SmoothRows():
            columns = [rows.index, rows.index]
        case _:
            raise TypeError(f"rows of the kind {type(rows).__name__} have no names")
    pairs = np.column_stack(columns).astype(np.int64)
    return np.ascontiguousarray(pairs).view([("first", np.int64), ("last", np.int64)]).ravel()
