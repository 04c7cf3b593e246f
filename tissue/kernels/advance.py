"""Many steps dt of the first-order model in one call, without the interpreter (Method 3.7)."""

from __future__ import annotations

from numpy.random import Generator

from tissue.events.together import begin_events
from tissue.kernels._numba import kernel
from tissue.kernels.cycle import adapt_rest_lengths, set_phases
from tissue.kernels.division import count_due, divide
from tissue.kernels.neighbours import LOST
from tissue.kernels.normals import draw_key
from tissue.kernels.scale import watch_sides
from tissue.kernels.store import CELLS, Store
from tissue.kernels.substeps import add_noise, make_substeps
from tissue.model.cells import Cells
from tissue.model.numbers import Numbers

# How a call ended: all steps made; no room for the daughters that may come; no room in the lists of close pairs;
# a cell that is lost.
DONE, FULL, CROWDED, NON_FINITE = range(4)


@kernel
def advance(
    store: Store, made: int, steps: int, numbers: Numbers, draws: Generator, noise: Generator
) -> tuple[int, int]:
    """Make the steps ``made`` to ``steps``, the k-th to t = (k + 1) dt; how many are made then, and how the call ended.

    After FULL nothing is lost: put the cells into a larger store and go on.
    """
    while made < steps:
        t = (made + 1) * numbers.dt
        if store.sizes[CELLS] + count_due(store, t) > len(store.cells.x):
            return made, FULL
        apply_rules(store, t, numbers, draws, noise)
        listed = make_substeps(store, numbers)
        if find_lost(store.cells, store.sizes[CELLS]) >= 0:
            return made, NON_FINITE
        if not listed:
            return made, CROWDED
        watch_sides(store, t)
        made += 1
    return made, DONE


@kernel
def apply_rules(store: Store, t: float, numbers: Numbers, draws: Generator, noise: Generator) -> None:
    """What happens once per dt before the cells move: divisions, EMT events, phases, rest lengths, noise or its key."""
    divide(store, t, numbers, draws)
    begin_events(store, t, numbers)
    set_phases(store, t, numbers)
    adapt_rest_lengths(store, t, numbers)
    if numbers.noise_in_substeps:
        draw_key(noise, store.scratch.noise_key)
    else:
        add_noise(store.cells, store.sizes[CELLS], numbers.variance * numbers.dt, noise)


@kernel
def find_lost(cells: Cells, n: int) -> int:
    """The first cell whose coordinates add up to LOST in magnitude, or are not numbers; -1 if there is none."""
    for i in range(n):
        nucleus, apical = abs(cells.x[i]) + abs(cells.y[i]), abs(cells.ax[i]) + abs(cells.ay[i])
        basal = abs(cells.bx[i]) + abs(cells.by[i])
        if not nucleus + apical + basal < LOST:  # nor if it is NaN
            return i
    return -1
