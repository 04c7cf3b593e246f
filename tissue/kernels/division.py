"""Division of cells (section 2.2.5 of chapter 3)."""

from __future__ import annotations

from numpy.random import Generator

from tissue.kernels import kernel
from tissue.kernels.cycle import draw_cycle
from tissue.kernels.scratch import DIVISIONS, STALE
from tissue.kernels.store import APICAL, BASAL, CELLS, NEXT_ID, Store
from tissue.model.cells import Cells, Integers
from tissue.model.numbers import Numbers

# The first fields of Cells are numbers, the others flags and ids.
NUMBERS = Cells._fields.index("moves")


@kernel
def count_due(store: Store, t: float) -> int:
    """How many cells end their cycle by time t: as many may be added."""
    cells = store.cells
    count = 0
    for i in range(store.sizes[CELLS]):
        count += t - cells.birth[i] >= cells.cycle[i]
    return count


@kernel
def divide(store: Store, t: float, numbers: Numbers, draws: Generator) -> None:
    """End the cycle of each cell that is old enough: it begins a new one, alone or with a second daughter beside it."""
    cells, sizes = store.cells, store.sizes
    i = 0
    while i < sizes[CELLS]:
        if t - cells.birth[i] >= cells.cycle[i]:
            two = cells.divides[i] and draws.random() < numbers.two_daughters
            cells.birth[i] = t
            cells.cycle[i] = draw_cycle(numbers, draws)
            if two:
                _split(store, i, numbers)
                i += 1
                cells.cycle[i] = draw_cycle(numbers, draws)
        i += 1


@kernel
def _split(store: Store, i: int, numbers: Numbers) -> None:
    """Put a copy of cell i behind it, in the arrays and in the layers, and the two apart by the offset (3.7)."""
    cells, layers, sizes = store.cells, store.layers, store.sizes
    n = sizes[CELLS]
    for k in range(n, i, -1):  # cell i itself is copied to i + 1
        for array in cells[:NUMBERS]:
            array[k] = array[k - 1]
        for flags in (cells.moves, cells.divides):
            flags[k] = flags[k - 1]
        for names in (cells.id, cells.mother, cells.emt, cells.events):
            names[k] = names[k - 1]
    for points in (cells.x, cells.ax, cells.bx):
        points[i] -= numbers.division_offset
        points[i + 1] += numbers.division_offset
    cells.rest_aa[i] = numbers.new_junction
    cells.id[i + 1] = sizes[NEXT_ID]
    cells.mother[i + 1] = cells.id[i]
    sizes[NEXT_ID] += 1
    sizes[CELLS] = n + 1
    sizes[APICAL] = _insert(layers.apical, sizes[APICAL], i)
    sizes[BASAL] = _insert(layers.basal, sizes[BASAL], i)
    _index_again(store)


@kernel
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


@kernel
def _index_again(store: Store) -> None:
    """What scratch knows by index is wrong now: sort again from the order of the tissue."""
    for s in range(store.sizes[CELLS]):
        store.scratch.order[s] = s
        store.scratch.bx_moves[s] = store.scratch.by_moves[s] = 1.0
        store.scratch.runs[s] = 0.0
    for k in range(store.sizes[BASAL]):
        store.scratch.by_moves[store.layers.basal[k]] = 0.0
    store.scratch.flags[STALE] = 1
    store.scratch.counts[DIVISIONS] += 1
