"""A band one cell wide: a row of cells, whose triangles all have ghosts. Cells that pass each other change places."""

from __future__ import annotations

from dincl.compile import inner
from tissue.space.network.chart import turn
from tissue.space.network.halfedges import around, following, preceding
from tissue.space.network.state import Network
from tissue.space.surface import Surface

LEFT = -1  # the ghost on the left of a row


@inner
def is_row(network: Network) -> bool:
    """Whether it is one."""
    if network.out[-2] < 0:
        return False
    for t in range(network.triangles[0]):
        if min(network.corner[3 * t], network.corner[3 * t + 1], network.corner[3 * t + 2]) >= 0:
            return False
    return True


@inner
def sort_row(surface: Surface, network: Network) -> int:
    """Exchange neighbours until all triangles turn left, for vertices in their new places; how often, -1 if it fails.

    Junctions keep their places in the row. Each exchange takes one pair out of order that was; points that coincide
    have none.
    """
    swaps, n = 0, network.triangles[0] // 2
    for _ in range(n):
        before = swaps
        for h in range(3 * network.triangles[0]):
            i, j, ghost = network.corner[h], network.corner[following(h)], network.corner[preceding(h)]
            if i >= 0 and j >= 0 and not turn(surface, network, i, j, ghost) > 0.0:
                _swap(network, i, j)
                swaps += 1
        if swaps == before:
            return swaps
    return -1


@inner
def _swap(network: Network, i: int, j: int) -> None:
    """Let two vertices change their places in the row."""
    of_i, of_j = network.out[i], network.out[j]
    _name(network, of_i, j)
    _name(network, of_j, i)
    network.out[i], network.out[j] = of_j, of_i


@inner
def _name(network: Network, first: int, vertex: int) -> None:
    """Let all half-edges that leave the same vertex leave this one."""
    h = first
    while True:
        network.corner[h] = vertex
        h = around(network, h)
        if h == first:
            return
