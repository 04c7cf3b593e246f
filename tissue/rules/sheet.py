"""The rules of a sheet and of closed surfaces: the layers are networks, and daughters stand behind all cells."""

from __future__ import annotations

import math
from functools import cache
from typing import Any

from dincl.compiled import inner
from tissue.kernels.layers import find, remove_from
from tissue.kernels.rules import Rules, compile_rules
from tissue.model.emt import inherit_events
from tissue.model.scale import position_in_space
from tissue.network.halfedges import is_row, set_rest
from tissue.network.insert import insert
from tissue.network.remove import remove
from tissue.state.cells import Floats, Integers
from tissue.state.network import Network
from tissue.state.numbers import Numbers, numbers_of
from tissue.state.running import APICAL, BASAL, CELLS, DIVISIONS, NEXT_ID, TissueState
from tissue.state.space import TissueRules
from tissue.state.surface import PLANE, Surface, normal, onto

Vector = tuple[float, float, float]
Points = tuple[Floats, Floats, Floats]


def split(state: TissueState, splits: int, numbers: Numbers, rules: Rules) -> None:
    """Part each cell that splits from a daughter behind all cells, one after the other."""
    daughters = state.daughters
    for i in range(state.sizes[CELLS]):
        if daughters.cycle[i] > 0.0:
            split_cell(state, i, daughters.turn[i], numbers_of(numbers, state.cells.kind[i]))
            state.cells.cycle[state.sizes[CELLS] - 1] = daughters.cycle[i]
            daughters.cycle[i] = 0.0


@inner
def split_cell(state: TissueState, i: int, turn: float, numbers: Numbers) -> None:
    """Part cell i from a daughter, the last cell of the arrays, each by the offset (3.7) along the basal surface.

    ``turn`` is the direction, as a part of a whole turn; in a row of cells the daughter is along it. ``torn`` of the
    tissue is set if a network has no room.
    """
    cells, space, j = state.cells, state.space, state.sizes[CELLS]
    _copy(state, i, j)
    t = direction(space.surface, 0.0 if is_row(space.apical) else turn, cells.bx[i], cells.by[i], cells.bz[i])
    distance = 2.0 * numbers.division_offset
    x, y, z = along(space.surface, t, cells.x[i], cells.y[i], cells.z[i])
    _step(state, i, -numbers.division_offset, x, y, z)
    _step(state, j, numbers.division_offset, x, y, z)
    a, b = (cells.ax, cells.ay, cells.az), (cells.bx, cells.by, cells.bz)
    at_a = along(space.surface, t, cells.ax[i], cells.ay[i], cells.az[i])
    apical = _part(space.surface, space.apical, a, i, j, at_a, distance, numbers.new_junction)
    basal = _part(space.surface, space.basal, b, i, j, t, distance, 0.0)
    if space.basal.out[i] >= 0:
        for k in (i, j):
            cells.bx[k], cells.by[k], cells.bz[k] = onto(space.surface, cells.bx[k], cells.by[k], cells.bz[k])
    if apical == 0.0 or basal == 0.0:
        space.torn[0] = 1


@inner
def _part(
    surface: Surface, network: Network, points: Points, i: int, j: int, t: Vector, distance: float, rest: float
) -> float:
    """Part the points of cell i and of her daughter j along a direction, in their network if it has cell i.

    How far they are apart then; 0 if the network has no room.
    """
    (px, py, pz), (x, y, z) = points, t
    if network.out[i] >= 0:
        return insert(surface, network, px, py, pz, i, j, x, y, z, distance, rest)
    for k, way in ((i, -0.5 * distance), (j, 0.5 * distance)):
        px[k], py[k], pz[k] = px[k] + way * x, py[k] + way * y, pz[k] + way * z
    return distance


@inner
def _copy(state: TissueState, i: int, j: int) -> None:
    """Make cell j, behind all others, a copy of cell i, with a name of its own and in the same layers."""
    cells, sizes = state.cells, state.sizes
    _copy_lines(state.blocks.floats, i, j)
    _copy_lines(state.blocks.flags, i, j)
    _copy_lines(state.blocks.integers, i, j)
    cells.id[j], cells.mother[j] = sizes[NEXT_ID], cells.id[i]
    state.motion.moves[j], state.motion.held[j], state.motion.runs[j] = 1.0, state.motion.held[i], 0.0
    sizes[NEXT_ID] += 1
    sizes[CELLS] = j + 1
    # A cell is in a layer if it is in its network.
    sizes[APICAL] = _append(state.layers.apical, sizes[APICAL], state.space.apical.out[i] >= 0, j)
    sizes[BASAL] = _append(state.layers.basal, sizes[BASAL], state.space.basal.out[i] >= 0, j)
    inherit_events(state, j)
    state.counts[DIVISIONS] += 1


