"""Proved bounds of functions on boxes, by branch and bound with balls of Arb."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from heapq import heappop, heappush
from math import inf, nextafter
from typing import Any

from dincl.extras import needs

# Boxes that are looked at before the search is given up.
LARGEST = 200_000
Box = Sequence[tuple[float, float]]


def balls() -> Any:
    """Return flint; MissingLibrary says that a proof needs it."""
    with needs("a bound by interval arithmetic", "proofs"):
        import flint
    return flint


def least_upper_bound(function: Callable[..., Any], box: Box, slack: float = 1e-6) -> float:
    """Return a proved bound of a function on a box that is at most ``slack`` above one of its values.

    ArithmeticError if it takes more than LARGEST boxes.
    """
    reached, waiting = -inf, [(-inf, tuple(box))]
    for _ in range(LARGEST):
        negative, sides = heappop(waiting)
        if -negative - reached <= slack:
            return -negative
        options = [[(_above(_over(function, part)), part) for part in cut] for cut in _cuts(sides)]
        for above, part in min(options, key=lambda parts: parts[0][0] + parts[1][0]):
            reached = max(reached, -_above(-function(*(balls().arb(low) for low, _ in part))))
            heappush(waiting, (-above, part))
    raise ArithmeticError(f"no bound within {slack:g} after {LARGEST} boxes")


def _above(ball: Any) -> float:
    """Return an upper bound of a ball; infinite where the ball is not finite."""
    return nextafter(float(ball.upper()), inf) if ball.is_finite() else inf


def _over(function: Callable[..., Any], sides: Sequence[tuple[float, float]]) -> Any:
    """Return a ball that holds all values on a box."""
    arb = balls().arb
    return function(*(arb(low).union(arb(high)) for low, high in sides))


def _cuts(sides: Sequence[tuple[float, float]]) -> Iterator[list[tuple[tuple[float, float], ...]]]:
    """Yield the two halves of a box, for each direction that is not a point."""
    for k, (low, high) in enumerate(sides):
        if low < high:
            middle = (low + high) / 2
            yield [(*sides[:k], ends, *sides[k + 1 :]) for ends in ((low, middle), (middle, high))]
