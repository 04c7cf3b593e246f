"""Where the velocity of a path jumps, and how long steps may be that resolve it, from its values before a run."""

from __future__ import annotations

import math
from itertools import pairwise
from math import comb
from typing import TYPE_CHECKING

import numpy as np

from dincl.constraints.moving import Path, derivative

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from numpy.typing import NDArray

Interval = tuple[float, float]

NO_KINKS = np.zeros((0, 2))
EPS = float(np.finfo(float).eps)
# Of the differences on both sides of a kink, as a part of the run.
SPACING = 1e-3
# A path is smooth where polynomials through 17 of its values leave no more than rounding: of their 16th difference,
# whose weights add up to 2^16, as a part of the largest value of the path. Looked at are two of them, since a kink at
# one of 14 places leaves nothing of a single one.
ORDER = 16
WEIGHTS = np.array([(-1.0) ** k * comb(ORDER, k) for k in range(ORDER + 1)])
ROUNDING = 4 * 2**ORDER * np.finfo(float).eps
# The first look is at so many equal parts; then parts that are not smooth are cut. No cut is at a time that people
# choose, for a kink that lies on a cut is in neither part.
PARTS, CUT = 13, 0.3819660112501051
# A path that is smooth in all parts and as a whole is resolved by this part of the whole.
RESOLVED = 4
# As a part of the run: what is not smooth within so short a time is a kink.
SHORT = 1e-6
# A path with noise has no velocity anywhere: it is given up after so many cuts.
MOST_CUTS = 2000


