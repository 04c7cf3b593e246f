"""Sets whose numbers depend on time alone, as piecewise Chebyshev polynomials that compiled code evaluates."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from dincl.rows.table import AFFINE, DISTANCE, RowTable
from dincl.rows.timed_sets import COEFFICIENT, LENGTH, NUMBER, SQUARE, TERMS, TimedSet
from dincl.system.time_scales import COEFFICIENTS, CUT, EPS, NODES, ROUNDING, SHORT

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from numpy.typing import NDArray

    from dincl.rows.base import TableRows
    from dincl.system.time_scales import Interval

# Numbers at the nodes of all panels of one set at most: 16 MB.
MOST_VALUES = 2_000_000
# Panels at most besides two for each smooth piece, so that a function is not asked for more values than are looked at.
MOST_PANELS = 500
# A panel is not cut to less than this part of the run.
SHORTEST = 1e-9
# Coefficients of a series are rounding up to this, relative to the scale of the numbers.
CHOPPED = 2 * EPS
# A number is a combination of functions of time if it differs by less than this, relative to its scale; and functions
# of one set at most.
ALIKE, MOST_FUNCTIONS = 32 * EPS, 100


class Reading(NamedTuple):
    """What timed sets read and write: the table of rows, the search radius (1,), whether anybody asks for changes."""

    table: RowTable
    radius: NDArray[np.float64]
    compares: bool


def table_of_displacement(
    family: int, path: Callable[[float], NDArray[np.float64]], pieces: Sequence[Interval], size: float, of: Reading
) -> TimedSet | None:
    """Tabulate the displacement of a set in a problem of this size; None if that takes too many panels."""
    panels = _panels(path, pieces, lambda values: np.maximum(np.abs(values).max(axis=0), size))
    if panels is None:
        return None
    start, stop, values, scale = panels
    return _timed_set(family, start, stop, values, scale, None, np.zeros((0, len(scale))), of)


def table_of_rows(
    family: int,
    rows_at: Callable[[float], TableRows | None],
    pieces: Sequence[Interval],
    size: float,
    first: int,
    of: Reading,
) -> TimedSet | None:
    """Tabulate the numbers of the rows of a set, which begin at row ``first`` of the table.

    None if compiled code does not know their kind, or if there are too many numbers, panels or functions.
    """
    part = rows_at(pieces[0][0])
    if part is None or not len(part.entries) or not np.isin(part.numbers["kind"], (AFFINE, DISTANCE)).all():
        return None
    m, lengths = len(part.entries), bool(np.all(part.numbers["kind"] == DISTANCE))

    def numbers(t: float) -> NDArray[np.float64]:
        now: Any = rows_at(t)
        sides = [np.broadcast_to(now.numbers.get(name, 0.0), m) for name in ("square", "length")]
        return np.concatenate((*sides, now.coefficient))

    def scale_of(values: NDArray[np.float64]) -> NDArray[np.float64]:
        largest = np.abs(values).max(axis=0)
        one, other = max(largest[:m].max(), 1e-300), max(largest[m : 2 * m].max(), size)
        third = other if lengths else max(largest[2 * m :].max(initial=0.0), 1e-300)
        return np.repeat((one, other, third), (m, m, len(largest) - 2 * m))

    panels = _panels(numbers, pieces, scale_of)
    if panels is None:
        return None
    start, stop, values, scale = panels
    base = values[0, 0]
    varying = np.flatnonzero((values != base).any(axis=(0, 1)))
    combined = _combined((values - base).reshape(-1, len(base))[:, varying], scale[varying])
    if combined is None:
        return None
    chosen, weight = combined
    number, functions = _places(m, first, of.table)[varying], varying[chosen]
    number["base"] = base[varying]
    order = np.argsort(number["row"], kind="stable")
    values, scale = (values - base)[:, :, functions], scale[functions]
    return _timed_set(family, start, stop, values, scale, number[order], weight[order], of)


def _timed_set(
    family: int,
    start: NDArray[np.float64],
    stop: NDArray[np.float64],
    values: NDArray[np.float64],
    scale: NDArray[np.float64],
    number: NDArray[np.void] | None,
    weight: NDArray[np.float64],
    of: Reading,
) -> TimedSet:
    """Make the table of functions from their values at the nodes (P, TERMS, F), for compiled code."""
    series = _series(values, scale)
    functions = len(scale)
    return TimedSet(
        family=family,
        translated=int(number is None),
        start=start,
        stop=stop,
        terms=np.where(series != 0.0, np.arange(TERMS) + 1, 2).max(axis=(1, 2), initial=2),
        series=series,
        number=np.zeros(0, dtype=NUMBER) if number is None else number,
        weight=weight,
        now=np.zeros(1, dtype=np.int64),
        time=np.full(2, np.nan),
        value=np.zeros(functions),
        slope=np.zeros(functions),
        reference=np.zeros(functions),
        unused=np.zeros(functions),
        polynomial=np.zeros(TERMS),
        derivative=np.zeros(TERMS),
        row=of.table.row,
        first=of.table.start,
        coefficient=of.table.coefficient,
        radius=of.radius,
        compares=int(of.compares),
    )


def _panels(
    function: Callable[[float], NDArray[np.float64]],
    pieces: Sequence[Interval],
    scale_of: Callable[[NDArray[np.float64]], NDArray[np.float64]],
) -> tuple[NDArray[np.float64], ...] | None:
    """Cut smooth pieces of time into panels in which the polynomial through 18 values leaves no more than rounding.

    Returns where panels start and stop, the values at their nodes (P, 18, K), and the scale of the numbers (K,).
    """
    waiting = list(reversed(pieces))
    found: list[tuple[float, float, NDArray[np.float64]]] = []
    length, scale = pieces[-1][1] - pieces[0][0], np.zeros(1)
    while waiting:
        a, b = waiting.pop()
        if b - a <= SHORT * length:  # the end of a run, behind a jump
            values = np.tile(function(b), (TERMS, 1))
            scale = np.maximum(scale, scale_of(values))
            found.append((a, b, values))
            continue
        nodes = a + (b - a) * NODES
        nodes[-1] = b
        values = np.array([function(float(t)) for t in nodes])
        scale = np.maximum(scale, scale_of(values))
        steepest = (np.abs(np.diff(values, axis=0)) / np.diff(nodes)[:, None]).max(axis=0)
        defect = np.abs(COEFFICIENTS[-2:] @ values).max(axis=0)
        if (defect <= ROUNDING * (scale + b * steepest)).all():
            found.append((a, b, values))
        elif b - a > SHORTEST * length:
            cut = a + CUT * (b - a)
            waiting += [(cut, b), (a, cut)]
        else:
            return None
        number = len(found) + len(waiting)
        if number * values.size > MOST_VALUES or number > MOST_PANELS + 2 * len(pieces):
            return None
    start, stop, values = (np.array(part) for part in zip(*found, strict=True))
    return start, stop, values, scale


def _series(values: NDArray[np.float64], scale: NDArray[np.float64]) -> NDArray[np.float64]:
    """Compute the coefficients (P, F, TERMS) of functions from values at the nodes (P, TERMS, F)."""
    first = values[:, :1]
    series = np.swapaxes(COEFFICIENTS @ (values - first), 1, 2)
    series[np.abs(series) <= CHOPPED * scale[:, None]] = 0.0
    series[:, :, 0] += first[:, 0]  # a constant is met without rounding
    return np.ascontiguousarray(series)


def _combined(values: NDArray[np.float64], scale: NDArray[np.float64]) -> tuple[list[int], NDArray[np.float64]] | None:
    """Choose numbers (S, K) of which all others are linear combinations; return these, and the weights (K, F)."""
    rest, chosen = values / scale, list[int]()
    while rest.size and (largest := np.abs(rest).max(axis=0)).max() > ALIKE:
        if len(chosen) == MOST_FUNCTIONS:
            return None
        k = int(largest.argmax())
        chosen.append(k)
        direction = rest[:, k] / np.linalg.norm(rest[:, k])
        rest = rest - np.outer(direction, direction @ rest)
        rest[:, chosen] = 0.0
    if not chosen:
        return chosen, np.zeros((values.shape[1], 0))
    basis = values[:, chosen]
    lengths = np.linalg.norm(basis, axis=0)
    weight = np.linalg.lstsq(basis / lengths, values)[0] / lengths[:, None]
    weight[:, chosen] = np.eye(len(chosen))
    return chosen, np.ascontiguousarray(weight.T)


def _places(m: int, first: int, table: RowTable) -> NDArray[np.void]:
    """Return where the numbers of m rows are in the table: squares, lengths and coefficients."""
    begin, end = int(table.start[first]), int(table.stop[first + m - 1])
    number, row = np.zeros(2 * m + end - begin, dtype=NUMBER), first + np.arange(m)
    entries = table.stop[row] - table.start[row]
    number["row"] = np.concatenate((row, row, np.repeat(row, entries)))
    number["kind"] = np.repeat((SQUARE, LENGTH, COEFFICIENT), (m, m, end - begin))
    number["place"][2 * m :] = np.arange(begin, end)
    number["column"][2 * m :] = table.column[begin:end]
    return number
