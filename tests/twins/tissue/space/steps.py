"""The substeps in three dimensions again in plain Python: the same numbers to rounding, written to be read.

Nothing is shared with the kernels: all pairs are looked at, there are no lists. Projections are the same bit for bit.
"""

from __future__ import annotations

import math

import numpy as np

from tests.twins.tissue.normals import normals
from tests.twins.tissue.space.state import SpaceTissue, Steps
from tissue.model import bending, junctions, repulsion, springs
from tissue.model.energy import Elastic, nearest_image
from tissue.state.cells import Floats, Integers
from tissue.state.surface import CYLINDER, PLANE, Surface


def make_substeps(state: SpaceTissue, steps: Steps) -> SpaceTissue:
    """Twin of what ``substeps.space_substeps_address`` names."""
    for number in range(steps.substeps):
        state = swept(moved(shaken(state, steps, number), steps), steps)
    return state


def shaken(state: SpaceTissue, steps: Steps, number: int) -> SpaceTissue:
    """Twin of ``noise.add_substep_noise``: along x and y as in two dimensions."""
    if steps.variance == 0.0:
        return state
    ids = np.arange(state.x.shape[1])
    across, depth = normals(steps.key, ids, number), normals(steps.key, ids, (1 << 31) + number)
    return state._replace(x=state.x + math.sqrt(steps.variance * steps.h) * np.vstack((across, depth[:1])))


def elastic(state: SpaceTissue, steps: Steps) -> Elastic:
    """What its energy depends on."""
    mine = {name: getattr(state, name) for name in Elastic._fields if name in SpaceTissue._fields}
    return Elastic(**mine, power=steps.power, repulsion=steps.repulsion)


def forces(state: SpaceTissue, steps: Steps) -> tuple[Floats, Floats, Floats]:
    """-grad W on X, A and B, (3, n) each, from the tensions and moments of ``tissue.model``."""
    to_a, to_b = state.a - state.x, state.b - state.x
    by_a, by_b = np.sqrt((to_a * to_a).sum(axis=0)), np.sqrt((to_b * to_b).sum(axis=0))
    u, v = to_a / by_a, to_b / by_b
    cosine = (u * v).sum(axis=0)
    on_a = -springs.tension(by_a, state.l_ax, state.stiff_ax, steps.power) * u
    on_b = -springs.tension(by_b, state.l_bx, state.stiff_bx, steps.power) * v
    on_a = on_a + bending.force(u, v, by_a, cosine, state.stiff_axb)
    on_b = on_b + bending.force(v, u, by_b, cosine, state.stiff_axb)
    on_x = -(on_a + on_b)
    pull(on_a, state.a, state.junctions, steps.surface, lambda d: junctions.tension(d, state.rest, state.k_aa))
    pairs = np.column_stack(np.tril_indices(state.x.shape[1], -1))
    apart = nearest_image(state.x[:, pairs[:, 1]] - state.x[:, pairs[:, 0]], steps.surface)
    pairs = pairs[(apart * apart).sum(axis=0) < repulsion.SOFT**2]
    pull(on_x, state.x, pairs, steps.surface, lambda d: repulsion.tension(d, steps.repulsion))
    return on_x, on_a, on_b


def pull(on: Floats, points: Floats, edges: Integers, surface: Surface, tension) -> None:
    """Add what the edges do, each of which pulls its ends together."""
    i, j = edges.T
    d = nearest_image(points[:, j] - points[:, i], surface)
    length = np.sqrt((d * d).sum(axis=0))
    for line, along in zip(on, tension(length) * d / length, strict=True):
        np.add.at(line, i, along)
        np.add.at(line, j, -along)


def moved(state: SpaceTissue, steps: Steps) -> SpaceTissue:
    """Z - (h / mu) grad W(Z); basal points that the surface holds move along it, others may run ahead (4.1)."""
    on_x, on_a, on_b = (steps.h / steps.mu * force for force in forces(state, steps))
    normal = outward(state.b, steps.surface)
    on_b = on_b - state.held * normal * (normal * on_b).sum(axis=0)
    ahead = state.b - state.x
    ahead = steps.h * state.runs * ahead / np.sqrt((ahead * ahead).sum(axis=0))
    return state._replace(x=state.x + on_x, a=state.a + on_a, b=state.b + state.b_moves * on_b + ahead)


def outward(points: Floats, surface: Surface) -> Floats:
    """Unit vectors (3, n) away from the axis or the centre; upwards from the plane."""
    if surface.bends == PLANE:
        return np.array([[0.0], [1.0], [0.0]]) * np.ones(points.shape[1])
    out = points.copy()
    if surface.bends == CYLINDER:
        out[2] = 0.0
    return out / np.sqrt((out * out).sum(axis=0))


def swept(state: SpaceTissue, steps: Steps) -> SpaceTissue:
    """One sweep of projections: hard balls, distance of basal points, surface."""
    b = put_on_surface(hold_together(state.b, state.neighbours, steps), state.held, steps.surface)
    return state._replace(x=separate(state.x, state.radius, steps.surface), b=b)


def nearest(d: list[float], surface: Surface) -> list[float]:
    """The difference of the nearest images."""
    for k, period in ((0, surface.period_x), (2, surface.period_z)):
        if math.isfinite(period):
            d[k] -= period * math.floor(d[k] / period + 0.5)
    return d


def separate(x: Floats, radius: Floats, surface: Surface) -> Floats:
    """Twin of ``balls.separate_balls``: |X_i - X_j| >= R_i + R_j (C1) for i, then j < i; each moves by half."""
    points, radii = x.T.tolist(), radius.tolist()
    for i in range(len(radii)):
        for j in range(i):
            d = nearest([p - q for p, q in zip(points[i], points[j], strict=True)], surface)
            reach, square = radii[i] + radii[j], d[0] * d[0] + d[1] * d[1] + d[2] * d[2]
            if square < reach * reach:
                part = 0.5 * (reach / math.sqrt(square) - 1.0)
                points[i] = [p + part * along for p, along in zip(points[i], d, strict=True)]
                points[j] = [p - part * along for p, along in zip(points[j], d, strict=True)]
    return np.array(points).T


def hold_together(b: Floats, neighbours: Integers, steps: Steps) -> Floats:
    """Twin of ``basal.hold_together``: |B_i - B_j| <= max_basal_distance (C2), edge by edge; each moves by half."""
    points = b.T.tolist()
    for i, j in neighbours.tolist():
        d = nearest([p - q for p, q in zip(points[j], points[i], strict=True)], steps.surface)
        square = d[0] * d[0] + d[1] * d[1] + d[2] * d[2]
        if square > steps.max_basal_distance * steps.max_basal_distance:
            part = 0.5 * (1.0 - steps.max_basal_distance / math.sqrt(square))
            points[i] = [p + part * along for p, along in zip(points[i], d, strict=True)]
            points[j] = [p - part * along for p, along in zip(points[j], d, strict=True)]
    return np.array(points).T


def put_on_surface(b: Floats, held: Floats, surface: Surface) -> Floats:
    """Twin of ``basal.put_on_surface``: the nearest point of the surface (C3)."""
    out = outward(b, surface)
    height = (out * b).sum(axis=0) - (0.0 if surface.bends == PLANE else surface.radius)
    return b - held * height * out
