"""Division of cells (section 2.2.5 of chapter 3)."""

from __future__ import annotations

from typing import Any

from numpy.random import Generator

from dincl.compiled import inner
from tissue.kernels import kernel
from tissue.kernels.numbers import numbers_of
from tissue.kernels.rules import Rules, call_place, call_split_in_space, call_splits
from tissue.model.cycle import draw_cycle
from tissue.model.emt import inherit_events
from tissue.state.cells import Cells, Floats, Integers
from tissue.state.numbers import Numbers
from tissue.state.space import SPATIAL
from tissue.state.store import APICAL, BASAL, CELLS, DIVISIONS, NEXT_ID, Store


@inner
def count_due(store: Store, t: float) -> int:
    """How many cells end their cycle by time t: as many may be added."""
    cells = store.cells
    count = 0
    for i in range(store.sizes[CELLS]):
        count += is_due(cells, i, t)
    return count


@inner
def is_due(cells: Cells, i: int, t: float) -> bool:
    """Whether cell i ends its cycle by time t."""
    due: bool = t - cells.birth[i] >= cells.cycle[i]
    return due


@kernel
def divide(store: Store, t: float, numbers: Numbers, rules: Rules, draws: Generator) -> None:
    """End the cycle of each cell that is old enough: it begins a new one, alone or with a second daughter beside it.

    In a slice all daughters get their places at once: to shift the arrays for one after the other would cost n^2.
    """
    cells, splits = store.cells, 0
    for i in range(store.sizes[CELLS]):
        if is_due(cells, i, t):
            own = numbers_of(numbers, cells.kind[i])
            two = cells.divides[i] and call_splits(rules.splits, store, i, draws.random(), own) != 0
            cells.birth[i] = t
            cells.cycle[i] = draw_cycle(own, draws)
            if two and store.space.dimension == SPATIAL:
                call_split_in_space(store.space.rules.split, store, i, draws.random(), own)
                cells.cycle[store.sizes[CELLS] - 1] = draw_cycle(own, draws)
            elif two:
                store.second[i] = draw_cycle(own, draws)
                splits += 1
    if splits > 0:
        _split(store, splits, numbers, rules)


@inner
def _split(store: Store, splits: int, numbers: Numbers, rules: Rules) -> None:
    """Put a copy behind each of the cells that split, in the arrays and in the layers, and part both.

    ``Store.second`` says which cells split, and the cycle of the second daughter of each.
    """
    cells, layers, sizes, second, n = store.cells, store.layers, store.sizes, store.second, store.sizes[CELLS]
    _spread_lines(store.blocks.floats, second, n, splits)
    _spread_lines(store.blocks.flags, second, n, splits)
    _spread_lines(store.blocks.integers, second, n, splits)
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
            inherit_events(store, place)
        place += 1
    store.counts[DIVISIONS] += splits
    _hold_again(store)
    place = 0
    for i in range(n):
        if second[i] > 0.0:
            call_place(rules.place, store, place, numbers_of(numbers, cells.kind[place]))
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


@inner
def _hold_again(store: Store) -> None:
    """Basal points move as forces want, or along the line: which do is known by index."""
    for i in range(store.sizes[CELLS]):
        store.motion.bx_moves[i] = store.motion.by_moves[i] = 1.0
        store.motion.runs[i] = 0.0
    for k in range(store.sizes[BASAL]):
        store.motion.by_moves[store.layers.basal[k]] = 0.0
