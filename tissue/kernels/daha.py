"""The damped Arrow-Hurwicz iteration for a tissue whose rules stand still (Method 3.4)."""

from __future__ import annotations

from typing import Final, NamedTuple

import numpy as np

from tissue.kernels._numba import kernel
from tissue.kernels.advance import CROWDED, DONE, NON_FINITE
from tissue.kernels.forces import junctions, move_by_neighbours, move_by_springs, prepare, repulsion
from tissue.kernels.lanes import WIDTH, fma, load, store
from tissue.kernels.multipliers import (
    REACH,
    Multipliers,
    hold_basal,
    hold_discs,
    list_pairs,
    multipliers_for,
)
from tissue.kernels.neighbours import LOST, make_lists
from tissue.kernels.scratch import Scratch
from tissue.kernels.store import APICAL, BASAL, CELLS, Store
from tissue.model.cells import Cells, Floats
from tissue.model.numbers import Numbers
from tissue.model.numbers_daha import Daha

# How a call ended, beside DONE, CROWDED and NON_FINITE: all iterations made, and the rule does not hold yet.
UNFINISHED = 1 + max(DONE, CROWDED, NON_FINITE)
# Bound of |z_n|^2 + |z_{n+1} - z_n|^2: below it |z_{n+1}| is below LOST.
TOO_FAR = LOST**2 / 2
# The first fields of Cells are the coordinates x, y, ax, ay, bx, by.
COORDINATES: Final = 6
BX = Cells._fields.index("bx")


class Memory(NamedTuple):
    """What the iteration remembers beside the positions, by coordinate."""

    multipliers: Multipliers
    before: tuple[Floats, ...]  # z_{n-1}, or z_n while it moves on
    change: tuple[Floats, ...]  # z_{n+1} - z_n without the part of the forces
    sums: Floats  # (2 WIDTH,)


def memory_for(cells: Cells) -> Memory:
    """Room for the capacity of ``cells``; all multipliers are zero."""
    before, change = (tuple(np.zeros(len(cells.x)) for _ in range(COORDINATES)) for _ in range(2))
    return Memory(multipliers_for(cells), before, change, np.zeros(2 * WIDTH))


@kernel
def iterate(held: Store, numbers: Numbers, daha: Daha, memory: Memory) -> tuple[int, int]:
    """Move the cells until |z_{n+1} - z_n| <= dtau eps |z_n| (3.24): the number of iterations, and how the call ended.

    z_{n+1} = z_n + ((1 - a) (z_n - z_{n-1}) - dtau^2 p_n) / (1 + a) with a = c dtau / 2 is (3.25), solved. It begins
    with the multipliers in ``memory``.
    """
    cells, n = held.cells, held.sizes[CELLS]
    points = cells[:COORDINATES]
    half = daha.c * daha.dtau / 2
    weight, inertia = daha.dtau**2 / (1 + half), (1 - half) / (1 + half)
    scale = weight * daha.alpha
    prepare(cells, n, held.layers, held.sizes[APICAL], numbers, scale, held.scratch)
    if not _begin(held, memory):
        return 0, CROWDED
    for made in range(1, daha.most_iterations + 1):
        for k in range(COORDINATES):
            _remember(points[k], n, inertia, memory.before[k], memory.change[k])
        _react(held, numbers, daha, weight, memory)
        _force(held, numbers, scale)
        memory.sums[:] = 0.0
        for k in range(COORDINATES):
            _move(points[k], n, memory.before[k], memory.change[k], memory.sums)
        moved, size = memory.sums[:WIDTH].sum(), memory.sums[WIDTH:].sum()
        if not moved + size < TOO_FAR:  # nor if it is NaN
            return made, NON_FINITE
        if moved <= (daha.dtau * daha.eps) ** 2 * size:
            return made, DONE
        if _are_stale(cells, n, held.scratch) and not _list(held, memory):
            return made, CROWDED
    return daha.most_iterations, UNFINISHED


@kernel
def _begin(held: Store, memory: Memory) -> bool:
    """z_1 = z_0; False if the pairs have no room."""
    n, points = held.sizes[CELLS], held.cells[:COORDINATES]
    for k in range(COORDINATES):
        for i in range(n):
            memory.before[k][i] = points[k][i]
    return _list(held, memory)


@kernel
def _list(held: Store, memory: Memory) -> bool:
    """Find who is near whom; False if there is no room for it."""
    n = held.sizes[CELLS]
    return make_lists(held.cells, n, held.scratch) and list_pairs(held.cells, n, held.scratch, memory.multipliers)


@kernel
def _are_stale(cells: Cells, n: int, scratch: Scratch) -> bool:
    """Whether a nucleus moved by more than REACH / 2 since it was listed."""
    x, y, listed_x, listed_y = cells.x, cells.y, scratch.listed_x, scratch.listed_y
    left = 0
    for i in range(n):
        dx, dy = x[i] - listed_x[i], y[i] - listed_y[i]
        left += dx * dx + dy * dy > 0.25 * REACH * REACH
    return left > 0


@kernel
def _react(held: Store, numbers: Numbers, daha: Daha, weight: float, memory: Memory) -> None:
    """Add what the constraints do at z_n to the changes."""
    cells, multipliers, change = held.cells, memory.multipliers, memory.change
    hold_discs(cells, daha, weight, multipliers, change[0], change[1])
    hold_basal(cells, held.layers, held.sizes[BASAL], numbers.max_basal, daha, weight, multipliers, change[BX])


@kernel
def _force(held: Store, numbers: Numbers, scale: float) -> None:
    """Move the cells by -scale grad W(z_n)."""
    cells, layers, scratch = held.cells, held.layers, held.scratch
    n, apical = held.sizes[CELLS], held.sizes[APICAL]
    repulsion(cells, n, scale * numbers.repulsion, scratch)
    junctions(cells, layers, apical, scratch)
    move_by_springs(cells, n, scratch)
    move_by_neighbours(cells, n, layers, apical, scratch)


@kernel
def _remember(q: Floats, n: int, inertia: float, before: Floats, change: Floats) -> None:
    """Begin the change of a coordinate with its inertia, and keep where it was."""
    for i in range(n):
        change[i] = inertia * (q[i] - before[i])
        before[i] = q[i]


@kernel
def _move(q: Floats, n: int, before: Floats, change: Floats, sums: Floats) -> None:
    """Add the change to a coordinate, and |q_{n+1} - q_n|^2 and |q_n|^2, in eight parts each, to the sums."""
    moved, size = load(sums, 0), load(sums, WIDTH)
    blocks = n - n % WIDTH
    for i in range(0, blocks, WIDTH):
        old, new = load(before, i), load(q, i) + load(change, i)
        store(q, i, new)
        moved, size = fma(new - old, new - old, moved), fma(old, old, size)
    store(sums, 0, moved)
    store(sums, WIDTH, size)
    for i in range(blocks, n):  # what lies behind the last cell is no number
        q[i] += change[i]
        sums[0] += (q[i] - before[i]) ** 2
        sums[WIDTH] += before[i] ** 2
