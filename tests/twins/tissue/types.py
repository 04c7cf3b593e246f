"""The numbers of named types of cells: those of each cell, and of all cells as arrays."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from tissue.state.cells import Integers
from tissue.state.numbers import Numbers

Named = Sequence[Numbers]
# What a type may have of its own.
OWN = (
    *("alpha_aa", "alpha_ax", "alpha_bx", "alpha_axb", "hard_radius", "enlarged_radius", "g2", "mitosis"),
    *("min_cycle", "max_cycle", "rate_aa", "rate_ax", "rate_bx", "max_cytoskeleton", "two_daughters"),
)


def of_cell(numbers: Numbers, named: Named, kind: int) -> Numbers:
    """The numbers of a cell of this kind: control cells and EMT cells come before the named types."""
    return named[kind - 2] if kind > 1 else numbers


def of_all(numbers: Numbers, named: Named, kind: Integers) -> Any:
    """The numbers with arrays (n,) for what types have of their own."""
    each = [of_cell(numbers, named, k) for k in kind]
    return numbers._replace(**{name: np.array([getattr(one, name) for one in each]) for name in OWN})
