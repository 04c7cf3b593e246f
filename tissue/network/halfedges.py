"""Half-edges of a network: what is beside each, and the flip, the one change that keeps all vertices."""

from __future__ import annotations

import math

from dincl.compiled import inner
from tissue.network.chart import squared_distance, turn
from tissue.state.cells import Floats
from tissue.state.network import Network
from tissue.state.space import PRESENT
from tissue.state.surface import Surface


@inner
def following(h: int) -> int:
    """Return the next half-edge of the triangle."""
    return h - 2 if h % 3 == 2 else h + 1


@inner
def preceding(h: int) -> int:
    """Return the half-edge before, of the same triangle."""
    return h + 2 if h % 3 == 0 else h - 1


@inner
def around(network: Network, h: int) -> int:
    """Return the half-edge that leaves the same vertex next, counterclockwise."""
    turned: int = network.twin[preceding(h)]
    return turned


@inner
def begins_edge(network: Network, h: int) -> bool:
    """Return whether h, of both half-edges of an edge that joins two cells, is the first: so loops meet each
    edge once.
    """
    g = network.twin[h]
    begins: bool = h < g and min(network.corner[h], network.corner[g]) >= 0
    return begins


@inner
def degree(network: Network, i: int) -> int:
    """Count the neighbours of vertex i, ghosts among them."""
    h, count = network.out[i], 1
    while around(network, h) != network.out[i]:
        h, count = around(network, h), count + 1
    return count


@inner
def find(network: Network, i: int, j: int) -> int:
    """Return the half-edge from vertex i to j; -1 if they are not joined."""
    h: int = network.out[i]
    while network.corner[following(h)] != j:
        h = around(network, h)
        if h == network.out[i]:
            return -1
    return h


@inner
def other_diagonal(network: Network, h: int) -> tuple[int, int]:
    """Return the vertices on the left and on the right of half-edge h."""
    return network.corner[preceding(h)], network.corner[preceding(network.twin[h])]


@inner
def left_after_flip(surface: Surface, network: Network, h: int) -> float:
    """Return the smaller ``turn`` of the two triangles that a flip would make; -1 if it is none that a network may
    make.
    """
    i, j = network.corner[h], network.corner[following(h)]
    left, right = other_diagonal(network, h)
    if left == right or (left < 0 and right < 0):
        return -1.0
    first, second = turn(surface, network, i, right, left), turn(surface, network, right, j, left)
    if not (first > 0.0 and second > 0.0) or find(network, left, right) >= 0:
        return -1.0
    return min(first, second)


@inner
def is_flippable(surface: Surface, network: Network, h: int) -> bool:
    """Return whether the two triangles at h are a strictly convex quadrilateral whose other diagonal may be an edge."""
    return left_after_flip(surface, network, h) > 0.0


@inner
def flip(network: Network, h: int) -> int:
    """Replace edge h, from i to j, by the one from the vertex on its right to the one on its left; where that is.

    Its rest length remains, and is to be set.
    """
    corner, twin, rest, out = network.corner, network.twin, network.rest, network.out
    g = twin[h]
    to_left, from_left = following(h), preceding(h)
    to_right, from_right = following(g), preceding(g)
    i, j, left, right = corner[h], corner[g], corner[from_left], corner[from_right]
    length = rest[h]
    _pair(network, h, twin[to_right])  # from i to the right
    _pair(network, g, twin[to_left])  # from j to the left
    corner[to_left], corner[to_right] = right, left
    twin[to_left], twin[to_right] = to_right, to_left
    rest[to_left], rest[to_right] = length, length
    out[i], out[j], out[left], out[right] = h, g, from_left, from_right
    return to_left


@inner
def _pair(network: Network, h: int, g: int) -> None:
    """Make h the twin of g, of the same rest length."""
    network.twin[h], network.twin[g] = g, h
    network.rest[h] = network.rest[g]


@inner
def set_rest(network: Network, h: int, length: float) -> None:
    """Set the rest length of both half-edges; 0 for an edge to a ghost."""
    g = network.twin[h]
    value = 0.0 if min(network.corner[h], network.corner[g]) < 0 else length
    network.rest[h], network.rest[g] = value, value


@inner
def rest_after_flip(surface: Surface, network: Network, px: Floats, py: Floats, pz: Floats, h: int, rule: int) -> float:
    """Return the rest length of the junction h that a flip has made, by a rule: PRESENT or MEAN."""
    if rule == PRESENT:
        return distance_along(surface, network, px, py, pz, h)
    g = network.twin[h]
    return _mean_of_four(network, following(h), preceding(h), following(g), preceding(g))


@inner
def _mean_of_four(network: Network, first: int, second: int, third: int, fourth: int) -> float:
    """Return the mean of the rest lengths of those that are junctions."""
    total, count = 0.0, 0
    for h in (first, second, third, fourth):
        if min(network.corner[h], network.corner[following(h)]) >= 0:
            total, count = total + network.rest[h], count + 1
    return total / count if count else 0.0


@inner
def distance_along(surface: Surface, network: Network, px: Floats, py: Floats, pz: Floats, h: int) -> float:
    """Return the distance of the ends of an edge in space; 0 if one is a ghost."""
    i, j = network.corner[h], network.corner[following(h)]
    return math.sqrt(squared_distance(surface, px, py, pz, i, j)) if min(i, j) >= 0 else 0.0


@inner
def take(network: Network, begin: int) -> int:
    """Take the first edge out of the ring."""
    h: int = network.work.edges[begin]
    network.work.listed[h] = 0
    return h


@inner
def list_around(network: Network, h: int, begin: int, waiting: int) -> int:
    """Add the four edges around h behind those that wait from ``begin`` on; how many wait then."""
    g = network.twin[h]
    for beside in (following(h), preceding(h), following(g), preceding(g)):
        if not (network.work.listed[beside] or network.work.listed[network.twin[beside]]):
            network.work.listed[beside] = 1
            network.work.edges[beyond(network, begin + waiting)] = beside
            waiting += 1
    return waiting


@inner
def beyond(network: Network, place: int) -> int:
    """Return the place in the ring."""
    return place - network.work.edges.size if place >= network.work.edges.size else place


LEFT = -1  # the ghost on the left of a row


@inner
def is_row(network: Network) -> bool:
    """Return whether the network is a single row of cells."""
    if network.out[-2] < 0:
        return False
    for t in range(network.triangles[0]):
        if min(network.corner[3 * t], network.corner[3 * t + 1], network.corner[3 * t + 2]) >= 0:
            return False
    return True


@inner
def flip_noted(network: Network, h: int, place: int) -> int:
    """Flip edge h as number ``place`` of those that may be undone; where the new one is."""
    network.work.logged[place] = network.rest[h]
    h = flip(network, h)
    network.work.log[2 * place] = network.corner[h]
    network.work.log[2 * place + 1] = network.corner[following(h)]
    return h


@inner
def undo(network: Network, flips: int) -> None:
    """Undo so many flips, the last one first: edges and rest lengths are as before, triangles may be elsewhere."""
    log = network.work.log
    for place in range(flips - 1, -1, -1):
        h = flip(network, find(network, log[2 * place], log[2 * place + 1]))
        set_rest(network, h, network.work.logged[place])
