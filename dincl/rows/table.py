"""Rows in one table: their values and gradients at a point, and those near it."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from dincl.compiled import inner
from dincl.compiled.arrays import Floats, Offsets
from dincl.drifts.functions import call_drift
from dincl.rows.formulas import square_distance

# Kinds of rows: of a distance, affine, evaluated by Python, or of a compiled formula.
DISTANCE, AFFINE, CALLED, FORMULA = range(4)
# What Python is asked for: where sets are; the values and gradients of its rows, too; and how fast sets move. Or to
# project x onto the rows of a set, in place.
PLACES, GRADIENTS, SPEEDS, SWEEP = 1.0, 2.0, 3.0, 4.0

ROW = np.dtype(
    [
        ("kind", np.int64),
        ("family", np.int64),  # the index of its constraint
        ("i", np.int64),  # the first particle, and the second or -1; of a called row its place among them
        ("j", np.int64),
        ("length", np.float64),  # L of sign (|X_i - X_j| - L), b of a.x - b
        ("sign", np.float64),
        ("square", np.float64),  # |a|^2
        ("sway", np.float64),  # how fast g changes at most while no particle moves faster than 1
    ]
)


class RowTable(NamedTuple):
    """m rows; row r has entries ``start[r]`` ... ``stop[r] - 1`` in the coordinates ``column``.

    ``coefficient`` holds a of an affine row, of a distance from a fixed point that point, of a formula its parameters.
    Rows that Python evaluates have entries in all coordinates, or, if ``tail[0]`` is not -1, those of their last
    gradients, from the entry ``tail[0]`` on.
    """

    row: NDArray[np.void]
    start: Offsets
    stop: Offsets
    column: Offsets
    coefficient: Floats
    tail: Offsets  # (1,)
    formula: Offsets  # (m,), or (0,) if there is none: addresses of formulas, see ``dincl.rows.formulas.row_formula``
    unit: Floats  # (1,): a coordinate times this is what formulas take
    point: Floats  # what a formula is given
    slope: Floats  # and what it writes: its gradient, and behind it its value


def row_table(
    row: NDArray[np.void],
    offset: Offsets,
    column: Offsets,
    coefficient: Floats,
    *,
    tail: int = -1,
    more: int = 0,
    formula: Offsets | None = None,
    unit: float = 1.0,
) -> RowTable:
    """Make the table of rows with entries ``offset[r]`` ... ``offset[r + 1] - 1``, and room for so many more."""
    widest = int(np.diff(offset).max(initial=0))
    return RowTable(
        row,
        np.array(offset[:-1]),
        np.array(offset[1:]),
        np.append(column, np.zeros(more, dtype=np.int64)),
        coefficient,
        np.full(1, tail),
        np.zeros(0, dtype=np.int64) if formula is None else formula,
        np.full(1, unit),
        np.zeros(widest),
        np.zeros(widest + 1),
    )


class Sets(NamedTuple):
    """What Python fills in when its function at ``address`` is called.

    ``ask[0]`` is the question, of the set ``ask[2]`` if of one. ``ask[1]`` is not 0 once an answer failed; then nothing
    is asked any more.
    """

    address: int
    ask: Floats
    shift: Floats  # (families, d): how far each set was carried
    speed: Floats  # (families, d): how fast it is carried
    value: Floats  # (called rows,): g
    first: Offsets  # (called rows + 1,): the Jacobian dg/dx, row by row
    column: Offsets
    entry: Floats


class NearRows(NamedTuple):
    """The rows near a point, ``row[:count[0]]``; ``number[1]`` lists were made; pairs kept apart are ``number[2]``."""

    row: Offsets
    key: Floats
    number: Offsets
    reference: Floats  # (n,): where the list was made, with sets carried by ``carried``, for this reach
    carried: Floats
    reach: Floats
    search: int  # the address of the function that puts the near rows into the table; 0 where it holds all rows


def room_for_list(m: int, n: int, families: int, d: int, search: int = 0) -> NearRows:
    """Room for a list of at most m rows; none is made yet."""
    row, number = np.zeros(m, dtype=np.int64), np.zeros(3, dtype=np.int64)
    return NearRows(row, np.zeros(m), number, np.zeros(n), np.zeros((families, d)), np.full(1, -1.0), search)


@inner
def ask(sets: Sets, t: float, x: Floats, what: float) -> int:
    """Let Python fill in what it alone knows; 0 if there is nothing, or if this and all before it went well.

    A step may go on with old answers, and is not made when it ends with a failure.
    """
    if sets.address == 0:
        return 0
    sets.ask[0] = what
    if sets.ask[1] == 0.0:
        failed = call_drift(sets.address, t, x, sets.shift, x.size, sets.shift.shape[1], sets.ask)
        sets.ask[1] = max(sets.ask[1], float(failed))
    return int(sets.ask[1])


@inner
def distance(rows: RowTable, sets: Sets, r: int, x: Floats) -> float:
    """|X_i - X_j| of a row of distances."""
    row = rows.row[r]
    d = sets.shift.shape[1]
    if row.j >= 0:
        return float(np.sqrt(square_distance(x, row.i * d, x, row.j * d, sets.shift[row.family])))
    square = 0.0
    for k in range(d):
        arrow = x[row.i * d + k] - (rows.coefficient[rows.start[r] + k] + sets.shift[row.family, k])
        square += arrow * arrow
    return float(np.sqrt(square))


@inner
def call_formula(rows: RowTable, sets: Sets, r: int, x: Floats) -> float:
    """g_r(x) of a compiled formula, NaN without a direction; its gradient is in ``slope`` then."""
    row, first, d, unit = rows.row[r], rows.start[r], sets.shift.shape[1], rows.unit[0]
    entries, point, slope = rows.stop[r] - first, rows.point, rows.slope
    for p in range(entries):
        column = rows.column[first + p]
        point[p] = unit * (x[column] - sets.shift[row.family, column % d])
    if call_drift(rows.formula[r], 0.0, point, slope, entries, d, rows.coefficient[first:]) != 0:
        return np.nan
    for p in range(entries):
        slope[p] *= unit
    return float(slope[entries])


@inner
def value_of(rows: RowTable, sets: Sets, r: int, x: Floats) -> float:
    """g_r(x); of a row that Python evaluates, what it answered."""
    row = rows.row[r]
    if row.kind == DISTANCE:
        return float(row.sign * (distance(rows, sets, r, x) - row.length))
    if row.kind == AFFINE:
        value, d = 0.0, sets.shift.shape[1]
        for p in range(rows.start[r], rows.stop[r]):
            value += rows.coefficient[p] * (x[rows.column[p]] - sets.shift[row.family, rows.column[p] % d])
        return float(value - row.length)
    return float(sets.value[row.i]) if row.kind == CALLED else call_formula(rows, sets, r, x)


@inner
def gap(rows: RowTable, sets: Sets, r: int, x: Floats) -> float:
    """g_r(x) of a distance; of other rows over the length of the gradient."""
    row, value = rows.row[r], value_of(rows, sets, r, x)
    if row.kind == DISTANCE:
        return value
    square = row.square if row.kind == AFFINE else square_of_gradient(rows, sets, r)
    return float(value / np.sqrt(square) if square > 0.0 else value)


@inner
def square_of_gradient(rows: RowTable, sets: Sets, r: int) -> float:
    """|grad g_r|^2 of a row that Python or a formula has just evaluated."""
    row, square = rows.row[r], 0.0
    if row.kind == CALLED:
        for p in range(sets.first[row.i], sets.first[row.i + 1]):
            square += sets.entry[p] * sets.entry[p]
    else:
        for p in range(rows.stop[r] - rows.start[r]):
            square += rows.slope[p] * rows.slope[p]
    return square


@inner
def evaluate_row(rows: RowTable, sets: Sets, r: int, x: Floats, gradient: Floats) -> float:
    """Write the gradient of row r at x into its entries of ``gradient``; g_r(x), NaN without a direction."""
    row = rows.row[r]
    if row.kind == DISTANCE:
        return evaluate_distance(rows, sets, r, x, gradient)
    if row.kind == AFFINE:
        for p in range(rows.start[r], rows.stop[r]):
            gradient[p] = rows.coefficient[p]
        return value_of(rows, sets, r, x)
    return evaluate_other(rows, sets, r, x, gradient)


@inner
def evaluate_distance(rows: RowTable, sets: Sets, r: int, x: Floats, gradient: Floats) -> float:
    """The same for a distance: unit vectors at its ends.

    Two that are held together and meet are farthest from violating: zero is a subgradient, and right there.
    """
    row, first, d = rows.row[r], rows.start[r], sets.shift.shape[1]
    i, j, length = row.i * d, row.j * d, distance(rows, sets, r, x)
    if length == 0.0 and row.sign > 0.0:
        return np.nan
    scale = row.sign / length if length > 0.0 else 0.0
    for k in range(d):
        if row.j >= 0:
            gradient[first + k] = scale * (x[i + k] - x[j + k])
            gradient[first + d + k] = -gradient[first + k]
        else:
            gradient[first + k] = scale * (x[i + k] - rows.coefficient[first + k] - sets.shift[row.family, k])
    return float(row.sign * (length - row.length))


@inner
def evaluate_other(rows: RowTable, sets: Sets, r: int, x: Floats, gradient: Floats) -> float:
    """The same for a row that Python or a formula evaluates."""
    row, value = rows.row[r], value_of(rows, sets, r, x)
    if row.kind == FORMULA:
        for p in range(rows.start[r], rows.stop[r]):
            gradient[p] = rows.slope[p - rows.start[r]]
        return value
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
    """Write the gradient of row r at x into its entries of ``gradient``; its ``gap``, NaN without a direction.

    Its length is 1, and root 2 for the distance of a pair, whose two ends have a unit vector each. A gradient that
    vanishes stays as it is.
    """
    row = rows.row[r]
    if row.kind == DISTANCE:
        return evaluate_distance(rows, sets, r, x, gradient)
    value, square = evaluate_row(rows, sets, r, x, gradient), row.square
    if row.kind != AFFINE:
        square = 0.0
        for p in range(rows.start[r], rows.stop[r]):
            square += gradient[p] * gradient[p]
    if square == 1.0 or not square > 0.0:
        return value
    scale = 1.0 / np.sqrt(square)
    for p in range(rows.start[r], rows.stop[r]):
        gradient[p] = scale * gradient[p]
    return float(value / np.sqrt(square))


@inner
def find_near(rows: RowTable, sets: Sets, x: Floats, reach: float, near: NearRows) -> None:
    """List the rows that can be violated once every particle moved by at most ``reach``, in their order."""
    count, pairs, d = 0, 0, sets.shift.shape[1]
    for r in range(rows.row.size):
        row = rows.row[r]
        room = row.sway * reach
        if row.kind == DISTANCE and row.sign > 0.0 and row.j >= 0:
            square, least = 0.0, row.length + room
            for k in range(d):
                arrow = x[row.i * d + k] - x[row.j * d + k]
                square += arrow * arrow
            close = square <= least * least
        elif row.kind == AFFINE:
            close = gap(rows, sets, r, x) * np.sqrt(row.square) <= room
        else:
            # A room that is no number is that of a formula of which nothing is known.
            close = row.kind == CALLED or not value_of(rows, sets, r, x) > room
        if close:
            near.row[count] = r
            count += 1
            pairs += row.kind == DISTANCE and row.sign > 0.0 and row.j >= 0
    near.number[0] = count
    near.number[2] = pairs
    note_list(sets, x, reach, near)


@inner
def note_list(sets: Sets, x: Floats, reach: float, near: NearRows) -> None:
    """Note where the list was made."""
    d = sets.shift.shape[1]
    near.number[1] += 1
    near.reach[0] = reach
    for k in range(x.size):
        near.reference[k] = x[k]
    for f in range(sets.shift.shape[0]):
        for k in range(d):
            near.carried[f, k] = sets.shift[f, k]


@inner
def sort_near(rows: RowTable, x: Floats, d: int, near: NearRows) -> None:
    """Put the near rows in the order of the axis along which the particles extend farthest (Shell's sort)."""
    axis, widest = 0, -1.0
    for k in range(d):
        low, high = x[k], x[k]
        for p in range(k, x.size, d):
            low, high = min(low, x[p]), max(high, x[p])
        if high - low > widest:
            axis, widest = k, high - low
    count = near.number[0]
    for p in range(count):
        r, near.key[p] = near.row[p], 0.0
        if rows.stop[r] > rows.start[r]:
            first, last = rows.column[rows.start[r]] // d, rows.column[rows.stop[r] - 1] // d
            near.key[p] = x[first * d + axis] + x[last * d + axis]
    step = 1
    while step < count // 3:
        step = 3 * step + 1
    while step > 0:
        for p in range(step, count):
            key, r, q = near.key[p], near.row[p], p
            while q >= step and near.key[q - step] > key:
                near.key[q], near.row[q] = near.key[q - step], near.row[q - step]
                q -= step
            near.key[q], near.row[q] = key, r
        step //= 3


@inner
def distance_from_list(sets: Sets, x: Floats, near: NearRows) -> float:
    """How far particles and sets at most are, together, from where the list was made."""
    d, moved, carried = sets.shift.shape[1], 0.0, 0.0
    for i in range(x.size // d):
        square = 0.0
        for k in range(d):
            square += (x[i * d + k] - near.reference[i * d + k]) ** 2
        moved = max(moved, square)
    for f in range(sets.shift.shape[0]):
        square = 0.0
        for k in range(d):
            square += (sets.shift[f, k] - near.carried[f, k]) ** 2
        carried = max(carried, square)
    return float(np.sqrt(moved) + np.sqrt(carried))
