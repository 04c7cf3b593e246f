"""Neighbours in both layers: renewed every few dt, with the rest lengths of pairs that stay; cells that come and go.

In between a daughter stands on the edge from her mother to the neighbour ahead, and the neighbours of a cell that
leaves join the nearest one of them. Both keep the layer a triangulation, if not Delaunay's.
"""

from __future__ import annotations

import math

import numpy as np

from dincl.compiled import inner
from dincl.errors import InvalidProblem
from tissue.network.triangulation import triangulate
from tissue.state.cells import Floats, Integers
from tissue.state.running import APICAL, BASAL, TissueState
from tissue.state.space import EDGES, SUM, TRIANGLES, Network, in_use, no_network, write
from tissue.state.surface import Surface, differences

# Steps dt from one triangulation to the next: a quarter of an hour of the presets. In periodic sheets heights, y_AB and
# its spread are the same within a standard error for 1 to 40 steps; the apical area of sheets grown for 12 h is 2 %
# larger than with 1 step, with 10 it is 6 %. A basal layer with a free edge draws together by exchanges of neighbours:
# with 1 or 2 steps in an hour, with 5 in two, with 10 in four, to the same extent. If all daughters stay it is a tenth
# narrower after 30 h than with 1 step, with 2 steps as much as with 5: free edges gain nothing by 2.
RENEWED = 5

Points = tuple[Floats, Floats, Floats]


def connected(surface: Surface, points: Floats, rest: float, longest: float, capacity: int) -> Network:
    """Return the network of points (n, 3), one for each cell, whose junctions all have this rest length.

    Raises InvalidProblem if the points have no triangulation, see ``triangulate``.
    """
    network = no_network(capacity)
    edges, triangles = triangulate(surface, points, longest)
    write(network, edges, np.full(len(edges), rest), triangles)
    return network


def renew(state: TissueState) -> None:
    """Make the networks of both layers Delaunay's triangulations of their points.

    Junctions keep their rest lengths; that of new neighbours is the mean over the junctions that both have. Raises
    InvalidProblem if points of a layer have no triangulation, see ``triangulate``.
    """
    space = state.space
    for network, (layer, points) in ((space.apical, apical_points(state)), (space.basal, basal_points(state))):
        edges, triangles = triangulate(space.surface, points, space.longest)
        pairs = layer[edges]
        write(network, pairs, _rest_lengths(network, pairs), layer[triangles])


def apical_points(state: TissueState) -> tuple[Integers, Floats]:
    """Return the cells of the apical layer, increasing, and their apical points (n, 3)."""
    layer, cells = state.layers.apical[: state.sizes[APICAL]], state.cells
    return layer, np.column_stack((cells.ax[layer], cells.ay[layer], cells.az[layer]))


def basal_points(state: TissueState) -> tuple[Integers, Floats]:
    """Return the cells of the basal layer, increasing, and their basal points (n, 3)."""
    layer, cells = state.layers.basal[: state.sizes[BASAL]], state.cells
    return layer, np.column_stack((cells.bx[layer], cells.by[layer], cells.bz[layer]))


def fresh_triangles(state: TissueState, layer: Integers, points: Floats, network: Network) -> Integers:
    """Return the triangles of a layer as it is now, those of its network where its points have no triangulation."""
    try:
        found: Integers = layer[triangulate(state.space.surface, points, state.space.longest)[1]]
    except InvalidProblem:
        return in_use(network)[2]
    return found


def _rest_lengths(network: Network, pairs: Integers) -> Floats:
    """Return the rest lengths of pairs (m, 2): what they have, else the mean over the junctions of both."""
    (edges, rest, _), room = in_use(network), network.capacity
    if not len(edges):
        return np.zeros(len(pairs))
    total = np.bincount(edges.ravel(), np.repeat(rest, 2), room)[pairs].sum(axis=1)
    mean: Floats = total / np.maximum(np.bincount(edges.ravel(), minlength=room)[pairs].sum(axis=1), 1)
    known, wanted = edges[:, 0] * room + edges[:, 1], pairs[:, 0] * room + pairs[:, 1]
    order = np.argsort(known)
    known = known[order]
    place = np.searchsorted(known, wanted).clip(max=len(known) - 1)
    return np.where(known[place] == wanted, rest[order[place]], mean)


@inner
def has_room(network: Network, daughters: int) -> bool:
    """Return whether ``add_daughter`` may be called so often: she adds three edges and two triangles at most."""
    edges, triangles = network.sizes[EDGES] + 3 * daughters, network.sizes[TRIANGLES] + 2 * daughters
    room: bool = edges <= len(network.edges) and triangles <= len(network.triangles)
    return room


