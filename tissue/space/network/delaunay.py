"""Flips until a network has the property of Delaunay on a flat chart: opposite angles have a sum of at most pi."""

from __future__ import annotations

from dincl.compile import inner
from tissue.kernels import kernel
from tissue.space.network.chart import between, turn
from tissue.space.network.halfedges import flip, following, is_flippable, other_diagonal
from tissue.space.network.ring import beyond, list_all, list_around
from tissue.space.network.state import Network
from tissue.space.surface import Surface

# Four points are on a circle if the sine of the sum of opposite angles is above minus this: rounding must not flip
# their diagonals for ever.
ROUND = 1e-12


@kernel
def make_delaunay(surface: Surface, network: Network) -> int:
    """Flip all edges inside until none has opposite angles of more than pi together; the number of flips.

    It ends, as each flip makes the smallest of six angles larger (Lawson).
    """
    flips = 0
    begin, waiting = 0, list_all(network)
    while waiting > 0:
        h = network.desk.edges[begin]
        begin, waiting = beyond(network, begin + 1), waiting - 1
        network.desk.listed[h] = 0
        if _is_in_circle(surface, network, h) and is_flippable(surface, network, h):
            waiting = list_around(network, flip(network, h), begin, waiting)
            flips += 1
    return flips


@inner
def _is_in_circle(surface: Surface, network: Network, h: int) -> bool:
    """Whether the vertex on the right of h is in the circle through its triangle; ghosts are in none."""
    i, j = network.corner[h], network.corner[following(h)]
    left, right = other_diagonal(network, h)
    if min(i, j, left, right) < 0:
        return False
    cosine, sine = _product(surface, network, left, i, j), turn(surface, network, i, j, left)
    cosine_beyond, sine_beyond = _product(surface, network, right, i, j), turn(surface, network, j, i, right)
    size = abs(cosine * sine_beyond) + abs(cosine_beyond * sine)
    return cosine * sine_beyond + cosine_beyond * sine < -ROUND * size


@inner
def _product(surface: Surface, network: Network, i: int, j: int, k: int) -> float:
    """(b - a) . (c - a)."""
    eu, ev = between(surface, network, i, j)
    fu, fv = between(surface, network, i, k)
    return eu * fu + ev * fv
