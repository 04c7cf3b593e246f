"""The edges of a network as lists, which substeps read while the neighbours stand still."""

from __future__ import annotations

from tissue.kernels import kernel
from tissue.space.network.state import Network
from tissue.state.cells import Floats, Integers


@kernel
def list_edges(network: Network, first: Integers, second: Integers, rest: Floats) -> int:
    """Write the cells i < j that each edge joins, and its rest length, edges to ghosts left out; how many there are.

    The order is that of the half-edges, so it is the same for the same network. There are at most 3 (capacity + 2).
    """
    count = 0
    for h in range(3 * network.triangles[0]):
        i, j = network.corner[h], network.corner[network.twin[h]]
        if 0 <= i < j:
            first[count], second[count], rest[count] = i, j, network.rest[h]
            count += 1
    return count
