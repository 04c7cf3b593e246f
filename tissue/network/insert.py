"""A daughter comes beside her mother: the vertex is split in two, which share two of its neighbours."""

from __future__ import annotations

import math

from dincl.compiled import inner
from tissue.kernels import kernel
from tissue.network.chart import between, chart_of, place_of, put, turn
from tissue.network.halfedges import around, following, is_row, preceding, set_rest
from tissue.state.cells import Floats
from tissue.state.network import Network, Place
from tissue.state.surface import CYLINDER, SPHERE, Surface

# Times that the distance is halved before the daughter is given up.
HALVINGS = 40


@kernel
def insert(
    surface: Surface,
    network: Network,
    px: Floats,
    py: Floats,
    pz: Floats,
    mother: int,
    daughter: int,
    tx: float,
    ty: float,
    tz: float,
    distance: float,
    rest: float,
) -> float:
    """Part a daughter from her mother: they get the places p +- d/2 t about hers, joined by a new junction.

    The neighbours ahead of the line across t are the daughter's, those behind it the mother's; the one that is most
    across on each side is neighbour of both, with the same rest length: so both have at least three. d is the distance
    given, or what is left of it after as many halvings as it takes for all triangles to turn left, which those of a row
    need not.

    Parameters
    ----------
    px, py, pz
        The points, where ``follow`` has brought the network; those of mother and daughter are changed.
    mother, daughter
        One in the network, and one that is not, below its capacity.
    tx, ty, tz
        The direction, of length 1, along the surface.
    rest
        Of the junction between them.

    Returns
    -------
    float
        The distance that was used; 0 if nothing was changed, as no distance is possible.
    """
    x, y, z = px[mother], py[mother], pz[mother]
    ahead, behind = _across(surface, network, mother, _along(surface, x, y, z, tx, ty, tz))
    if ahead < 0 or behind < 0:
        return 0.0
    half, ordered = 0.5 * distance, is_row(network)
    for _ in range(HALVINGS):
        place = chart_of(surface, x - half * tx, y - half * ty, z - half * tz)
        put(network, daughter, chart_of(surface, x + half * tx, y + half * ty, z + half * tz))
        if ordered or _fits(surface, network, mother, daughter, place, ahead, behind):
            put(network, mother, place)
            _split(network, mother, daughter, ahead, behind, rest)
            px[mother], py[mother], pz[mother] = x - half * tx, y - half * ty, z - half * tz
            px[daughter], py[daughter], pz[daughter] = x + half * tx, y + half * ty, z + half * tz
            return 2.0 * half
        half *= 0.5
    return 0.0


@inner
def _along(surface: Surface, x: float, y: float, z: float, tx: float, ty: float, tz: float) -> Place:
    """Return the direction t on the chart, at a point."""
    if surface.bends == SPHERE:
        return surface.side * tx, surface.side * ty, surface.side * tz
    if surface.bends == CYLINDER:
        return surface.side * surface.radius * (x * ty - y * tx) / (x * x + y * y), tz, 0.0
    return tz, tx, 0.0


@inner
def _across(surface: Surface, network: Network, i: int, direction: Place) -> tuple[int, int]:
    """Return the half-edges of vertex i that are most across a direction: to its right, and to its left; -1 for
    none.
    """
    right, left, most_right, most_left = -1, -1, 0.0, 0.0
    h = network.out[i]
    while True:
        sine = _sine(surface, network, i, network.corner[following(h)], direction)
        if sine > most_left:
            left, most_left = h, sine
        if -sine > most_right:
            right, most_right = h, -sine
        h = around(network, h)
        if h == network.out[i]:
            return right, left


@inner
def _sine(surface: Surface, network: Network, i: int, j: int, direction: Place) -> float:
    """Compute the sine of the angle from a direction to the way from i to j, times the length of the direction."""
    du, dv, dw = direction
    if surface.bends != SPHERE:
        eu, ev = between(surface, network, i, j)
        return (du * ev - dv * eu) / math.sqrt(eu * eu + ev * ev)
    a, b, c = place_of(network, i)
    eu, ev, ew = network.u[j] - a, network.v[j] - b, network.w[j] - c
    cross = a * (dv * ew - dw * ev) + b * (dw * eu - du * ew) + c * (du * ev - dv * eu)
    sine: float = cross / math.sqrt(eu * eu + ev * ev + ew * ew)
    return sine


@inner
def _fits(
    surface: Surface, network: Network, mother: int, daughter: int, place: Place, ahead: int, behind: int
) -> bool:
    """Return whether all triangles turn left after the split with the mother at a place; she is put back."""
    before = place_of(network, mother)
    put(network, mother, place)
    right, left = network.corner[following(ahead)], network.corner[following(behind)]
    fits = (
        turn(surface, network, mother, daughter, left) > 0.0 and turn(surface, network, daughter, mother, right) > 0.0
    )
    h, vertex = ahead, daughter
    while fits:
        fits = turn(surface, network, vertex, network.corner[following(h)], network.corner[preceding(h)]) > 0.0
        h = around(network, h)
        if h == behind:
            vertex = mother
        if h == ahead:
            break
    put(network, mother, before)
    return fits


@inner
def _split(network: Network, mother: int, daughter: int, ahead: int, behind: int, rest: float) -> None:
    """Give the half-edges of the mother from ``ahead`` to before ``behind``, counterclockwise, to the daughter."""
    corner, twin = network.corner, network.twin
    right, left = corner[following(ahead)], corner[following(behind)]
    to_right, to_left = twin[ahead], twin[behind]
    h = ahead
    while h != behind:
        corner[h] = daughter
        h = around(network, h)
    first = 3 * network.triangles[0]
    network.triangles[0] += 2
    _write(network, first, mother, daughter, left)
    _write(network, first + 3, daughter, mother, right)
    twin[first], twin[first + 3] = first + 3, first
    _join(network, first + 1, to_left)  # daughter and left
    _join(network, first + 2, behind)  # left and mother
    _join(network, first + 4, to_right)  # mother and right
    _join(network, first + 5, ahead)  # right and daughter
    network.out[mother], network.out[daughter] = first, first + 3
    set_rest(network, first, rest)


@inner
def _write(network: Network, h: int, i: int, j: int, k: int) -> None:
    """Write a triangle that begins with half-edge h."""
    network.corner[h], network.corner[h + 1], network.corner[h + 2] = i, j, k


@inner
def _join(network: Network, h: int, g: int) -> None:
    """Make a new half-edge the twin of an old one, of its rest length."""
    network.twin[h], network.twin[g] = g, h
    network.rest[h] = network.rest[g]
