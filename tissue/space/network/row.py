"""A band one cell wide: a row of cells, whose triangles all have ghosts. As in the plane its order stays."""

from __future__ import annotations

from dincl.compiled import inner
from tissue.space.network.state import Network

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
