"""The basal layer that a parameter file describes, as a curve in R_soft."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from tissue.files.units import Measure, reduced
from tissue.state.basal_curve import LINE, BasalCurve, ellipse, through
from tissue.state.cells import Floats

Points = tuple[tuple[Measure, Measure], ...]


@lru_cache(maxsize=64)
def curve_of(
    shape: str, perimeter: Measure, aspect: float, points: Points, side: str, closed: bool, soft_radius: Measure
) -> BasalCurve:
    """Make the curve of these values of [layer]; the same one for equal values.

    Raises
    ------
    ValueError
        If the points are none of a curve: fewer than four, or one twice in a row.
    """
    if shape in ("line", "sphere"):
        return LINE
    inside = side == "inside"
    if shape in ("circle", "ellipse"):
        of_shape = 1.0 if shape == "circle" else aspect
        return ellipse(reduced(perimeter, soft_radius), of_shape, inside=inside, ring=closed)
    if len(points) < 4:
        raise ValueError("a list of at least four points")
    given = np.array([[reduced(part, soft_radius) for part in point] for point in points])
    if closed:
        given = np.vstack((given, given[:1]))
    if not np.hypot(*np.diff(given, axis=0).T).all():
        raise ValueError("a list of points of which none is there twice in a row")
    return through(_turned(given, inside) if closed else given, around=closed)


def _turned(points: Floats, inside: bool) -> Floats:
    """Turn a closed polygon so that the tissue is on its left: counterclockwise for a tissue inside."""
    (x, y), (next_x, next_y) = points[:-1].T, points[1:].T
    counterclockwise = (x * next_y - y * next_x).sum() > 0
    return points if counterclockwise == inside else points[::-1]
