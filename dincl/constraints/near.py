"""The rows that matter near a state at a time: the only place that knows how rows move with their sets."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, partial
from typing import TYPE_CHECKING, Any

import numpy as np

from dincl.neighbours import ROW_MARGIN
from dincl.norms import longest
from dincl.rows.affine import AffineRows, linearised
from dincl.rows.together import RowsTogether

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray
    from scipy.sparse import csr_array

    from dincl.constraints.base import Constraint
    from dincl.errors import StepFailure
    from dincl.rows.base import RowsOfOneKind
    from dincl.work import Work

# Central and one-sided differences of order 6 for the first derivative.
CENTRAL = np.array([-1, 9, -45, 0, 45, -9, 1]) / 60
FORWARD = np.array([-147, 360, -450, 400, -225, 72, -10]) / 60

# The index of a constraint in its problem, and a row of it in words.
Name = tuple[int, str]
# t -> where a set is, (d,) [length].
Path = Callable[[float], "NDArray[np.float64]"]


@dataclass(frozen=True, eq=False)
class Selection:
    """Chosen rows of the constraints of a problem, at any time; ``len`` is their number m.

    ``blocks`` has the rows of each constraint as they are where its set is at rest.
    """

    constraints: Sequence[Constraint]
    blocks: tuple[RowsOfOneKind, ...]
    shape: tuple[int, ...]

    def __len__(self) -> int:
        return sum(len(block) for block in self.blocks)

    def at(self, t: float) -> RowsTogether:
        """The rows at time t."""
        count, d = self.shape
        shifts = [constraint.displacement(t, d) for constraint in self.constraints]
        pairs = zip(self.blocks, shifts, strict=True)
        return RowsTogether(tuple([b if shift is None else b.shifted(shift) for b, shift in pairs]), count * d)

    def linearised(self, t: float, x: NDArray[np.float64], carried_to: float | None = None) -> AffineRows:
        """The rows of time t linearised at x (N, d), and then carried, with their sets, to another time."""
        rows = self.at(t)
        moves = None if carried_to is None else self._moves(t, carried_to)
        if moves is None:
            return linearised(rows, x)
        pairs = zip(rows.blocks, moves, strict=True)
        carried = tuple(linearised(block, x).shifted(move) for block, move in pairs)
        return linearised(RowsTogether(carried, rows.size), x)

    def take(self, keep: NDArray[np.bool_]) -> Selection:
        """The rows where ``keep`` (m,) is true."""
        starts = np.cumsum([0, *(len(block) for block in self.blocks)])
        chosen = [block.take(keep[start:][: len(block)]) for block, start in zip(self.blocks, starts, strict=False)]
        return Selection(self.constraints, tuple(chosen), self.shape)

    @cached_property
    def names(self) -> tuple[Name, ...]:
        """For each row the index of its constraint, and the row in words."""
        d = self.shape[1]
        return tuple((index, block.label(k, d)) for index, block in enumerate(self.blocks) for k in range(len(block)))

    def coincidence(self, row: int) -> StepFailure:
        """Why this row has no direction."""
        for block in self.blocks:
            if row < len(block):
                break
            row -= len(block)
        rows: Any = block
        found: StepFailure = rows.coincidence(row)
        return found

    def least_speeds(self, t: float, unit: csr_array, spacing: float) -> NDArray[np.float64]:
        """n_k . c' for unit gradients n_k and the velocity c' of the set of row k, shape (m,); 0 for sets at rest.

        ``spacing`` is that of the differences that give c' [time].
        """
        least = np.zeros(unit.shape[0])
        start = 0
        for constraint, block in zip(self.constraints, self.blocks, strict=True):
            mine = slice(start, start + len(block))
            start += len(block)
            if len(block) and constraint.displacement(t, self.shape[1]) is not None:
                path: Any = partial(constraint.displacement, d=self.shape[1])
                velocity = np.tile(derivative(path, t, spacing), self.shape[0])
                least[mine] = (unit @ velocity)[mine]
        return least

    def carried(self, start: float, end: float) -> float:
        """How far the farthest of the sets is carried between two times [length]."""
        moves = self._moves(start, end)
        return 0.0 if moves is None else longest(moves)

    def _moves(self, start: float, end: float) -> NDArray[np.float64] | None:
        """How far each set is carried between two times, shape (constraints, d); None if all are at rest."""
        d = self.shape[1]
        paths = [(one.displacement(start, d), one.displacement(end, d)) for one in self.constraints]
        if all(before is None or after is None for before, after in paths):
            return None
        return np.array([np.zeros(d) if before is None or after is None else after - before for before, after in paths])


def derivative(
    path: Path, t: float, spacing: float, smooth: tuple[float, float] = (0.0, np.inf)
) -> NDArray[np.float64]:
    """The velocity of a path, shape (d,), by differences of order 6 among times of ``smooth`` [length / time]."""
    spacing = min(spacing, (smooth[1] - smooth[0]) / (len(FORWARD) - 1))
    if t - 3 * spacing < smooth[0]:
        places, weights = range(7), FORWARD
    elif t + 3 * spacing > smooth[1]:
        places, weights = range(0, -7, -1), -FORWARD
    else:
        places, weights = range(-3, 4), CENTRAL
    shifts = np.array([path(t + k * spacing) for k in places])
    # A set at rest has no velocity, not even of rounding.
    found: NDArray[np.float64] = weights @ (shifts - shifts[places.index(0)]) / spacing
    return found


def select(constraints: Sequence[Constraint], t: float, x: NDArray[np.float64], reach: float) -> Selection:
    """All rows that can be violated at time t once every particle moved by at most ``reach`` from x (N, d)."""
    blocks = tuple(constraint.select(_at_rest(constraint, t, x), reach) for constraint in constraints)
    return Selection(constraints, blocks, x.shape)


def carried_over(before: Selection, multipliers: NDArray[np.float64], selection: Selection) -> NDArray[np.float64]:
    """The multipliers of rows that were in another selection, zero for the others, shape (m,)."""
    found, first, last = np.zeros(len(selection)), 0, 0
    for old, new in zip(before.blocks, selection.blocks, strict=True):
        of_old, of_new = multipliers[first : first + len(old)], found[last : last + len(new)]
        first, last = first + len(old), last + len(new)
        pushing = of_old > 0
        if pushing.any() and len(new):
            _, here, there = np.intersect1d(row_names(old)[pushing], row_names(new), return_indices=True)
            of_new[there] = of_old[pushing][here]
    return found


def row_names(rows: RowsOfOneKind) -> NDArray[np.complex128]:
    """One number for each row of a constraint, shape (m,): its two keys as a complex number, which sorts fast."""
    names: NDArray[np.complex128] = np.ascontiguousarray(rows.keys(), dtype=np.float64).view(np.complex128).ravel()
    return names


def _at_rest(constraint: Constraint, t: float, x: NDArray[np.float64]) -> NDArray[np.float64]:
    """x as seen from the set at time t."""
    shift = constraint.displacement(t, x.shape[1])
    return x if shift is None else x - shift


class _NearOne:
    """The near rows of one constraint, in the frame in which it is at rest."""

    def __init__(self, constraint: Constraint) -> None:
        self._constraint = constraint
        self._reference: NDArray[np.float64] | None = None
        self._reach = 0.0

    def rows(self, t: float, x: NDArray[np.float64], reach: float, work: Work) -> RowsOfOneKind:
        own = _at_rest(self._constraint, t, x)
        if self._reference is None or longest(own - self._reference) + reach > self._reach:
            self._reference, self._reach = own.copy(), ROW_MARGIN * reach
            self._rows = self._constraint.select(own, self._reach)
            work.neighbour_builds += 1
        return self._rows


class Near:
    """The near rows of the constraints of a problem; one per run.

    What ``select`` and ``rows`` return for (t, x, reach) holds every row that can be violated at time t after each
    particle moved at most ``reach`` from x (N, d). Which rows there are changes only now and then, so a solver can keep
    what it built for them.
    """

    def __init__(self, constraints: Sequence[Constraint], work: Work) -> None:
        self._constraints = constraints
        self._parts = [_NearOne(constraint) for constraint in constraints]
        self._work = work
        self._selection: Selection | None = None

    def select(self, t: float, x: NDArray[np.float64], reach: float) -> Selection:
        """The near rows, to be taken at any time."""
        builds = self._work.neighbour_builds
        blocks = tuple([part.rows(t, x, reach, self._work) for part in self._parts])
        # Only a build changes which rows there are.
        if self._selection is None or self._work.neighbour_builds != builds:
            self._selection = Selection(self._constraints, blocks, x.shape)
        return self._selection

    def rows(self, t: float, x: NDArray[np.float64], reach: float) -> RowsTogether:
        """The near rows at time t."""
        return self.select(t, x, reach).at(t)
