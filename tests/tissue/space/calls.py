"""The substeps in three dimensions called like their twins, and tissues to call them with."""

import ctypes
import math

import numpy as np

from tests.twins.tissue import SpaceTissue, Steps, still
from tissue.kernels.surface_workspace import SURFACE_COUNTERS, SurfaceWorkspaces
from tissue.model.energy import nearest_image
from tissue.model.springs import coefficient
from tissue.state.surface import PLANE, SPHERE, Surface, cylinder, heights, normals, plane, sphere
from tissue.step.substeps import SURFACE, substeps_address

FREE = {"period_x": np.inf, "period_z": np.inf}
SURFACES = {
    "open plane": Surface(PLANE, np.inf, 1.0, **FREE),
    "periodic plane": Surface(PLANE, np.inf, 1.0, 5.5, 7.1),
    "tight plane": Surface(PLANE, np.inf, 1.0, 4.01, 4.3),
    "strip": Surface(PLANE, np.inf, 1.0, 30.0, 4.5),
    "cylinder": Surface(1, 3.0, 1.0, np.inf, 6.5),
    "open cylinder": Surface(1, 9.0, -1.0, **FREE),
    "sphere": Surface(SPHERE, 2.5, 1.0, **FREE),
    "inside of a sphere": Surface(SPHERE, 8.0, -1.0, **FREE),
}


# Addresses of a workspace and a number of cells; 0.
SUBSTEPS = ctypes.CFUNCTYPE(*[ctypes.c_int64] * 4)


def workspace_of(state: SpaceTissue, steps: Steps, workspaces: SurfaceWorkspaces | None = None) -> SurfaceWorkspaces:
    """A workspace with the tissue on it, or that one with the tissue in its place."""
    n, scale = state.x.shape[1], steps.h / steps.mu
    numbers = {"substeps": steps.substeps, "max_basal_distance": steps.max_basal_distance}
    numbers |= {"repulsion": scale * steps.repulsion, "deviation": float(np.sqrt(steps.variance * steps.h))}
    edges = max(len(state.junctions), len(state.neighbours), 1)
    workspaces = workspaces or SurfaceWorkspaces(n, edges, steps.surface, **numbers)
    work = workspaces.flat.value
    for letter, points in (("", state.x), ("a", state.a), ("b", state.b)):
        for axis, line in zip("xyz", points, strict=True):
            getattr(work, letter + axis)[:n] = line
    for name in ("radius", "l_ax", "l_bx", "held"):
        getattr(work, name)[:n] = getattr(state, name)
    work.moves[:n] = state.b_moves
    for end in ("ax", "bx"):
        alphas, rests = getattr(state, f"stiff_{end}"), getattr(state, f"l_{end}")
        pairs = zip(alphas, rests, strict=True)
        getattr(work, f"k_{end}")[:n] = [coefficient(scale, alpha, rest, steps.power) for alpha, rest in pairs]
    work.k_axb[:n], work.runs[:n] = scale * state.stiff_axb, steps.h * state.runs
    work.id[:n], work.noise_key[:] = np.arange(n), steps.key
    for name, edges in (("junctions", state.junctions), ("neighbours", state.neighbours)):
        getattr(work, name)[: len(edges)] = edges
    work.rest[: len(state.rest)], work.k_aa[: len(state.rest)] = state.rest, scale * state.k_aa
    work.sizes[:] = len(state.junctions), len(state.neighbours)
    return workspaces


def taken(workspaces: SurfaceWorkspaces, state: SpaceTissue) -> SpaceTissue:
    """The tissue with the points of the workspace."""
    n, work = state.x.shape[1], workspaces.flat.value
    x, a, b = (np.array([getattr(work, letter + axis)[:n] for axis in "xyz"]) for letter in ("", "a", "b"))
    return state._replace(x=x, a=a, b=b)


def make_substeps(state: SpaceTissue, steps: Steps, workspaces: SurfaceWorkspaces | None = None) -> SpaceTissue:
    """As ``twins.make_substeps_in_space``."""
    return counted(state, steps, workspaces)[0]


def counted(
    state: SpaceTissue, steps: Steps, workspaces: SurfaceWorkspaces | None = None
) -> tuple[SpaceTissue, dict[str, int]]:
    """The same, and the counters."""
    workspaces, n = workspace_of(state, steps, workspaces), state.x.shape[1]
    before = workspaces.flat.value.counts.copy()
    assert SUBSTEPS(substeps_address(SURFACE))(workspaces.flat.address, workspaces.wide.address, n) == 0
    counts = dict(zip(SURFACE_COUNTERS, (workspaces.flat.value.counts - before).tolist(), strict=True))
    return taken(workspaces, state), counts


def edges_of(points, surface, near):
    """All pairs (i, j) of points (3, n) that are near each other, as edges (m, 2)."""
    d = points[:, :, None] - points[:, None, :]
    for k, period in ((0, surface.period_x), (2, surface.period_z)):
        if np.isfinite(period):
            d[k] -= period * np.round(d[k] / period)
    return np.argwhere(np.triu((d**2).sum(axis=0) < near**2, 1))


