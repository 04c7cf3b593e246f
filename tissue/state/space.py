"""State of a running tissue in three dimensions besides its cells: the surface, networks of neighbours, rules."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from dincl.errors import InvalidProblem
from tissue.state.cells import Floats, Integers
from tissue.state.surface import FLAT_SURFACE, Surface

FLAT, SPATIAL = 2, 3
# Places in Network.sizes. A triangulation of n cells has at most 3 n edges and 2 n triangles.
EDGES, TRIANGLES = range(2)
# Rest lengths of a junction that closes the gap of a cell that left: the distance of its cells then, or the sum of the
# two whose place it takes, so that the tension stays.
PRESENT, SUM = range(2)


class Mesh(NamedTuple):
    """Neighbours in a layer, as saved states have them: without room to grow."""

    edges: Integers  # (m, 2): pairs i < j of cells that are neighbours, each once
    rest: Floats  # (m,): rest lengths of their junctions [R_soft]
    triangles: Integers  # (T, 3): counterclockwise as seen from the tissue


class Network(NamedTuple):
    """Neighbours in a layer: Delaunay's triangulation of its points, with daughters and gaps since it was made.

    See ``tissue.network.neighbours``. Cells are indices; of each array the first ``sizes`` are in use.
    """

    edges: Integers  # (3 capacity, 2)
    rest: Floats  # (3 capacity,)
    triangles: Integers  # (2 capacity, 3)
    sizes: Integers  # (2,): numbers of edges and of triangles

    @property
    def capacity(self) -> int:
        """Number of cells that there is room for."""
        return len(self.edges) // 3


class TissueRules(NamedTuple):
    """Where the machine code of the rules is by which cells come and go in slices or on surfaces, see ``tissue.rules``.

    Kernels call them by their addresses, so that a slice does not compile what changes networks.
    """

    split: int = 0  # cells into two daughters
    leave_apical: int = 0  # how a cell leaves a layer
    leave_basal: int = 0


class Space(NamedTuple):
    """The dimension and the rules of a tissue, and for a sheet or a closed surface its networks."""

    dimension: int
    surface: Surface  # which holds the basal points
    apical: Network  # of the junctions
    basal: Network  # of basal points that stay near each other (C2)
    rules: TissueRules
    longest: float = math.inf  # edge at a free boundary, see ``tissue.network.triangulation`` [R_soft]


class Sheets(NamedTuple):
    """The surface and both networks of a saved state."""

    surface: Surface
    apical: Mesh
    basal: Mesh
    longest: float  # as in ``Space``


def no_network(capacity: int) -> Network:
    """Return a network without neighbours, with room for so many cells."""
    edges, triangles = 3 * capacity, 2 * capacity
    return Network(
        np.zeros((edges, 2), np.int64), np.zeros(edges), np.zeros((triangles, 3), np.int64), np.zeros(2, np.int64)
    )


def network_of(mesh: Mesh, capacity: int) -> Network:
    """Return a network with room for so many cells that goes on from a mesh; raises InvalidProblem as ``write``."""
    network = no_network(capacity)
    write(network, *mesh)
    return network


def write(network: Network, edges: Integers, rest: Floats, triangles: Integers) -> None:
    """Replace what is in a network; raises InvalidProblem for more edges or triangles than there is room for."""
    m, count = len(edges), len(triangles)
    if m > len(network.edges) or count > len(network.triangles):
        room = f"{len(network.edges)} edges and {len(network.triangles)} triangles"
        raise InvalidProblem(f"network = {m} edges and {count} triangles: must be at most {room}")
    network.edges[:m], network.rest[:m], network.triangles[:count] = edges, rest, triangles
    network.sizes[:] = m, count


def in_use(network: Network) -> Mesh:
    """Copy the edges, rest lengths and triangles in use."""
    edges, triangles = network.sizes
    return Mesh(network.edges[:edges].copy(), network.rest[:edges].copy(), network.triangles[:triangles].copy())


def kept(space: Space) -> Sheets:
    """Copy the networks as they are now."""
    return Sheets(space.surface, in_use(space.apical), in_use(space.basal), space.longest)


def wrong_mesh(mesh: Mesh, n: int) -> bool:
    """Return whether kernels would read or write elsewhere with this mesh of n cells."""
    edges, rest, triangles = mesh
    if edges.shape != (len(rest), 2) or triangles.shape != (len(triangles), 3) or rest.ndim != 1:
        return True
    if len(edges) > 3 * n or len(triangles) > 2 * n or not len(edges):
        return True
    outside = min(edges.min(), triangles.min(initial=0)) < 0 or max(edges.max(), triangles.max(initial=0)) >= n
    pairs = (edges[:, 0] < edges[:, 1]).all() and len(np.unique(edges, axis=0)) == len(edges)
    return bool(outside or not pairs or not np.isfinite(rest).all() or (rest < 0.0).any())


def no_space(rules: TissueRules = TissueRules()) -> Space:  # noqa: B008  # a tuple of numbers
    """Return the space of a slice with these rules."""
    return Space(FLAT, FLAT_SURFACE, no_network(0), no_network(0), rules)


def with_room(space: Space, capacity: int) -> Space:
    """Return the same networks with room for so many cells; a slice has none."""
    if space.dimension == FLAT:
        return space
    apical, basal = (network_of(in_use(network), capacity) for network in (space.apical, space.basal))
    return space._replace(apical=apical, basal=basal)
