"""Room to work in: what the kernels compute on the way, kept from one call to the next."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from tissue.kernels.lanes import WIDTH
from tissue.model.cells import Cells, Floats, Integers

# Far from every cell, and from each other: the end of the sorted arrays.
FAR = 1e6
# Cells of smaller index that may be near one cell: more of them means that the tissue has collapsed.
NEAR = 32
# What is counted, and where.
COUNTERS = ("substeps", "lists", "pairs", "close_pairs", "corrections", "basal_corrections", "divisions")
SUBSTEPS, LISTS, SOFT_PAIRS, CLOSE_PAIRS, CORRECTIONS, BASAL_CORRECTIONS, DIVISIONS = range(len(COUNTERS))
# Places in Scratch.flags: whether all lists must be made anew; how many nuclei were listed again since they were made
STALE, MOVED = 0, 1


class Scratch(NamedTuple):
    """Arrays of the capacity of the cells and, where sorted, WIDTH more."""

    # Springs, made once per dt: displacement in a substep is k (1 - l / d) (X - A)
    k_ax: Floats
    k_bx: Floats
    k_axb: Floats
    l_ax: Floats
    l_bx: Floats
    bx_moves: Floats  # whether forces move the basal point: 1, or 0 for one that moves by itself (4.1)
    by_moves: Floats  # likewise; 0 for one on the basal line, too
    runs: Floats  # how far a basal point that moves by itself goes in a substep
    # The apical layer, in its order
    layer_x: Floats
    layer_y: Floats
    pull_x: Floats
    pull_y: Floats
    rest: Floats  # of the junction to the next one, and its displacement k (d - rest) in a substep
    k_aa: Floats
    # Nuclei by their x
    order: Integers  # order[s]: the cell in place s
    sorted_x: Floats
    sorted_y: Floats
    sorted_radius: Floats
    push_x: Floats
    push_y: Floats
    low: Integers  # window of the block of WIDTH sorted nuclei
    high: Integers
    # Neighbour lists
    key: Floats  # x by which the nuclei are sorted
    listed_x: Floats  # where the nuclei were when they were listed
    listed_y: Floats
    near: Integers  # NEAR places for each cell i: cells j < i that may touch it, in increasing order
    near_count: Integers
    moved: Integers  # nuclei that were listed again
    widest: Floats  # the largest radius
    noise_key: Integers  # of the noise in substeps, see ``tissue.kernels.normals``
    flags: Integers
    counts: Integers  # one for each of COUNTERS


def scratch_for(cells: Cells) -> Scratch:
    """Scratch for the capacity of ``cells``; the lists are made at the first substep."""
    capacity = len(cells.x)
    lengths = {
        "near": NEAR * capacity,
        "widest": 1,
        "noise_key": 2 * WIDTH,
        "low": capacity // WIDTH + 1,
        "high": capacity // WIDTH + 1,
        "flags": 2,
        "counts": len(COUNTERS),
    }
    whole = {"order", "low", "high", "near", "near_count", "moved", "noise_key", "flags", "counts"}
    arrays: dict[str, NDArray[Any]] = {
        name: np.zeros(lengths.get(name, capacity + WIDTH), np.int64 if name in whole else np.float64)
        for name in Scratch._fields
    }
    arrays["flags"][0] = 1
    return Scratch(**arrays)