def random_tissue(n, seed, surface, crowd=1.0, **fields):
    """Cells that stand upright on a surface, anywhere; ``crowd``: how many times denser than 3 in a unit of area.

    Stiffnesses and lengths are drawn for each cell, some basal points are free, some run by themselves.
    """
    rng = np.random.default_rng(seed)
    b, up = _on_surface(rng, n, surface, crowd)
    height = 8.0 if surface.side > 0 else min(5.0, 0.8 * surface.radius)
    at = rng.uniform(1 / 6, 5 / 6, n)
    thrown = rng.normal(0.0, 0.3, (3, n))
    held = (rng.uniform(size=n) < 0.8).astype(float)
    moves = (rng.uniform(size=n) < 0.9).astype(float)
    edges = edges_of(b, surface, 0.9)[: 3 * n]
    drawn = {
        "x": b + at * height * up + thrown,
        "a": b + height * up + rng.normal(0.0, 0.2, (3, n)),
        "b": b + (1.0 - held) * (0.5 * up + thrown),
        "radius": np.where(rng.uniform(size=n) < 0.1, 0.7, 0.3),
        "l_ax": rng.uniform(1.5, 5.0, n),
        "l_bx": rng.uniform(1.5, 5.0, n),
        "held": held,
        "b_moves": moves,
        "runs": (1.0 - moves) * rng.uniform(0.5, 1.0, n),
        "junctions": edges,
        "rest": rng.uniform(0.05, 0.5, len(edges)),
        "k_aa": 1.25 * rng.uniform(0.5, 2.0, len(edges)),
        "neighbours": rng.permutation(edges),
    }
    stiff = {"stiff_ax": 2.0, "stiff_bx": 2.0, "stiff_axb": 15.0}
    drawn |= {name: alpha * rng.uniform(0.5, 2.0, n) for name, alpha in stiff.items()}
    return SpaceTissue(**{**drawn, **fields})


def heap(seed, n, size, surface, radius=None):
    """Nuclei in a heap of this size, on which nothing acts but balls."""
    rng = np.random.default_rng(seed)
    state = still(random_tissue(n, seed % 1000, surface))
    own = rng.choice([0.0, 0.3, 0.7], n) if radius is None else np.full(n, radius)
    return state._replace(x=rng.uniform(-size, size, (3, n)) + np.array([[9.0], [4.0], [-7.0]]), radius=own)


def _on_surface(rng, n, surface, crowd):
    """Points anywhere on the surface, and the direction into the tissue."""
    area = n / (3.0 * crowd)
    if surface.bends == PLANE:
        wide = surface.period_x if np.isfinite(surface.period_x) else np.sqrt(area)
        deep = surface.period_z if np.isfinite(surface.period_z) else area / wide
        b = np.array([rng.uniform(0.0, wide, n), np.zeros(n), rng.uniform(0.0, deep, n)])
        return b, np.array([[0.0], [1.0], [0.0]]) * np.ones(n)
    if surface.bends == SPHERE:
        out = rng.normal(size=(3, n))
        out /= np.sqrt((out**2).sum(axis=0))
        return surface.radius * out, surface.side * out
    round_it = 2 * np.pi * surface.radius
    deep = surface.period_z if np.isfinite(surface.period_z) else area / round_it
    angle, z = rng.uniform(0.0, 2 * np.pi, n), rng.uniform(0.0, deep, n)
    out = np.array([np.cos(angle), np.sin(angle), np.zeros(n)])
    return surface.radius * out + np.array([[0.0], [0.0], [1.0]]) * z, surface.side * out


# Points on each kind of surface, about a distance of 1 apart

KINDS = {
    "plane": plane(period_x=8.0, period_z=9.0),
    "cylinder outside": cylinder(1.5, inside=False, period_z=9.0),
    "cylinder inside": cylinder(1.6, inside=True, period_z=8.0),
    "sphere outside": sphere(2.2, inside=False),
    "sphere inside": sphere(2.5, inside=True),
    "patch": plane(),
    "ribbon": plane(period_x=8.0),
    "tube": cylinder(1.8, inside=True),
}
# V - E + F of their triangulations; of spheres 2.
EULER = {"plane": 0, "cylinder outside": 0, "cylinder inside": 0, "ribbon": 0, "tube": 0, "patch": 1}
OPEN = ("patch", "ribbon", "tube")


def spread_points(name, n, rng):
    """n points (n, 3) at random on a surface, none nearer to another than three quarters of the mean distance."""
    surface, chosen = KINDS[name], []
    distance = 0.75 * math.sqrt(area(name) / n)
    while len(chosen) < n:
        candidate = one_point(name, rng)
        d = nearest_image(candidate[:, None] - np.reshape(chosen, (-1, 3)).T, surface)
        if (np.linalg.norm(d, axis=0) > distance).all():
            chosen.append(candidate)
    points = np.array(chosen)
    return points + normals(surface, points) * rng.uniform(0.0, 0.2, (n, 1))


def area(name):
    surface = KINDS[name]
    if surface.bends == SPHERE:
        return 4 * math.pi * surface.radius**2
    return math.prod(size(name))


def size(name):
    """Lengths of the chart that points are spread on."""
    surface = KINDS[name]
    if surface.bends == PLANE:
        first, second = surface.period_z, surface.period_x
    else:
        first, second = 2 * math.pi * surface.radius, surface.period_z
    return [6.0 if math.isinf(length) else length for length in (first, second)]


def feet(surface, points):
    """The nearest points of the surface to points (..., 3)."""
    return points - heights(surface, points)[..., None] * normals(surface, points)


def one_point(name, rng):
    surface = KINDS[name]
    if surface.bends == SPHERE:
        return feet(surface, rng.normal(size=3))
    u, v = rng.uniform(0.0, size(name))
    if surface.bends == PLANE:
        return np.array((v, 0.0, u))
    angle = u / surface.radius
    return np.array((surface.radius * math.cos(angle), surface.radius * math.sin(angle), v))
