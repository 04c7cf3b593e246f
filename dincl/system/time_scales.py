"""Breaks of the functions of time of a problem, and how long steps may be between them, from values before a run.

A function is smooth in a piece of time if the polynomial through 18 of its values leaves no more than rounding, also at
the times between them that are looked at. Elsewhere bisection finds a break: a jump of the value, to the last bit, or
of the slope. Without one the piece is cut in two.
"""

from __future__ import annotations

import math
from contextlib import suppress
from functools import cache, partial
from heapq import heappop, heappush
from itertools import pairwise
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.polynomial.chebyshev import chebval, chebvander

from dincl.drifts import compiled
from dincl.drifts.base import CountedDrift
from dincl.errors import StepFailure
from dincl.status import Status

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from numpy.typing import ArrayLike, NDArray

    from dincl.constraints.moving import Path
    from dincl.problem import Problem
    from dincl.steps.grid import TimeGrid

Interval = tuple[float, float]

NO_BREAKS = np.zeros((0, 2))
NONE_SMOOTH: Mapping[int, Sequence[Interval]] = {}
EPS = float(np.finfo(float).eps)
# Values of one function at most: as many as a run of a few hundred steps takes. They resolve about sixty breaks.
MOST_VALUES = 5000
# What is not smooth is cut at this part, or at one minus it: the part where the function turns most is the shorter one.
# No cut is at a time that people choose, for a break that lies on a cut is in neither part.
CUT = 0.3819660112501051
# A run of at least so many equal steps looks at sets before it begins, which costs as much as ten steps that call them:
# at the time of each step or, from so many on, of one in so many, but at most so many times, besides output times.
FEWEST_STEPS, MANY_STEPS, STEPS_OF_A_LOOK, MOST_LOOKS = 40, 200, 8, 50_000
# A look is taken at so many times besides, at more of what depends on time; at output times; and beside each of at most
# so many of them, at these parts of the time to the next one. A drift that has the same value at x0 at all of the first
# ones does not depend on time.
LOOKS, MORE_LOOKS, FEW, BESIDE = 61, 233, 100, (1e-5, 1e-2)
# A set is asked at so many times whether it accepts its numbers; when it is tabulated, also at all nodes of its panels.
ASKED = 16
# Chebyshev nodes in [0, 1], and the matrix from values there to coefficients. Of the last two coefficients a jump
# leaves at least one. How much more than they a value between the nodes may differ.
NODES = 0.5 - 0.5 * np.cos(np.pi * np.arange(18) / 17)
COEFFICIENTS = np.linalg.inv(chebvander(2.0 * NODES - 1.0, 17))
BETWEEN = 8.0
# Rounding of a value, relative to the largest value of the function and to its change from t = 0 at the steepest slope:
# of a piece, and of a single difference.
ROUNDING, OF_DIFFERENCE = 64 * EPS, 16 * EPS
# Pieces shorter than this part of the run are not looked at: a change within one is a jump.
SHORT = 1e-12
# Of the interval with a break, the part at its ends whose slopes are compared with those inside. The change of slope at
# a break stays above this part of the first one found while the interval is halved; that of a smooth function does not.
EDGE, KEPT = 1.0 / 48.0, 0.125
# The slope beside the interval is that over at most so many times its length.
BESIDE_AT_MOST = 8.0
# A break of the slope is located once the interval is this part of the first one.
LOCATED = 1e-3
# The defect of what is smooth falls at least by this factor where a piece is cut; that of noise does not.
FALLS = 0.25
# Coefficients from this one on are the rough part of what is not resolved.
ROUGH = 9
# A function that is smooth from one break to the next is resolved by so many steps.
RESOLVED = 4
# A polynomial that leaves so small a part of the accuracy resolves a function for steps that estimate their error.
PART_OF_ACCURACY = 1e-3
# Noise of a drift that moves a particle by no more than this part of the accuracy during a run is not resolved.
NEGLIGIBLE = 1e-3


class TimeScales(NamedTuple):
    """Breaks and pieces of the functions of time of a problem.

    ``breaks`` (K, 2) are intervals, as short as rounding allows, with a jump of a set or of its velocity in each;
    ``stops`` (S, 2) are these and those of the drift at x0. Pieces (P, 2) are times until which, since the one before,
    all functions are resolved by steps of the second number [time].
    ``smooth`` are intervals, from break to break or shorter, in which a polynomial of degree 17 leaves no more than
    rounding of the numbers of a set, by its index; a set that is not resolved has none.
    ``rest`` is how far a set may be from where it is taken to be, since it has more breaks than are looked for
    [length], and ``detail`` says which and where. ``failure`` says why there are no breaks, if so. ``evaluations`` of
    the drift were made.
    """

    breaks: NDArray[np.float64] = NO_BREAKS
    stops: NDArray[np.float64] = NO_BREAKS
    pieces: NDArray[np.float64] = NO_BREAKS
    rest: float = 0.0
    detail: str = ""
    failure: StepFailure | None = None
    evaluations: int = 0
    smooth: Mapping[int, Sequence[Interval]] = NONE_SMOOTH
    start: float = 0.0


