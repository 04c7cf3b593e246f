"""Kernels of the tissue called like their twins, on copies, with what changes handed back; and compared with them."""

import sys
from typing import Any, NamedTuple

import numpy as np
import pytest

from tests.tissue import states as tissue_states
from tests.twins.tissue import steps as twins
from tests.twins.tissue.state import Tissue
from tissue.events.known import settled
from tissue.kernels import kernel
from tissue.kernels.curve import evaluate, foot_of, height_of
from tissue.kernels.workspace import Workspaces
from tissue.model import measures
from tissue.model.basal_layer import order_basal
from tissue.model.discs import separate
from tissue.rules.slice import in_plane
from tissue.runs.compiled_rules import rules_pointer
from tissue.runs.group import Group
from tissue.state import running as store
from tissue.state.basal_curve import curve_numbers
from tissue.state.cells import Emt, Forces, emt_cells
from tissue.state.numbers import numbers_pointer
from tissue.step import advance
from tissue.step.copies import copy_in, copy_out

COORDINATES = Forces._fields
MOBILE = COORDINATES[:5]  # by is 0 on the basal line
# Coordinates are about 10: one rounding is 1e-15. Roots of the kernels are accurate to 2e-13, and nothing moves by more
# than 0.2 in a substep.
SUBSTEP = 1e-13
# What neighbouring states differ by, to see how the dynamics part them: far above rounding, far below all lengths.
NEAR_BY = 1e-8
# Nothing changes but by divisions, phases and forces; no second daughters.
STILL = tissue_states.numbers(variance=0.0, rate_ax=0.0, rate_bx=0.0, rate_aa=0.0, two_daughters=0.0)
ROOM = 8


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


def apply_rules(tissue, t, numbers, draws, noise, named=()):
    """As ``twins.apply_rules``."""
    kept = held(tissue)
    advance.apply_rules(kept, t, numbers_pointer(numbers, named), rules_pointer([kept]), draws, noise)
    return taken(kept)


def make_substeps(cells, layers, numbers, noise):
    """As ``twins.make_substeps``, without noise: of this the kernel has a key from the rules."""
    assert noise is None
    group = Group([held(Tissue(cells, layers, len(cells.x)))], numbers)
    assert group.make_substeps()
    return taken(group.states[0]).cells


def steps(tissue, made, wanted, numbers, draws, noise, named=()):
    """As ``twins.steps``."""
    group = Group([held(tissue, 4 * len(tissue.cells.x) + ROOM)], numbers, [Random(draws, noise)], named=named)
    assert group.call(made, wanted) == (wanted, advance.DONE)
    assert not group.ended.any()
    return taken(group.states[0])


def measured(tissue):
    """All measurements of a tissue."""
    return measures.measure(held(tissue))


def together(states, wanted, given_numbers, seeds, named=()):
    """The states after steps made side by side; ``ended`` of each."""
    room = 4 * max(len(state.cells.x) for state in states)
    random = [Random(*generators(seed)) for seed in seeds]
    group = Group([held(state, room) for state in states], given_numbers, random, named=named)
    assert group.call(0, wanted) == (wanted, advance.DONE)
    return [taken(kept) for kept in group.states], group.ended


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
def _on_curve(curve, s, found):
    for k in range(len(s)):
        found[0, k], found[1, k], found[2, k], found[3, k] = evaluate(curve, s[k])


def on_curve(curve, s):
    """The points of a curve at arclengths s (m,), and its tangents: (4, m)."""
    found = np.empty((4, len(s)))
    _on_curve(curve_numbers(curve), s, found)
    return found


@kernel
def _feet_and_heights(curve, x, y, found):
    for k in range(len(x)):
        found[0, k] = foot_of(curve, x[k], y[k]) if curve.bent else x[k]
        found[1, k] = height_of(curve, x[k], y[k])


def feet_and_heights(curve, x, y):
    """The arclengths of the nearest points of a curve, and the distances to it: (2, m)."""
    found = np.empty((2, len(x)))
    _feet_and_heights(curve_numbers(curve), x, y, found)
    return found


