"""A network as arrays: triangles in half-edges, and where its points were when it was last known to be right."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from dincl import checks
from dincl.errors import InvalidProblem
from tissue.state.cells import Floats, Integers

# Ghosts, the vertices at infinity, are -1 and -2: the last places of the arrays of vertices are theirs.
GHOSTS = 2
# Flips of a single move of a vertex, at most: it crosses a few edges. Beyond, the move is cut in half.
LONGEST_LOG = 128
# What there is of a network besides its workspace and the number of triangles, by half-edges and by vertices.
OF_HALF_EDGES, OF_VERTICES = ("corner", "twin", "rest"), ("out", "u", "v", "w")

# On the chart, see ``tissue.network.chart``.
Place = tuple[float, float, float]


class NetworkWorkspace(NamedTuple):
    """What the kernels write on while they work; nothing in it outlives a call."""

    from_u: Floats  # of a vertex: where it comes from, and where it goes
    from_v: Floats
    from_w: Floats
    to_u: Floats
    to_v: Floats
    to_w: Floats
    waiting: Integers  # of a vertex: whether it is in the queue
    queue: Integers  # vertices
    edges: Integers  # a ring of half-edges
    listed: Integers  # of a half-edge: whether it is in the ring; 0 between calls
    log: Integers  # ends of the edges that the last flips of a vertex made, in pairs
    logged: Floats  # rest lengths of the edges before


class Network(NamedTuple):
    """An oriented triangulation of a closed surface: no loop, no two edges with the same ends, none that cross.

    Half-edge h = 3 t + c goes from corner[h] to corner[following(h)] in triangle t, counterclockwise as seen from the
    side of the tissue. Vertices are indices of cells. A patch with a boundary has a ghost vertex -1 that is joined to
    all of it; a band, periodic along one axis and open along the other, has two, -1 and -2. So all is closed.
    """

    corner: Integers  # (3 T,), of which 3 triangles[0] are in use
    twin: Integers  # (3 T,): the half-edge the other way
    rest: Floats  # (3 T,): rest length of the junction, equal on both twins; 0 at ghosts
    out: Integers  # (capacity + GHOSTS,): a half-edge that leaves the vertex, -1 if it is not in the network
    u: Floats  # (capacity + GHOSTS,): the chart, see ``tissue.network.chart``, in which all triangles turn left
    v: Floats
    w: Floats
    triangles: Integers  # (1,)
    work: NetworkWorkspace

    @property
    def capacity(self) -> int:
        """How many cells it has room for."""
        return len(self.out) - GHOSTS


def no_network(capacity: int) -> Network:
    """Return a network without vertices; a sphere of n vertices has 2 n - 4 triangles, all others 2 n."""
    vertices = checks.integer("capacity", capacity, least=0) + GHOSTS
    edges = 6 * vertices
    from_u, from_v, from_w, to_u, to_v, to_w, u, v, w = (np.zeros(vertices) for _ in range(9))
    corner, twin, out = (np.full(length, -1, np.int64) for length in (edges, edges, vertices))
    waiting, queue, ring, listed = (np.zeros(length, np.int64) for length in (vertices, vertices, edges, edges))
    log, logged = np.zeros(2 * LONGEST_LOG, np.int64), np.zeros(LONGEST_LOG)
    work = NetworkWorkspace(from_u, from_v, from_w, to_u, to_v, to_w, waiting, queue, ring, listed, log, logged)
    return Network(corner, twin, np.zeros(edges), out, u, v, w, np.zeros(1, np.int64), work)


def grown(network: Network, capacity: int) -> Network:
    """Return the same network with room for more cells; raises InvalidProblem for less room than it has."""
    if checks.integer("capacity", capacity, least=0) < network.capacity:
        raise InvalidProblem(f"capacity = {capacity}: must be at least {network.capacity}, what the network has")
    return with_room(capacity, network, int(network.triangles[0]))


def with_room(capacity: int, given: Any, triangles: int) -> Network:
    """Return a network with room for so many cells, with the first triangles and all vertices of the arrays of
    ``given``.
    """
    network, used, cells = no_network(capacity), 3 * triangles, len(given.out) - GHOSTS
    for name in OF_HALF_EDGES:
        getattr(network, name)[:used] = getattr(given, name)[:used]
    for name in OF_VERTICES:
        getattr(network, name)[:cells] = getattr(given, name)[:cells]
        getattr(network, name)[-GHOSTS:] = getattr(given, name)[-GHOSTS:]
    network.triangles[0] = triangles
    return network
