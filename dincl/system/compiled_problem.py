"""A problem as compiled code sees it: one table of rows, the sets at any time, the drift, arrays to write to."""

from __future__ import annotations

import math
from contextlib import suppress
from functools import partial
from typing import TYPE_CHECKING, Any, NamedTuple, NoReturn

import numpy as np

from dincl.compiled.calls import SETS
from dincl.compiled.structs import StructPointer
from dincl.constants import LARGEST
from dincl.constraints.moving import derivative
from dincl.constraints.selection import gradient_lengths, select, transfer_multipliers
from dincl.constraints.selection import rates as gap_rates
from dincl.errors import StepFailure
from dincl.norms import longest
from dincl.rows.base import TableRows
from dincl.rows.candidates import no_candidates
from dincl.rows.table import (
    AFFINE,
    CALLBACK,
    DISTANCE,
    GRADIENTS,
    ROW,
    VELOCITIES,
    RowTable,
    Sets,
    row_table,
    write_timed,
)
from dincl.solvers.active_set import least_distance
from dincl.solvers.envelope_factor import EnvelopeFactor, envelope_factor
from dincl.status import Status
from dincl.system import arrays as codes
from dincl.system.arrays import Drift, SystemArrays, curvature, overlaps_at
from dincl.system.callbacks import DriftPointer, PythonFunction, catching, numbers_at
from dincl.system.time_scales import NO_BREAKS
from dincl.system.time_tables import Reading, table_of_displacement, table_of_rows

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence
    from contextlib import AbstractContextManager

    from numpy.typing import NDArray

    from dincl.constraints.base import Constraint
    from dincl.constraints.selection import Selection
    from dincl.problem import Problem
    from dincl.rows.base import RowsOfOneKind
    from dincl.rows.timed_sets import TimedSet
    from dincl.system.time_scales import Interval
    from dincl.work import Work

# More rows, or particles, than these are not listed all at once: those of 200 discs.
MOST_PARTICLES = 200
# The name in ``Work.back_ends``.
NAME = "active set"
FAILURES = {
    codes.UNMET: (Status.NOT_CONVERGED, f"{NAME}: active rows keep a violated row from being met."),
    codes.CYCLES: (Status.NOT_CONVERGED, f"{NAME}: rounding keeps it from an answer."),
    codes.TOO_FAR: (Status.NOT_CONVERGED, "The projection moved a particle again and again beyond the rows looked at."),
    codes.NOT_A_NUMBER: (Status.NON_FINITE, f"A coordinate is not a number, or exceeds {LARGEST:g} in magnitude."),
    codes.SINGULAR: (Status.NOT_CONVERGED, "Gradients of the contacts that are held became dependent."),
}
# A Jacobian of no more entries than this has room for all of them.
MOST_DENSE = 100_000
# Step of the differences for velocities of moving sets [time], unless ``spacing`` is set.
SPACING = 1e-3
# Changes of general sets between two times are kept for so many: a step asks for few.
MOST_CHANGES = 64


class Units(NamedTuple):
    """Units of a run: its numbers times ``length`` and ``time`` are the numbers of the user.

    Powers of two: the numbers of a run are of size one, and no bit of them changes.
    """

    length: float = 1.0
    time: float = 1.0

    @property
    def speed(self) -> float:
        """The unit of velocities [length / time]."""
        return self.length / self.time


def units_of(length: float, time: float) -> Units:
    """Return the powers of two next below a length and a time; 1 for a zero."""
    return Units(*(math.ldexp(0.5, math.frexp(value)[1]) if value > 0 else 1.0 for value in (length, time)))


