"""Rows in one table: their values and gradients at a point, and those near it."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from dincl.compiled import inner
from dincl.compiled.arrays import Floats, Offsets
from dincl.drifts.functions import call_drift
from dincl.rows.formulas import square_distance

# Kinds of rows: of a distance, affine, or evaluated by Python.
DISTANCE, AFFINE, CALLED = 0, 1, 2
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
    """m rows; row r has entries ``start[r]`` ... ``start[r + 1]`` in the coordinates ``column``.

    ``coefficient`` holds a of an affine row, and of a distance from a fixed point that point.
    """

    row: NDArray[np.void]
    start: Offsets
    column: Offsets
    coefficient: Floats


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
def square_of_gradient(rows: RowTable, sets: Sets, r: int) -> float:
    """|grad g_r|^2 of an affine row, or of one that Python has just evaluated."""
    row, square = rows.row[r], 0.0
    if row.kind == AFFINE:
        return float(row.square)
    for p in range(sets.first[row.i], sets.first[row.i + 1]):
        square += sets.entry[p] * sets.entry[p]
    return square


@inner
def value_of(rows: RowTable, sets: Sets, r: int, x: Floats) -> float:
    """g_r(x); of a row that Python evaluates, what it answered."""
    row = rows.row[r]
    if row.kind == DISTANCE:
        return float(row.sign * (distance(rows, sets, r, x) - row.length))
    if row.kind == CALLED:
        return float(sets.value[row.i])
    value, d = 0.0, sets.shift.shape[1]
    for p in range(rows.start[r], rows.start[r + 1]):
        value += rows.coefficient[p] * (x[rows.column[p]] - sets.shift[row.family, rows.column[p] % d])
    return float(value - row.length)


@inner
def gap(rows: RowTable, sets: Sets, r: int, x: Floats) -> float:
    """g_r(x) of a distance; of other rows over the length of the gradient."""
    value = value_of(rows, sets, r, x)
    if rows.row[r].kind == DISTANCE:
        return value
    square = square_of_gradient(rows, sets, r)
    return float(value / np.sqrt(square) if square > 0.0 else value)


@inner
def linearise(rows: RowTable, sets: Sets, r: int, x: Floats, gradient: Floats) -> float:
    """Write the gradient of row r at x into its entries of ``gradient``; its ``gap``, NaN without a direction.

    Its length is 1, and root 2 for the distance of a pair, whose two ends have a unit vector each.

    Two that are held together and meet are farthest from violating: zero is a subgradient, and right there. A gradient
    that vanishes stays as it is.
    """
    row = rows.row[r]
    first, last = rows.start[r], rows.start[r + 1]
    if row.kind == DISTANCE:
        d = sets.shift.shape[1]
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
    square = square_of_gradient(rows, sets, r)
    scale = 1.0 / np.sqrt(square) if square > 0.0 else 1.0
    if row.kind == CALLED:
        for p in range(first, last):
            gradient[p] = 0.0
        for p in range(sets.first[row.i], sets.first[row.i + 1]):
            gradient[first + sets.column[p]] = scale * sets.entry[p]
    else:
        for p in range(first, last):
            gradient[p] = scale * rows.coefficient[p]
    return gap(rows, sets, r, x)


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
            close = row.kind == CALLED or gap(rows, sets, r, x) <= room
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
        r = near.row[p]
        first, last = rows.column[rows.start[r]] // d, rows.column[rows.start[r + 1] - 1] // d
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
