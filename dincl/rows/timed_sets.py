"""Sets whose numbers are functions of time alone: piecewise Chebyshev polynomials, which compiled code evaluates.

``dincl.system.time_tables`` makes them before a run.
"""

from typing import Annotated, NamedTuple

import numpy as np
from numpy.typing import NDArray

from dincl.compiled import inner
from dincl.compiled.arrays import Floats, Offsets
from dincl.rows.formulas import to_image

# Terms of a series.
TERMS = 18
# What changes in time: the length or the square of a row, or one of its coefficients.
SQUARE, LENGTH, COEFFICIENT = range(3)
# Kinds of rows, as in ``dincl.rows.table``.
DISTANCE = 0

TIMED_SET = np.dtype(
    [
        ("family", np.int64),
        ("translated", np.int64),  # 1 if the functions are the displacement of the set
        ("panel", np.int64),  # its first panel, its first function, its first number and the first weight
        ("function", np.int64),
        ("number", np.int64),
        ("weight", np.int64),
        ("series", np.int64),  # the place of its first series
        ("panels", np.int64),  # how many panels, functions and numbers it has
        ("functions", np.int64),
        ("numbers", np.int64),
        ("now", np.int64),  # the panel of the last time
        ("time", np.float64),  # whose values are in ``value``, and in the table of rows
        ("since", np.float64),  # whose values are in ``reference``
    ]
)
NUMBER = np.dtype(
    [
        ("row", np.int64),
        ("kind", np.int64),
        ("place", np.int64),  # among the coefficients, and the coordinate that the coefficient belongs to
        ("column", np.int64),
        ("base", np.float64),  # the number is base + sum_j weight_j f_j(t)
    ]
)


class TimedSets(NamedTuple):
    """Functions of time f_j of sets, and the numbers of rows that are linear in them; rows in the order of the table.

    A function has ``TERMS`` coefficients in each panel [start, stop] of its set.
    """

    sets: Annotated[NDArray[np.void], TIMED_SET]
    start: Floats
    stop: Floats
    terms: Offsets  # of each panel: the terms that are not zero
    series: Floats
    value: Floats  # of each function, at the last time; and its derivative
    slope: Floats
    reference: Floats  # of each function, at the time with which changes are compared; and its derivative
    unused: Floats
    number: Annotated[NDArray[np.void], NUMBER]
    weight: Floats
    polynomial: Floats  # (TERMS,): Chebyshev polynomials, and their derivatives
    derivative: Floats
    row: NDArray[np.void]  # of the table of rows
    first: Offsets
    coefficient: Floats
    radius: Floats  # (1,): the search radius
    compares: int  # 0 if nobody asks for changes


@inner
def place_sets(timed: TimedSets, shift: Floats, speed: Floats, t: float) -> None:
    """Write displacements and their velocities, and the numbers of the rows of sets that are not translated."""
    for g in range(timed.sets.size):
        one = timed.sets[g]
        if one.time == t:
            continue
        one.time = t
        evaluate_functions(timed, g, t, timed.value, timed.slope)
        if one.translated == 0:
            write_numbers(timed, g)
            continue
        for k in range(shift.shape[1]):
            f = one.function + k
            shift[one.family, k], speed[one.family, k] = timed.value[f], timed.slope[f]


@inner
def evaluate_functions(timed: TimedSets, g: int, t: float, value: Floats, slope: Floats) -> None:
    """Write the functions of a set into ``value``, their derivatives into ``slope``: T_n' = n U_(n - 1)."""
    one, terms = timed.sets[g], 0
    panel, last = one.panel + one.now, one.panel + one.panels - 1
    while panel < last and t > timed.stop[panel]:
        panel += 1
    while panel > one.panel and t <= timed.stop[panel - 1]:
        panel -= 1
    one.now, terms = panel - one.panel, timed.terms[panel]
    width = max(timed.stop[panel] - timed.start[panel], 1e-300)
    theta = ((t - timed.start[panel]) - (timed.stop[panel] - t)) / width
    polynomial, derivative, second = timed.polynomial, timed.derivative, 1.0  # the last one is U_(n - 1)
    polynomial[0], polynomial[1], derivative[0], derivative[1], before = 1.0, theta, 0.0, 1.0, 0.0
    for n in range(2, terms):
        polynomial[n] = 2.0 * theta * polynomial[n - 1] - polynomial[n - 2]
        second, before = 2.0 * theta * second - before, second
        derivative[n] = n * second
    for j in range(one.functions):
        place, total, rising = one.series + TERMS * (one.now * one.functions + j), 0.0, 0.0
        for n in range(terms):
            total += timed.series[place + n] * polynomial[n]
            rising += timed.series[place + n] * derivative[n]
        value[one.function + j], slope[one.function + j] = total, rising * 2.0 / width