ONE = Units()


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
        entries = min(m * count * d, MOST_DENSE)
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
            tables=np.ones(1, dtype=np.int64),
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
        tables: list[TimedSet] = []
        of = Reading(system.rows, system.near.radius, compares)
        size = longest(self._start) / unit.length
        for f, parts in smooth.items():
            pieces = [(a / unit.time, b / unit.time) for a, b in parts]
            with suppress(StepFailure):  # the run fails when it gets there
                if f in self._paths and pieces:
                    table = table_of_displacement(f, partial(self._displaced, f), pieces, size, of)
                elif pieces and len(self._blocks[f]) and not system.near.search:
                    table = table_of_rows(f, partial(self._tabulated, f), pieces, size, self._starts[f], of)
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
        self._tables = [StructPointer(one) for one in tables]
        asks = self._paths or self._general or self.updates or self._called
        addresses = [bool(asks), write_timed.address, *(one.address for one in self._tables)]
        self.arrays = self.arrays._replace(tables=np.array(addresses, dtype=np.int64))
        self.system.replace({"sets.tables": self.arrays.tables})

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
            found = gap_rates(one, self._blocks[f], t, x, *self._differences(t)) / gradient_lengths(rows, x)
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


class CompiledProblem:
    """A problem, bound to one run.

    Attributes
    ----------
    selection
        The rows in the table: all rows, or, of many particles, the near rows.
    units
        Units of the arrays; the problem and its functions have their own.
    place
        The address of ``arrays`` for kernels, which are called inside of ``with callbacks()``.
    functions
        The functions of Python that kernels call.
    """

    def __init__(
        self,
        problem: Problem,
        selection: Selection,
        units: Units = ONE,
        *,
        exact: bool = False,
        searches: bool = False,
        programs: bool = True,
        events: bool = False,
    ) -> None:
        """Bind with the rows of ``selection``: see ``for_events``, ``for_sweeps`` and ``for_projections``."""
        self.problem, self.units, self.selection = problem, units, selection
        self._programs, self._exact, self._events = programs, exact, events
        n, families, d = problem.x0.size, len(problem.constraints), problem.x0.shape[1]
        rows, called = self._tabulated(0.0)
        self.drift = DriftPointer(problem)
        self.sets = SetsPointer(problem.x0, selection, called, units, self.drift, problem.box)
        search = PythonFunction(self._list_rows, SETS) if searches else None
        functions = (self.drift, self.sets, search)
        self.functions = [one for one in functions if isinstance(one, PythonFunction)]
        m = len(rows.row)
        self._pointer = self.sets.system = StructPointer(
            SystemArrays(
                rows=rows,
                sets=self.sets.arrays,
                near=no_candidates(m, n, families, d, search.address if search else 0),
                program=least_distance(np.zeros(len(rows.column)), np.zeros(m), np.zeros(m), n),
                factor=self._factor(m),
                drift=Drift(
                    self.drift.address,
                    self.drift.data,
                    np.zeros(2, dtype=np.int64),
                    np.zeros(1 + 2 * n),
                    np.array([units.time, units.length, units.speed]),
                    np.zeros(n),
                ),
                velocity=np.zeros(n),
                middle=np.zeros(n),
                move=np.zeros((families, d)),
                offending=np.zeros(1, dtype=np.int64),
                curvature=curvature(n if programs else 0, m if programs else 0),
            )
        )
        self.place = self._pointer.address
        self._counted = (0, 0, 0.0, 0.0, 0)

    @classmethod
    def for_events(cls, problem: Problem, units: Units) -> CompiledProblem:
        """Bind to an event-driven run, which needs all rows and solves programs of velocities."""
        return cls(problem, select(problem.constraints, 0.0, problem.x0, np.inf), units, events=True)

    @classmethod
    def for_sweeps(cls, problem: Problem, selection: Selection) -> CompiledProblem:
        """Bind to a scheme that takes one of these rows after another, without room for programs."""
        return cls(problem, selection, programs=False)

    @classmethod
    def for_projections(cls, problem: Problem, *, exact: bool) -> CompiledProblem:
        """Bind to projections onto S (``exact``) or its linearisation: with all rows of few particles, or near ones."""
        few = len(problem.x0) <= MOST_PARTICLES
        selection = select(problem.constraints, 0.0, problem.x0, np.inf if few else 0.0)
        return cls(problem, selection, exact=exact, searches=not few)

    @property
    def arrays(self) -> SystemArrays:
        """The arrays at ``place``."""
        arrays: SystemArrays = self._pointer.value
        return arrays

    def callbacks(self) -> AbstractContextManager[None]:
        """Surround calls of kernels, which may call Python."""
        return catching(self.functions)

    def overlaps(self, times: NDArray[np.float64], x: NDArray[np.float64]) -> NDArray[np.float64]:
        """Compute how far states (K, N, d) at these times are outside of the rows in the table, shape (K,) [length]."""
        overlap, flat = np.empty(len(times)), x.reshape(len(times), -1) / self.units.length
        with self.callbacks():
            overlaps_at(self.place, times / self.units.time, flat, overlap)
        self.sets.raise_error()
        return overlap * self.units.length

    def _tabulated(self, t: float) -> tuple[RowTable, tuple[int, ...]]:
        """Return the rows as kernels read them, and the indices of constraints whose rows Python evaluates.

        Rows of sets that are only translated are in the places of the sets without displacement.
        """
        shape, n = self.problem.x0.shape, self.problem.x0.size
        blocks = list(self.selection.blocks)
        for f, one in enumerate(self.problem.constraints):
            if one.timed and len(blocks[f]) and one.displacement(t, shape[1]) is None:
                blocks[f] = one.rows_at(t, blocks[f], shape)
        return tabulate(blocks, n, shape[1], self.units.length, dense=self._events)

    def _factor(self, m: int) -> EnvelopeFactor:
        """Make room for the factors of a dense solver."""
        n = self.problem.x0.size
        return envelope_factor(min(m, n) + 1, n) if self._programs else envelope_factor(1, 0)

    def _list_rows(self, t: float, x: int, *_: int) -> None:
        """Put the rows near x at time t into the table; rows that stay keep their multipliers."""
        problem, before = self.problem, self.selection
        near = numbers_at(x, problem.x0.shape).copy()
        self.selection = select(problem.constraints, t, near, float(self.arrays.near.radius[0]))
        rows, called = self._tabulated(t)
        multiplier = transfer_multipliers(before, self.arrays.program.multiplier, self.selection)
        m = len(rows.row)
        arrays = {f"rows.{name}": part for name, part in rows._asdict().items()}
        arrays |= {f"factor.{name}": part for name, part in self._factor(m)._asdict().items()}
        arrays |= {"program.gradient": np.zeros(len(rows.column)), "program.bound": np.zeros(m)}
        arrays |= {
            "program.length": np.ones(m),
            "near.chosen": np.zeros(m, np.int64),
            "near.link": np.zeros(m, np.int64),
        }
        arrays |= {"program.multiplier": multiplier, "near.row": np.arange(m), "near.key": np.zeros(m)}
        arrays["curvature.slope"] = np.zeros(m if self._programs else 0)
        self._pointer.replace(arrays)
        self.sets.reselect(self.selection, called)
        self.arrays.near.number[0] = m

    def count(self, work: Work) -> None:
        """Add the work since the last call, and let the drift count its evaluations."""
        arrays, before = self.arrays, self._counted
        drifts, builds = int(arrays.drift.calls[0]), int(arrays.near.number[1])
        iterations, calls = float(arrays.program.answer[0]), float(arrays.program.answer[2])
        python = self.sets.calls
        self._counted = (drifts, builds, iterations, calls, python)
        work.drift_evaluations += drifts - before[0]
        work.neighbour_builds += builds - before[1]
        if self._programs:
            work.solver_iterations += round(iterations - before[2])
        else:
            work.constraint_projections += round(iterations - before[2])
        work.solver_calls += round(calls - before[3])
        work.callbacks += python - before[4]
        if calls > 0 and NAME not in work.back_ends:
            work.back_ends += (NAME,)
        self.drift.count_evaluations(drifts - before[0])

    def raise_errors(self) -> None:
        """Raise what a function of the user raised in a kernel, if anything."""
        for function in self.functions:
            function.raise_error()

    def failure(self, code: int, tol: float = 0.0) -> NoReturn:
        """Raise StepFailure, or what a function of the user raised, for the code by which a kernel ended."""
        self.raise_errors()
        arrays = self.arrays
        if code == codes.DRIFT:
            at, n = arrays.drift.failed, arrays.velocity.size
            self.drift.failure(float(at[0]), at[1 : n + 1], at[n + 1 :], int(arrays.drift.calls[1]))
        if code == codes.COINCIDENT:
            raise self.selection.coincidence(int(arrays.offending[0]))
        from dincl.projection.certificate import missed, wedge

        if code == codes.WEDGE:
            raise wedge(2.0 * float(arrays.program.answer[1]))
        if code == codes.MISSED:
            residual, bent = float(arrays.program.answer[1]), float(arrays.curvature.largest[0]) - 1.0
            failure = missed(NAME, residual, tol, bent, float(np.abs(arrays.program.y).max()))
        else:
            failure = StepFailure(*FAILURES[code])
        raise self.reason(failure, contradicting=code == codes.UNMET)

    def reason(self, failure: StepFailure, *, contradicting: bool = False) -> StepFailure:
        """Return INFEASIBLE if the program of the near rows is proved to be so, else the failure with its reason.

        Of programs of velocities only the rows ``contradicting`` each other are known, which then have multipliers.
        """
        if not self._programs or (self._events and not contradicting):
            return failure
        from dincl.matrices import divided, from_rows
        from dincl.projection.certificate import row_lengths, why_unsolved

        rows, program, near = self.arrays.rows, self.arrays.program, self.arrays.near
        listed = near.row[: near.number[0]]
        if contradicting:
            listed = listed[program.multiplier[listed] > 0]
        entries = [np.arange(rows.start[r], rows.stop[r]) for r in listed]
        place = np.concatenate([np.zeros(0, dtype=np.int64), *entries])
        indptr = np.cumsum([0, *map(len, entries)])
        matrix = from_rows(indptr, rows.column[place], program.gradient[place], program.y.size)
        lengths, kind, sign = row_lengths(matrix), rows.row["kind"][listed], rows.row["sign"][listed]
        missing = (program.bound[listed] - matrix @ program.y) / lengths
        # A point of a curved set obeys the linearisation of a container, but not that of an obstacle.
        binding = (kind == AFFINE) | ((kind == DISTANCE) & (sign < 0)) | (not self._exact)
        size = max(float(np.abs(program.y).max()), float(np.abs(self.problem.x0).max()) / self.units.length)
        multipliers = program.multiplier[listed] * lengths
        return why_unsolved(failure, divided(matrix, lengths), missing, size, binding, multipliers)


