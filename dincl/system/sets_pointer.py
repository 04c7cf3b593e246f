"""What compiled code asks Python about sets: where they are, rows that Python evaluates, projections that it makes."""

from __future__ import annotations

import ctypes
from functools import partial
from typing import TYPE_CHECKING, Any, NoReturn

import numpy as np

from dincl.constraints.moving import derivative
from dincl.errors import StepFailure
from dincl.rows.table import GRADIENTS, SWEEP, VELOCITIES, Sets
from dincl.system.kinks import NO_KINKS, kinks_of, smooth_around
from dincl.system.python_function import C_FUNCTION, PLACE, Callback, numbers_at

if TYPE_CHECKING:
    from collections.abc import Mapping

    from dincl.compiled.structs import StructPointer
    from dincl.constraints.selection import Selection
    from dincl.rows.base import CustomSweep, RowsOfOneKind
    from dincl.system.units import Units
    from dincl.work import Work

# A Jacobian of no more entries than this has room for all of them.
MOST_DENSE = 100_000
# Of the differences that give the velocities of moving sets [time], where nobody says otherwise.
SPACING = 1e-3


class SetsPointer(Callback):
    """The sets of a problem at any time; a context in which kernels may ask for them.

    Attributes
    ----------
    arrays
        What ``dincl.rows.table`` reads. Its address, which is 0 if there is nothing to ask, lives as long as this.
    system
        The struct that holds the arrays as its field ``sets``: arrays that have become too short are replaced there.
    custom_sweeps, work
        Projections of the user by index of their constraint, and the work of the run that they count.
    calls
        How many questions were answered.
    spacing
        Of the differences that give the velocities of moving sets [time].
    kinks
        Intervals (K, 2) with a jump of a velocity in each: no difference reaches across one [time].
    foreseen
        Why kinks could not be found, if so.
    """

    system: StructPointer
    work: Work

    def __init__(
        self, selection: Selection, called: tuple[int, ...], units: Units, custom_sweeps: Mapping[int, CustomSweep]
    ) -> None:
        count, d = selection.shape
        families, self.spacing = len(selection.constraints), SPACING
        self.kinks, self._units, self.custom_sweeps, self.calls = NO_KINKS, units, custom_sweeps, 0
        self.foreseen: StepFailure | None = None
        self._error: BaseException | None = None
        moving = {f: one for f, one in enumerate(selection.constraints) if one.displacement(0.0, d) is not None}
        self._paths: dict[int, Any] = {f: partial(one.displacement, d=d) for f, one in moving.items()}
        self._shape, m = (count, d), self._select(selection, called)
        self.python: Any = self._answer
        self._callback = C_FUNCTION(self.python)
        asks, entries = bool(self._paths or m or custom_sweeps), entries_for(m * count * d)
        self.arrays = Sets(
            address=int(ctypes.cast(self._callback, PLACE).value or 0) if asks else 0,
            request=np.zeros(3),
            shift=np.zeros((families, d)),
            speed=np.zeros((families, d)),
            value=np.zeros(m),
            first=np.zeros(m + 1, dtype=np.int64),
            column=np.zeros(entries, dtype=np.int64),
            entry=np.zeros(entries),
        )

    def _select(self, selection: Selection, called: tuple[int, ...]) -> int:
        """Take the rows that Python evaluates; how many they are."""
        self._called: list[tuple[int, RowsOfOneKind]] = [(f, selection.blocks[f]) for f in called]
        return sum(len(block) for _, block in self._called)

    def reselect(self, selection: Selection, called: tuple[int, ...]) -> None:
        """Take other rows, and replace the arrays that depend on their number."""
        m = self._select(selection, called)
        if m != len(self.arrays.value):
            self.arrays = self.arrays._replace(value=np.zeros(m), first=np.zeros(m + 1, dtype=np.int64))
            self.system.replace({"sets.value": self.arrays.value, "sets.first": self.arrays.first})
        self._grow(len(self.arrays.entry))

    def failure(self) -> NoReturn:
        """Raise what was raised while an answer was made."""
        error, self._error = self._error, None
        self.arrays.request[1] = 0.0
        raise error or RuntimeError("no answer of the sets failed")

    @property
    def failed(self) -> bool:
        """Whether an answer failed, and nobody heard of it yet."""
        return bool(self.arrays.request[1])

    def keep(self, error: BaseException) -> None:
        self._error, self.arrays.request[1] = error, 1.0

    def _answer(self, t: float, x: int, out: int, n: int, d: int, data: int) -> int:
        self.calls += 1
        try:
            if self.arrays.request[0] == SWEEP:
                family = int(self.arrays.request[2])
                self.custom_sweeps[family].sweep(t * self._units.time, numbers_at(x, self._shape), self.work)
            else:
                self._fill(t, x)
        except BaseException as error:  # noqa: BLE001  # raised again by ``failure``; here it would be printed
            self.keep(error)
            return 1
        return 0

    def _fill(self, scaled: float, place: int) -> None:
        sets, unit = self.arrays, self._units
        t = scaled * unit.time
        for family in self._paths:
            sets.shift[family] = self._paths[family](t) / unit.length
            if sets.request[0] == VELOCITIES:
                smooth = smooth_around(t, self.kinks)
                sets.speed[family] = derivative(self._paths[family], t, self.spacing, smooth) / unit.speed
        if sets.request[0] >= GRADIENTS and self._called:
            self._evaluate(numbers_at(place, self._shape) * unit.length)

    def _evaluate(self, x: Any) -> None:
        """Write values and Jacobian of the rows that Python evaluates."""
        sets, unit, row, entry = self.arrays, self._units, 0, 0
        for family, block in self._called:
            moved = block.shifted(sets.shift[family] * unit.length) if family in self._paths else block
            values, matrix = moved.values(x), moved.jacobian(x)
            rows, entries = slice(row, row + len(values)), slice(entry, entry + len(matrix.data))
            if entries.stop > len(self.arrays.entry):
                self._grow(2 * entries.stop)
            sets = self.arrays
            sets.value[rows] = values / unit.length
            sets.first[row + 1 : rows.stop + 1] = entry + matrix.indptr[1:]
            sets.column[entries], sets.entry[entries] = matrix.indices, matrix.data
            row, entry = rows.stop, entries.stop

    def _grow(self, most: int) -> None:
        """Make room for so many entries of the Jacobian, here and in the table."""
        column, entry = np.resize(self.arrays.column, most), np.resize(self.arrays.entry, most)
        self.arrays = self.arrays._replace(column=column, entry=entry)
        arrays, rows = {"sets.column": column, "sets.entry": entry}, self.system.value.rows
        if rows.tail[0] >= 0:
            size = int(rows.tail[0]) + most
            arrays |= {"rows.column": np.resize(rows.column, size)}
            arrays |= {"program.gradient": np.resize(self.system.value.program.gradient, size)}
        self.system.replace(arrays)

    def find_kinks(self, end: float) -> None:
        """Find where velocities of sets jump until ``end``, unless a path fails: a run may keep what it reaches."""
        try:
            self.kinks = kinks_of(list(self._paths.values()), end)
        except StepFailure as failure:
            self.foreseen = failure


def entries_for(dense: int) -> int:
    """For how many entries of a Jacobian that has so many when dense there is room at first."""
    return min(dense, MOST_DENSE)
