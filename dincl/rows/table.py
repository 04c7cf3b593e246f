"""Rows of the constraints of a problem in one table, as compiled code reads them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from dincl.rows.base import TableRows

if TYPE_CHECKING:
    from collections.abc import Sequence

    from dincl.rows.base import RowsOfOneKind

# More rows, or particles, than these are not listed all at once: those of 200 discs.
MOST_PARTICLES = 200


def tabulate(blocks: Sequence[RowsOfOneKind], n: int, d: int, entries_called: int) -> tuple[Any, tuple[int, ...]]:
    """The rows of all blocks, one below the other, and the indices of blocks that only Python can evaluate.

    ``entries_called`` is the number of entries of a row of those: n where gradients are stored, or 0.
    """
    from dincl.kernels.table import CALLED, ROW, RowTable

    called: list[int] = []
    parts = []
    before = 0
    for family, block in enumerate(blocks):
        part = block.tabulated(d)
        if part is None:
            m, e = len(block), entries_called
            called.append(family)
            numbers = {"kind": CALLED, "i": before + np.arange(m), "j": -1, "sway": np.inf}
            part = TableRows(numbers, np.full(m, e), np.tile(np.arange(e), m), np.zeros(m * e))
            before += m
        row = np.zeros(len(part.entries), dtype=ROW)
        for name, values in part.numbers.items():
            row[name] = values
        row["family"] = family
        parts.append((row, part))
    entries = np.concatenate([np.zeros(1, dtype=np.int64), *(part.entries for _, part in parts)])
    column = np.concatenate([np.zeros(0, dtype=np.int64), *(part.column for _, part in parts)])
    coefficient = np.concatenate([np.zeros(0), *(part.coefficient for _, part in parts)])
    rows = np.concatenate([np.zeros(0, dtype=ROW), *(row for row, _ in parts)])
    return RowTable(rows, np.cumsum(entries), column, coefficient), tuple(called)
