"""Rows selected from the constraints of a problem, near a state, at a time: how rows move with their sets."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, partial
from typing import TYPE_CHECKING, Any

import numpy as np

from dincl.constraints.moving import derivative
from dincl.neighbours import ROW_MARGIN
from dincl.norms import longest
from dincl.rows.affine import AffineRows, linearised
from dincl.rows.base import StackedRows

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray
    from scipy.sparse import csr_array

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
        count, d = self.shape
        shifts = [constraint.displacement(t, d) for constraint in self.constraints]
        pairs = zip(self.blocks, shifts, strict=True)
        return StackedRows(tuple([b if shift is None else b.shifted(shift) for b, shift in pairs]), count * d)

    def linearised(self, t: float, x: NDArray[np.float64], carried_to: float | None = None) -> AffineRows:
        """Return the rows of time t linearised at x (N, d), and then translated, with their sets, to another time."""
        rows = self.at(t)
        moves = None if carried_to is None else self._moves(t, carried_to)
        if moves is None:
            return linearised(rows, x)
        pairs = zip(rows.blocks, moves, strict=True)
        carried = tuple(linearised(block, x).shifted(move) for block, move in pairs)
        return linearised(StackedRows(carried, rows.size), x)

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

    def least_speeds(self, t: float, unit: csr_array, spacing: float) -> NDArray[np.float64]:
        """Compute n_k . c' for unit gradients n_k and the velocity c' of the set of row k, shape (m,).

        ``spacing`` is that of the differences that give c' [time].
        """
        least, start = np.zeros(unit.shape[0]), 0
        for constraint, block in zip(self.constraints, self.blocks, strict=True):
            rows = slice(start, start + len(block))
            start += len(block)
            if len(block) and constraint.displacement(t, self.shape[1]) is not None:
                path: Any = partial(constraint.displacement, d=self.shape[1])
                least[rows] = (unit @ np.tile(derivative(path, t, spacing), self.shape[0]))[rows]
        return least

    def largest_displacement(self, start: float, end: float) -> float:
        """Compute the largest displacement of a set between two times [length]."""
        moves = self._moves(start, end)
        return 0.0 if moves is None else longest(moves)

    def _moves(self, start: float, end: float) -> NDArray[np.float64] | None:
        """The displacement of each set between two times, shape (constraints, d); None if no set moves."""
        d = self.shape[1]
        paths = [(one.displacement(start, d), one.displacement(end, d)) for one in self.constraints]
        if all(before is None or after is None for before, after in paths):
            return None
        return np.array([np.zeros(d) if before is None or after is None else after - before for before, after in paths])


def select(constraints: Sequence[Constraint], t: float, x: NDArray[np.float64], search_radius: float) -> Selection:
    """Select all rows that can be violated at time t after each particle moved at most ``search_radius`` from x."""
    shifts = [constraint.displacement(t, x.shape[1]) for constraint in constraints]
    pairs = zip(constraints, shifts, strict=True)
    blocks = [one.select(x if shift is None else x - shift, search_radius) for one, shift in pairs]
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
            if longest(x - reference) + selection.largest_displacement(time, t) + search_radius <= selected_within:
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
