"""Edges are flipped while a judge, of three, prefers the other diagonal of a quadrilateral that may be flipped."""

from __future__ import annotations

from dincl.compiled import inner
from tissue.kernels import kernel
from tissue.network.chart import between, chart_of, put, squared_distance, turn
from tissue.network.halfedges import (
    beyond,
    distance_along,
    flip,
    following,
    is_flippable,
    list_around,
    other_diagonal,
    rest_after_flip,
    set_rest,
    take,
)
from tissue.state.cells import Floats
from tissue.state.network import Network
from tissue.state.space import MEAN
from tissue.state.surface import SPHERE, Surface

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
    longest: float,
    rule: int,
) -> int:
    """Flip until the judge is content; the number of flips.

    Lengths are compared by their squares: the other diagonal must be below ``factor`` times the edge. Edges from a
    boundary to a ghost count as long as ``longest``, for IN_SPACE; other judges leave boundaries alone.
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
        if _is_preferred(surface, network, px, py, pz, h, judge, factor, longest) and is_flippable(surface, network, h):
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
    longest: float,
) -> bool:
    """Return whether the judge prefers the other diagonal of h."""
    i, j = network.corner[h], network.corner[following(h)]
    left, right = other_diagonal(network, h)
    if judge == IN_SPACE:
        before = squared_distance(surface, px, py, pz, i, j) if min(i, j) >= 0 else longest
        after = squared_distance(surface, px, py, pz, left, right) if min(left, right) >= 0 else longest
        # An edge between cells that is given up has no margin: one that comes has had it.
        return after < (before if min(left, right) < 0 else factor * before)
    if min(i, j, left, right) < 0:
        return False
    if judge == IN_CHART:
        return _squared_in_chart(surface, network, left, right) < factor * _squared_in_chart(surface, network, i, j)
    return _is_in_circle(surface, network, i, j, left, right)


@inner
def _squared_in_chart(surface: Surface, network: Network, i: int, j: int) -> float:
    """Return the square of the length of an edge in the chart; the same for (j, i) to the last bit."""
    du, dv = network.u[j] - network.u[i], network.v[j] - network.v[i]
    dw = network.w[j] - network.w[i]
    if surface.bends != SPHERE:
        du, dv = between(surface, network, i, j)
    squared: float = du * du + dv * dv + dw * dw
    return squared


@inner
def _is_in_circle(surface: Surface, network: Network, i: int, j: int, left: int, right: int) -> bool:
    """Return whether the angles at ``left`` and ``right`` are more than pi together: each is in the circle of the
    other.
    """
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


@kernel
def relax(
    surface: Surface, network: Network, px: Floats, py: Floats, pz: Floats, margin: float, longest: float, rule: int
) -> int:
    """Flip edges of length l whose other diagonal is shorter than (1 - margin) l in space, until there is none.

    At the boundary of a patch an edge longer than ``longest`` is given up, and a notch is filled if the closing edge is
    shorter than (1 - margin) ``longest``. The flips are made that ``is_flippable`` allows, so nothing ever crosses.

    It ends. Take the sum of (l^2 - longest^2) over all edges between cells, longest = 0 if there is no boundary,
    where their number never changes. A flip inside replaces l^2 by a smaller number; an edge that is given up takes a
    term > 0 out, one that fills a notch brings a term < 0. So the sum falls with each flip, also as computed, since
    the length of a pair is always the same number; no network comes twice, and there are finitely many.

    Parameters
    ----------
    px, py, pz
        The points, where ``follow`` has brought the network.
    margin
        From 0 to 1.
    longest
        Of edges at a boundary; of no meaning without.
    rule
        Of the rest lengths of new junctions: PRESENT or MEAN.

    Returns
    -------
    int
        The number of flips.
    """
    return exchange(surface, network, px, py, pz, IN_SPACE, (1.0 - margin) ** 2, longest * longest, rule)


@kernel
def make_delaunay(surface: Surface, network: Network) -> int:
    """Flip all edges inside until none has opposite angles of more than pi together; the number of flips.

    It ends, as each flip lets the surface over the chart with the height u^2 + v^2 at the vertices sink (Lawson).
    """
    return exchange(surface, network, network.u, network.v, network.w, DELAUNAY, 1.0, 0.0, MEAN)


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
    """Measure the distance in space of the ends of each half-edge, (3 triangles,); 0 at ghosts."""
    for h in range(3 * network.triangles[0]):
        lengths[h] = distance_along(surface, network, px, py, pz, h)
