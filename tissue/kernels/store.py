"""All arrays of a running tissue together: cells and layers with room to grow, and scratch."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from tissue.kernels.lanes import WIDTH
from tissue.kernels.scratch import Scratch, scratch_for
from tissue.model.cells import CellLayers, Cells, Emt, Integers, empty, first, no_emt

# Places in Store.sizes
CELLS, APICAL, BASAL, NEXT_ID = range(4)


class Store(NamedTuple):
    """What the kernels work on; of each array the first ``sizes`` entries are in use."""

    cells: Cells
    layers: CellLayers
    emt: Emt  # always whole
    sizes: Integers  # number of cells, of cells in the apical and in the basal layer, next id
    scratch: Scratch


def stored(
    cells: Cells, layers: CellLayers | None = None, next_id: int | None = None, emt: Emt | None = None, *, capacity: int
) -> Store:
    """A store with room for ``capacity`` cells at least, all cells in both layers if none are given.

    Its counters are zero and its neighbour lists not yet made.
    """
    n, capacity = len(cells.x), -(-capacity // WIDTH) * WIDTH
    layers = layers or CellLayers(np.arange(n), np.arange(n))
    roomy, apical, basal = empty(capacity), np.zeros(capacity, np.int64), np.zeros(capacity, np.int64)
    for name, array in zip(Cells._fields, cells, strict=True):
        getattr(roomy, name)[:n] = array
    apical[: len(layers.apical)] = layers.apical
    basal[: len(layers.basal)] = layers.basal
    sizes = [
        n,
        len(layers.apical),
        len(layers.basal),
        int(cells.id.max(initial=-1)) + 1 if next_id is None else next_id,
    ]
    scratch = scratch_for(roomy)
    scratch.order[:n] = np.arange(n)
    scratch.bx_moves[:n] = 1.0
    scratch.by_moves[:n] = 1.0
    scratch.by_moves[layers.basal] = 0.0
    return Store(roomy, CellLayers(apical, basal), no_emt() if emt is None else emt, np.array(sizes, np.int64), scratch)


def grown(held: Store) -> Store:
    """The same cells and counters with twice the room."""
    larger = stored(*contents(held), int(held.sizes[NEXT_ID]), held.emt, capacity=2 * len(held.cells.x))
    larger.scratch.counts[:] = held.scratch.counts
    return larger


def contents(held: Store) -> tuple[Cells, CellLayers]:
    """Copies of the cells and layers in use."""
    n, apical, basal = held.sizes[CELLS], held.sizes[APICAL], held.sizes[BASAL]
    return first(held.cells, n), CellLayers(held.layers.apical[:apical].copy(), held.layers.basal[:basal].copy())
