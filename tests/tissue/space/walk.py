"""Random walks of the points of a network, with cells that come and go; everything is looked at after each step."""

import numpy as np

from tests.tissue.space import by_address as kernels
from tests.tissue.space.invariants import check, edges_of
from tests.tissue.space.tissues import KINDS, spread_points
from tissue.network.follow import STUCK
from tissue.network.start import triangulated
from tissue.state import surface as s
from tissue.state.space import PRESENT

MARGIN = 0.1


class Walk:
    """A network of n points and room for more."""

    def __init__(self, name, n, seed, *, capacity=None, reach=2.0, rule=PRESENT):
        self.name, self.surface, self.rng = name, KINDS[name], np.random.default_rng(seed)
        self.capacity, self.reach, self.rule = capacity or 2 * n, reach, rule
        self.points = np.full((self.capacity, 3), np.nan)
        self.points[:n] = spread_points(name, n, self.rng)
        self.network = triangulated(self.surface, self.points[:n], np.copy, self.capacity)
        self.work = 0

    @property
    def members(self):
        return np.flatnonzero(self.network.out[:-2] >= 0)

    def step(self, length):
        """Move each point at random along the surface, by about a length, and let the network follow."""
        members = self.members
        moved = self.points[members] + length * self.rng.normal(size=(len(members), 3))
        moved = s.laid(self.surface, moved) + 0.1 * s.normals(self.surface, moved)
        self.points[members] = kept_inside(self.name, moved)
        self.follow()

    def follow(self):
        work = kernels.follow(self.surface, self.network, *self.columns, self.rule)
        assert work != STUCK
        self.work += work
        return work

    def relax(self):
        return kernels.relax(self.surface, self.network, *self.columns, MARGIN, self.reach, self.rule)

    @property
    def columns(self):
        """x, y, z, as kernels take them: views that they may write to."""
        if not self.points.flags.f_contiguous:
            self.points = np.asfortranarray(self.points)
        return self.points.T

    def insert(self, distance=0.3):
        """A daughter of a cell at the longest edge, in a random direction; the distance that was used."""
        free = np.flatnonzero(self.network.out[:-2] < 0)
        mother, daughter = self.edge_by_length()[-1, self.rng.integers(2)], free[0]
        direction = self.rng.normal(size=3)
        normal = s.normals(self.surface, self.points[mother])
        direction -= (direction @ normal) * normal
        direction /= np.linalg.norm(direction)
        return kernels.insert(self.surface, self.network, *self.columns, mother, daughter, *direction, distance, 0.5)

    def remove(self, rule=PRESENT):
        """Take a cell at one of the shortest edges out; the number of new edges."""
        cell = self.edge_by_length()[self.rng.integers(10), self.rng.integers(2)]
        return kernels.remove(self.surface, self.network, *self.columns, cell, rule)

    def edge_by_length(self):
        """All edges, the shortest first: where cells come and go with no heed of room, walks make holes and heaps."""
        edges = edges_of(self.network)
        d = self.points[edges[:, 0]] - self.points[edges[:, 1]]
        dx, dy, dz = (
            nearest_image(d[:, k], p) for k, p in ((0, self.surface.period_x), (1, np.inf), (2, self.surface.period_z))
        )
        return edges[np.argsort(dx**2 + dy**2 + dz**2)]

    def check(self, **settings):
        check(self.surface, self.network, self.points, **settings)


def nearest_image(d, period):
    return d - period * np.round(d / period) if np.isfinite(period) else d


def kept_inside(name, points):
    """Reflected at the ends of a box where the surface is open, so that a patch stays together."""
    surface, points = KINDS[name], points.copy()
    if name == "patch of a cylinder":
        angle, distance = np.arctan2(points[:, 1], points[:, 0]), np.hypot(points[:, 0], points[:, 1])
        angle = reflected(surface.radius * angle) / surface.radius
        points[:, 0], points[:, 1] = distance * np.cos(angle), distance * np.sin(angle)
    for column, period in ((0, surface.period_x), (2, surface.period_z)):
        if np.isinf(period) and (surface.bends == s.PLANE or (surface.bends == s.CYLINDER and column == 2)):
            points[:, column] = reflected(points[:, column])
    return points


def reflected(x):
    """Into the interval from 0 to 6."""
    return 6.0 - np.abs(6.0 - np.abs(x))


def is_relaxed(walk):
    """Whether no edge inside has a shorter other diagonal that could take its place, by the margin; counted again."""
    from tissue.network.chart import squared_distance
    from tissue.network.halfedges import following, is_flippable, other_diagonal

    network = walk.network
    for h in range(3 * network.triangles[0]):
        ends, others = (network.corner[h], network.corner[following(h)]), other_diagonal(network, h)
        if min(*ends, *others) < 0 or not is_flippable(walk.surface, network, h):
            continue
        before, after = (squared_distance(walk.surface, *walk.columns, *pair) for pair in (ends, others))
        if after < (1 - MARGIN) ** 2 * before * (1 - 1e-12):
            return False
    return True


__all__ = ["MARGIN", "Walk", "edges_of", "is_relaxed"]
