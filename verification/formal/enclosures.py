"""Proofs by interval arithmetic: bounds of functions on boxes, by branch and bound with balls of Arb."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import partial
from heapq import heappop, heappush
from itertools import product
from math import inf, nextafter
from typing import Any

from dincl.extras import needs
from verification.claims import FormalProof, Technique
from verification.formal import Step, refuse_unless_refuted

# Boxes that are looked at before a proof is given up.
LARGEST = 200_000
Box = Sequence[tuple[float, float]]


def balls() -> Any:
    """Return flint; MissingLibrary says that a proof needs it."""
    with needs("a proof by interval arithmetic", "proofs"):
        import flint
    return flint


def not_negative(
    statement: str, function: Callable[..., Any], box: Box, wrong: str, factor: float = -1.0
) -> FormalProof:
    """Prove that a function is at least 0 on a box.

    Parameters
    ----------
    statement
        What follows.
    function
        (factor, coordinates) -> ball, for balls of coordinates.
    box
        The ends of each coordinate.
    wrong
        What a reader calls the variant with the other factor.
    factor
        Of the wrong variant: it must be negative at a point of the box.

    Raises
    ------
    UnsoundProof
        If no point is found where the wrong variant is negative.
    """
    return _enclosure(partial(function, 1.0), partial(function, factor), box, statement, wrong)


def positive(right: Callable[..., Any], wrong: Callable[..., Any], box: Box, said: str = "", rejects: str = "") -> Step:
    """Return the proof that a function of balls is at least 0 on a box; ``wrong`` is negative at a point of it.

    ``said``, ``rejects``: see ``Step``.
    """
    return Step(partial(_enclosure, right, wrong, box), said, rejects)


def _enclosure(
    right: Callable[..., Any], other: Callable[..., Any], box: Box, statement: str, wrong: str
) -> FormalProof:
    true, boxes = _decided(right, box)
    refuse_unless_refuted(_decided(other, box)[0] is False, statement, wrong)
    tool = f"python-flint {balls().__version__}"
    return FormalProof(statement, Technique.ENCLOSURE, tool, true, wrong, f"{boxes} boxes" if box else "")


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


def _decided(function: Callable[..., Any], box: Box) -> tuple[bool | None, int]:
    """Return whether a function is at least 0 on a box (False at a negative midpoint), and the number of boxes."""
    arb = balls().arb
    waiting, seen = [tuple(box)], 0
    while waiting and seen < LARGEST:
        sides = waiting.pop()
        seen += 1
        middle = [(low + high) / 2 for low, high in sides]
        if function(*map(arb, middle)) < 0:
            return False, seen
        if not _over(function, sides) >= 0:
            waiting += _halves(sides, middle)
    return (None if waiting else True), seen


def _cuts(sides: Sequence[tuple[float, float]]) -> Iterator[list[tuple[tuple[float, float], ...]]]:
    """Yield the two halves of a box, for each direction that is not a point."""
    for k, (low, high) in enumerate(sides):
        if low < high:
            middle = (low + high) / 2
            yield [(*sides[:k], ends, *sides[k + 1 :]) for ends in ((low, middle), (middle, high))]


def _halves(sides: Sequence[tuple[float, float]], middle: Sequence[float]) -> list[tuple[tuple[float, float], ...]]:
    """Yield the parts of a box that is halved in each direction that is not a point."""
    cut = [
        ((low, at), (at, high)) if low < high else ((low, high),) for (low, high), at in zip(sides, middle, strict=True)
    ]
    return list(product(*cut))
