"""Kernels of slices called on copies, with what changes handed back, and small tissues to call them with."""

from typing import Any, NamedTuple

import numpy as np

from tests.tissue import states as tissue_states
from tissue.events.known import settled
from tissue.kernels import kernel
from tissue.kernels.curve import evaluate, foot_of, height_of
from tissue.kernels.workspace import Workspaces
from tissue.model.basal_layer import order_basal
from tissue.model.discs import separate
from tissue.rules.slice import in_plane
from tissue.runs.compiled_rules import rules_pointer
from tissue.runs.group import Group
from tissue.state import running as store
from tissue.state.basal_curve import curve_numbers
from tissue.state.cells import CellLayers, Cells, Emt, Forces, emt_cells, no_emt
from tissue.state.numbers import numbers_pointer
from tissue.step import advance
from tissue.step.copies import copy_in, copy_out

COORDINATES = Forces._fields
# Nothing changes but by divisions, phases and forces; no second daughters.
STILL = tissue_states.numbers(variance=0.0, rate_ax=0.0, rate_bx=0.0, rate_aa=0.0, two_daughters=0.0)
ROOM = 8


class Tissue(NamedTuple):
    """What changes in a run."""

    cells: Cells
    layers: CellLayers
    next_id: int
    emt: Emt = no_emt()


class Random(NamedTuple):
    """The generators of a run, as in ``Streams``."""

    cycle: Any
    noise: Any


def held(tissue, capacity=None, curve=store.STRAIGHT):
    """A store with the tissue in it, by default with room for each cell to divide."""
    room = 2 * len(tissue.cells.x) + ROOM if capacity is None else capacity
    emt = Emt(*(array.copy() for array in tissue.emt))
    return store.new_state(
        tissue.cells, tissue.layers, tissue.next_id, emt, capacity=room, curve=curve, space=in_plane()
    )


def taken(kept):
    """The tissue in a store."""
    return Tissue(*store.contents(kept), int(kept.sizes[store.NEXT_ID]), kept.emt)


def ruled(tissue, t, numbers=STILL, seed=0, named=()):
    """The tissue after divisions, EMT events, phases, rest lengths and noise of one time."""
    kept = held(tissue)
    advance.apply_rules(kept, t, numbers_pointer(numbers, named), rules_pointer([kept]), *generators(seed))
    return taken(kept)


def make_substeps(cells, layers, numbers, key=(0, 0)):
    """The cells after all substeps of one dt; ``key``: of the noise, where it comes in substeps."""
    group = Group([held(Tissue(cells, layers, len(cells.x)))], numbers)
    group.states[0].noise_key[:] = key or 0
    assert group.make_substeps()
    return taken(group.states[0]).cells


def steps(tissue, made, wanted, numbers, draws, noise, named=()):
    """The tissue after the steps ``made`` to ``wanted``, the k-th to t = (k + 1) dt (Method 3.7)."""
    group = Group([held(tissue, 4 * len(tissue.cells.x) + ROOM)], numbers, [Random(draws, noise)], named=named)
    assert group.call(made, wanted) == (wanted, advance.DONE)
    assert not group.ended.any()
    return taken(group.states[0])


@kernel
def _sweeps(stores, ended, flat, wide, numbers, scale):
    n = copy_in(stores, ended, flat, numbers, scale)
    if len(ended) == 1:
        separate(flat, n)
        order_basal(flat, n)
    else:
        separate(wide, n)
        order_basal(wide, n)
    copy_out(flat, stores)


def swept(states, given_numbers, curve=store.STRAIGHT):
    """The cells of one tissue, or of eight, after one sweep of all projections."""
    kept, width = [held(state, curve=curve) for state in states], len(states)
    workspaces = Workspaces(max(len(one.cells.x) for one in kept), width, [[given_numbers]], np.ones(1), kept[0].curve)
    places = np.array([one.address for one in kept])
    pointer = numbers_pointer(given_numbers)
    numbers = np.full(width, pointer.address)
    _sweeps(places, np.zeros(width, np.int64), workspaces.flat, workspaces.wide, numbers, np.ones(width))
    return [taken(one).cells for one in kept]


@kernel
def _on_curve(curve, s, x, y, found):
    for k in range(len(s)):
        found[0, k], found[1, k], found[2, k], found[3, k] = evaluate(curve, s[k])
        found[4, k] = foot_of(curve, x[k], y[k]) if curve.bent else x[k]
        found[5, k] = height_of(curve, x[k], y[k])


def on_curve(curve, s, x, y):
    """The points of a curve at arclengths s (m,), its tangents; feet and heights of points: (6, m)."""
    found = np.empty((6, len(s)))
    _on_curve(curve_numbers(curve), s, x, y, found)
    return found


def generators(seed, count=2):
    """Independent generators, the same for the same seed."""
    return [np.random.default_rng(child) for child in np.random.SeedSequence(seed).spawn(count)]


def distance(a, b):
    """The largest difference of a coordinate."""
    return max(np.abs(getattr(a, name) - getattr(b, name)).max() for name in COORDINATES)


def aged(n, seed, layers_of=tissue_states.layers, **fields):
    """A random tissue of all ages: some cells are about to divide, some in G2 or mitosis."""
    rng = np.random.default_rng(seed)
    cycle = rng.uniform(10.0, 21.0, n)
    state = tissue_states.cells(n, seed, cycle=cycle, birth=-rng.uniform(0.0, 1.0, n) * cycle, **fields)
    return Tissue(state, layers_of(n), n)


def freed(n):
    """Layers that some cells have left: the first, the last, some between."""
    return tissue_states.layers(n, apical=[i for i in range(n) if i % 5], basal=[i for i in range(n - 1) if i % 4 != 2])


def upright(n=1, height=8.0, nucleus=5.0, spacing=3.0, **fields):
    """Straight cells side by side, age 0, cycle 12."""
    place = spacing * np.arange(n)
    points = (np.column_stack((place, np.full(n, y))) for y in (nucleus, height, 0.0))
    return Tissue(tissue_states.tissue(*points, **{"cycle": 12.0, **fields}), tissue_states.layers(n), n)


def with_emt(state, cells, **times):
    """The tissue with these EMT cells, with times of events by name, the same or each its own; others never begin."""
    m = len(cells)
    state.cells.emt[cells] = np.arange(m)
    state.cells.divides[cells] = False
    at = settled({name: np.broadcast_to(np.float64(time), m).copy() for name, time in {"a": np.inf, **times}.items()})
    return state._replace(emt=emt_cells(at))