def time_scales(
    problem: Problem, times: ArrayLike, accuracy: float = 0.0, start: float = 0.0, named: Sequence[float] = ()
) -> TimeScales:
    """Find breaks of sets and of the drift at x0, and how long steps may be that resolve them, from ``start`` on.

    ``named`` breaks are taken as they are, and each function is looked at from one to the next.

    They are looked at, among others, at and beside these times. ``accuracy`` is that of the run [length]. A function
    that fails, perhaps later than the run ends, is left out. No function is called more than MOST_VALUES times, once
    for each look, and 18 times for each named break.
    """
    kept = np.unique(np.append(np.asarray(times, dtype=np.float64), start))
    looks, length = _looks(kept, MORE_LOOKS), float(kept[-1]) - start
    breaks: list[Interval] = []
    stops: list[Interval] = []
    sides: list[list[int]] = []
    pieces, rest, detail, failure, smooth = [], 0.0, "", None, dict[int, list[Interval]]()
    size = float(np.abs(problem.x0).max(initial=0.0))
    for k, name, path in _paths(problem):
        try:
            resolved = PART_OF_ACCURACY * accuracy / max(1.0, size)
            found = _Search(path, looks, name, named, MOST_VALUES, resolved)
        except StepFailure as raised:
            failure = failure or raised
            continue
        breaks += found.breaks
        sides.append(found.sides)
        smooth[k] = _smooth_if_accepted(problem, k, found)
        pieces.append(found.pieces(at_nodes=False))
        if found.rest(size) > rest:
            rest = found.rest(size)
            detail = f"{name} changes too often, near t = {found.place:.6g}, to be resolved by {MOST_VALUES} values."
    drift, calls = compiled(problem.drift), 0
    if drift is None or not drift.autonomous:

        @cache
        def at_start(t: float) -> NDArray[np.float64]:
            nonlocal calls
            calls += 1
            return problem.velocity(t, problem.x0).ravel()

        with suppress(StepFailure):  # a run that gets so far says why
            first = at_start(start)
            if length > 0 and any((at_start(float(t)) != first).any() for t in _looks(kept, LOOKS)):
                allowed = PART_OF_ACCURACY * accuracy / length, NEGLIGIBLE * accuracy / length
                found = _Search(at_start, looks, "drift", named, MOST_VALUES, *allowed)
                stops += found.breaks
                sides.append(found.sides)
                pieces.append(found.pieces(at_nodes=True))
    for t, *each in zip(named, *sides, strict=True):
        found_at = {side for side in each if side}
        breaks.append(_beside(t, found_at.pop() if len(found_at) == 1 else 0, float(looks[-1])))
    joined = _joined(breaks, length), _joined(breaks + stops, length)
    return TimeScales(*joined, _common(pieces), rest, detail, failure, calls, smooth, start)


