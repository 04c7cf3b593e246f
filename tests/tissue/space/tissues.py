"""Points on every kind of surface, about a distance of 1 apart."""

import math

import numpy as np

from tissue.model.energy import nearest_image
from tissue.state import surface as s

# Number of points, surface, and how they are laid out: one of each kind of network.
KINDS = {
    "plane": s.plane(period_x=8.0, period_z=9.0),
    "cylinder outside": s.cylinder(1.5, inside=False, period_z=9.0),
    "cylinder inside": s.cylinder(1.6, inside=True, period_z=8.0),
    "sphere outside": s.sphere(2.2, inside=False),
    "sphere inside": s.sphere(2.5, inside=True),
    "patch": s.plane(),
    "ribbon": s.plane(period_x=8.0),
    "tube": s.cylinder(1.8, inside=True),
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
    return points + s.normals(surface, points) * rng.uniform(0.0, 0.2, (n, 1))


def area(name):
    surface = KINDS[name]
    if surface.bends == s.SPHERE:
        return 4 * math.pi * surface.radius**2
    return math.prod(size(name))


def size(name):
    """Lengths of the chart that points are spread on."""
    surface = KINDS[name]
    if surface.bends == s.PLANE:
        first, second = surface.period_z, surface.period_x
    else:
        first, second = 2 * math.pi * surface.radius, surface.period_z
    return [6.0 if math.isinf(length) else length for length in (first, second)]


def feet(surface, points):
    """The nearest points of the surface to points (..., 3)."""
    return points - s.heights(surface, points)[..., None] * s.normals(surface, points)


def one_point(name, rng):
    surface = KINDS[name]
    if surface.bends == s.SPHERE:
        return feet(surface, rng.normal(size=3))
    u, v = rng.uniform(0.0, size(name))
    if surface.bends == s.PLANE:
        return np.array((v, 0.0, u))
    angle = u / surface.radius
    return np.array((surface.radius * math.cos(angle), surface.radius * math.sin(angle), v))
