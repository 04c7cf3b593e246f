"""The substeps of position based dynamics between two updates of the rules (Method 3.7, (3.34))."""

from __future__ import annotations

import math

from numpy.random import Generator

from tissue.kernels._numba import kernel
from tissue.kernels.forces import junctions, move_by_neighbours, move_by_springs, prepare, repulsion
from tissue.kernels.normals import shake
from tissue.kernels.scratch import STALE, SUBSTEPS
from tissue.kernels.store import APICAL, BASAL, CELLS, Store
from tissue.kernels.sweeps import order_basal, refresh, separate
from tissue.model.cells import Cells
from tissue.model.numbers import Numbers


@kernel
def add_noise(cells: Cells, n: int, variance: float, noise: Generator) -> None:
    """Add N(0, variance) to each coordinate of the nuclei, (3.35); draw nothing if there is no variance."""
    if variance == 0.0:
        return
    deviation = math.sqrt(variance)
    for i in range(n):
        cells.x[i] += deviation * noise.standard_normal()
        cells.y[i] += deviation * noise.standard_normal()


@kernel
def make_substeps(store: Store, numbers: Numbers) -> bool:
    """All substeps of one dt; False if the cells are too crowded for the neighbour lists."""
    cells, layers, scratch = store.cells, store.layers, store.scratch
    n, apical, basal = store.sizes[CELLS], store.sizes[APICAL], store.sizes[BASAL]
    h = numbers.dt / numbers.substeps
    scale = h / numbers.mu
    prepare(cells, n, layers, apical, numbers, scale, scratch)
    scratch.counts[SUBSTEPS] += numbers.substeps
    moved = True  # by the rules
    for number in range(numbers.substeps):
        if numbers.noise_in_substeps:
            shake(cells.x, cells.y, cells.id, n, numbers.variance * h, scratch.noise_key, number)
            moved = True
        if (moved or scratch.flags[STALE]) and not refresh(cells, n, scratch):
            return False
        moved = False
        repulsion(cells, n, scale * numbers.repulsion, scratch)
        junctions(cells, layers, apical, scratch)
        move_by_springs(cells, n, scratch)
        move_by_neighbours(cells, n, layers, apical, scratch)
        if not (refresh(cells, n, scratch) and separate(cells, n, scratch)):
            return False
        order_basal(cells, layers, basal, numbers.max_basal, scratch)
    return True
