"""Where a network lies on its surface: the chart, and which way three vertices turn in it.

The plane has the chart (z, x), the cylinder (side radius angle, z), each with its periods; the chart of the sphere is
the normal. Edges are straight in it, or arcs of great circles, so triangles that all turn left do not overlap. A ghost
is a point at infinity: behind a patch as seen from its middle, or at the open end of a band. So a patch is the side of
a sphere that one sees from a pole, all of its boundary is seen from its middle, and ghosts need no rules of their own.
"""

from __future__ import annotations

import math

from dincl.compiled import inner
from tissue.state.cells import Floats
from tissue.state.network import Network, Place
from tissue.state.surface import CYLINDER, PLANE, SPHERE, Surface, nearest_image, normal


@inner
def chart_of(surface: Surface, x: float, y: float, z: float) -> Place:
    """Return the place of a point in the chart."""
    if surface.bends == PLANE:
        return z, x, 0.0
    if surface.bends == CYLINDER:
        return surface.side * surface.radius * math.atan2(y, x), z, 0.0
    return normal(surface, x, y, z)


@inner
def place_of(network: Network, i: int) -> Place:
    """Return where vertex i is on the chart."""
    return network.u[i], network.v[i], network.w[i]


@inner
def put(network: Network, i: int, place: Place) -> None:
    """Place vertex i on the chart."""
    network.u[i], network.v[i], network.w[i] = place


@inner
def on_the_way(begin: Place, end: Place, part: float) -> Place:
    """Return the place after a part of a straight way."""
    return (
        begin[0] + part * (end[0] - begin[0]),
        begin[1] + part * (end[1] - begin[1]),
        begin[2] + part * (end[2] - begin[2]),
    )


@inner
def period_u(surface: Surface) -> float:
    """Return the period of the first coordinate of the chart."""
    return surface.period_z if surface.bends == PLANE else 2.0 * math.pi * surface.radius


@inner
def period_v(surface: Surface) -> float:
    """Return the period of the second one."""
    return surface.period_x if surface.bends == PLANE else surface.period_z


@inner
def squared_distance(surface: Surface, px: Floats, py: Floats, pz: Floats, i: int, j: int) -> float:
    """|p_i - p_j|^2 in space, to the nearest image; the same for (j, i) to the last bit."""
    dx = nearest_image(px[i] - px[j], surface.period_x)
    dz = nearest_image(pz[i] - pz[j], surface.period_z)
    dy = py[i] - py[j]
    squared: float = dx * dx + dy * dy + dz * dz
    return squared


@inner
def turn(surface: Surface, network: Network, i: int, j: int, k: int) -> float:
    """> 0 if the vertices i, j, k turn left: twice the area of their triangle, or det(n_i, n_j, n_k) on the sphere.

    It changes its sign, and nothing else, when two of them are exchanged. It is linear in the place of each. Two
    ghosts turn left with nobody, nor does a triangle that goes around a period.
    """
    sign = 1.0
    if i < j:
        i, j, sign = j, i, -sign
    if j < k:
        j, k, sign = k, j, -sign
    if i < j:
        i, j, sign = j, i, -sign
    if j < 0:
        return -1.0
    if surface.bends == SPHERE:
        return sign * _determinant(network, i, j, k)
    return sign * _cross(surface, network, i, j, k) if k >= 0 else sign * _cross_ghost(surface, network, i, j, k)


@inner
def _determinant(network: Network, i: int, j: int, k: int) -> float:
    """a . ((b - a) x (c - a))."""
    u, v, w = network.u, network.v, network.w
    eu, ev, ew = u[j] - u[i], v[j] - v[i], w[j] - w[i]
    fu, fv, fw = u[k] - u[i], v[k] - v[i], w[k] - w[i]
    determinant: float = u[i] * (ev * fw - ew * fv) + v[i] * (ew * fu - eu * fw) + w[i] * (eu * fv - ev * fu)
    return determinant


@inner
def _cross(surface: Surface, network: Network, i: int, j: int, k: int) -> float:
    """(b - a) x (c - a) to the nearest images, of which the three sides must make a triangle."""
    u, v = network.u, network.v
    pu, pv = period_u(surface), period_v(surface)
    eu, ev = nearest_image(u[j] - u[i], pu), nearest_image(v[j] - v[i], pv)
    fu, fv = nearest_image(u[k] - u[i], pu), nearest_image(v[k] - v[i], pv)
    # As the third side is the nearest image of f - e, it closes the triangle if that is short enough.
    if abs(fu - eu) > 0.5 * pu or abs(fv - ev) > 0.5 * pv:
        return math.nan
    return eu * fv - ev * fu


@inner
def _cross_ghost(surface: Surface, network: Network, i: int, j: int, ghost: int) -> float:
    """Compute the cross product with the direction to a ghost for c - a."""
    eu, ev = between(surface, network, i, j)
    fu, fv = between(surface, network, i, ghost)
    # Of a patch, -f is the way to the middle, and the triangle with that must not go around either.
    if network.w[ghost] != 0.0 and abs(fu + eu) > 0.5 * period_u(surface):
        return math.nan
    return eu * fv - ev * fu


@inner
def between(surface: Surface, network: Network, i: int, j: int) -> tuple[float, float]:
    """Compute the way from vertex i to the nearest image of j on a plane chart, or the direction to a ghost."""
    if j < 0 and network.w[j] == 0.0:  # the end of a band
        return network.u[j], network.v[j]
    du = nearest_image(network.u[j] - network.u[i], period_u(surface))
    dv = nearest_image(network.v[j] - network.v[i], period_v(surface))
    return (-du, -dv) if j < 0 else (du, dv)


@inner
def middle_of_patch(surface: Surface, network: Network, px: Floats, py: Floats, pz: Floats) -> Place:
    """Return what a patch is seen from: the mean of its points, on the chart; w = -1 as the ghost is on the
    other side.
    """
    n, x, y, z = 0, 0.0, 0.0, 0.0
    for i in range(network.out.size - 2):
        if network.out[i] >= 0:
            n, x, y, z = n + 1, x + px[i], y + py[i], z + pz[i]
    if n == 0:
        return 0.0, 0.0, -1.0
    if surface.bends == CYLINDER:
        return surface.side * surface.radius * math.atan2(y, x), z / n, -1.0
    return z / n, x / n, -1.0
