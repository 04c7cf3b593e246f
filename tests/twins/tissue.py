"""The substeps of a tissue again in plain Python, in a slice and in space: written to be read and not to be fast.

All pairs are looked at, there are no lists, and the forces are those of ``tissue.model.energy``. Sums of forces may
round differently than in the kernels; projections are the same bit for bit.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from tissue.model import energy
from tissue.model.energy import Elastic
from tissue.state.cells import CellLayers, Cells, Floats, Integers
from tissue.state.numbers import Numbers
from tissue.state.surface import CYLINDER, FLAT_SURFACE, PLANE, Surface

WORDS = 2.0**32


# Noise in substeps


def threefry(key, counter: Integers, number: int) -> tuple[Floats, Floats]:
    """Words (n,), (n,) of Threefry-2x32 as doubles, for one key and counters (counter_i, number)."""
    keys = [np.uint32(word) for word in (*key, key[0] ^ key[1] ^ 0x1BD11BDA)]
    x, y = counter.astype(np.uint32), np.full(len(counter), number, np.uint32)
    for made in range(6):  # five times four rounds, the key before and after each four
        x = x + keys[made % 3]
        y = y + keys[(made + 1) % 3] + np.uint32(made)
        for turn in ((13, 15, 26, 6), (17, 29, 16, 24))[made % 2] if made < 5 else ():
            x = x + y
            y = (y << np.uint32(turn) | y >> np.uint32(32 - turn)) ^ x
    return x.astype(np.float64), y.astype(np.float64)


def normals(key, counter: Integers, number: int) -> Floats:
    """Pairs (2, n) of independent N(0, 1) by Box and Muller."""
    u, v = ((words + 0.5) / WORDS for words in threefry(key, counter, number))
    return np.sqrt(-2 * np.log(u)) * np.array([np.cos(2 * np.pi * v - np.pi), np.sin(2 * np.pi * v - np.pi)])


# A slice


def make_substeps(cells: Cells, layers: CellLayers, numbers: Numbers, key=None) -> Cells:
    """All PBD steps in one dt (3.34) of a tissue whose basal points move as the forces want; ``key``: of the noise."""
    h = numbers.dt / numbers.substeps
    for number in range(numbers.substeps):
        if key is not None:
            across, up = math.sqrt(numbers.variance * h) * normals(key, cells.id, number)
            cells = cells._replace(x=cells.x + across, y=cells.y + up)
        push = energy.forces(cells, layers, numbers)
        push.by[layers.basal] = 0.0  # (C3)
        end = {name: getattr(cells, name) + h / numbers.mu * force for name, force in push._asdict().items()}
        cells = swept(cells._replace(**end), layers, numbers)
    return cells


def swept(cells: Cells, layers: CellLayers, numbers: Numbers) -> Cells:
    """One sweep of projections: hard discs, basal order, basal distance."""
    x, y, _ = separate(np.array([cells.x, cells.y, 0.0 * cells.x]), cells.radius)
    bx = cells.bx.copy()
    bx[layers.basal] = limit(order(bx[layers.basal]), numbers.max_basal_distance)
    return cells._replace(x=x, y=y, bx=bx)


def separate(x: Floats, radius: Floats, surface: Surface = FLAT_SURFACE) -> Floats:
    """|X_i - X_j| >= R_i + R_j (C1) of points (3, n) for i, then j < i; each moves by half of an overlap."""
    points, radii = x.T.tolist(), radius.tolist()
    for i in range(len(radii)):
        for j in range(i):
            d = nearest([p - q for p, q in zip(points[i], points[j], strict=True)], surface)
            contact, square = radii[i] + radii[j], d[0] * d[0] + d[1] * d[1] + d[2] * d[2]
            if square < contact * contact:
                part = 0.5 * (contact / math.sqrt(square) - 1.0)
                points[i] = [p + part * along for p, along in zip(points[i], d, strict=True)]
                points[j] = [p - part * along for p, along in zip(points[j], d, strict=True)]
    return np.array(points).T


def order(b: Floats) -> Floats:
    """b_{k+1} - b_k >= 0 from left to right: a pair in the wrong order meets in its middle (C4)."""
    b = b.copy()
    for k in range(len(b) - 1):
        half = 0.5 * (b[k + 1] - b[k])
        if half < 0.0:
            b[k : k + 2] += (half, -half)
    return b


def limit(b: Floats, largest: float) -> Floats:
    """b_{k+1} - b_k <= largest from left to right: each moves by half of the excess (C2)."""
    b = b.copy()
    for k in range(len(b) - 1):
        half = 0.5 * (b[k + 1] - b[k] - largest)
        if half > 0.0:
            b[k : k + 2] += (half, -half)
    return b


# A sheet or a closed surface


class SpaceTissue(NamedTuple):
    """Points (3, n), what each cell has of its own (n,), and edges (m, 2)."""

    x: Floats
    a: Floats
    b: Floats
    radius: Floats
    stiff_ax: Floats
    stiff_bx: Floats
    stiff_axb: Floats
    l_ax: Floats
    l_bx: Floats
    b_moves: Floats
    held: Floats
    runs: Floats  # [1/h]
    junctions: Integers
    rest: Floats
    k_aa: Floats
    neighbours: Integers


class Steps(NamedTuple):
    """The numbers of one dt."""

    h: float = 0.00125
    substeps: int = 1
    mu: float = 0.2
    power: int = 2
    repulsion: float = 0.5
    max_basal_distance: float = 1 / 3
    variance: float = 0.0  # of the noise per coordinate and hour, in substeps
    key: tuple[int, int] = (7, 8)
    surface: Surface = FLAT_SURFACE


def make_substeps_in_space(state: SpaceTissue, steps: Steps) -> SpaceTissue:
    """Noise, forces, and one sweep of projections: hard balls, distance of basal points, surface."""
    for number in range(steps.substeps):
        state = moved(shaken(state, steps, number), steps)
        b = put_on_surface(hold_together(state.b, state.neighbours, steps), state.held, steps.surface)
        state = state._replace(x=separate(state.x, state.radius, steps.surface), b=b)
    return state


def shaken(state: SpaceTissue, steps: Steps, number: int) -> SpaceTissue:
    """Along x and y as in a slice, along z by another counter."""
    if steps.variance == 0.0:
        return state
    ids = np.arange(state.x.shape[1])
    across, depth = normals(steps.key, ids, number), normals(steps.key, ids, (1 << 31) + number)
    return state._replace(x=state.x + math.sqrt(steps.variance * steps.h) * np.vstack((across, depth[:1])))


def elastic(state: SpaceTissue, steps: Steps) -> Elastic:
    """What its energy depends on."""
    mine = {name: getattr(state, name) for name in Elastic._fields if name in SpaceTissue._fields}
    return Elastic(**mine, power=steps.power, repulsion=steps.repulsion)


def moved(state: SpaceTissue, steps: Steps) -> SpaceTissue:
    """Z - (h / mu) grad W(Z); basal points that the surface holds move along it, others may run ahead (4.1)."""
    forces = energy.forces_of(state.x, state.a, state.b, elastic(state, steps), steps.surface)
    on_x, on_a, on_b = (steps.h / steps.mu * force for force in forces)
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


def nearest(d: list[float], surface: Surface) -> list[float]:
    """The difference of the nearest images."""
    for k, period in ((0, surface.period_x), (2, surface.period_z)):
        if math.isfinite(period):
            d[k] -= period * math.floor(d[k] / period + 0.5)
    return d


def hold_together(b: Floats, neighbours: Integers, steps: Steps) -> Floats:
    """|B_i - B_j| <= max_basal_distance (C2), edge by edge; each moves by half."""
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
    """The nearest point of the surface (C3)."""
    out = outward(b, surface)
    height = (out * b).sum(axis=0) - (0.0 if surface.bends == PLANE else surface.radius)
    return b - held * height * out


def still(state: SpaceTissue) -> SpaceTissue:
    """Without springs, bending, junctions or basal points that run: with no repulsion nothing acts but projections."""
    off = {name: 0.0 * getattr(state, name) for name in ("stiff_ax", "stiff_bx", "stiff_axb", "k_aa", "runs")}
    return state._replace(**off)


def mapped(state: SpaceTissue, image) -> SpaceTissue:
    """All points (3, n) taken to their images."""
    return state._replace(**{name: image(getattr(state, name)) for name in ("x", "a", "b")})


def distance(one: SpaceTissue, other: SpaceTissue) -> float:
    """The largest difference of a coordinate; NaN if there is one."""
    return float(max(np.abs(getattr(one, name) - getattr(other, name)).max() for name in ("x", "a", "b")))