def smooth_pieces(problem: Problem, grids: Sequence[TimeGrid], times: NDArray[np.float64]) -> dict[int, list[Interval]]:
    """Find the ``smooth`` pieces of ``TimeScales`` for a run of equal steps.

    Grids end at breaks. Sets are looked at at these output times and at the time of each step, of every eighth one in
    long runs, but at most at MOST_LOOKS, and refused where they would be in a step. A function is called once more for
    two steps, at most MOST_VALUES times, and 18 times for each break.
    """
    found: dict[int, list[Interval]] = {}
    if not any(one.timed for one in problem.constraints):
        return found
    steps, named = sum(grid.steps for grid in grids), [grid.time(grid.steps) for grid in grids[:-1]]
    if steps < max(FEWEST_STEPS, 4 * len(NODES) * len(named)):
        return found
    number = steps if steps < MANY_STEPS else min(max(LOOKS, steps // STEPS_OF_A_LOOK), MOST_LOOKS)
    each = [np.linspace(0, one.steps, max(2, number * one.steps // steps)).round() for one in grids]
    of_steps = [one.origin + k * (one.t_end / one.steps) for one, k in zip(grids, each, strict=True)]
    looks = np.union1d(np.concatenate(of_steps), times)
    for k, name, path in _paths(problem):
        with suppress(StepFailure):  # the run says why, if it gets so far
            search = _Search(path, looks, name, named, min(steps // 2, MOST_VALUES))
            found[k] = _smooth_if_accepted(problem, k, search)
    return found


def _smooth_if_accepted(problem: Problem, k: int, search: _Search) -> list[Interval]:
    """Return the smooth pieces of a set; none if it refuses its numbers at one of ASKED times or more."""
    one, x0, pieces = problem.constraints[k], problem.x0, search.smooth()
    if one.displacement(0.0, x0.shape[1]) is None:  # what is only translated has numbers that it accepted before
        try:
            for t in search.looks[:: max(1, len(search.looks) // ASKED)].tolist():
                one.select_at(t, x0, 0.0)
        except StepFailure:
            return []
    return pieces


def _paths(problem: Problem) -> Iterator[tuple[int, str, Path]]:
    """Give the index and a name of each timed set, and its displacement or, if it is not translated, its numbers."""
    d = problem.x0.shape[1]
    for k, one in enumerate(problem.constraints):
        if one.timed:
            path: Any = partial(one.parameters, x=problem.x0)
            if one.displacement(0.0, d) is not None:
                path = partial(one.displacement, d=d)
            if isinstance(problem.drift, CountedDrift):
                path = partial(_counted, problem.drift, path)
            yield k, f"constraints[{k}] ({type(one).__name__})", path


def _counted(drift: CountedDrift, path: Path, t: float) -> NDArray[np.float64]:
    """Evaluate a path; a drift that counts may raise an exception to end the run."""
    drift.count_evaluations(0)
    return path(t)


def _looks(kept: NDArray[np.float64], number: int) -> NDArray[np.float64]:
    """Return the times to look at besides the nodes of pieces, for a run from the first to the last time kept."""
    found = [kept[0] + (np.arange(number) + CUT) / number * (kept[-1] - kept[0]), kept]
    if len(kept) <= FEW + 1:
        gaps = np.diff(kept)
        found += [side for part in BESIDE for side in (kept[:-1] + part * gaps, kept[1:] - part * gaps)]
    return np.unique(np.concatenate(found))


def _beside(t: float, side: int, end: float) -> Interval:
    """Return the interval before (-1), behind (1) or around (0) a named time in which rounding may put a break."""
    apart = 2.0 * EPS * end
    return (t if side > 0 else t - apart, t if side < 0 else t + apart)


def _joined(intervals: list[Interval], length: float) -> NDArray[np.float64]:
    """Return intervals in order (K, 2), joined where hardly any time is between them."""
    found: list[list[float]] = []
    for a, b in sorted(intervals):
        if found and a - found[-1][1] <= SHORT * length:
            found[-1][1] = max(b, found[-1][1])
        else:
            found.append([a, b])
    return np.array(found).reshape(-1, 2)


def _common(tables: Sequence[NDArray[np.float64]]) -> NDArray[np.float64]:
    """Return the pieces (P, 2) that resolve all that these tables of pieces resolve."""
    tables = [table for table in tables if len(table)]
    if not tables:
        return NO_BREAKS
    stops = np.unique(np.concatenate([table[:, 0] for table in tables]))
    which = [np.minimum(np.searchsorted(table[:, 0], stops), len(table) - 1) for table in tables]
    return np.column_stack((stops, np.min([table[k, 1] for table, k in zip(tables, which, strict=True)], axis=0)))


class _Piece(NamedTuple):
    """A function from a to b: how far it is from a polynomial, and the largest ratio of this to what rounding allows.

    That is the one of the component ``axis``; values are known at ``times``.
    """

    a: float
    b: float
    defect: float
    ratio: float
    axis: int
    times: NDArray[np.float64]
    resolved: bool = False


class _Search:
    """The breaks of one function of time from the first to the last of ``looks``, and smooth pieces between them.

    ``named`` are times of breaks that are known. What a polynomial leaves up to ``resolved`` [units of the function]
    does not limit steps, and noise up to ``negligible`` counts as smooth. At most ``most`` values are computed, besides
    those at ``looks`` and next to named breaks.
    """

    def __init__(
        self,
        function: Path,
        looks: NDArray[np.float64],
        name: str,
        named: Sequence[float],
        most: int,
        resolved: float = 0.0,
        negligible: float = 0.0,
    ) -> None:
        self._function, self._name = function, name
        self._enough, self._negligible = resolved, negligible
        self._start, self._end = float(looks[0]), float(looks[-1])
        self._length = self._end - self._start
        self.looks, self._most = looks, most + len(looks) + len(NODES) * len(named)
        self._values: dict[float, NDArray[np.float64]] = {}
        self._largest: NDArray[np.float64] | float = 0.0
        self.breaks: list[Interval] = []
        self._smooth: list[Interval] = []
        # The longest pieces that are smooth enough for steps.
        self._resolved: list[Interval] = []
        # Pieces that are not smooth: the roughest first.
        self._waiting: list[tuple[float, float, _Piece]] = []
        self._value(self._start)
        self.sides = [self._side(t) for t in named]
        self._named = [_beside(t, side, self._end) for t, side in zip(named, self.sides, strict=True)]
        for start, stop in self._edges():
            self._add(start, stop)
        while self._waiting and len(self._values) < self._most:
            self._split(heappop(self._waiting)[-1])

    @property
    def place(self) -> float:
        """The middle of the roughest piece that is not resolved [time]."""
        return 0.5 * (self._waiting[0][-1].a + self._waiting[0][-1].b)

    def rest(self, size: float) -> float:
        """Bound by how much the function is not resolved; of numbers without unit, for a problem of this size."""
        found = 0.0
        for *_, piece in self._waiting:
            values = self._at(piece.a + (piece.b - piece.a) * NODES)
            fit = chebvander(2.0 * NODES - 1.0, 17)[:, ROUGH:] @ (COEFFICIENTS[ROUGH:] @ values)
            rough = 2.0 * np.abs(fit).max(axis=0)
            found = max(found, float((rough * np.maximum(1.0, size / np.maximum(self._largest, 1e-300))).max()))
        return found

    def pieces(self, *, at_nodes: bool) -> NDArray[np.float64]:
        """Return until when steps may be how long, (P, 2): what is not resolved in one step, or from node to node.

        What is resolved takes RESOLVED steps from break to break, if all breaks are found.
        """
        part = 1 if self._waiting else RESOLVED
        found = [(b, (b - a) / part) for a, b in self._resolved]
        for *_, piece in self._waiting:
            if not piece.resolved:
                times = piece.times if at_nodes else np.array([piece.a, piece.b])
                found += list(zip(times[1:].tolist(), np.diff(times).tolist(), strict=True))
        return np.array(sorted(found)).reshape(-1, 2)

    def smooth(self) -> list[Interval]:
        """Return intervals in which one polynomial leaves no more than rounding; none if a piece is not resolved."""
        short = [one for one in self._edges() if one[1] - one[0] <= SHORT * self._length]
        return [] if self._waiting else sorted(self._smooth + short)

    def _edges(self) -> list[Interval]:
        """Return the intervals from break to break."""
        breaks = _joined(self._named + self.breaks, self._length)
        edges = [self._start, *(t for a_break in breaks for t in a_break), self._end]
        return list(zip(edges[::2], edges[1::2], strict=True))

    def _side(self, t: float) -> int:
        """Return whether the function jumps before (-1) or behind (1) a time, to rounding; 0 if it does not jump."""
        values = self._at(np.array([t, *_beside(t, 0, self._end)]))
        before, behind = (np.abs(values[0] - other).max() for other in values[1:])
        jumps = abs(before - behind) > ROUNDING * np.max(self._largest)
        return 0 if not jumps else 1 if behind > before else -1

    def _value(self, t: float) -> NDArray[np.float64]:
        found = self._values.get(t)
        if found is None:
            found = self._values[t] = self._function(t)
            if found.size != (count := self._values[self._start].size):
                raise StepFailure(
                    Status.CONSTRAINT_FAILED,
                    f"{self._name}: its functions of time return {found.size} numbers at t = {t:.6g}, {count} at "
                    f"t = {self._start:g}: the shape of each array must stay the same.",
                )
            self._largest = np.maximum(self._largest, np.abs(found))
        return found

    def _at(self, times: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.array([self._value(float(t)) for t in times])

    def _add(self, a: float, b: float, before: float = np.inf, *, resolved: bool = False) -> None:
        """Add the piece from a to b; ``before`` is the defect of the one that it is a part of, if nothing breaks it."""
        if b - a <= SHORT * self._length:
            if a < b:
                self.breaks.append((a, b))
            return
        piece = self._looked_at(a, b)
        is_smooth = piece.ratio <= 1.0 or FALLS * before <= piece.defect <= self._negligible
        enough = is_smooth or piece.defect <= self._enough
        if enough and not resolved:
            self._resolved.append((a, b))
        if is_smooth:
            self._smooth.append((a, b))
        else:
            heappush(self._waiting, (-piece.ratio, a, piece._replace(resolved=resolved or enough)))

    def _looked_at(self, a: float, b: float) -> _Piece:
        """Compare a function from a to b with the polynomial through its values at the nodes."""
        nodes = a + (b - a) * NODES
        nodes[-1] = b
        values = self._at(nodes)
        steepest = (np.abs(np.diff(values, axis=0)) / np.diff(nodes)[:, None]).max(axis=0)
        coefficients = COEFFICIENTS @ values
        looks = self.looks[(self.looks > a) & (self.looks < b)]
        between = np.zeros((1, values.shape[1]))
        if len(looks):
            between = np.abs(self._at(looks) - chebval(2.0 * (looks - a) / (b - a) - 1.0, coefficients).T) / BETWEEN
        defect = np.maximum(np.abs(coefficients[-2:]).max(axis=0), between.max(axis=0))
        allowed = ROUNDING * (self._largest + b * steepest)
        allowed[allowed == 0.0] = np.inf  # a function that is zero everywhere
        axis = int((defect / allowed).argmax())
        ratio = float(defect[axis] / allowed[axis])
        return _Piece(a, b, float(defect.max()), ratio, axis, np.union1d(nodes, looks))

    def _split(self, piece: _Piece) -> None:
        """Divide a piece at a break, or cut it."""
        a, b = piece.a, piece.b
        left, right = self._turn_of(piece)
        found = self._bisected(left, right, piece.axis) if piece.defect > self._negligible else None
        if found is None:
            cut = a + (CUT if left < 0.5 * (a + b) else 1.0 - CUT) * (b - a)
            self._add(a, cut, piece.defect, resolved=piece.resolved)
            self._add(cut, b, piece.defect, resolved=piece.resolved)
            return
        self.breaks.append(found)
        short = SHORT * self._length
        edges = [a, *found, b]
        if found[0] - a <= short or b - found[1] <= short:
            # The next break may be as near to this end as a piece is short, or much farther.
            near = math.sqrt(short * (b - a))
            edges.append(min(found[1] + near, b) if found[0] - a <= short else max(found[0] - near, a))
        for start, stop in pairwise(sorted(edges)):
            if (start, stop) != found:
                self._add(start, stop, resolved=piece.resolved)

    def _turn_of(self, piece: _Piece) -> Interval:
        """Return the known times before and after that at which the slope changes most, by more than rounding."""
        times, values = piece.times, self._at(piece.times)[:, piece.axis]
        apart = np.diff(times)
        turn = np.abs(np.diff(np.diff(values) / apart))
        turn -= OF_DIFFERENCE * np.abs(values).max() / np.minimum(apart[1:], apart[:-1])
        k = int(turn.argmax())
        return float(times[k]), float(times[k + 2])

    def _bisected(self, a: float, b: float, axis: int) -> Interval | None:
        """Halve the interval from a to b: keep the half whose slope differs more from the slope beside it.

        Returns the two sides of a break, or None where the slope changes smoothly.
        """

        def value(t: float) -> float:
            return float(self._value(t)[axis])

        def slope(start: float, stop: float) -> float:
            return (value(stop) - value(start)) / (stop - start)

        width, edge, largest = b - a, EDGE * (b - a), 0.0
        if not a < a + edge < b - edge < b:
            return a, b
        # The slopes before and after are those from and to these times; inside, at an end that has not moved.
        start, stop = a, b
        before, after = slope(a, a + edge), slope(b - edge, b)
        while a < (middle := 0.5 * (a + b)) < b and b - a > EPS**2 * self._end:
            left, right = slope(a, middle), slope(middle, b)
            if abs(left - before) >= abs(right - after):
                stop, b, after = b, middle, right
            else:
                start, a, before = a, middle, left
            if b - a < 4.0 * edge:
                edge = EDGE * (b - a)
                if start == a < a + edge:
                    before = slope(a, a + edge)
                if b - edge < b == stop:
                    after = slope(b - edge, b)
            # A slope beside the interval over a much longer time differs from the one inside though all is smooth.
            if a - start > BESIDE_AT_MOST * (b - a):
                start = a - 2.0 * (b - a)
                before = slope(start, a)
            if stop - b > BESIDE_AT_MOST * (b - a):
                stop = b + 2.0 * (b - a)
                after = slope(b, stop)
            inside = slope(a, b)
            turn = max(abs(inside - before), abs(inside - after))
            largest = max(largest, turn)
            if turn < KEPT * largest:
                return None
            size = float(np.ravel(self._largest)[axis]) + b * min(abs(before), abs(after))
            if turn * (b - a) <= OF_DIFFERENCE * size:
                # A kink lies somewhere in here, and no difference of values tells where.
                middle, apart = 0.5 * (a + b), 2.0 * EPS * self._end
                return (middle - apart, middle + apart) if b - a <= LOCATED * width else None
        return a, b
