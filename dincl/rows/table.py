"""Rows in one table for compiled code: values and gradients at a point."""

from functools import partial
from typing import Annotated, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from dincl.compiled import c_function, call, inner
from dincl.compiled.arrays import Floats, Offsets, Table, empty
from dincl.compiled.calls import DOUBLES, SETS, signature
from dincl.compiled.structs import reader, struct_type
from dincl.rows.formulas import square_distance, to_image
from dincl.rows.timed_sets import TimedSet, place_set, write_change, write_rates

# Kinds of rows: distances, affine rows, rows that Python evaluates.
DISTANCE, AFFINE, CALLBACK = range(3)
# Requests to Python: displacements of the sets; also values and gradients of its rows; also velocities of the sets.
DISPLACEMENTS, GRADIENTS, VELOCITIES = range(1, 4)

call_sets = call(SETS)

ROW = np.dtype(  # one cache line
    [
        ("kind", np.int16),
        ("plain", np.int16),  # of a distance: whether both scales are 1 and nothing is periodic
        ("family", np.int32),  # the index of its constraint
        ("i", np.int32),  # the first particle, and the second or -1; of a row of Python its place among these rows
        ("j", np.int32),
        ("length", np.float64),  # L of sign (|s_i X_i - s_j X_j| - L), b of a.x - b
        ("sign", np.float64),
        ("square", np.float64),  # |a|^2, or |grad g|^2 of a distance
        ("lipschitz", np.float64),  # how fast g changes at most while no particle and no set moves faster than 1
        ("one", np.float64),  # of a distance: the scales s_i and s_j
        ("other", np.float64),
    ]
)
timed_set_at = reader(empty(TimedSet)._replace(row=np.zeros(0, dtype=ROW)))


class RowTable(NamedTuple):
    """m rows; row r has entries ``start[r]`` ... ``stop[r] - 1`` in the coordinates ``column``.

    ``coefficient`` holds a of an affine row, the fixed point of a distance. Rows that Python evaluates have entries in
    all coordinates, or, if ``tail[0]`` is not -1, the entries of their last gradients, from the entry ``tail[0]`` on.
    """

    row: Annotated[NDArray[np.void], ROW]
    start: Offsets
    stop: Offsets
    column: Offsets
    coefficient: Floats
    tail: Offsets  # (1,)


def row_table(
    row: NDArray[np.void], offset: Offsets, column: Offsets, coefficient: Floats, *, tail: int = -1, more: int = 0
) -> RowTable:
    """Make the table of rows with entries ``offset[r]`` ... ``offset[r + 1] - 1``, and space for ``more`` of them."""
    return RowTable(
        row,
        np.array(offset[:-1]),
        np.array(offset[1:]),
        np.append(column, np.zeros(more, dtype=np.int64)),
        coefficient,
        np.full(1, tail),
    )


class Sets(NamedTuple):
    """Displacements of the sets, and the rows that Python evaluates: its function at ``address`` writes them.

    ``failed[0]`` is not 0 once a call has failed; then there are no more calls. A set that is not only translated is
    ``general``: at each request its numbers in the table are written. Sets in ``tables`` are evaluated by compiled
    code, all others by Python.
    """

    address: int
    failed: Offsets  # (1,)
    shift: Table  # (families, d): the displacement of each set
    speed: Table  # (families, d): its velocity
    general: Offsets  # (families,): 1 for general sets
    since: Floats  # (1,): the time with which they are compared
    change: Floats  # (families,): how much they have changed since, see ``Constraint.change``
    rate: Floats  # (m,): (dg/dt) / |grad g| of the rows of general sets
    value: Floats  # (rows of Python,): g
    first: Offsets  # (rows of Python + 1,): the Jacobian dg/dx, row by row
    column: Offsets
    entry: Floats
    box: Floats  # (d,): the periods of the axes, 0 for one that does not repeat; or (0,) if none does
    tables: Offsets  # whether Python writes anything; the address of ``write_timed``; those of each TimedSet, if any


# int64 f(sets, t, x, coordinates, request): compiled code writes what is requested, see ``write_timed``.
TIMED: Any = signature(int, struct_type(empty(Sets)), float, DOUBLES, int, int)
call_timed = call(TIMED)


