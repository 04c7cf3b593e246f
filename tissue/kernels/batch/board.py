"""The eight values of each cell side by side: where the substeps of a batch are made."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from tissue.kernels import kernel
from tissue.kernels.batch.rows import row
from tissue.kernels.forces import prepare
from tissue.kernels.lanes import WIDTH
from tissue.kernels.scratch import FAR
from tissue.kernels.store import APICAL, BASAL, CELLS, Store
from tissue.model.cells import Floats, Integers
from tissue.model.numbers import Numbers

# What ``ended`` says of a replicate, if not the number of the step that failed.
RUNNING, EMPTY = 0, -1


class Board(NamedTuple):
    """Cell i of replicate k has place WIDTH i + k in each array.

    Replicates with fewer cells than others are filled up with cells that lie far from everything and never move.
    """

    # Copies of the cells, and coefficients as in Scratch
    x: Floats
    y: Floats
    ax: Floats
    ay: Floats
    bx: Floats
    by: Floats
    radius: Floats
    k_ax: Floats
    k_bx: Floats
    k_axb: Floats
    l_ax: Floats
    l_bx: Floats
    bx_moves: Floats
    by_moves: Floats
    runs: Floats
    # Layers: whether a cell is inside, 1 or 0
    in_apical: Floats
    in_basal: Floats
    rest: Floats  # of the junction from a cell to the next one of the apical layer
    k_aa: Floats  # what a cell gives to the coefficients of its junctions
    # What is computed on the way
    push_x: Floats  # push of the soft discs on the nucleus, for strength 1
    push_y: Floats
    drag_x: Floats  # displacement of the apical point by the junctions
    drag_y: Floats
    ends: Floats  # where the basal sweeps bring the points of the layer
    before_x: Floats  # nuclei before the sweep
    before_y: Floats
    front: Floats  # the rightmost end of the discs 0 to i
    low: Integers  # the first cell that may be near cell i, one number for all replicates
    cells: Floats  # numbers of cells, one for each replicate
    id: Integers
    noise_key: Integers  # of the noise in substeps, see ``tissue.kernels.normals``


def board_for(capacity: int) -> Board:
    """A board for replicates with so many cells at most."""
    lengths, kinds = {"cells": WIDTH, "noise_key": 2 * WIDTH}, dict.fromkeys(("low", "id", "noise_key"), np.int64)
    return Board(
        **{name: _aligned(lengths.get(name, WIDTH * capacity), kinds.get(name, np.float64)) for name in Board._fields}
    )


def _aligned(length: int, kind: type[np.number[Any]]) -> NDArray[Any]:
    """Zeros, 8 bytes each, of which eight lie in one line of the cache: what lies in two takes twice as long."""
    zeros = np.zeros(length + WIDTH - 1, kind)
    begin = -zeros.ctypes.data % (8 * WIDTH) // 8
    return zeros[begin : begin + length]


@kernel
def copy_in(group: Store, ended: Integers, numbers: Numbers, scale: float, board: Board) -> int:
    """Copy the replicates that run to the board; ``scale`` = h / mu; the largest number of cells."""
    largest = 0
    for k in range(WIDTH):
        store = row(group, k)
        n = store.sizes[CELLS] if ended[k] == RUNNING else 0
        prepare(store.cells, n, store.layers, 0, numbers, scale, store.scratch)
        board.cells[k] = n
        board.noise_key[k], board.noise_key[WIDTH + k] = store.scratch.noise_key[0], store.scratch.noise_key[WIDTH]
        largest = max(largest, n)
    cells, scratch = group.cells, group.scratch
    for i in range(largest):
        for k in range(WIDTH):
            place = WIDTH * i + k
            if i < board.cells[k]:
                board.x[place], board.y[place] = cells.x[k, i], cells.y[k, i]
                board.ax[place], board.ay[place] = cells.ax[k, i], cells.ay[k, i]
                board.bx[place], board.by[place] = cells.bx[k, i], cells.by[k, i]
                board.radius[place] = cells.radius[k, i]
                board.k_ax[place], board.l_ax[place] = scratch.k_ax[k, i], scratch.l_ax[k, i]
                board.k_bx[place], board.l_bx[place] = scratch.k_bx[k, i], scratch.l_bx[k, i]
                board.k_axb[place] = scratch.k_axb[k, i]
                board.bx_moves[place], board.by_moves[place] = scratch.bx_moves[k, i], scratch.by_moves[k, i]
                board.runs[place], board.rest[place] = scratch.runs[k, i], cells.rest_aa[k, i]
                board.k_aa[place] = 0.5 * (scale * numbers.junction_factor * cells.stiff_aa[k, i])
                board.id[place] = cells.id[k, i]
            else:
                _fill(board, i, place)
            board.in_apical[place] = board.in_basal[place] = 0.0
    for k in range(WIDTH):
        if board.cells[k] > 0:
            store = row(group, k)
            _mark(store.layers.apical, store.sizes[APICAL], k, board.in_apical)
            _mark(store.layers.basal, store.sizes[BASAL], k, board.in_basal)
    return largest


@kernel
def _mark(layer: Integers, size: int, k: int, inside: Floats) -> None:
    """Mark the cells of a layer of replicate k."""
    for i in layer[:size]:
        inside[WIDTH * i + k] = 1.0


@kernel
def _fill(board: Board, i: int, place: int) -> None:
    """An empty place: a cell that stands upright, far from everything and from its like, without forces."""
    board.x[place] = board.ax[place] = board.bx[place] = FAR * (1 + i)
    board.y[place], board.ay[place], board.by[place] = 0.0, 1.0, -1.0
    board.radius[place] = board.k_ax[place] = board.k_bx[place] = board.k_axb[place] = 0.0
    board.bx_moves[place] = board.by_moves[place] = board.runs[place] = 0.0


@kernel
def copy_out(board: Board, n: int, group: Store) -> None:
    """Copy the positions of cells 0 to n - 1 back to the replicates that run."""
    cells = group.cells
    for i in range(n):
        for k in range(WIDTH):
            place = WIDTH * i + k
            if i < board.cells[k]:
                cells.x[k, i], cells.y[k, i] = board.x[place], board.y[place]
                cells.ax[k, i], cells.ay[k, i] = board.ax[place], board.ay[place]
                cells.bx[k, i], cells.by[k, i] = board.bx[place], board.by[place]
