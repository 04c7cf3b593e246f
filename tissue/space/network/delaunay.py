"""Flips until a network has the property of Delaunay on a flat chart: opposite angles have a sum of at most pi."""

from __future__ import annotations

from tissue.kernels import kernel
from tissue.space.network.exchange import DELAUNAY, exchange
from tissue.space.network.halfedges import MEAN
from tissue.space.network.state import Network
from tissue.space.surface import Surface


@kernel
def make_delaunay(surface: Surface, network: Network) -> int:
    """Flip all edges inside until none has opposite angles of more than pi together; the number of flips.

    It ends, as each flip lets the surface over the chart with the height u^2 + v^2 at the vertices sink (Lawson).
    """
    return exchange(surface, network, network.u, network.v, network.w, DELAUNAY, 1.0, 0.0, MEAN)
