"""All rows of the constraints of a small problem in one table, as compiled code reads them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from dincl.rows.tabulated import TableRows

if TYPE_CHECKING:
    from collections.abc import Sequence

    from dincl.rows.base import RowsOfOneKind

# More rows, or particles, than these are not listed all at once: those of 200 discs.
MOST_PARTICLES = 200
# Sweeps over more particles than these are as fast without compiled steps, which look at all pairs for a list.
MOST_SWEPT = 100


def tabulate(blocks: Sequence[RowsOfOneKind], n: int, d: int) -> tuple[Any, tuple[int, ...]]:
    """The rows of all blocks, one below the other, and the indices of blocks that only Python can evaluate."""
    from dincl.kernels.table import CALLED, ROW, RowTable

    called: list[int] = []
    parts = []
    for family, block in enumerate(blocks):
        part = block.tabulated(d)
        if part is None:
            m, before = len(block), sum(len(blocks[other]) for other in called)
            called.append(family)
            numbers = {"kind": CALLED, "i": before + np.arange(m), "j": -1, "sway": np.inf}
            part = TableRows(numbers, np.full(m, n), np.tile(np.arange(n), m), np.zeros(m * n))
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
