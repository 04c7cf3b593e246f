"""The neighbours of a layer in space as arrays: pairs of cells with their rest lengths, and triangles."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from dincl import checks
from dincl.errors import InvalidProblem
from tissue.state.cells import Floats, Integers

# Places in Network.sizes. A triangulation of n cells has at most 3 n edges and 2 n triangles.
EDGES, TRIANGLES = range(2)


class Network(NamedTuple):
    """Neighbours in a layer: Delaunay's triangulation of its points, with daughters and gaps since it was made.

    See ``tissue.network.neighbours``. Cells are indices; of each array the first ``sizes`` are in use.
    """

    edges: Integers  # (3 capacity, 2): pairs i < j of cells that are neighbours, each once
    rest: Floats  # (3 capacity,): rest length of the junction of a pair [R_soft]
    triangles: Integers  # (2 capacity, 3): counterclockwise as seen from the tissue
    sizes: Integers  # (2,): numbers of edges and of triangles

    @property
    def capacity(self) -> int:
        """Number of cells that there is room for."""
        return len(self.edges) // 3


def no_network(capacity: int) -> Network:
    """Return a network without neighbours, with room for so many cells."""
    n = checks.integer("capacity", capacity, least=0)
    return Network(
        np.zeros((3 * n, 2), np.int64), np.zeros(3 * n), np.zeros((2 * n, 3), np.int64), np.zeros(2, np.int64)
    )


def write(network: Network, edges: Integers, rest: Floats, triangles: Integers) -> None:
    """Replace what is in a network; raises InvalidProblem for more edges or triangles than there is room for."""
    m, count = len(edges), len(triangles)
    if m > len(network.edges) or count > len(network.triangles):
        room = f"{len(network.edges)} edges and {len(network.triangles)} triangles"
        raise InvalidProblem(f"network = {m} edges and {count} triangles: must be at most {room}")
    network.edges[:m], network.rest[:m], network.triangles[:count] = edges, rest, triangles
    network.sizes[:] = m, count


def in_use(network: Network) -> tuple[Integers, Floats, Integers]:
    """Return copies of the edges, rest lengths and triangles in use."""
    edges, triangles = network.sizes
    return network.edges[:edges].copy(), network.rest[:edges].copy(), network.triangles[:triangles].copy()


def grown(network: Network, capacity: int) -> Network:
    """Return the same network with room for more cells; raises InvalidProblem for less room than it has."""
    if checks.integer("capacity", capacity, least=0) < network.capacity:
        raise InvalidProblem(f"capacity = {capacity}: must be at least {network.capacity}, what the network has")
    larger = no_network(capacity)
    write(larger, *in_use(network))
    return larger
