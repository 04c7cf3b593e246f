"""The rules of a sheet and of closed surfaces: the layers have networks, and daughters stand behind all cells."""

from __future__ import annotations

import math
from functools import cache
from typing import Any

from dincl.compiled import inner
from tissue.kernels.layers import find, remove_from
from tissue.kernels.rules import Rules, compile_rules
from tissue.model.emt import inherit_events
from tissue.network.neighbours import add_daughter, remove_cell
from tissue.state.cells import Floats, Integers
from tissue.state.numbers import Numbers, numbers_of
from tissue.state.running import APICAL, BASAL, CELLS, DIVISIONS, NEXT_ID, TissueState
from tissue.state.space import Network, TissueRules
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

    ``turn`` is the direction, as a part of a whole turn.
    """
    cells, space, j = state.cells, state.space, state.sizes[CELLS]
    apically, basally = (
        find(state.layers.apical, state.sizes[APICAL], i) >= 0,
        find(state.layers.basal, state.sizes[BASAL], i) >= 0,
    )
    _copy(state, i, j, apically, basally)
    t = direction(space.surface, turn, cells.bx[i], cells.by[i], cells.bz[i])
    at_a = along(space.surface, t, cells.ax[i], cells.ay[i], cells.az[i])
    at_x = along(space.surface, t, cells.x[i], cells.y[i], cells.z[i])
    a, b = (cells.ax, cells.ay, cells.az), (cells.bx, cells.by, cells.bz)
    if apically:
        add_daughter(space.surface, space.apical, a, i, j, at_a, numbers.new_junction)
    if basally:
        add_daughter(space.surface, space.basal, b, i, j, t, 0.0)
    for points, way in (((cells.x, cells.y, cells.z), at_x), (a, at_a), (b, t)):
        _step(points, i, -numbers.offset, way)
        _step(points, j, numbers.offset, way)
    if basally:
        for k in (i, j):
            cells.bx[k], cells.by[k], cells.bz[k] = onto(space.surface, cells.bx[k], cells.by[k], cells.bz[k])


@inner
def _copy(state: TissueState, i: int, j: int, apically: bool, basally: bool) -> None:
    """Make cell j, behind all others, a copy of cell i, with a name of its own and in the layers where cell i is."""
    cells, sizes = state.cells, state.sizes
    _copy_lines(state.blocks.floats, i, j)
    _copy_lines(state.blocks.flags, i, j)
    _copy_lines(state.blocks.integers, i, j)
    cells.id[j], cells.mother[j] = sizes[NEXT_ID], cells.id[i]
    state.motion.moves[j], state.motion.held[j], state.motion.runs[j] = 1.0, state.motion.held[i], 0.0
    sizes[NEXT_ID] += 1
    sizes[CELLS] = j + 1
    sizes[APICAL] = _append(state.layers.apical, sizes[APICAL], apically, j)
    sizes[BASAL] = _append(state.layers.basal, sizes[BASAL], basally, j)
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
def _step(points: Points, i: int, way: float, t: Vector) -> None:
    """Move a point along a direction."""
    (x, y, z), (tx, ty, tz) = points, t
    x[i], y[i], z[i] = x[i] + way * tx, y[i] + way * ty, z[i] + way * tz


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
    """Take cell i out of a layer, whose size is at the place ``size``, and of its network."""
    k = find(layer, state.sizes[size], i)
    if k >= 0:
        state.sizes[size] = remove_from(layer, state.sizes[size], k)
        remove_cell(state.space.surface, network, points, i, bridge)
    return int(k >= 0)


@cache
def sheet_rules() -> TissueRules:
    """Compile the rules of sheets and closed surfaces, on first use."""
    return compile_rules(split, leave_apical, leave_basal)