@partial(c_function, TIMED)
def write_timed(sets: Sets, t: float, x: Floats, n: int, request: int) -> int:
    """Write what is requested of the sets that compiled code evaluates; request 0: how much they have changed near x.

    By its address, so that kernels of runs without such sets are compiled without it.
    """
    d = sets.shift.shape[1]
    for g in range(2, sets.tables.size):
        one = timed_set_at(sets.tables[g])
        if request > 0:
            place_set(one, sets.shift, sets.speed, t)
        if request == VELOCITIES:
            write_rates(one, sets.rate, x, d, sets.box)
        if request <= DISPLACEMENTS and one.compares != 0:
            write_change(one, sets.change, sets.since[0], x, n, d)
    return 0


@inner
def call_python(sets: Sets, t: float, x: Floats, request: int) -> int:
    """Write what is requested, or have Python write it; return 0 if no call of Python has failed so far.

    After a failure a step may go on with old numbers: at its end it is rejected.
    """
    if sets.address == 0:
        return 0
    if sets.tables.size > 2:
        call_timed(sets.tables[1], sets, t, x, x.size, request)
    if sets.failed[0] == 0 and sets.tables[0] != 0:
        sets.failed[0] = max(sets.failed[0], call_sets(sets.address, t, x, request))
    return int(sets.failed[0])


@inner
def compare_sets(sets: Sets, x: Floats) -> None:
    """Write how much the sets that compiled code evaluates have changed, near x."""
    if sets.tables.size > 2:
        call_timed(sets.tables[1], sets, 0.0, x, x.size, 0)


@inner
def is_timed(sets: Sets, row: Any) -> bool:
    """Return whether a row may depend on time."""
    return bool(sets.address != 0 and (row.j < 0 or sets.general[row.family] != 0))


@inner
def arrow_of(rows: RowTable, sets: Sets, r: int, x: Floats, k: int) -> float:
    """Compute component k of the arrow of a row of distances, s_i X_i - s_j X_j - anchor, the shortest to an image."""
    row, d = rows.row[r], sets.shift.shape[1]
    other = rows.coefficient[rows.start[r] + k]
    other += row.other * x[row.j * d + k] if row.j >= 0 else sets.shift[row.family, k]
    arrow = row.one * x[row.i * d + k] - other
    return float(to_image(arrow, sets.box[k]) if sets.box.size > 0 else arrow)


@inner
def distance(rows: RowTable, sets: Sets, r: int, x: Floats) -> float:
    """Compute the length of the arrow of a row of distances."""
    row, d, square = rows.row[r], sets.shift.shape[1], 0.0
    if row.plain != 0 and row.j >= 0:
        return float(np.sqrt(square_distance(x, row.i * d, x, row.j * d, sets.shift[row.family])))
    for k in range(d):
        arrow = arrow_of(rows, sets, r, x, k)
        square += arrow * arrow
    return float(np.sqrt(square))


@inner
def value_of(rows: RowTable, sets: Sets, r: int, x: Floats) -> float:
    """Compute g_r(x); for a row of Python, return the value that it wrote last."""
    row = rows.row[r]
    if row.kind == DISTANCE:
        return float(row.sign * (distance(rows, sets, r, x) - row.length))
    if row.kind == AFFINE:
        value, d = 0.0, sets.shift.shape[1]
        for p in range(rows.start[r], rows.stop[r]):
            value += rows.coefficient[p] * (x[rows.column[p]] - sets.shift[row.family, rows.column[p] % d])
        return float(value - row.length)
    return float(sets.value[row.i])


@inner
def gap(rows: RowTable, sets: Sets, r: int, x: Floats) -> float:
    """Compute g_r(x) of a distance in the coordinates of the user, and g_r(x) / |grad g_r(x)| of other rows."""
    row, value = rows.row[r], value_of(rows, sets, r, x)
    if row.kind == DISTANCE and row.plain != 0:
        return value
    square = row.square if row.kind == AFFINE or row.kind == DISTANCE else square_of_gradient(rows, sets, r)
    return float(value / np.sqrt(square) if square > 0.0 else value)


