"""Sets of a problem, as compiled code asks Python for them: places of moving sets, and rows."""

from __future__ import annotations

from contextlib import suppress
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from dincl.compiled.calls import SETS
from dincl.compiled.structs import StructPointer
from dincl.constraints.moving import derivative
from dincl.constraints.selection import rates as gap_rates
from dincl.constraints.selection import row_lengths
from dincl.errors import StepFailure
from dincl.norms import longest
from dincl.rows.table import DISTANCE, GRADIENTS, VELOCITIES, RowTable, Sets, write_timed
from dincl.system.callbacks import PythonFunction, numbers_at
from dincl.system.time_scales import NO_BREAKS
from dincl.system.time_tables import table_of_displacement, table_of_rows, timed_sets

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from numpy.typing import NDArray

    from dincl.constraints.base import Constraint
    from dincl.constraints.selection import Selection
    from dincl.rows.base import RowsOfOneKind, TableRows
    from dincl.system.callbacks import DriftPointer
    from dincl.system.compiled_problem import Units
    from dincl.system.time_scales import Interval
    from dincl.system.time_tables import TimeTable

# A Jacobian of no more entries than this has room for all of them.
MOST_DENSE = 100_000
# Step of the differences for velocities of moving sets [time], unless ``spacing`` is set.
SPACING = 1e-3
# Changes of general sets between two times are kept for so many: a step asks for few.
MOST_CHANGES = 64