@inner
def _copy_lines(block: Any, i: int, j: int) -> None:
    for line in range(block.shape[0]):
        block[line, j] = block[line, i]


@inner
def _append(layer: Integers, size: int, inside: bool, j: int) -> int:
    """Put cell j behind all others of a layer if its mother is inside; the new size."""
    if inside:
        layer[size] = j
        size += 1
    return size


@inner
def _step(state: TissueState, i: int, way: float, x: float, y: float, z: float) -> None:
    """Move nucleus i along a direction."""
    cells = state.cells
    cells.x[i], cells.y[i], cells.z[i] = cells.x[i] + way * x, cells.y[i] + way * y, cells.z[i] + way * z


@inner
def direction(surface: Surface, turn: float, x: float, y: float, z: float) -> Vector:
    """Return the direction along the surface at X that is a part of a whole turn from one across the z axis."""
    cosine, sine = math.cos(2.0 * math.pi * turn), math.sin(2.0 * math.pi * turn)
    if surface.bends == PLANE:
        return cosine, 0.0, sine
    n = normal(surface, x, y, z)
    # Across: the x axis where the normal is along the z axis.
    first = (n[1], -n[0], 0.0) if abs(n[2]) < 0.9 else (0.0, n[2], -n[1])
    length = math.sqrt(first[0] * first[0] + first[1] * first[1] + first[2] * first[2])
    a, b, c = first[0] / length, first[1] / length, first[2] / length
    d, e, f = b * n[2] - c * n[1], c * n[0] - a * n[2], a * n[1] - b * n[0]
    return cosine * a + sine * d, cosine * b + sine * e, cosine * c + sine * f


@inner
def along(surface: Surface, t: Vector, x: float, y: float, z: float) -> Vector:
    """Return the direction t as it is along the surface that is parallel to the basal one through X."""
    if surface.bends == PLANE:
        return t
    n = normal(surface, x, y, z)
    part = t[0] * n[0] + t[1] * n[1] + t[2] * n[2]
    a, b, c = t[0] - part * n[0], t[1] - part * n[1], t[2] - part * n[2]
    length = math.sqrt(a * a + b * b + c * c)
    return a / length, b / length, c / length


def leave_apical(state: TissueState, i: int, bridge: int) -> int:
    """Take cell i out of the apical layer and its network of junctions; return whether it was in it."""
    cells, space = state.cells, state.space
    left: int = _leave(state, state.layers.apical, APICAL, space.apical, (cells.ax, cells.ay, cells.az), i, bridge)
    return left


def leave_basal(state: TissueState, i: int, bridge: int) -> int:
    """Take cell i out of the basal layer and the network of its neighbours; return whether it was in it."""
    cells, space = state.cells, state.space
    left: int = _leave(state, state.layers.basal, BASAL, space.basal, (cells.bx, cells.by, cells.bz), i, bridge)
    return left


@inner
def _leave(
    state: TissueState, layer: Integers, size: int, network: Network, points: Points, i: int, bridge: int
) -> int:
    """Take cell i out of a layer, whose size is at the place ``size``, and of its network; ``torn`` if it cannot."""
    k = find(layer, state.sizes[size], i)
    if k >= 0:
        state.sizes[size] = remove_from(layer, state.sizes[size], k)
        if remove(state.space.surface, network, points[0], points[1], points[2], i, bridge) < 0:
            state.space.torn[0] = 1
    return int(k >= 0)


def position(state: TissueState, i: int) -> float:
    """Compute y_AB of a cell."""
    found: float = position_in_space(state, i)
    return found


def shrink(state: TissueState, numbers: Numbers) -> None:
    """Relax each rest length towards 0 over one dt, eta <- eta exp(-k dt)  (3.6); k is the mean of both cells."""
    network, kind = state.space.apical, state.cells.kind
    rate, kept = 0.0, 1.0
    for i in range(state.sizes[CELLS]):  # those of cells are not used, but are in tables
        state.cells.rest_aa[i] *= math.exp(-numbers_of(numbers, kind[i]).rate_aa * numbers.dt)
    for h in range(3 * network.triangles[0]):
        i, j = network.corner[h], network.corner[network.twin[h]]
        if 0 <= i < j:
            own = 0.5 * (numbers_of(numbers, kind[i]).rate_aa + numbers_of(numbers, kind[j]).rate_aa)
            if own != rate:  # mostly the same: few exponentials for many junctions
                rate, kept = own, math.exp(-own * numbers.dt)
            set_rest(network, h, network.rest[h] * kept)


@cache
def sheet_rules() -> TissueRules:
    """Compile the rules of sheets and closed surfaces, on first use."""
    return compile_rules(split, leave_apical, leave_basal, position, shrink)
