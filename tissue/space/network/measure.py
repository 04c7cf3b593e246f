"""Numbers of a whole network: places on the chart, which way triangles turn, how long edges are."""

from __future__ import annotations

from tissue.kernels import kernel
from tissue.space.network.chart import chart_of, put, turn
from tissue.space.network.halfedges import distance_along
from tissue.space.network.state import Network
from tissue.space.surface import Surface
from tissue.state.cells import Floats


@kernel
def place(surface: Surface, network: Network, px: Floats, py: Floats, pz: Floats) -> None:
    """Put as many vertices as there are points at their places on the chart, whatever becomes of the triangles."""
    for i in range(px.size):
        put(network, i, chart_of(surface, px[i], py[i], pz[i]))


@kernel
def measure_turns(surface: Surface, network: Network, turns: Floats) -> None:
    """``turn`` of each triangle, (triangles,): all are > 0."""
    corner = network.corner
    for t in range(network.triangles[0]):
        turns[t] = turn(surface, network, corner[3 * t], corner[3 * t + 1], corner[3 * t + 2])


@kernel
def measure_lengths(surface: Surface, network: Network, px: Floats, py: Floats, pz: Floats, lengths: Floats) -> None:
    """The distance in space of the ends of each half-edge, (3 triangles,); 0 at ghosts."""
    for h in range(3 * network.triangles[0]):
        lengths[h] = distance_along(surface, network, px, py, pz, h)
