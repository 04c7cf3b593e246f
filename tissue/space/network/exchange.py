"""Edges are flipped while a judge, of three, prefers the other diagonal of a quadrilateral that may be flipped."""

from __future__ import annotations

from dincl.compiled import inner
from tissue.space.network.chart import between, squared_distance, turn
from tissue.space.network.halfedges import (
    flip,
    following,
    is_flippable,
    other_diagonal,
    rest_after_flip,
    set_rest,
)
from tissue.space.network.ring import beyond, list_around, take
from tissue.space.network.state import Network
from tissue.space.surface import SPHERE, Surface
from tissue.state.cells import Floats

# Judges: the shorter diagonal in space or in the chart, the one of Delaunay in a flat chart.
IN_SPACE, IN_CHART, DELAUNAY = range(3)
# Four points are on a circle if the sine of the sum of opposite angles is above minus this: rounding must not flip
# their diagonals for ever.
ROUND = 1e-12


@inner
def exchange(
    surface: Surface,
    network: Network,
    px: Floats,
    py: Floats,
    pz: Floats,
    judge: int,
    factor: float,
    reach: float,
    rule: int,
) -> int:
    """Flip until the judge is content; the number of flips.

    Lengths are compared by their squares: the other diagonal must be below ``factor`` times the edge. Edges from a
    boundary to a ghost count as long as ``reach``, for IN_SPACE; other judges leave boundaries alone.
    """
    flips, visited, begin, waiting = 0, 0, 0, 0
    while visited < 3 * network.triangles[0] or waiting > 0:
        # First all edges by their places, then those beside a flip.
        h = visited
        if visited < 3 * network.triangles[0]:
            visited += 1
            if h > network.twin[h]:
                continue
        else:
            h = take(network, begin)
            begin, waiting = beyond(network, begin + 1), waiting - 1
        if _is_preferred(surface, network, px, py, pz, h, judge, factor, reach) and is_flippable(surface, network, h):
            h = flip(network, h)
            set_rest(network, h, rest_after_flip(surface, network, px, py, pz, h, rule))
            waiting = list_around(network, h, begin, waiting)
            flips += 1
    return flips


@inner
def _is_preferred(
    surface: Surface,
    network: Network,
    px: Floats,
    py: Floats,
    pz: Floats,
    h: int,
    judge: int,
    factor: float,
    reach: float,
) -> bool:
    """Whether the judge prefers the other diagonal of h."""
    i, j = network.corner[h], network.corner[following(h)]
    left, right = other_diagonal(network, h)
    if judge == IN_SPACE:
        before = squared_distance(surface, px, py, pz, i, j) if min(i, j) >= 0 else reach
        after = squared_distance(surface, px, py, pz, left, right) if min(left, right) >= 0 else reach
        # An edge between cells that is given up has no margin: one that comes has had it.
        return after < (before if min(left, right) < 0 else factor * before)
    if min(i, j, left, right) < 0:
        return False
    if judge == IN_CHART:
        return _squared_in_chart(surface, network, left, right) < factor * _squared_in_chart(surface, network, i, j)
    return _is_in_circle(surface, network, i, j, left, right)


@inner
def _squared_in_chart(surface: Surface, network: Network, i: int, j: int) -> float:
    """The square of the length of an edge in the chart; the same for (j, i) to the last bit."""
    du, dv = network.u[j] - network.u[i], network.v[j] - network.v[i]
    dw = network.w[j] - network.w[i]
    if surface.bends != SPHERE:
        du, dv = between(surface, network, i, j)
    squared: float = du * du + dv * dv + dw * dw
    return squared


@inner
def _is_in_circle(surface: Surface, network: Network, i: int, j: int, left: int, right: int) -> bool:
    """Whether the angles at ``left`` and ``right`` are more than pi together: each is in the circle of the other."""
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