@inner
def write_numbers(timed: TimedSets, g: int) -> None:
    """Write the numbers of the rows of a set into the table."""
    one = timed.sets[g]
    for k in range(one.number, one.number + one.numbers):
        number, weight = timed.number[k], one.weight + (k - one.number) * one.functions
        total = number.base
        for j in range(one.functions):
            total += timed.weight[weight + j] * timed.value[one.function + j]
        if number.kind == SQUARE:
            timed.row[number.row].square = total
        elif number.kind == LENGTH:
            timed.row[number.row].length = total
        else:
            timed.coefficient[number.place] = total


@inner
def write_rates(timed: TimedSets, rate: Floats, x: Floats, d: int, box: Floats) -> None:
    """Write (dg/dt) / |grad g| of the rows of sets that are not translated, at x."""
    for g in range(timed.sets.size):
        one, last = timed.sets[g], -1
        for k in range(one.number, one.number + one.numbers):
            number, slope, weight = timed.number[k], 0.0, one.weight + (k - one.number) * one.functions
            r = number.row
            row = timed.row[r]
            for j in range(one.functions):
                slope += timed.weight[weight + j] * timed.slope[one.function + j]
            if r != last:
                last, rate[r] = r, 0.0
            length = np.sqrt(row.square) if row.square > 0.0 else 1.0  # as for gaps
            if row.kind == DISTANCE and row.plain != 0:
                length = 1.0
            if number.kind == LENGTH:
                rate[r] -= slope * (row.sign if row.kind == DISTANCE else 1.0) / length
            elif number.kind == COEFFICIENT and row.kind == DISTANCE:
                rate[r] -= slope * along(timed, r, number.place, x, d, box) / length
            elif number.kind == COEFFICIENT:
                rate[r] += slope * x[number.column] / length


@inner
def write_changes(timed: TimedSets, change: Floats, since: float, x: Floats, n: int, d: int) -> None:
    """Write how much each set that is not translated has changed since the time ``since``.

    That is a bound of the change of each gap near x, over the Lipschitz constant of its row.
    """
    radius = timed.radius[0]
    for i in range(0, n, d):
        square = 0.0
        for k in range(d):
            square += x[i + k] * x[i + k]
        # The bound also holds for rows that the next search may list.
        radius = max(radius, np.sqrt(square))
    for g in range(timed.sets.size):
        one = timed.sets[g]
        if one.translated != 0:
            continue
        if one.since != since:
            one.since = since
            evaluate_functions(timed, g, since, timed.reference, timed.unused)
        change[one.family] = change_of(timed, g, x, radius)


@inner
def change_of(timed: TimedSets, g: int, x: Floats, radius: float) -> float:
    """Compute how much a set has changed within ``radius`` of x."""
    one, largest, moved, turned, last = timed.sets[g], 0.0, 0.0, 0.0, -1
    stop = one.number + one.numbers
    for k in range(one.number, stop):
        number, changed, weight = timed.number[k], 0.0, one.weight + (k - one.number) * one.functions
        row = timed.row[number.row]
        for j in range(one.functions):
            f = one.function + j
            changed += timed.weight[weight + j] * (timed.value[f] - timed.reference[f])
        if number.row != last:
            last, moved, turned = number.row, 0.0, 0.0
        if row.kind == DISTANCE:
            moved += abs(changed) if number.kind != SQUARE else 0.0
        elif number.kind == LENGTH:
            moved -= changed
        elif number.kind == COEFFICIENT:
            moved += changed * x[number.column]
            turned += abs(changed)
        if k + 1 == stop or timed.number[k + 1].row != last:
            largest = max(largest, (abs(moved) + turned * radius) / row.lipschitz)
    return largest


@inner
def along(timed: TimedSets, r: int, place: int, x: Floats, d: int, box: Floats) -> float:
    """Compute the component of the unit arrow of a distance, times its sign, that belongs to this coefficient.

    ``dincl.rows.table.arrow_of`` is the same for rows of sets that rest or are translated.
    """
    row, first, square, component = timed.row[r], timed.first[r], 0.0, 0.0
    for k in range(d):
        arrow = row.one * x[row.i * d + k] - timed.coefficient[first + k]
        if row.j >= 0:
            arrow -= row.other * x[row.j * d + k]
        if box.size > 0:
            arrow = to_image(arrow, box[k])
        square += arrow * arrow
        if first + k == place:
            component = arrow
    return float(row.sign * component / np.sqrt(square)) if square > 0.0 else 0.0
