"""Many steps dt of eight replicates in one call."""

from __future__ import annotations

from numpy.random import Generator

from tissue.kernels._numba import kernel
from tissue.kernels.advance import DONE, FULL, apply_rules, find_lost
from tissue.kernels.batch.board import RUNNING, Board, copy_in, copy_out
from tissue.kernels.batch.forces import junctions, move, repulsion
from tissue.kernels.batch.rows import row
from tissue.kernels.batch.sweeps import order_basal, separate
from tissue.kernels.division import count_due
from tissue.kernels.lanes import WIDTH
from tissue.kernels.normals import shake
from tissue.kernels.scale import watch_sides
from tissue.kernels.store import CELLS, Store
from tissue.model.cells import Integers
from tissue.model.numbers import Numbers

Generators = tuple[Generator, ...]


@kernel
def advance(
    group: Store,
    board: Board,
    ended: Integers,
    made: int,
    steps: int,
    numbers: Numbers,
    draws: Generators,
    noise: Generators,
) -> tuple[int, int]:
    """Make the steps ``made`` to ``steps`` of the replicates that run; how many are made then, and how the call ended.

    A replicate that fails stays as it is from then on: ``ended`` is set to the step that failed. After FULL nothing is
    lost: put the cells into larger stores and go on.
    """
    h = numbers.dt / numbers.substeps
    while made < steps:
        t = (made + 1) * numbers.dt
        for k in range(WIDTH):
            held = row(group, k)
            if ended[k] == RUNNING and held.sizes[CELLS] + count_due(held, t) > len(held.cells.x):
                return made, FULL
        for k in range(WIDTH):
            if ended[k] == RUNNING:
                apply_rules(row(group, k), t, numbers, draws[k], noise[k])
        n = copy_in(group, ended, numbers, h / numbers.mu, board)
        if n == 0:  # nobody runs any more
            return steps, DONE
        for number in range(numbers.substeps):
            if numbers.noise_in_substeps:
                shake(board.x, board.y, board.id, WIDTH * n, numbers.variance * h, board.noise_key, number)
            make_substep(board, n, numbers, h)
        copy_out(board, n, group)
        for k in range(WIDTH):
            held = row(group, k)
            if ended[k] == RUNNING:
                if find_lost(held.cells, held.sizes[CELLS]) >= 0:
                    ended[k] = made + 1
                else:
                    watch_sides(held, t)
        made += 1
    return made, DONE


@kernel
def make_substep(board: Board, n: int, numbers: Numbers, h: float) -> None:
    """One substep of all replicates on the board: forces, then one sweep of projections."""
    scale = h / numbers.mu
    if numbers.repulsion != 0.0:
        repulsion(board, n)
    junctions(board, n)
    move(board, n, scale * numbers.repulsion)
    separate(board, n)
    order_basal(board, n, numbers.max_basal)