@inner
def add_daughter(
    surface: Surface, network: Network, points: Points, i: int, j: int, t: tuple[float, float, float], rest: float
) -> None:
    """Put daughter j, the last cell, on the edge from her mother i to the neighbour k that is farthest along t.

    She is joined to both and to the corners beside that edge. The edge to k keeps its rest length, those to the corners
    have that of the mother; ``rest`` is that of the new junction.
    """
    ahead, most = -1, -math.inf
    for edge in range(network.sizes[EDGES]):
        k = _other_end(network, edge, i)
        if k >= 0:
            dx, dy, dz = _way(surface, points, i, k)
            along = dx * t[0] + dy * t[1] + dz * t[2]
            if along > most:
                ahead, most = edge, along
    if ahead >= 0:
        k, first = _other_end(network, ahead, i), network.sizes[TRIANGLES]
        network.edges[ahead, 0], network.edges[ahead, 1] = k, j
        for old in range(first):
            at_i, at_k, new = _corner(network, old, i), _corner(network, old, k), network.sizes[TRIANGLES]
            # After cells have left, more than two may be at one edge; there is room for two.
            if at_i >= 0 and at_k >= 0 and new < first + 2:
                for c in range(3):
                    network.triangles[new, c] = network.triangles[old, c]
                network.triangles[old, at_k], network.triangles[new, at_i] = j, j
                network.sizes[TRIANGLES] = new + 1
                beside = network.triangles[old, 3 - at_i - at_k]
                if _find(network, beside, j) < 0:
                    own = _find(network, i, beside)
                    _add_edge(network, beside, j, network.rest[own] if own >= 0 else rest)
    _add_edge(network, i, j, rest)


@inner
def remove_cell(surface: Surface, network: Network, points: Points, i: int, bridge: int) -> None:
    """Take cell i out: its nearest neighbour k takes its place, so all its neighbours join that one.

    The rest length of a new junction of k and a is the sum of those of (a, i) and (i, k), ``bridge`` = SUM, or the
    distance.
    """
    k, nearest, to_k = -1, math.inf, 0.0
    for edge in range(network.sizes[EDGES]):
        a = _other_end(network, edge, i)
        if a >= 0:
            distance = _distance(surface, points, i, a)
            if distance < nearest:
                k, nearest, to_k = a, distance, network.rest[edge]
    edge = 0
    while edge < network.sizes[EDGES]:
        a = _other_end(network, edge, i)
        if a < 0:
            edge += 1
        elif a == k or _find(network, a, k) >= 0:
            last = network.sizes[EDGES] - 1
            network.edges[edge, 0], network.edges[edge, 1] = network.edges[last, 0], network.edges[last, 1]
            network.rest[edge] = network.rest[last]
            network.sizes[EDGES] = last
        else:
            network.edges[edge, 0], network.edges[edge, 1] = min(a, k), max(a, k)
            network.rest[edge] = network.rest[edge] + to_k if bridge == SUM else _distance(surface, points, a, k)
            edge += 1
    number = 0
    while number < network.sizes[TRIANGLES]:
        at_i = _corner(network, number, i)
        if at_i >= 0 and (k < 0 or _corner(network, number, k) >= 0):
            last = network.sizes[TRIANGLES] - 1
            for c in range(3):
                network.triangles[number, c] = network.triangles[last, c]
            network.sizes[TRIANGLES] = last
        else:
            if at_i >= 0:
                network.triangles[number, at_i] = k
            number += 1


@inner
def _add_edge(network: Network, i: int, j: int, rest: float) -> None:
    """Join cells i < j."""
    edge = network.sizes[EDGES]
    network.edges[edge, 0], network.edges[edge, 1], network.rest[edge] = i, j, rest
    network.sizes[EDGES] = edge + 1


@inner
def _other_end(network: Network, edge: int, i: int) -> int:
    """Return the neighbour of cell i along an edge, -1 if the edge is not its own."""
    first, second = network.edges[edge, 0], network.edges[edge, 1]
    other: int = second if first == i else first if second == i else -1
    return other


@inner
def _find(network: Network, i: int, j: int) -> int:
    """Return the edge of cells i and j, -1 if they are no neighbours."""
    for edge in range(network.sizes[EDGES]):
        if _other_end(network, edge, i) == j:
            return edge
    return -1


@inner
def _corner(network: Network, number: int, i: int) -> int:
    """Return which corner of a triangle cell i is, -1 if it is none."""
    for c in range(3):
        if network.triangles[number, c] == i:
            return c
    return -1


@inner
def _way(surface: Surface, points: Points, i: int, j: int) -> tuple[float, float, float]:
    """Return the way from a point to the nearest image of another one."""
    x, y, z = points
    return differences(surface, x[j] - x[i], y[j] - y[i], z[j] - z[i])


@inner
def _distance(surface: Surface, points: Points, i: int, j: int) -> float:
    dx, dy, dz = _way(surface, points, i, j)
    return math.sqrt(dx * dx + dy * dy + dz * dz)
