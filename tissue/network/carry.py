"""One vertex moves along a straight line of the chart, all others stand: the edges in its way are flipped.

While vertex i moves, ``turn`` of each of its triangles is linear in the time, so it is known when the first of them has
its vertices on a line. One of the three is between the others then, and has come to the edge between them: that one is
flipped, which makes two triangles that turn left. It is found as the only flip of the three that does.
"""

from __future__ import annotations

import math

from dincl.compiled import inner
from tissue.network.chart import on_the_way, place_of, put, turn
from tissue.network.halfedges import (
    around,
    flip_noted,
    following,
    left_after_flip,
    preceding,
    rest_after_flip,
    set_rest,
    undo,
)
from tissue.state.cells import Floats
from tissue.state.network import LONGEST_LOG, Network, Place
from tissue.state.surface import Surface


@inner
def carry(surface: Surface, network: Network, px: Floats, py: Floats, pz: Floats, rule: int, i: int, end: Place) -> int:
    """Move vertex i to another place of the chart; how many edges it flipped, or -1, and then all is as it was.

    It cannot go where it would be on another vertex, nor through one; nor if it needs more than LONGEST_LOG flips.
    """
    begin = place_of(network, i)
    for flips in range(LONGEST_LOG + 1):
        h, when = _first_to_turn(surface, network, i, begin, end)
        if h < 0:
            return flips
        put(network, i, on_the_way(begin, end, when))
        crossed = _crossed(surface, network, h) if flips < LONGEST_LOG else -1
        if crossed < 0:
            put(network, i, begin)
            undo(network, flips)
            break
        h = flip_noted(network, crossed, flips)
        set_rest(network, h, rest_after_flip(surface, network, px, py, pz, h, rule))
    return -1


@inner
def _first_to_turn(surface: Surface, network: Network, i: int, begin: Place, end: Place) -> tuple[int, float]:
    """Return which triangle of vertex i has its vertices on a line first on the way, as a half-edge, and when: from 0
    to 1.

    -1 if all turn left at the end of the way, where the vertex is then.
    """
    first, when, h = -1, math.inf, network.out[i]
    while True:
        put(network, i, end)
        after = _turn_at(surface, network, h)
        if not after > 0.0:
            put(network, i, begin)
            before = _turn_at(surface, network, h)
            # One that is made on the way may not turn left at its begin. What is not a number is nowhere on the way.
            at = before / (before - after) if before > 0.0 and after <= 0.0 else 0.0
            if at < when:
                first, when = h, at
        h = around(network, h)
        if h == network.out[i]:
            break
    put(network, i, end)
    return first, when


@inner
def _turn_at(surface: Surface, network: Network, h: int) -> float:
    """``turn`` of the triangle of h."""
    corner = network.corner
    return turn(surface, network, corner[h], corner[following(h)], corner[preceding(h)])


@inner
def _crossed(surface: Surface, network: Network, h: int) -> int:
    """Find the edge that a vertex of a flat triangle has come to; -1 if it cannot be flipped."""
    best, most = -1, 0.0
    for edge in (following(h), h, preceding(h)):
        left = left_after_flip(surface, network, edge)
        if left > most:
            best, most = edge, left
    return best
