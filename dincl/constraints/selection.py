"""Rows selected from the constraints of a problem, near a state, at a time: how rows move with their sets."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from dincl.constraints.moving import derivative
from dincl.matrices import row_squares
from dincl.neighbours import ROW_MARGIN
from dincl.norms import longest
from dincl.rows.base import StackedRows
from dincl.rows.kinds import AffineRows, DistanceRows, linearised

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from dincl.constraints.base import Constraint
    from dincl.errors import StepFailure
    from dincl.rows.base import RowsOfOneKind
    from dincl.work import Work

# The index of a constraint in its problem, and a row of it in words.
Name = tuple[int, str]


@dataclass(frozen=True, eq=False)
class Selection:
    """m = ``len`` rows of the constraints of a problem, one block for each constraint, at displacement 0."""

    constraints: Sequence[Constraint]
    blocks: tuple[RowsOfOneKind, ...]
    shape: tuple[int, ...]

    def __len__(self) -> int:
        return sum(len(block) for block in self.blocks)

    def at(self, t: float) -> StackedRows:
        """Return the rows at time t."""
        pairs = zip(self.constraints, self.blocks, strict=True)
        return StackedRows(tuple([one.rows_at(t, block, self.shape) for one, block in pairs]), math.prod(self.shape))

    def linearised(self, t: float, x: NDArray[np.float64], carried_to: float | None = None) -> AffineRows:
        """Return the rows of time t linearised at x (N, d), and then carried, with their sets, to another time."""
        rows = self.at(t)
        if carried_to is None or not any(one.timed for one in self.constraints):
            return linearised(rows, x)
        pairs = zip(self.constraints, rows.blocks, self.at(carried_to).blocks, strict=True)
        carried = tuple([self._carried(one, now, later, x, t, carried_to) for one, now, later in pairs])
        return linearised(StackedRows(carried, rows.size), x)

    def _carried(
        self, constraint: Constraint, rows: RowsOfOneKind, later: RowsOfOneKind, x: NDArray[np.float64], *times: float
    ) -> AffineRows:
        """Return rows linearised at x, carried between two times by the displacement of the set, or by their gaps."""
        flat = linearised(rows, x)
        if not constraint.timed or not len(rows):
            return flat
        before, after = (constraint.displacement(time, self.shape[1]) for time in times)
        if before is not None and after is not None:
            return linearised(flat.placed(None, after - before), x)
        length = gradient_lengths(rows, x)
        change = later.values(x) * length / gradient_lengths(later, x) - rows.values(x)
        return AffineRows(flat.matrix, flat.bound - change)

    def take(self, keep: NDArray[np.bool_]) -> Selection:
        """Return the rows where ``keep`` (m,) is true."""
        starts = np.cumsum([0, *(len(block) for block in self.blocks)])
        chosen = [block.take(keep[start:][: len(block)]) for block, start in zip(self.blocks, starts, strict=False)]
        return Selection(self.constraints, tuple(chosen), self.shape)

    @cached_property
    def names(self) -> tuple[Name, ...]:
        """For each row the index of its constraint, and the row in words."""
        d = self.shape[1]
        return tuple((index, block.label(k, d)) for index, block in enumerate(self.blocks) for k in range(len(block)))

    def coincidence(self, row: int) -> StepFailure:
        """Return the failure of a row without gradient."""
        family, first = 0, 0
        while row >= first + len(self.blocks[family]):
            family, first = family + 1, first + len(self.blocks[family])
        block: Any = self.blocks[family]
        found: StepFailure = block.coincidence(row - first)
        return found

    def largest_change(self, start: float, end: float, x: NDArray[np.float64], search_radius: float) -> float:
        """Bound the change of all sets between two times, see ``Constraint.change`` [length]."""
        return max((one.change(start, end, x, search_radius) for one in self.constraints if one.timed), default=0.0)


def gradient_lengths(rows: RowsOfOneKind, x: NDArray[np.float64]) -> NDArray[np.float64]:
    """Compute |grad g_k|, by which gaps are scaled; 1 for distances that are lengths, and where it vanishes."""
    if isinstance(rows, DistanceRows) and rows.plain:
        return np.ones(len(rows))
    lengths = np.sqrt(row_squares(rows.jacobian(x)))
    return np.where(lengths > 0, lengths, 1.0)


def rates(
    constraint: Constraint,
    block: RowsOfOneKind,
    t: float,
    x: NDArray[np.float64],
    spacing: float,
    smooth: tuple[float, float] = (0.0, np.inf),
) -> NDArray[np.float64]:
    """Compute dg_k/dt at x of rows selected at any time, by differences within ``smooth``, shape (m,)."""

    def values(time: float) -> NDArray[np.float64]:
        found: NDArray[np.float64] = constraint.rows_at(time, block, x.shape).values(x)
        return found

    return derivative(values, t, spacing, smooth)


def select(constraints: Sequence[Constraint], t: float, x: NDArray[np.float64], search_radius: float) -> Selection:
    """Select all rows that can be violated at time t after each particle moved at most ``search_radius`` from x."""
    blocks = [one.select_at(t, x, search_radius) for one in constraints]
    return Selection(constraints, tuple(blocks), x.shape)


class Candidates:
    """Rows that can be violated near the states of a run; selected anew only when particles or sets have moved far."""

    def __init__(self, constraints: Sequence[Constraint], work: Work) -> None:
        self._constraints, self._work = constraints, work
        self._selected: tuple[float, NDArray[np.float64], float, Selection] | None = None

    def select(self, t: float, x: NDArray[np.float64], search_radius: float) -> Selection:
        """Select all rows that can be violated at time t after each particle moved at most ``search_radius`` from x.

        The same object is returned as long as it contains them.
        """
        if self._selected is not None:
            time, reference, selected_within, selection = self._selected
            moved = longest(x - reference) + selection.largest_change(time, t, x, selected_within)
            if moved + search_radius <= selected_within:
                return selection
        selection = select(self._constraints, t, x, ROW_MARGIN * search_radius)
        self._selected = t, x.copy(), ROW_MARGIN * search_radius, selection
        self._work.neighbour_builds += len(self._constraints)
        return selection


def transfer_multipliers(
    before: Selection, multipliers: NDArray[np.float64], selection: Selection
) -> NDArray[np.float64]:
    """Return multipliers (m,) for a selection: of its rows that were in the selection before, zero for all others."""
    found, first, last = np.zeros(len(selection)), 0, 0
    for old, new in zip(before.blocks, selection.blocks, strict=True):
        of_old, of_new = multipliers[first : first + len(old)], found[last : last + len(new)]
        first, last = first + len(old), last + len(new)
        active = of_old > 0
        if active.any() and len(new):
            _, here, there = np.intersect1d(row_keys(old)[active], row_keys(new), return_indices=True)
            of_new[there] = of_old[active][here]
    return found


def row_keys(rows: RowsOfOneKind) -> NDArray[np.complex128]:
    """Return the two keys of each row of a constraint as one complex number, which sorts fast, shape (m,)."""
    names: NDArray[np.complex128] = np.ascontiguousarray(rows.keys(), dtype=np.float64).view(np.complex128).ravel()
    return names
