"""The networks of a tissue as they are kept: without room to grow, and without what only kernels need."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from tissue.state.cells import Floats, Integers
from tissue.state.network import GHOSTS, OF_HALF_EDGES, OF_VERTICES, Network, with_room
from tissue.state.space import Space
from tissue.state.surface import Surface


class Mesh(NamedTuple):
    """A network of n cells with T triangles; see ``tissue.state.network.Network`` for its half-edges."""

    corner: Integers  # (3 T,)
    twin: Integers
    rest: Floats
    out: Integers  # (n + GHOSTS,), the last ones of the ghosts
    u: Floats
    v: Floats
    w: Floats

    @property
    def triangles(self) -> Integers:
        """Cells of the triangles without those to ghosts, (m, 3)."""
        found = self.corner.reshape(-1, 3)
        inside: Integers = found[found.min(axis=1) >= 0]
        return inside

    @property
    def edges(self) -> Integers:
        """Pairs of cells that are joined, (m, 2), each once."""
        joined: Integers = self._ends[self._once]
        return joined

    @property
    def edge_rests(self) -> Floats:
        """The rest length of the junction along each of ``edges``, (m,)."""
        rests: Floats = self.rest[self._once]
        return rests

    @property
    def _ends(self) -> Integers:
        """Return from which cell to which each half-edge goes, (3 T, 2)."""
        return np.column_stack((self.corner, self.corner.reshape(-1, 3)[:, [1, 2, 0]].ravel()))

    @property
    def _once(self) -> NDArray[np.bool_]:
        """Mark the half-edges that are the first of their edge and join two cells, (3 T,)."""
        first: NDArray[np.bool_] = (np.arange(len(self.corner)) < self.twin) & (self._ends.min(axis=1) >= 0)
        return first


class Sheets(NamedTuple):
    """The surface that holds the basal points, and both networks."""

    surface: Surface
    apical: Mesh
    basal: Mesh


def kept(space: Space, n: int) -> Sheets:
    """Copy the networks of n cells as they are now."""
    return Sheets(space.surface, _mesh(space.apical, n), _mesh(space.basal, n))


def network_of(mesh: Mesh, capacity: int) -> Network:
    """Return a network with room for so many cells that goes on from a mesh."""
    return with_room(capacity, mesh, len(mesh.corner) // 3)


def _mesh(network: Network, n: int) -> Mesh:
    used = 3 * int(network.triangles[0])
    halves = {name: getattr(network, name)[:used].copy() for name in OF_HALF_EDGES}
    places = {
        name: np.concatenate((getattr(network, name)[:n], getattr(network, name)[-GHOSTS:])) for name in OF_VERTICES
    }
    return Mesh(**halves, **places)


def as_arrays(sheets: Sheets | None) -> dict[str, Any]:
    """Return the arrays of a file, by name; none in the plane."""
    if sheets is None:
        return {}
    found: dict[str, Any] = {"surface": np.array(sheets.surface, np.float64)}
    for name in ("apical", "basal"):
        found |= {f"{name}.{field}": array for field, array in getattr(sheets, name)._asdict().items()}
    return found


def of_arrays(arrays: Mapping[str, Any]) -> Sheets | None:
    """Return the sheets that the arrays of a file are."""
    if "surface" not in arrays:
        return None
    bends, *numbers = arrays["surface"].tolist()
    meshes = (Mesh(*(arrays[f"{name}.{field}"] for field in Mesh._fields)) for name in ("apical", "basal"))
    return Sheets(Surface(int(bends), *numbers), *meshes)


def wrong_mesh(mesh: Mesh, n: int) -> bool:
    """Return whether kernels would read or write elsewhere, or not end, with this mesh of n cells.

    Twins are pairs with the same ends, each vertex that has a half-edge owns it, and the half-edges around each vertex
    are all that begin there.
    """
    used = len(mesh.corner)
    if used % 3 or len(mesh.out) != n + GHOSTS or not used:
        return True
    corner, twin, out = mesh.corner, mesh.twin, mesh.out
    if corner.min() < -GHOSTS or corner.max() >= n or twin.min() < 0 or twin.max() >= used:
        return True
    ahead = corner.reshape(-1, 3)[:, [1, 2, 0]].ravel()
    paired = (twin[twin] == np.arange(used)).all() and (corner[twin] == ahead).all() and (ahead[twin] == corner).all()
    if not paired or out.min() < -1 or out.max() >= used:
        return True
    owners = np.flatnonzero(out >= 0)
    owner = np.where(owners >= n, owners - n - GHOSTS, owners)
    owned = (corner[out[owners]] == owner).all() and {*corner.tolist()} == {*owner.tolist()}
    numbers = np.concatenate((mesh.rest, mesh.u, mesh.v, mesh.w))
    return not (owned and np.isfinite(numbers).all() and (mesh.rest >= 0).all())
