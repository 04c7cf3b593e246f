"""Many steps dt of the first-order model in one call, without the interpreter (Method 3.7)."""

from __future__ import annotations

from numpy.random import Generator

from dincl.compiled.generators import generator_at
from tissue.kernels import kernel
from tissue.kernels.board import LOST, RUNNING, board_at
from tissue.kernels.numbers import numbers_at
from tissue.kernels.rules import Rules, call_substeps, rules_at
from tissue.model.cycle import adapt_rest_lengths, set_phases
from tissue.model.division import count_due, divide
from tissue.model.emt import begin_events
from tissue.model.extents import is_closed
from tissue.model.noise import add_noise, draw_key
from tissue.model.scale import watch_sides
from tissue.state.cells import Integers
from tissue.state.numbers import Numbers
from tissue.state.space import SPATIAL
from tissue.state.store import CELLS, Store, store_at
from tissue.step.copies import copy_in, copy_out

# How a call ended: all steps made; no room for the daughters that may come.
DONE, FULL = range(2)


@kernel
def advance(
    stores: Integers, random: Integers, ended: Integers, made: int, steps: int, how: Integers
) -> tuple[int, int]:
    """Make the steps ``made`` to ``steps``, the k-th to t = (k + 1) dt; how many are made then, and how the call ended.

    A tissue that is lost, or whose lumen is closed, stays as it is from then on: ``ended`` is set to the step that
    failed. After FULL nothing is lost: put the cells into larger stores and go on.

    Parameters
    ----------
    stores, ended
        (1,) or (WIDTH,): where the tissues are; RUNNING for those to go on with.
    random
        (2, k, GENERATOR): their generators of draws and of noise.
    how
        (5,): where the numbers and the board are, seen flat and as substeps see it, the substeps for it, and the rules.
    """
    numbers, rules = numbers_at(how[0]), rules_at(how[4])
    while made < steps:
        t = (made + 1) * numbers.dt
        for k in range(len(stores)):
            if ended[k] == RUNNING and is_full(store_at(stores[k]), t):
                return made, FULL
        for k in range(len(stores)):
            if ended[k] == RUNNING:
                draws, noise = generator_at(random[0], k), generator_at(random[1], k)
                apply_rules(store_at(stores[k]), t, numbers, rules, draws, noise)
        if not make_substeps(stores, ended, how):  # nobody runs any more
            return steps, DONE
        for k in range(len(stores)):
            if ended[k] == RUNNING:
                store = store_at(stores[k])
                if find_lost(store) >= 0 or is_closed(store):
                    ended[k] = made + 1
                else:
                    watch_sides(store, t)
        made += 1
    return made, DONE


@kernel
def make_substeps(stores: Integers, ended: Integers, how: Integers) -> int:
    """All substeps of one dt, without the rules: the largest number of cells of the tissues that run.

    In space they copy the tissue, which is alone, by themselves.
    """
    if store_at(stores[0]).space.dimension == SPATIAL:
        return call_substeps(how[3], how[1], stores[0], 0) if ended[0] == RUNNING else 0
    numbers, flat = numbers_at(how[0]), board_at(how[1])
    n = copy_in(stores, ended, flat, numbers, numbers.dt / numbers.substeps / numbers.mu)
    if n > 0:
        call_substeps(how[3], how[1], how[2], n)
        copy_out(flat, stores)
    return n


@kernel
def is_full(store: Store, t: float) -> bool:
    """Whether the daughters that may come at time t have no room."""
    full: bool = store.sizes[CELLS] + count_due(store, t) > len(store.cells.x)
    return full


@kernel
def apply_rules(store: Store, t: float, numbers: Numbers, rules: Rules, draws: Generator, noise: Generator) -> None:
    """What happens once per dt before the cells move: divisions, EMT events, phases, rest lengths, noise or its key."""
    divide(store, t, numbers, rules, draws)
    begin_events(store, t, numbers, rules)
    set_phases(store, t, numbers)
    adapt_rest_lengths(store, t, numbers, rules)
    if numbers.noise_in_substeps:
        draw_key(noise, store.noise_key)
    else:
        add_noise(store, numbers.variance * numbers.dt, noise)


@kernel
def find_lost(store: Store) -> int:
    """The first cell whose coordinates add up to LOST in magnitude, or are not numbers; -1 if there is none."""
    cells = store.cells
    for i in range(store.sizes[CELLS]):
        nucleus, apical = abs(cells.x[i]) + abs(cells.y[i]), abs(cells.ax[i]) + abs(cells.ay[i])
        basal, deep = abs(cells.bx[i]) + abs(cells.by[i]), abs(cells.z[i]) + abs(cells.az[i]) + abs(cells.bz[i])
        if not nucleus + apical + basal + deep < LOST:  # nor if it is NaN
            return i
    return -1
