"""Positions on the apical-basal scale (section 3.3.1 of chapter 4), of one nucleus after the other."""

from __future__ import annotations

import math

from dincl.compiled import inner
from tissue.kernels import kernel
from tissue.kernels.curve import height_of
from tissue.kernels.rules import call_position
from tissue.kernels.store import APICAL, CELLS, Store
from tissue.space.state import SPATIAL
from tissue.state.cells import Floats


@inner
def ab_position(store: Store, i: int) -> float:
    """y_AB(X_i) = h(X_i) / h(A^ref), A^ref the point of the apical path nearest to X_i; as ``ab_positions``.

    h is the height above the basal layer, y above a line.
    """
    if store.space.dimension == SPATIAL:
        in_space: float = call_position(store.space.rules.position, store, i)
        return in_space
    cells, layer = store.cells, store.layers.apical
    x, y = cells.x[i], cells.y[i]
    nearest, reference, size = math.inf, (cells.ax[layer[0]], cells.ay[layer[0]]), store.sizes[APICAL]
    for k in range(size if store.curve.ring > 0.0 else size - 1):
        end = layer[k + 1 if k + 1 < size else 0]
        from_x, from_y = cells.ax[layer[k]], cells.ay[layer[k]]
        along_x, along_y = cells.ax[end] - from_x, cells.ay[end] - from_y
        away_x, away_y = x - from_x, y - from_y
        square, part = along_x * along_x + along_y * along_y, 0.0
        if square > 0.0:
            part = min(max((away_x * along_x + away_y * along_y) / square, 0.0), 1.0)
        away_x, away_y = away_x - part * along_x, away_y - part * along_y
        if away_x * away_x + away_y * away_y < nearest:
            nearest = away_x * away_x + away_y * away_y
            reference = from_x + part * along_x, from_y + part * along_y
    position: float = height_of(store.curve, x, y) / height_of(store.curve, reference[0], reference[1])
    return position


@inner
def apical_range(store: Store) -> tuple[float, float]:
    """The lowest and the highest y of the apical layer, between which A^ref lies; no bounds where the layer bends."""
    low, high = math.inf, -math.inf
    if store.curve.bent or store.space.surface.bends:
        return -math.inf, math.inf
    for k in range(store.sizes[APICAL]):
        i = store.layers.apical[k]
        low, high = min(low, store.cells.ay[i]), max(high, store.cells.ay[i])
    return low, high


@inner
def side_of(store: Store, i: int, low: float) -> int:
    """-1 for y_AB(X_i) < 0, 1 for y_AB(X_i) > 1, else 0 (4.3); ``low`` of ``apical_range``, above the basal line."""
    y = store.cells.y[i]
    if 0.0 <= y <= low:
        return 0
    position = ab_position(store, i)
    return (position > 1.0) - (position < 0.0)


@inner
def watch_sides(store: Store, t: float) -> None:
    """Keep since when and where each EMT cell is outside of the tissue."""
    cells, emt = store.cells, store.emt
    if len(emt.side) == 0:
        return
    low, _ = apical_range(store)
    for i in range(store.sizes[CELLS]):
        k = cells.emt[i]
        if k >= 0:
            side = side_of(store, i, low)
            if side != emt.side[k]:
                emt.side[k], emt.since[k], emt.since_x[k] = side, t, cells.x[i]


@kernel
def measure(store: Store, positions: Floats, controls: Floats) -> None:
    """y_AB of each EMT cell; of the control cells their number, how many are above 1 and below 0, and the lowest y_AB.

    Most need no look at the apical path: y_AB lies between y / high and y / low.
    """
    cells, n, (low, high) = store.cells, store.sizes[CELLS], apical_range(store)
    controls[0], controls[1], controls[2], controls[3] = 0.0, 0.0, 0.0, math.inf
    for i in range(n):
        k = cells.emt[i]
        if k >= 0:
            positions[k] = ab_position(store, i)
            continue
        controls[0] += 1.0
        if not 0.0 <= cells.y[i] <= low or cells.y[i] < controls[3] * high:
            position = ab_position(store, i)
            controls[1] += position > 1.0
            controls[2] += position < 0.0
            controls[3] = min(controls[3], position)
