"""Flips that can be undone: each is noted, by the ends of the edge that it made."""

from __future__ import annotations

from dincl.compiled import inner
from tissue.space.network.halfedges import find, flip, following, set_rest
from tissue.space.network.state import Network


@inner
def flip_noted(network: Network, h: int, place: int) -> int:
    """Flip edge h as number ``place`` of those that may be undone; where the new one is."""
    network.desk.logged[place] = network.rest[h]
    h = flip(network, h)
    network.desk.log[2 * place] = network.corner[h]
    network.desk.log[2 * place + 1] = network.corner[following(h)]
    return h


@inner
def undo(network: Network, flips: int) -> None:
    """Undo so many flips, the last one first: edges and rest lengths are as before, triangles may be elsewhere."""
    log = network.desk.log
    for place in range(flips - 1, -1, -1):
        h = flip(network, find(network, log[2 * place], log[2 * place + 1]))
        set_rest(network, h, network.desk.logged[place])