def kinks_and_pieces(paths: Sequence[Path], end: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Intervals (K, 2) in (0, end), as short as rounding allows, with a jump of the velocity of a path in each; pieces.

    Pieces (P, 2) are times until which, since the one before, all paths are resolved by steps of the second number
    [time]. A path that is smooth nowhere is taken as it is, without any kink or piece.
    """
    divided = [_divided(path, end) for path in paths]
    found = [_located(path, kinks, end) for path, (kinks, _) in zip(paths, divided, strict=True)]
    kinks = np.array(sorted(kink for some in found for kink in some)).reshape(-1, 2)
    apart = np.append(True, kinks[1:, 0] > kinks[:-1, 1])[: len(kinks)]
    return kinks[apart], common_pieces([pieces for _, pieces in divided])


def pieces_of(path: Path, end: float) -> NDArray[np.float64]:
    """Return the pieces (P, 2) of a path whose kinks a run finds on its way, see ``kinks_and_pieces``."""
    return _divided(path, end)[1]


def common_pieces(tables: Sequence[NDArray[np.float64]]) -> NDArray[np.float64]:
    """Return the pieces (P, 2) that resolve all that these tables of pieces resolve."""
    tables = [table for table in tables if len(table)]
    if not tables:
        return NO_KINKS
    stops = np.unique(np.concatenate([table[:, 0] for table in tables]))
    which = [np.minimum(np.searchsorted(table[:, 0], stops), len(table) - 1) for table in tables]
    return np.column_stack((stops, np.min([table[k, 1] for table, k in zip(tables, which, strict=True)], axis=0)))


def smooth_around(t: float, kinks: NDArray[np.float64]) -> tuple[float, float]:
    """The times between the kinks before and after t: where differences may look."""
    k = int(np.searchsorted(kinks[:, 1], t, side="right"))
    return float(kinks[k - 1, 1]) if k else 0.0, float(kinks[k, 0]) if k < len(kinks) else np.inf


def _divided(path: Path, end: float) -> tuple[list[Interval], NDArray[np.float64]]:
    """Return the kinks of a path, and its pieces (P, 2): until when, and how long steps may be."""
    is_smooth = _smoothness(path, end)
    first = _cuts(0.0, end, end)
    pieces, kinks = _cut(is_smooth, first, end)
    if not kinks:
        return [], np.array(_steps(is_smooth, 0.0, end, pieces, len(first))).reshape(-1, 2)
    found: list[Interval] = []
    for (_, a), (b, _) in pairwise([(0.0, 0.0), *kinks, (end, end)]):
        if b - a > SHORT * end:
            parts = _cuts(a, b, end)
            found += _steps(is_smooth, a, b, _cut(is_smooth, parts, end)[0], len(parts))
    return kinks, np.array(found).reshape(-1, 2)


def _smoothness(path: Path, end: float) -> Callable[[float, float], bool]:
    """Return whether a path is smooth from a to b, as a function of both."""
    cuts = [0.0, *(part[1] for part in _cuts(0.0, end, end))]
    places = np.array([path(t) for t in cuts])
    # Times are rounded, too, and a fast path shows it.
    fastest = np.abs(np.diff(places, axis=0) / np.diff(cuts)[:, None]).max(axis=0) if end > 0 else 0.0
    allowed = ROUNDING * (np.abs(places).max(axis=0) + end * fastest)

    def is_smooth(a: float, b: float) -> bool:
        values = np.array([path(float(t)) for t in np.linspace(a, b, ORDER + 2)])
        return all(bool((np.abs(WEIGHTS @ part) <= allowed).all()) for part in (values[1:], values[:-1]))

    return is_smooth


def _cuts(a: float, b: float, end: float) -> list[Interval]:
    """Divide the time from a to b into parts of the length of the first look, or shorter ones."""
    count = math.ceil(PARTS * (b - a) / end) if b > a else 0
    inner = [a + (k + CUT) / count * (b - a) for k in range(count if count > 1 else 0)]
    return [part for part in pairwise([a, *inner, b]) if part[0] < part[1]]


def _cut(
    is_smooth: Callable[[float, float], bool], waiting: list[Interval], end: float
) -> tuple[list[Interval], list[Interval]]:
    """Cut parts until they are smooth, or so short that there is a kink: both in order, empty if there is no end."""
    waiting = list(waiting)
    pieces: list[Interval] = []
    kinks: list[Interval] = []
    for _ in range(MOST_CUTS):
        if not waiting:
            return sorted(pieces), sorted(kinks)
        a, b = waiting.pop()
        if is_smooth(a, b):
            pieces.append((a, b))
        elif b - a > SHORT * end:
            cut = a + CUT * (b - a)
            waiting += [(a, cut), (cut, b)]
        else:
            kinks.append(_narrowed(is_smooth, a, b))
    return [], []


def _steps(
    is_smooth: Callable[[float, float], bool], a: float, b: float, pieces: list[Interval], count: int
) -> list[Interval]:
    """Return until when steps may be how long: a piece; or a part of the whole, if it is smooth and never was cut."""
    if len(pieces) == count and is_smooth(a, b):
        return [(b, (b - a) / RESOLVED)]
    return [(stop, stop - start) for start, stop in pieces]


def _narrowed(is_smooth: Callable[[float, float], bool], a: float, b: float) -> Interval:
    """The shortest part around a kink that is not smooth yet."""
    while True:
        cut = a + CUT * (b - a)
        rough = [part for part in ((a, cut), (cut, b)) if a < cut < b and not is_smooth(*part)]
        if not rough:
            return a, b
        a, b = rough[0]


def _located(path: Path, kinks: list[Interval], end: float) -> list[Interval]:
    """Each kink where the straight lines from both its sides meet: known far better than where rounding hides it."""
    ends, found = [0.0, *(t for kink in kinks for t in kink), end], []
    for k, (a, b) in enumerate(kinks):
        before = derivative(path, a, SPACING * end, (ends[2 * k], a))
        after = derivative(path, b, SPACING * end, (b, ends[2 * k + 3]))
        axis = int(np.abs(after - before).argmax())
        jump = float((after - before)[axis])
        way = float((path(b) - path(a))[axis])
        t = min(max(a + ((b - a) * after[axis] - way) / jump, a), b) if jump else a
        rounding = 8 * EPS * (abs(path(a)[axis]) + end * abs(jump))
        meets = abs(way - (t - a) * before[axis] - (b - t) * after[axis]) <= rounding
        found.append((t - 2 * EPS * end, t + 2 * EPS * end) if meets else (a, b))
    return found
