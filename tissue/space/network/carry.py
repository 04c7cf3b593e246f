"""One vertex moves along a straight line of the chart, all others stand: the edges in its way are flipped.

While vertex i moves, ``turn`` of each of its triangles is linear in the time, so it is known when the first of them has
its vertices on a line. One of the three is between the others then, and has come to the edge between them: that one is
flipped, which makes two triangles that turn left. It is found as the only flip of the three that does.
"""

from __future__ import annotations

import math

from dincl.compile import inner
from tissue.space.network.chart import turn
from tissue.space.network.halfedges import around, following, left_after_flip, preceding, rest_after_flip, set_rest
from tissue.space.network.state import LONGEST_LOG, Network
from tissue.space.network.undo import flip_noted, undo
from tissue.space.surface import Surface
from tissue.state.cells import Floats


@inner
def carry(
    surface: Surface,
    network: Network,
    px: Floats,
    py: Floats,
    pz: Floats,
    rule: int,
    i: int,
    u: float,
    v: float,
    w: float,
) -> int:
    """Move vertex i to (u, v, w) of the chart; how many edges it flipped, or -1, and then all is as it was.

    It cannot go where it would be on another vertex, nor through one; nor if it needs more than LONGEST_LOG flips.
    """
    from_u, from_v, from_w = network.u[i], network.v[i], network.w[i]
    for flips in range(LONGEST_LOG + 1):
        h, when = _first_to_turn(surface, network, i, from_u, from_v, from_w, u, v, w)
        if h < 0:
            return flips
        put(network, i, from_u + when * (u - from_u), from_v + when * (v - from_v), from_w + when * (w - from_w))
        crossed = _crossed(surface, network, h) if flips < LONGEST_LOG else -1
        if crossed < 0:
            put(network, i, from_u, from_v, from_w)
            undo(network, flips)
            return -1
        h = flip_noted(network, crossed, flips)
        set_rest(network, h, rest_after_flip(surface, network, px, py, pz, h, rule))
    return -1


@inner
def put(network: Network, i: int, u: float, v: float, w: float) -> None:
    """Place vertex i on the chart."""
    network.u[i], network.v[i], network.w[i] = u, v, w


@inner
def _first_to_turn(
    surface: Surface,
    network: Network,
    i: int,
    from_u: float,
    from_v: float,
    from_w: float,
    u: float,
    v: float,
    w: float,
) -> tuple[int, float]:
    """Which triangle of vertex i has its vertices on a line first on the way, as a half-edge, and when: from 0 to 1.

    -1 if all turn left at the end of the way, where the vertex is then.
    """
    first, when, h = -1, math.inf, network.out[i]
    while True:
        put(network, i, u, v, w)
        after = _turn_at(surface, network, h)
        if not after > 0.0:
            put(network, i, from_u, from_v, from_w)
            before = _turn_at(surface, network, h)
            at = before / (before - after) if before > 0.0 else 0.0
            if at < when:
                first, when = h, at
            elif first < 0:  # what is not a number is nowhere on the way
                first, when = h, 0.0
        h = around(network, h)
        if h == network.out[i]:
            break
    put(network, i, u, v, w)
    return first, min(when, 1.0)


@inner
def _turn_at(surface: Surface, network: Network, h: int) -> float:
    """``turn`` of the triangle of h."""
    corner = network.corner
    return turn(surface, network, corner[h], corner[following(h)], corner[preceding(h)])


@inner
def _crossed(surface: Surface, network: Network, h: int) -> int:
    """Of a triangle whose vertices are on a line, the edge that one of them has come to; -1 if it cannot be flipped."""
    best, most = -1, 0.0
    for edge in (following(h), h, preceding(h)):
        left = left_after_flip(surface, network, edge)
        if left > most:
            best, most = edge, left
    return best