def generators(seed, count=2):
    """Independent generators, the same for the same seed."""
    return [np.random.default_rng(child) for child in np.random.SeedSequence(seed).spawn(count)]


def distance(a, b):
    """The largest difference of a coordinate."""
    return max(np.abs(getattr(a, name) - getattr(b, name)).max() for name in COORDINATES)


def same_events(a, b):
    """Whether all that rules decide, and no position enters, is the same bit for bit."""
    fields = ("stiff_aa", "radius", "birth", "cycle", "moves", "divides", "id", "mother", "emt", "events", "kind")
    return all(np.array_equal(getattr(a.cells, name), getattr(b.cells, name)) for name in fields) and all(
        np.array_equal(*pair) for pair in zip(a.layers, b.layers, strict=True)
    )


def aged(n, seed, layers_of=tissue_states.layers, **fields):
    """A random tissue of all ages: some cells are about to divide, some in G2 or mitosis."""
    rng = np.random.default_rng(seed)
    cycle = rng.uniform(10.0, 21.0, n)
    state = tissue_states.cells(n, seed, cycle=cycle, birth=-rng.uniform(0.0, 1.0, n) * cycle, **fields)
    return Tissue(state, layers_of(n), n)


def freed(n):
    """Layers that some cells have left: the first, the last, some between."""
    return tissue_states.layers(n, apical=[i for i in range(n) if i % 5], basal=[i for i in range(n - 1) if i % 4 != 2])


def compared(state, given_numbers, wanted, seed=0, named=()):
    """The same steps by kernels and by twins, equal to rounding; the result of the twins.

    Rounding of each substep may grow as much as the distance of two neighbouring states grows from start to end.
    """
    made = steps(state, 0, wanted, given_numbers, *generators(seed), named)
    expected = twins.steps(state, 0, wanted, given_numbers, *generators(seed), named)
    beside = twins.steps(_shaken(state, seed), 0, wanted, given_numbers, *generators(seed), named)
    growth = max(1.0, distance(beside.cells, expected.cells) / NEAR_BY)
    assert same_events(made, expected)
    assert made.next_id == expected.next_id
    allowed = SUBSTEP * wanted * given_numbers.substeps * growth
    np.testing.assert_array_less(distance(made.cells, expected.cells), allowed)
    return expected


def _shaken(state, seed):
    rng = np.random.default_rng(seed)
    moved = {name: getattr(state.cells, name) + NEAR_BY * rng.uniform(-1.0, 1.0, len(state.cells.x)) for name in MOBILE}
    return state._replace(cells=state.cells._replace(**moved))


HEAPS = ("square", "column", "row", "two heaps")


def heap(rng, n, size, kind):
    """Discs that overlap in heaps: anywhere in a square, in a column, in a row, or in two heaps far apart."""
    x, y = rng.uniform(0.0, size, (2, n))
    if kind == "column":
        x[:] = 1.0
    elif kind == "row":
        y[:] = 1.0
    elif kind == "two heaps":
        x[::2] += 5.0
    return tissue_states.tissue(
        np.column_stack((x, y)),
        np.column_stack((x, y + 4.0)),
        np.column_stack((x, 0.0 * y)),
        radius=rng.choice([1 / 3, 0.7], n),
    )


def upright(n=1, height=8.0, nucleus=5.0, spacing=3.0, **fields):
    """Straight cells side by side, age 0, cycle 12."""
    place = spacing * np.arange(n)
    points = (np.column_stack((place, np.full(n, y))) for y in (nucleus, height, 0.0))
    return Tissue(tissue_states.tissue(*points, **{"cycle": 12.0, **fields}), tissue_states.layers(n), n)


def with_emt(state, cells, **times):
    """The tissue with these EMT cells, all with the same times of events by name; the others never begin."""
    m = len(cells)
    state.cells.emt[cells] = np.arange(m)
    state.cells.divides[cells] = False
    at = settled({name: np.full(m, time) for name, time in {"a": np.inf, **times}.items()})
    return state._replace(emt=emt_cells(at))


both = pytest.mark.parametrize("model", [sys.modules[__name__], twins], ids=["kernels", "twins"])
