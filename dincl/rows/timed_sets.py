"""Sets whose numbers are functions of time alone: piecewise Chebyshev polynomials, which compiled code evaluates.

``dincl.system.time_tables`` makes them before a run.
"""

from typing import Annotated, NamedTuple

import numpy as np
from numpy.typing import NDArray

from dincl.compiled import inner
from dincl.compiled.arrays import Floats, Offsets, Table
from dincl.rows.formulas import to_image

# Terms of a series.
TERMS = 18
# What changes in time: the length or the square of a row, or one of its coefficients.
SQUARE, LENGTH, COEFFICIENT = range(3)
# Kinds of rows, as in ``dincl.rows.table``.
DISTANCE = 0

NUMBER = np.dtype(
    [
        ("row", np.int64),
        ("kind", np.int64),
        ("place", np.int64),  # among the coefficients, and the coordinate that the coefficient belongs to
        ("column", np.int64),
        ("base", np.float64),  # the number is base + sum_j weight_j f_j(t)
    ]
)


class TimedSet(NamedTuple):
    """F functions of time f_j of a set, on P panels, and the K numbers of its rows that are linear in them."""

    family: int
    translated: int  # 1 if the functions are the displacement of the set
    start: Floats  # (P,): where panels start and stop
    stop: Floats
    terms: Offsets  # (P,): the terms that are not zero
    series: Annotated[NDArray[np.float64], 3]  # (P, F, TERMS)
    number: Annotated[NDArray[np.void], NUMBER]  # (K,), rows in the order of the table
    weight: Table  # (K, F)
    now: Offsets  # (1,): the panel of the last time
    time: Floats  # (2,): that of ``value`` and of the numbers in the table, and that of ``reference``
    value: Floats  # (F,): the functions at the last time; and their derivatives
    slope: Floats
    reference: Floats  # (F,): at the time with which changes are compared; and their derivatives
    unused: Floats
    polynomial: Floats  # (TERMS,): Chebyshev polynomials, and their derivatives
    derivative: Floats
    row: NDArray[np.void]  # of the table of rows
    first: Offsets
    coefficient: Floats
    radius: Floats  # (1,): the search radius
    compares: int  # 0 if nobody asks for changes


@inner
def place_set(one: TimedSet, shift: Floats, speed: Floats, t: float) -> None:
    """Write the displacement and velocity of a set that is translated, else the numbers of its rows."""
    if one.time[0] == t:
        return
    one.time[0] = t
    evaluate_functions(one, t, one.value, one.slope)
    if one.translated == 0:
        write_numbers(one)
    else:
        for k in range(shift.shape[1]):
            shift[one.family, k], speed[one.family, k] = one.value[k], one.slope[k]


@inner
def evaluate_functions(one: TimedSet, t: float, value: Floats, slope: Floats) -> None:
    """Write the functions of a set into ``value``, their derivatives into ``slope``: T_n' = n U_(n - 1)."""
    panel, last = one.now[0], one.start.size - 1
    while panel < last and t > one.stop[panel]:
        panel += 1
    while panel > 0 and t <= one.stop[panel - 1]:
        panel -= 1
    one.now[0], terms = panel, one.terms[panel]
    width = max(one.stop[panel] - one.start[panel], 1e-300)
    theta = ((t - one.start[panel]) - (one.stop[panel] - t)) / width
    polynomial, derivative, second = one.polynomial, one.derivative, 1.0  # the last one is U_(n - 1)
    polynomial[0], polynomial[1], derivative[0], derivative[1], before = 1.0, theta, 0.0, 1.0, 0.0
    for n in range(2, terms):
        polynomial[n] = 2.0 * theta * polynomial[n - 1] - polynomial[n - 2]
        second, before = 2.0 * theta * second - before, second
        derivative[n] = n * second
    for j in range(value.size):
        total, rising = 0.0, 0.0
        for n in range(terms):
            total += one.series[panel, j, n] * polynomial[n]
            rising += one.series[panel, j, n] * derivative[n]
        value[j], slope[j] = total, rising * 2.0 / width