class SetsPointer(PythonFunction):
    """The sets of a problem at any time; its address is 0 if compiled code has nothing to ask.

    Attributes
    ----------
    arrays
        Read and written by ``dincl.rows.table``.
    system
        The struct with the arrays as its field ``sets``: longer arrays replace them there.
    spacing, spacings
        Step of the differences for velocities of moving sets [time]; and times (P, 2) until which, since the one
        before, it is at most the second number.
    updates
        Functions of time that are called at each request: they write what is not in the table.
    breaks
        Intervals (K, 2) with a jump of a set or of its velocity in each: no difference reaches across one [time].
    """

    system: StructPointer

    def __init__(
        self,
        start: NDArray[np.float64],
        selection: Selection,
        called: tuple[int, ...],
        units: Units,
        drift: DriftPointer,
        box: NDArray[np.float64] | None = None,
    ) -> None:
        self._drift = drift
        self._start, self._shape = start, selection.shape
        count, d = selection.shape
        families, self.spacing = len(selection.constraints), SPACING
        self.breaks, self.spacings = NO_BREAKS, NO_BREAKS
        self._units = units
        self.updates: list[Callable[[float], None]] = []
        timed = {f: one for f, one in enumerate(selection.constraints) if one.timed}
        moving = {f: one for f, one in timed.items() if one.displacement(0.0, d) is not None}
        self._translated = frozenset(moving)
        self._paths: dict[int, Any] = {f: partial(one.displacement, d=d) for f, one in moving.items()}
        self._general = {f: one for f, one in timed.items() if f not in moving}
        m = self._select(selection, called)
        entries = entries_for(m * count * d)
        if timed or m:
            super().__init__(self._answer, SETS)
        self.arrays = Sets(
            address=self.address,
            failed=np.zeros(1, dtype=np.int64),
            shift=np.zeros((families, d)),
            speed=np.zeros((families, d)),
            general=np.isin(np.arange(families), list(self._general)).astype(np.int64),
            since=np.zeros(1),
            change=np.zeros(families),
            rate=np.zeros(len(selection) if self._general else 0),
            value=np.zeros(m),
            first=np.zeros(m + 1, dtype=np.int64),
            column=np.zeros(entries, dtype=np.int64),
            entry=np.zeros(entries),
            box=np.zeros(0) if box is None else box / units.length,
            tables=np.array([0, 1, 0]),
        )

    def _select(self, selection: Selection, called: tuple[int, ...]) -> int:
        """Take the rows that Python evaluates, and return their number."""
        # The time whose numbers are in the table, for each general set; and its changes between two times.
        self._written: dict[int, float] = {}
        self._changes: dict[tuple[int, float, float], tuple[float, Any, float]] = {}
        self._blocks, self._starts = selection.blocks, np.cumsum([0, *map(len, selection.blocks)])
        self._called: list[tuple[int, RowsOfOneKind]] = [(f, selection.blocks[f]) for f in called]
        return sum(len(block) for _, block in self._called)

    def reselect(self, selection: Selection, called: tuple[int, ...]) -> None:
        """Take other rows, and replace the arrays that depend on their number."""
        m = self._select(selection, called)
        if m != len(self.arrays.value):
            self.arrays = self.arrays._replace(value=np.zeros(m), first=np.zeros(m + 1, dtype=np.int64))
            self.system.replace({"sets.value": self.arrays.value, "sets.first": self.arrays.first})
        if self._general:
            self.arrays = self.arrays._replace(rate=np.zeros(len(selection)))
            self.system.replace({"sets.rate": self.arrays.rate})
        self._grow(len(self.arrays.entry))

    def tabulate(self, smooth: Mapping[int, Sequence[Interval]], *, compares: bool = True) -> None:
        """Let compiled code evaluate the sets that depend on time alone; Python is asked for all others.

        ``smooth`` are the intervals of time in which a set, by its index, is smooth. Who never lists near rows does not
        ask how sets change.
        """
        unit, system = self._units, self.system.value
        tables: list[TimeTable] = []
        size = longest(self._start) / unit.length
        for f, parts in smooth.items():
            pieces = [(a / unit.time, b / unit.time) for a, b in parts]
            with suppress(StepFailure):  # the run fails when it gets there
                if f in self._paths and pieces:
                    table = table_of_displacement(f, partial(self._displaced, f), pieces, size)
                elif pieces and len(self._blocks[f]) and not system.near.search:
                    table = table_of_rows(f, partial(self._tabulated, f), pieces, size, self._starts[f], system.rows)
                    # In the table are the numbers of time 0, of which some may not change from a later start on.
                    first = self._tabulated(f, pieces[0][0]) if pieces[0][0] > 0.0 else None
                    if table is not None and first is not None:
                        write_numbers(system.rows, slice(*self._starts[f : f + 2]), first)
                else:
                    continue
                if table is not None:
                    tables.append(table)
        if not tables:
            return
        for one in tables:
            self._paths.pop(one.family, None)
            self._general.pop(one.family, None)
        self._tables = StructPointer(timed_sets(tables, system.rows, system.near.radius, compares=compares))
        asks = self._paths or self._general or self.updates or self._called
        self.arrays.tables[:] = self._tables.address, bool(asks), write_timed.address

    def _displaced(self, f: int, t: float) -> NDArray[np.float64]:
        found: NDArray[np.float64] = self._paths[f](t * self._units.time) / self._units.length
        return found

    def _tabulated(self, f: int, t: float) -> TableRows | None:
        rows = self._general[f].rows_at(t * self._units.time, self._blocks[f], self._shape)
        part = rows.tabulated(self._shape[1])
        return None if part is None else in_units(part, self._units.length)

    def keep(self, error: BaseException) -> None:
        """Keep an error, and let kernels see it: an interrupted function returns 0."""
        super().keep(error)
        self.arrays.failed[0] = 1

    def raise_error(self) -> None:
        """Raise the error of a question, if any; the next question is asked again."""
        self.arrays.failed[0] = 0
        super().raise_error()

    def _answer(self, t: float, x: int, question: int) -> None:
        # The budget of evaluations is checked here, too: a slow function of the user could overrun it before compiled
        # code next counts its calls of the drift.
        self._drift.note_call()
        unit, t = self._units, t * self._units.time
        for f, path in self._paths.items():
            self.arrays.shift[f] = path(t) / unit.length
            if question == VELOCITIES:
                self.arrays.speed[f] = derivative(path, t, *self._differences(t)) / unit.speed
        for update in self.updates:
            update(t)
        place = numbers_at(x, self._shape) * unit.length if self._general or self._called else None
        for f, one in self._general.items():
            self._write(t, f, one, place, rates=question == VELOCITIES)
        if question >= GRADIENTS and self._called:
            self._evaluate(t, place)

    def _differences(self, t: float) -> tuple[float, tuple[float, float]]:
        """Return the step of differences at t, and the breaks before and after t, between which they may look."""
        breaks, pieces, spacing = self.breaks, self.spacings, self.spacing
        k = int(np.searchsorted(breaks[:, 1], t, side="right"))
        if len(pieces):
            spacing = min(spacing, float(pieces[min(int(np.searchsorted(pieces[:, 0], t)), len(pieces) - 1), 1]))
        return spacing, (float(breaks[k - 1, 1]) if k else 0.0, float(breaks[k, 0]) if k < len(breaks) else np.inf)

    def _write(self, t: float, f: int, one: Constraint, x: Any, *, rates: bool) -> None:
        """Write the change of a general set, the numbers of its rows in the table, and their rates of change."""
        arrays, unit, table, mine = self.arrays, self._units, self.system.value.rows, slice(*self._starts[f : f + 2])
        arrays.change[f] = self._change(t, f, one, x) / unit.length
        if not len(self._blocks[f]) or (self._written.get(f) == t and not rates):
            return
        rows = one.rows_at(t, self._blocks[f], self._shape)
        part = rows.tabulated(self._shape[1])
        if part is not None:
            write_numbers(table, mine, in_units(part, unit.length))
            self._written[f] = t
        if rates:
            found = gap_rates(one, self._blocks[f], t, x, *self._differences(t)) / row_lengths(rows, x)
            arrays.rate[mine] = found / unit.speed

    def _change(self, t: float, f: int, one: Constraint, x: Any) -> float:
        """Return the change of a set between the time it is compared with and t, near x.

        A step asks for it at the same two times and several points near each other.
        """
        since, near = float(self.arrays.since[0]) * self._units.time, self.system.value.near
        search_radius = float(near.radius[0]) * self._units.length
        found = self._changes.get((f, since, t))
        if found is not None and longest(x - found[1]) + search_radius <= found[2]:
            return found[0]
        # The bound must also hold for rows that the next search will list, whose radius is not known yet.
        radius = max(search_radius, longest(x))
        change = one.change(since, t, x, radius)
        if len(self._changes) >= MOST_CHANGES:
            self._changes.clear()
        self._changes[f, since, t] = change, x.copy(), radius
        return change

    def _evaluate(self, t: float, x: Any) -> None:
        """Write values and Jacobian of the rows that Python evaluates."""
        sets, unit, row, entry = self.arrays, self._units, 0, 0
        for family, block in self._called:
            moved = block.placed(None, sets.shift[family] * unit.length) if family in self._translated else block
            if family in self._general:
                moved = self._general[family].rows_at(t, block, self._shape)
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


def in_units(part: TableRows, unit: float) -> TableRows:
    """Return rows whose lengths are divided by ``unit``."""
    length = part.numbers.get("length", 0.0) / unit
    coefficient = part.coefficient / unit if part.numbers["kind"] == DISTANCE else part.coefficient
    return part._replace(numbers=part.numbers | {"length": length}, coefficient=coefficient)


def write_numbers(table: RowTable, rows: slice, part: TableRows) -> None:
    """Write the numbers of rows that are in the table."""
    table.row["length"][rows] = part.numbers["length"]
    table.row["square"][rows] = part.numbers.get("square", 0.0)
    table.coefficient[table.start[rows.start] : table.stop[rows.stop - 1]] = part.coefficient


def entries_for(dense: int) -> int:
    """Return how many entries there is room for at first, of a Jacobian with so many when dense."""
    return min(dense, MOST_DENSE)