@inner
def square_of_gradient(rows: RowTable, sets: Sets, r: int) -> float:
    """Compute |grad g_r|^2 of a row that Python has just evaluated."""
    row, square = rows.row[r], 0.0
    for p in range(sets.first[row.i], sets.first[row.i + 1]):
        square += sets.entry[p] * sets.entry[p]
    return square


@inner
def scaled_length(rows: RowTable, sets: Sets, r: int) -> float:
    """Return the factor by which ``linearise`` divided the gradient and the gap of row r just now."""
    row = rows.row[r]
    if row.kind == DISTANCE and row.plain != 0:
        return 1.0
    square = row.square if row.kind == AFFINE or row.kind == DISTANCE else square_of_gradient(rows, sets, r)
    return float(np.sqrt(square)) if square > 0.0 else 1.0


@inner
def evaluate_row(rows: RowTable, sets: Sets, r: int, x: Floats, gradient: Floats) -> float:
    """Write the gradient of row r at x into its entries of ``gradient``; return g_r(x), NaN without a gradient."""
    row = rows.row[r]
    if row.kind == DISTANCE:
        return evaluate_distance(rows, sets, r, x, gradient)
    if row.kind == AFFINE:
        for p in range(rows.start[r], rows.stop[r]):
            gradient[p] = rows.coefficient[p]
        return value_of(rows, sets, r, x)
    return evaluate_called(rows, sets, r, gradient)


@inner
def evaluate_distance(rows: RowTable, sets: Sets, r: int, x: Floats, gradient: Floats) -> float:
    """Write the unit vectors at both ends of a distance; return g_r(x), NaN without a gradient.

    Where two that are held together coincide, zero is a subgradient.
    """
    row, first, d = rows.row[r], rows.start[r], sets.shift.shape[1]
    length = distance(rows, sets, r, x)
    if length == 0.0 and row.sign > 0.0:
        return np.nan
    scale = row.sign / length if length > 0.0 else 0.0
    if row.plain != 0 and row.j >= 0:  # the usual case, a tenth of the time of a run
        for k in range(d):
            slope = scale * (x[row.i * d + k] - x[row.j * d + k])
            gradient[first + k], gradient[first + d + k] = slope, -slope
        return float(row.sign * (length - row.length))
    for k in range(d):
        slope = scale * arrow_of(rows, sets, r, x, k)
        gradient[first + k] = row.one * slope
        if row.j >= 0:
            gradient[first + d + k] = -row.other * slope
    return float(row.sign * (length - row.length))


@inner
def evaluate_called(rows: RowTable, sets: Sets, r: int, gradient: Floats) -> float:
    """Write the gradient of a row that Python evaluates; return g_r(x)."""
    row, value = rows.row[r], float(sets.value[rows.row[r].i])
    begin, end, tail = sets.first[row.i], sets.first[row.i + 1], rows.tail[0]
    if tail < 0:
        first = rows.start[r]
        for p in range(first, rows.stop[r]):
            gradient[p] = 0.0
        for p in range(begin, end):
            gradient[first + sets.column[p]] = sets.entry[p]
        return value
    rows.start[r], rows.stop[r] = tail + begin, tail + end
    for p in range(begin, end):
        rows.column[tail + p], gradient[tail + p] = sets.column[p], sets.entry[p]
    return value


@inner
def linearise(rows: RowTable, sets: Sets, r: int, x: Floats, gradient: Floats) -> float:
    """Write the gradient of row r at x, scaled to length 1, into ``gradient``; return the gap, NaN without a gradient.

    The gradient for the plain distance of a pair keeps its length, root 2. A gradient that vanishes stays as it is.
    """
    row = rows.row[r]
    if row.kind == DISTANCE and row.plain != 0:
        return evaluate_distance(rows, sets, r, x, gradient)
    value, square = evaluate_row(rows, sets, r, x, gradient), row.square
    if row.kind != AFFINE and row.kind != DISTANCE:
        square = 0.0
        for p in range(rows.start[r], rows.stop[r]):
            square += gradient[p] * gradient[p]
    if square == 1.0 or not square > 0.0:
        return value
    scale = 1.0 / np.sqrt(square)
    for p in range(rows.start[r], rows.stop[r]):
        gradient[p] = scale * gradient[p]
    return float(value / np.sqrt(square))