@inner
def write_numbers(one: TimedSet) -> None:
    """Write the numbers of the rows of a set into the table."""
    for k in range(one.number.size):
        number = one.number[k]
        total = number.base
        for j in range(one.value.size):
            total += one.weight[k, j] * one.value[j]
        if number.kind == SQUARE:
            one.row[number.row].square = total
        elif number.kind == LENGTH:
            one.row[number.row].length = total
        else:
            one.coefficient[number.place] = total


@inner
def write_rates(one: TimedSet, rate: Floats, x: Floats, d: int, box: Floats) -> None:
    """Write (dg/dt) / |grad g| of the rows of a set that is not translated, at x."""
    last = -1
    for k in range(one.number.size):
        number, slope = one.number[k], 0.0
        r = number.row
        row = one.row[r]
        for j in range(one.slope.size):
            slope += one.weight[k, j] * one.slope[j]
        if r != last:
            last, rate[r] = r, 0.0
        length = np.sqrt(row.square) if row.square > 0.0 else 1.0  # as for gaps
        if row.kind == DISTANCE and row.plain != 0:
            length = 1.0
        if number.kind == LENGTH:
            rate[r] -= slope * (row.sign if row.kind == DISTANCE else 1.0) / length
        elif number.kind == COEFFICIENT and row.kind == DISTANCE:
            rate[r] -= slope * along(one, r, number.place, x, d, box) / length
        elif number.kind == COEFFICIENT:
            rate[r] += slope * x[number.column] / length


@inner
def write_change(one: TimedSet, change: Floats, since: float, x: Floats, n: int, d: int) -> None:
    """Write how much a set that is not translated has changed since the time ``since``.

    That is a bound of the change of each gap near x, over the Lipschitz constant of its row.
    """
    if one.translated != 0:
        return
    radius, largest, moved, turned, last = one.radius[0], 0.0, 0.0, 0.0, -1
    for i in range(0, n, d):
        square = 0.0
        for k in range(d):
            square += x[i + k] * x[i + k]
        # The bound also holds for rows that the next search may list.
        radius = max(radius, np.sqrt(square))
    if one.time[1] != since:
        one.time[1] = since
        evaluate_functions(one, since, one.reference, one.unused)
    for k in range(one.number.size):
        number, changed = one.number[k], 0.0
        row = one.row[number.row]
        for j in range(one.value.size):
            changed += one.weight[k, j] * (one.value[j] - one.reference[j])
        if number.row != last:
            last, moved, turned = number.row, 0.0, 0.0
        if row.kind == DISTANCE:
            moved += abs(changed) if number.kind != SQUARE else 0.0
        elif number.kind == LENGTH:
            moved -= changed
        elif number.kind == COEFFICIENT:
            moved += changed * x[number.column]
            turned += abs(changed)
        if k + 1 == one.number.size or one.number[k + 1].row != last:
            largest = max(largest, (abs(moved) + turned * radius) / row.lipschitz)
    change[one.family] = largest


@inner
def along(one: TimedSet, r: int, place: int, x: Floats, d: int, box: Floats) -> float:
    """Compute the component of the unit arrow of a distance, times its sign, that belongs to this coefficient.

    ``dincl.rows.table.arrow_of`` is the same for rows of sets that rest or are translated.
    """
    row, first, square, component = one.row[r], one.first[r], 0.0, 0.0
    for k in range(d):
        arrow = row.one * x[row.i * d + k] - one.coefficient[first + k]
        if row.j >= 0:
            arrow -= row.other * x[row.j * d + k]
        if box.size > 0:
            arrow = to_image(arrow, box[k])
        square += arrow * arrow
        if first + k == place:
            component = arrow
    return float(row.sign * component / np.sqrt(square)) if square > 0.0 else 0.0
