"""The network of a band at the start: periodic along one axis, with a boundary at both ends of the other."""

from __future__ import annotations

import numpy as np

from tissue.space.network.chart import between, turn
from tissue.space.network.state import Network
from tissue.space.surface import Surface
from tissue.state.cells import Integers

# A new edge of a boundary goes at most this part of the period along the band, so that its triangle goes not around.
LONGEST = 0.25
# A notch that is flatter than this, its height over its width along the band, is none: a straight boundary has none.
FLATTEST = 1e-6


def band_triangles(surface: Surface, network: Network, n: int, along: int, period: float) -> Integers:
    """All triangles of a band of n vertices, which are on the chart already, and of its ghosts -1 and -2.

    The vertices in the order along the period are a closed line. On both sides its notches are filled, as in Graham's
    scan for a convex hull; what is left of the two sides are boundaries of which each point sees its ghost.
    """
    position = (network.u if along == 0 else network.v)[:n]
    ring = np.argsort(position - period * np.floor(position / period), kind="stable")
    # So that the ghost -2 is on the right.
    order = (ring if along == 0 else ring[::-1]).tolist()
    limit = LONGEST * period
    right, first = _filled(surface, network, order, along, limit)
    left, second = _filled(surface, network, order[::-1], along, limit)
    ends = [(b, a, -2) for a, b in _pairs(right)] + [(b, a, -1) for a, b in _pairs(left)]
    return np.array(first + second + ends, np.int64).reshape(-1, 3)


def _pairs(line: list[int]) -> list[tuple[int, int]]:
    """The edges of a closed line."""
    return list(zip(line, line[1:] + line[:1], strict=True))


def _filled(
    surface: Surface, network: Network, line: list[int], along: int, limit: float
) -> tuple[list[int], list[tuple[int, int, int]]]:
    """What is left of a closed line when all notches on its right are filled, and the triangles that fill them."""
    line, triangles, place, since = list(line), [], 0, 0
    while since < len(line) and len(line) > 3:
        before, tip, after = (line[(place + k) % len(line)] for k in range(3))
        width = abs(between(surface, network, before, after)[along])
        if width <= limit and turn(surface, network, before, after, tip) > FLATTEST * width**2:
            triangles.append((before, after, tip))
            line.remove(tip)
            place, since = max(0, place - 2), 0
        else:
            place, since = (place + 1) % len(line), since + 1
    return line, triangles
