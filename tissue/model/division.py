"""Division of cells (section 2.2.5 of chapter 3)."""

from __future__ import annotations

from typing import Any

from numpy.random import Generator

from dincl.compiled import inner
from tissue.kernels import kernel
from tissue.kernels.handed import numbers_of
from tissue.kernels.rules import Rules, call_place, call_split_in_space, call_splits
from tissue.kernels.store import APICAL, BASAL, CELLS, DIVISIONS, NEXT_ID, Store
from tissue.model.cycle import draw_cycle
from tissue.model.emt import inherit_events
from tissue.space.state import SPATIAL
from tissue.state.cells import Cells, Integers
from tissue.state.numbers import Numbers


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
    """End the cycle of each cell that is old enough: it begins a new one, alone or with a second daughter beside it."""
    cells, sizes = store.cells, store.sizes
    i = 0
    while i < sizes[CELLS]:
        if is_due(cells, i, t):
            own = numbers_of(numbers, cells.kind[i])
            two = cells.divides[i] and call_splits(rules.splits, store, i, draws.random(), own) != 0
            cells.birth[i] = t
            cells.cycle[i] = draw_cycle(own, draws)
            if two:
                daughter = _part(store, i, own, rules, draws)
                cells.cycle[daughter] = draw_cycle(own, draws)
        i += 1


@inner
def _part(store: Store, i: int, numbers: Numbers, rules: Rules, draws: Generator) -> int:
    """Part cell i into two beside each other: the place of the second one."""
    if store.space.dimension == SPATIAL:
        call_split_in_space(store.space.rules.split, store, i, draws.random(), numbers)
        last: int = store.sizes[CELLS] - 1
        return last
    _split(store, i, numbers)
    call_place(rules.place, store, i, numbers)
    return i + 1


@inner
def _split(store: Store, i: int, numbers: Numbers) -> None:
    """Put a copy of cell i behind it, in the arrays and in the layers."""
    cells, layers, sizes = store.cells, store.layers, store.sizes
    n = sizes[CELLS]
    _shift(store.blocks.floats, i, n)
    _shift(store.blocks.flags, i, n)
    _shift(store.blocks.integers, i, n)
    cells.rest_aa[i] = numbers.new_junction
    cells.id[i + 1] = sizes[NEXT_ID]
    cells.mother[i + 1] = cells.id[i]
    sizes[NEXT_ID] += 1
    sizes[CELLS] = n + 1
    sizes[APICAL] = _insert(layers.apical, sizes[APICAL], i)
    sizes[BASAL] = _insert(layers.basal, sizes[BASAL], i)
    inherit_events(store, i + 1)
    _hold_again(store)
    store.counts[DIVISIONS] += 1


@inner
def _shift(block: Any, i: int, n: int) -> None:
    """Make room in all rows: each cell behind i goes one place on, and i is copied to i + 1."""
    for line in range(block.shape[0]):
        for k in range(n, i, -1):
            block[line, k] = block[line, k - 1]


@inner
def _insert(layer: Integers, size: int, i: int) -> int:
    """Make room for the new cell i + 1 in a layer: behind its mother, if she is in it; the new size."""
    inside = False
    for k in range(size):
        inside = inside or layer[k] == i
        if layer[k] > i:
            layer[k] += 1
    if not inside:
        return size
    k = size
    while layer[k - 1] > i:
        layer[k] = layer[k - 1]
        k -= 1
    layer[k] = i + 1
    return size + 1


@inner
def _hold_again(store: Store) -> None:
    """Basal points move as forces want, or along the line: which do is known by index."""
    for i in range(store.sizes[CELLS]):
        store.motion.bx_moves[i] = store.motion.by_moves[i] = 1.0
        store.motion.runs[i] = 0.0
    for k in range(store.sizes[BASAL]):
        store.motion.by_moves[store.layers.basal[k]] = 0.0
