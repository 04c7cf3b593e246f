"""The rules of a slice: the cells are in a row, from left to right or around, and so are the layers."""

from __future__ import annotations

import math
from functools import cache
from typing import Any

from dincl.compiled import inner
from tissue.kernels.layers import chained_before, chained_behind, find, remove_from
from tissue.kernels.rules import Rules, call_place, compile_rules
from tissue.model.emt import inherit_events
from tissue.state.cells import Floats, Integers
from tissue.state.numbers import Numbers, numbers_of
from tissue.state.running import APICAL, BASAL, CELLS, DIVISIONS, NEXT_ID, TissueState
from tissue.state.space import SUM, Space, TissueRules, no_space


def split_in_slice(state: TissueState, splits: int, numbers: Numbers, rules: Rules) -> None:
    """Put a copy behind each of the cells that split, in the arrays and in the layers, and part both.

    All daughters get their places at once: to shift the arrays for one after the other would cost n^2.
    """
    cells, layers, sizes, n = state.cells, state.layers, state.sizes, state.sizes[CELLS]
    second = state.daughters.cycle
    _spread_lines(state.blocks.floats, second, n, splits)
    _spread_lines(state.blocks.flags, second, n, splits)
    _spread_lines(state.blocks.integers, second, n, splits)
    sizes[APICAL] = _spread_layer(layers.apical, sizes[APICAL], second, n, splits)
    sizes[BASAL] = _spread_layer(layers.basal, sizes[BASAL], second, n, splits)
    sizes[CELLS] = n + splits
    place = 0
    for i in range(n):
        if second[i] > 0.0:
            cells.rest_aa[place] = numbers_of(numbers, cells.kind[place]).new_junction
            place += 1
            cells.id[place], cells.mother[place] = sizes[NEXT_ID], cells.id[place - 1]
            cells.cycle[place] = second[i]
            sizes[NEXT_ID] += 1
            inherit_events(state, place)
        place += 1
    state.counts[DIVISIONS] += splits
    # Basal points move as forces want, or along the layer: which do is known by index.
    for i in range(sizes[CELLS]):
        state.motion.moves[i], state.motion.held[i], state.motion.runs[i] = 1.0, 0.0, 0.0
    for k in range(sizes[BASAL]):
        state.motion.held[layers.basal[k]] = 1.0
    place = 0
    for i in range(n):
        if second[i] > 0.0:
            call_place(rules.place, state, place, numbers_of(numbers, cells.kind[place]))
            second[i] = 0.0
            place += 1
        place += 1


@inner
def _spread_lines(block: Any, second: Floats, n: int, splits: int) -> None:
    """Move the n cells apart in all lines, from the last one on, and copy each that splits into the place behind it."""
    for line in range(block.shape[0]):
        place, i = n + splits - 1, n - 1
        while place > i:
            block[line, place] = block[line, i]
            if second[i] > 0.0:
                place -= 1
                block[line, place] = block[line, i]
            place, i = place - 1, i - 1


@inner
def _spread_layer(layer: Integers, size: int, second: Floats, n: int, splits: int) -> int:
    """Give the cells of a layer their new places, and put each daughter behind her mother; the new size."""
    added = 0
    for k in range(size):
        added += second[layer[k]] > 0.0
    place, before, i = size + added - 1, splits, n - 1  # ``before``: how many of the cells up to i split
    for k in range(size - 1, -1, -1):
        cell = layer[k]
        while i > cell:
            before -= second[i] > 0.0
            i -= 1
        layer[place] = cell + before
        if second[cell] > 0.0:
            place -= 1
            layer[place] = cell + before - 1
        place -= 1
    return size + added


def leave_apical_in_slice(state: TissueState, i: int, bridge: int) -> int:
    """Take cell i out of the apical layer, or of its chain, and join its neighbours; return whether it was in one.

    The new junction rests at the present distance, or at the sum of the two whose place it takes, by ``bridge``. In a
    ring the last cell and the first one are neighbours.
    """
    cells, layer, sizes = state.cells, state.layers.apical, state.sizes
    n = sizes[APICAL]
    k = find(layer, n, i)
    if k >= 0:
        ring = state.curve.ring > 0.0 and n > 2
        left = layer[k - 1] if k > 0 else layer[n - 1] if ring else -1
        right = layer[k + 1] if k < n - 1 else layer[0] if ring else -1
        sizes[APICAL] = remove_from(layer, n, k)
    elif cells.chain[i] > 0:
        left, right = chained_before(cells, i), chained_behind(cells, sizes[CELLS], i)
        cells.chain[i] = 0
    else:
        return 0
    if left >= 0 and right >= 0:
        if bridge == SUM:
            cells.rest_aa[left] += cells.rest_aa[i]
        else:
            cells.rest_aa[left] = math.hypot(cells.ax[right] - cells.ax[left], cells.ay[right] - cells.ay[left])
    return 1


def leave_basal_in_slice(state: TissueState, i: int, bridge: int) -> int:
    """Take cell i out of the basal layer, where its neighbours are neighbours now; return whether it was in it."""
    k = find(state.layers.basal, state.sizes[BASAL], i)
    if k >= 0:
        state.sizes[BASAL] = remove_from(state.layers.basal, state.sizes[BASAL], k)
    return int(k >= 0)


@cache
def slice_rules() -> TissueRules:
    """Compile the rules of a slice, on first use."""
    return compile_rules(split_in_slice, leave_apical_in_slice, leave_basal_in_slice)


@cache
def in_plane() -> Space:
    """Return the dimension and the rules of a slice."""
    return no_space(slice_rules())