def tabulate(
    blocks: Sequence[RowsOfOneKind], n: int, d: int, unit: float = 1.0, *, dense: bool = False
) -> tuple[RowTable, tuple[int, ...]]:
    """Make the table of the rows of all blocks, one below the other, and find the blocks that only Python can evaluate.

    Returns the indices of these blocks, too; their rows have entries in all n coordinates, if ``dense``. Lengths are
    divided by ``unit``.
    """
    called: list[int] = []
    parts, before = [], 0
    for family, block in enumerate(blocks):
        if not len(block):
            continue
        part = block.tabulated(d)
        if part is None:
            m, e = len(block), n if dense else 0
            called.append(family)
            numbers = {"kind": CALLBACK, "i": before + np.arange(m), "j": -1, "lipschitz": np.inf}
            part = TableRows(numbers, np.full(m, e), np.tile(np.arange(e), m), np.zeros(m * e))
            before += m
        row = np.zeros(len(part.entries), dtype=ROW)
        for name, values in part.numbers.items():
            row[name] = values
        row["family"] = family
        row["length"] /= unit
        apart = np.repeat(row["kind"] == DISTANCE, part.entries)
        parts.append((row, part, np.where(apart, part.coefficient / unit, part.coefficient)))
    entries = np.concatenate([np.zeros(1, dtype=np.int64), *(part.entries for _, part, _ in parts)])
    column = np.concatenate([np.zeros(0, dtype=np.int64), *(part.column for _, part, _ in parts)])
    coefficient = np.concatenate([np.zeros(0), *(numbers for _, _, numbers in parts)])
    rows = np.concatenate([np.zeros(0, dtype=ROW), *(row for row, _, _ in parts)])
    loose = bool(called) and not dense
    more, tail = (min(before * n, MOST_DENSE), len(column)) if loose else (0, -1)
    return row_table(rows, np.cumsum(entries), column, coefficient, tail=tail, more=more), tuple(called)
