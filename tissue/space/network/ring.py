"""Edges that wait to be looked at again, in a ring, as their quadrilateral has changed: each is in it once."""

from __future__ import annotations

from dincl.compiled import inner
from tissue.space.network.halfedges import following, preceding
from tissue.space.network.state import Network


@inner
def take(network: Network, begin: int) -> int:
    """Take the first edge out of the ring."""
    h: int = network.desk.edges[begin]
    network.desk.listed[h] = 0
    return h


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
