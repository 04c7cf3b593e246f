"""A cell leaves the network: its neighbours join each other across the place that it leaves."""

from __future__ import annotations

import math

from dincl.compiled import inner
from tissue.kernels import kernel
from tissue.network.chart import squared_distance, turn
from tissue.network.halfedges import (
    around,
    degree,
    distance_along,
    find,
    flip_noted,
    following,
    is_row,
    preceding,
    set_rest,
    undo,
)
from tissue.state.cells import Floats
from tissue.state.network import LONGEST_LOG, Network
from tissue.state.space import SUM
from tissue.state.surface import Surface


@kernel
def remove(surface: Surface, network: Network, px: Floats, py: Floats, pz: Floats, i: int, rule: int) -> int:
    """Take vertex i out of the network; its star is filled by triangles, the shortest new edges first.

    A new edge goes from one neighbour to the next but one and cuts off an ear: a triangle that turns left and has no
    other neighbour in it. What is left remains a simple polygon, so there is always a next ear. Edges to a ghost come
    last, so that what was the boundary is filled; ``relax`` gives up what is too long then. In a row both neighbours
    join each other, wherever they are.

    Returns
    -------
    int
        The number of new edges; -1 if the vertex cannot leave, and nothing was changed: the network would have two
        edges with the same ends, or the vertex has more neighbours than LONGEST_LOG.
    """
    edges, ordered = degree(network, i) - 3, is_row(network)
    if edges > LONGEST_LOG:
        return -1
    for made in range(edges):
        h = _shortest_ear(surface, network, px, py, pz, i, ordered)
        if h < 0:
            undo(network, made)
            return -1
        _cut(surface, network, px, py, pz, h, rule, made)
    if not _leaves_a_triangle(surface, network, i, ordered):
        undo(network, edges)
        return -1
    _delete(network, i)
    return edges


@inner
def _shortest_ear(surface: Surface, network: Network, px: Floats, py: Floats, pz: Floats, i: int, ordered: bool) -> int:
    """Return the half-edge from i to the tip of the ear with the shortest new edge; -1 if there is no ear."""
    best, shortest, h = -1, math.inf, network.out[i]
    while True:
        before, after = _beside(network, h)
        squared = 1e300  # of an edge to a ghost
        if min(before, after) >= 0:
            squared = squared_distance(surface, px, py, pz, before, after)
        if squared < shortest and _is_ear(surface, network, h, ordered):
            best, shortest = h, squared
        h = around(network, h)
        if h == network.out[i]:
            return best


@inner
def _beside(network: Network, h: int) -> tuple[int, int]:
    """Return the neighbours before and after the one at the end of h, counterclockwise."""
    return network.corner[preceding(network.twin[h])], network.corner[preceding(h)]


@inner
def _is_ear(surface: Surface, network: Network, h: int, ordered: bool) -> bool:
    """Return whether the neighbours at h and beside it are an ear of all neighbours, and may be joined."""
    before, after = _beside(network, h)
    tip = network.corner[following(h)]
    if before == after or find(network, before, after) >= 0:
        return False
    if ordered:
        return min(before, after) >= 0
    if not turn(surface, network, before, tip, after) > 0.0:
        return False
    g = around(network, around(network, h))
    while network.corner[following(g)] != before:
        other = network.corner[following(g)]
        if (
            turn(surface, network, before, tip, other) >= 0.0
            and turn(surface, network, tip, after, other) >= 0.0
            and turn(surface, network, after, before, other) >= 0.0
        ):
            return False
        g = around(network, g)
    return True


@inner
def _cut(surface: Surface, network: Network, px: Floats, py: Floats, pz: Floats, h: int, rule: int, place: int) -> None:
    """Flip the edge to the tip of an ear away."""
    sides = network.rest[preceding(h)] + network.rest[following(network.twin[h])]
    h = flip_noted(network, h, place)
    set_rest(network, h, sides if rule == SUM else distance_along(surface, network, px, py, pz, h))


@inner
def _leaves_a_triangle(surface: Surface, network: Network, i: int, ordered: bool) -> bool:
    """Return whether the three neighbours that i has by now turn left, or need not, and are not a triangle already."""
    h = network.out[i]
    j, k, m = network.corner[following(h)], network.corner[preceding(h)], network.corner[preceding(network.twin[h])]
    beyond = network.twin[following(h)]
    return (ordered or turn(surface, network, j, k, m) > 0.0) and network.corner[preceding(beyond)] != m


@inner
def _delete(network: Network, i: int) -> None:
    """Make one triangle of the three around a vertex, and take the others out of the arrays."""
    corner, out = network.corner, network.out
    h = network.out[i]
    second = around(network, h)
    third = around(network, second)
    j, k, m = corner[following(h)], corner[following(second)], corner[following(third)]
    # j -> k remains, and in its triangle k -> i becomes k -> m, i -> j becomes m -> j.
    kept, from_k = following(h), preceding(h)
    _take_over(network, from_k, following(second))
    _take_over(network, h, following(third))
    corner[h] = m
    out[i], out[j], out[k], out[m] = -1, kept, from_k, h
    _erase(network, max(second // 3, third // 3))
    _erase(network, min(second // 3, third // 3))


@inner
def _take_over(network: Network, h: int, g: int) -> None:
    """Let half-edge h take the place of g."""
    beyond = network.twin[g]
    network.twin[h], network.twin[beyond] = beyond, h
    network.rest[h] = network.rest[g]


@inner
def _erase(network: Network, t: int) -> None:
    """Move the last triangle to the place of one that is erased."""
    network.triangles[0] -= 1
    last = network.triangles[0]
    if t == last:
        return
    for c in range(3):
        h, g = 3 * t + c, 3 * last + c
        network.corner[h] = network.corner[g]
        _take_over(network, h, g)
        if network.out[network.corner[h]] == g:
            network.out[network.corner[h]] = h
