"""Edges that wait to be looked at, in a ring: each is in it once, those whose quadrilateral changes come again."""

from __future__ import annotations

from dincl.compile import inner
from tissue.space.network.halfedges import following, preceding
from tissue.space.network.state import Network


@inner
def list_all(network: Network) -> int:
    """Fill the ring with one half-edge of each edge; how many."""
    count = 0
    for h in range(3 * network.triangles[0]):
        network.desk.listed[h] = 1 if h < network.twin[h] else 0
        if h < network.twin[h]:
            network.desk.edges[count] = h
            count += 1
    return count


@inner
def list_around(network: Network, h: int, begin: int, waiting: int) -> int:
    """Add the four edges around h behind those that wait from ``begin`` on; how many wait then."""
    g = network.twin[h]
    for beside in (following(h), preceding(h), following(g), preceding(g)):
        if not (network.desk.listed[beside] or network.desk.listed[network.twin[beside]]):
            network.desk.listed[beside] = 1
            network.desk.edges[beyond(network, begin + waiting)] = beside
            waiting += 1
    return waiting


@inner
def beyond(network: Network, place: int) -> int:
    """The place in the ring."""
    return place - network.desk.edges.size if place >= network.desk.edges.size else place
