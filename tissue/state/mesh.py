"""The networks of a tissue as they are kept: without room to grow."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from tissue.state.cells import Floats, Integers
from tissue.state.network import Network, in_use, no_network, write
from tissue.state.space import Space
from tissue.state.surface import Surface


class Mesh(NamedTuple):
    """Neighbours in a layer, see ``tissue.state.network.Network``."""

    edges: Integers  # (m, 2): pairs i < j of cells, each once
    rest: Floats  # (m,): rest lengths of their junctions [R_soft]
    triangles: Integers  # (T, 3): counterclockwise as seen from the tissue


class Sheets(NamedTuple):
    """The surface that holds the basal points, and both networks."""

    surface: Surface
    apical: Mesh
    basal: Mesh
    longest: float  # edge at a free boundary [R_soft]; inf without a boundary


def kept(space: Space) -> Sheets:
    """Copy the networks as they are now."""
    return Sheets(space.surface, Mesh(*in_use(space.apical)), Mesh(*in_use(space.basal)), space.longest)


def network_of(mesh: Mesh, capacity: int) -> Network:
    """Return a network with room for so many cells that goes on from a mesh."""
    network = no_network(capacity)
    write(network, *mesh)
    return network


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
