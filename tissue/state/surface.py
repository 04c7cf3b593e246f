"""The basal surface of a tissue in three dimensions: a plane, a cylinder, a sphere."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from dincl.compiled import inner
from dincl.errors import InvalidProblem
from tissue.state.cells import Floats

PLANE, CYLINDER, SPHERE = range(3)


class Surface(NamedTuple):
    """Basal surface as kernels see it; lengths in units of R_soft.

    The plane is y = 0, the cylinder x^2 + y^2 = radius^2, the sphere |X| = radius.
    """

    bends: int  # PLANE, CYLINDER or SPHERE
    radius: float
    side: float  # 1: the tissue is outside, -1: inside; 1 for the plane
    period_x: float  # inf for none; of the plane alone
    period_z: float  # inf for none; of the plane and the cylinder


FLAT_SURFACE = Surface(PLANE, math.inf, 1.0, math.inf, math.inf)


def plane(*, period_x: float = math.inf, period_z: float = math.inf) -> Surface:
    """Return the plane y = 0, periodic or not."""
    return Surface(PLANE, math.inf, 1.0, period_x, period_z)


def cylinder(radius: float, *, inside: bool, period_z: float = math.inf) -> Surface:
    """Return the cylinder x^2 + y^2 = radius^2, with the tissue inside or outside."""
    return Surface(CYLINDER, radius, -1.0 if inside else 1.0, math.inf, period_z)


def sphere(radius: float, *, inside: bool) -> Surface:
    """Return the sphere |X| = radius, with the tissue inside or outside."""
    return Surface(SPHERE, radius, -1.0 if inside else 1.0, math.inf, math.inf)


@inner
def nearest_image(d: float, period: float) -> float:
    """Return the difference d of two coordinates, less the multiple of the period that makes it smallest; inf
    has none.
    """
    return d - period * np.rint(d / period) if abs(d) > 0.5 * period else d


@inner
def differences(surface: Surface, dx: float, dy: float, dz: float) -> tuple[float, float, float]:
    """Return the difference of two points, to the nearest image."""
    return nearest_image(dx, surface.period_x), dy, nearest_image(dz, surface.period_z)


@inner
def distance_from_middle(surface: Surface, x: float, y: float, z: float) -> float:
    """|P X|, of a surface that bends: the distance from the axis of the cylinder, the centre of the sphere."""
    return math.sqrt(x * x + y * y + (z * z if surface.bends == SPHERE else 0.0))


@inner
def height(surface: Surface, x: float, y: float, z: float) -> float:
    """Compute h(X) = side (|P X| - radius): the distance from the surface, below 0 on the side without tissue."""
    if surface.bends == PLANE:
        return y
    return surface.side * (distance_from_middle(surface, x, y, z) - surface.radius)


@inner
def normal(surface: Surface, x: float, y: float, z: float) -> tuple[float, float, float]:
    """Compute n = side P X / |P X|, towards the tissue; NaN in the middle of a surface that bends, where there
    is none.
    """
    if surface.bends == PLANE:
        return 0.0, 1.0, 0.0
    # Not as a factor 1 / |P X|: quotients are right to the last digit.
    away = surface.side * distance_from_middle(surface, x, y, z)
    return x / away, y / away, (z / away if surface.bends == SPHERE else 0.0)


@inner
def onto(surface: Surface, x: float, y: float, z: float) -> tuple[float, float, float]:
    """Return the point of the surface that is nearest to X: radius P X / |P X|, and what P leaves out as it is."""
    if surface.bends == PLANE:
        return x, 0.0, z
    factor = surface.radius / distance_from_middle(surface, x, y, z)
    return x * factor, y * factor, (z * factor if surface.bends == SPHERE else z)


def heights(surface: Surface, points: ArrayLike) -> Floats:
    """Compute h(X) of points (..., 3), shape (...)."""
    at = np.asarray(points, float)
    if surface.bends == PLANE:
        return at[..., 1].copy()
    result: Floats = surface.side * (np.linalg.norm(_projected(surface, at), axis=-1) - surface.radius)
    return result


def normals(surface: Surface, points: ArrayLike) -> Floats:
    """Compute n of points (..., 3), of the same shape; raises InvalidProblem for one in the middle of a surface that
    bends.
    """
    at = np.asarray(points, float)
    if surface.bends == PLANE:
        return np.broadcast_to((0.0, 1.0, 0.0), at.shape).copy()
    away = _projected(surface, at)
    distances: Floats = np.linalg.norm(away, axis=-1, keepdims=True)
    if not (distances > 0.0).all():
        raise InvalidProblem("points = a point in the middle of the surface: must be apart from it, to have a normal")
    result: Floats = surface.side * away / distances
    return result


def _projected(surface: Surface, points: Floats) -> Floats:
    """P X."""
    return points if surface.bends == SPHERE else points * (1.0, 1.0, 0.0)
