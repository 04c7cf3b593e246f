"""The region that a picture of a problem shows: all states, and the walls, balls and curves that are not far away."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from dincl.shapes import Ball, Curve, Wall, radii, shapes_at

if TYPE_CHECKING:
    from dincl.problem import Problem

MAKES_NO_NUMBERS = True
Floats = NDArray[np.float64]
# Room around what is shown, and the least extent along any axis, as parts of its size.
MARGIN, NARROWEST = 0.06, 0.5
# A wall is shown if it is at most so far from the rest, as a part of its size; two that face each other, and a closed
# curve, if they are at most so many sizes wide.
FARTHEST, WIDEST = 1.0, 8.0
# Points along each axis at which the level of a curve is looked for.
LEVEL_POINTS = 40


def region(problem: Problem, x: Floats, times: Sequence[float]) -> tuple[Floats, Floats]:
    """Return the lowest and the highest corner of what is shown of states (K, N, d) and of the sets at some times."""
    radius = np.max([radii(problem, t) for t in times], axis=0)[:, None]
    low, high = (x - radius).min(axis=(0, 1)), (x + radius).max(axis=(0, 1))
    shapes = [shape for t in times for shape in shapes_at(problem, t)]
    for ball in shapes:
        if isinstance(ball, Ball):
            low, high = np.minimum(low, ball.centre - ball.radius), np.maximum(high, ball.centre + ball.radius)
    size = float((high - low).max()) or 1.0
    walls = [shape for shape in shapes if isinstance(shape, Wall)]
    for wall in walls:
        # From the corner that is nearest to the wall to its foot.
        corner = np.where(wall.normal > 0, low, high)
        foot = corner - (wall.normal @ corner - wall.offset) * wall.normal
        faces = min(map(wall.distance, walls)) <= WIDEST * size
        if faces or np.abs(foot - corner).max() <= FARTHEST * size:
            low, high = np.minimum(low, foot), np.maximum(high, foot)
    for curve in shapes:
        if isinstance(curve, Curve):
            low, high = _with_curve(curve, low, high, size)
    room = MARGIN * size + np.maximum(0.0, NARROWEST * size - (high - low)) / 2
    return low - room, high + room


def _with_curve(curve: Curve, low: Floats, high: Floats, size: float) -> tuple[Floats, Floats]:
    """Extend the region to a closed curve, looked for in wider and wider surroundings."""
    by = FARTHEST * size
    while by <= WIDEST * size:
        axes = [np.linspace(a - by, b + by, LEVEL_POINTS) for a, b in zip(low, high, strict=True)]
        free = values_on_grid(curve, *axes) >= 0
        for side in (free, ~free):
            if side.any() and not (side[[0, -1]].any() or side[:, [0, -1]].any()):
                places = np.argwhere(side)
                ends = [places.min(axis=0) - 1, places.max(axis=0) + 1]
                corners = np.array([[axes[0][j], axes[1][i]] for i, j in ends])
                return np.minimum(low, corners[0]), np.maximum(high, corners[1])
        by *= 2
    return low, high


def values_on_grid(curve: Curve, x: Floats, y: Floats) -> Floats:
    """Return g at each point of a grid, (len(y), len(x))."""
    with np.errstate(all="ignore"):
        return np.array([[curve.g(np.array([a, b])) for a in x] for b in y])
