"""Scenes of sets that turn, close or grow, all with exact solutions, all but one without a drift."""

from __future__ import annotations

import math
from functools import partial
from typing import Any

import numpy as np

from dincl.checks import integer
from dincl.constraints import HalfSpace, InsideBall, Moving, NonOverlap, RigidMotion
from dincl.drifts import constant
from dincl.errors import InvalidProblem
from dincl.scenes.base import Exact, Scene

RADIUS = 0.5
# The drum: the distance of the centres of discs from its middle, the speed of its paddle, and the starts.
FARTHEST, SPEED = 2.0, 0.5
DRUM_STARTS = ((1.4, 0.6), (0.2, 0.6))
# The walls close as t grows: half of the angle between them is OPEN - CLOSING t.
OPEN, CLOSING, WEDGE_START = 0.9, 0.25, 0.8
# Growing discs of radius SMALL e^(GROWTH t) in a box.
SMALL, GROWTH, WIDTH = 0.3, 0.4, 2.4
BOX_START = ((0.7, 1.0), (1.3, 1.0))


def drum(n: int = 1) -> Scene:
    """n = 1 or 2 discs of radius 1/2 in a round drum whose paddle, a wall through the middle, turns with w = 1/2.

    Let e(t) = (cos wt, sin wt) lie along the paddle and m(t) be e turned by 90 degrees. A disc rests until the paddle
    meets it, when m . X = r. Then X = s e + r m, and X' . e = 0, as the paddle pushes along m only: s' = r w, an
    involute of a circle. It slides outwards until it meets the shell, s^2 + r^2 = D^2, or the disc before it, and is
    then carried round, X' = w (s m - r e), with multipliers of at least w s for the paddle and w r D / s for the shell.
    """
    if integer("n", n, least=1) > 2:
        raise InvalidProblem(f"n = {n}: must be 1 or 2, for which the exact solution is known")
    return Scene(
        DRUM_STARTS[:n],
        constant(np.zeros((n, 2))),
        [
            *([NonOverlap(RADIUS)] if n > 1 else []),
            Moving(HalfSpace(normal=(0, 1), radius=RADIUS), RigidMotion(_paddle)),
            InsideBall((0, 0), FARTHEST),
        ],
        name="drum",
        title="A drum that turns" if n == 1 else "A drum that turns, two discs",
        times=(2.0, 4.0),
        radius=RADIUS,
        exact=Exact((n, 2), partial(_drum, n)),
    )


def _paddle(t: float) -> float:
    return SPEED * t


def _drum(n: int, t: Any) -> list[Any]:
    import mpmath

    r, angle = mpmath.mpf(RADIUS), SPEED * t
    e = (mpmath.cos(angle), mpmath.sin(angle))
    outermost = mpmath.sqrt(FARTHEST**2 - r**2)
    places = []
    for k, start in enumerate(DRUM_STARTS[:n]):
        x, y = map(mpmath.mpf, start)
        far = mpmath.hypot(x, y)
        met = mpmath.acos(r / far) - mpmath.atan2(x, y)
        if angle < met:
            places.append((x, y))
            continue
        s = min(mpmath.sqrt(far**2 - r**2) + r * (angle - met), outermost - 2 * r * k)
        places.append((s * e[0] - r * e[1], s * e[1] + r * e[0]))
    return places


def closing_walls() -> Scene:
    """A disc of radius r = 1/2 between two walls that close, each by the angle a(t) = 0.9 - t/4 from the axis.

    It rests until both walls meet it, sin a = r / x(0), and is pushed out along the axis: x(t) = max(x(0), r / sin a).
    """
    return Scene(
        [[WEDGE_START, 0.0]],
        constant(np.zeros((1, 2))),
        [HalfSpace(normal=_upper, radius=RADIUS), HalfSpace(normal=_lower, radius=RADIUS)],
        name="closing_walls",
        title="A disc between closing walls",
        times=(1.5, 2.5),
        radius=RADIUS,
        exact=Exact((1, 2), _closing_walls),
    )


def _upper(t: float) -> tuple[float, float]:
    return math.sin(OPEN - CLOSING * t), -math.cos(OPEN - CLOSING * t)


def _lower(t: float) -> tuple[float, float]:
    return math.sin(OPEN - CLOSING * t), math.cos(OPEN - CLOSING * t)


def _closing_walls(t: Any) -> list[Any]:
    import mpmath

    angle = mpmath.mpf(OPEN) - CLOSING * t
    return [max(mpmath.mpf(WEDGE_START), RADIUS / mpmath.sin(angle)), mpmath.mpf(0)]


def growing_discs() -> Scene:
    """Two discs of radius r(t) = 0.3 e^(2t/5), which touch, between two walls; they sink to a floor, F = (0, -1).

    They push each other apart, each by the growth of r, until the left one meets its wall, x_1 = r; then x_1 = r and
    x_2 = 3 r. Their heights are max(1 - t, r): on the floor they are lifted.
    """
    return Scene(
        BOX_START,
        constant(np.array([[0.0, -1.0], [0.0, -1.0]])),
        [
            NonOverlap(growing_radius),
            HalfSpace(normal=(1, 0), radius=growing_radius),
            HalfSpace(normal=(-1, 0), offset=-WIDTH, radius=growing_radius),
            HalfSpace(normal=(0, 1), radius=growing_radius),
        ],
        name="growing_discs",
        title="Growing discs in a box",
        times=(1.0, 1.5),
        radius=SMALL,
        exact=Exact((2, 2), _growing_discs),
    )


def growing_radius(t: float) -> float:
    """r(t) = 0.3 e^(2t/5)."""
    return SMALL * math.exp(GROWTH * t)


def _growing_discs(t: Any) -> list[Any]:
    import mpmath

    r = mpmath.mpf(SMALL) * mpmath.exp(mpmath.mpf(GROWTH) * t)
    first = max(BOX_START[0][0] - (r - SMALL), r)
    height = max(BOX_START[0][1] - t, r)
    return [(first, height), (first + 2 * r, height)]
