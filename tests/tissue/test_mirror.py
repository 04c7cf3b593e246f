"""No rule knows left from right: a mirrored tissue with mirrored types has the mirrored run, to rounding.

The one exception is the order of the sweeps over hard discs and basal neighbours, from left to right: of two pairs that
share a cell, the first is parted first. So cells stand apart here where runs are compared to rounding, and crowds are
compared in the mean.
"""

import math
from itertools import product

import numpy as np
import pytest

from tests.tissue import kernel_calls as kernels
from tests.tissue import states
from tests.tissue.kernel_calls import both, generators
from tests.twins.tissue.state import Tissue
from tissue.events.known import row, settled
from tissue.files.groups import first_of
from tissue.model.junctions import pairs
from tissue.runs.group import Group
from tissue.state.basal_curve import curve_numbers, ellipse
from tissue.state.cells import CONTROL, NAMED, CellLayers, Emt, emt_cells

# All cells divide at the age of 1 h, and no number is drawn that matters; hard discs are small, neighbours are free.
GIVEN = states.numbers(
    variance=0.0,
    two_daughters=1.0,
    min_cycle=1.0,
    max_cycle=1.0,
    g2=0.2,
    mitosis=0.1,
    hard_radius=0.0,
    enlarged_radius=0.0,
    max_basal_distance=50.0,
    g2_stiffening=2.0,
    freed_stiffness=0.5,
    contraction=0.3,
    substeps=40,
    junction_factor=0.25,
)
NAMED_NUMBERS = (
    GIVEN._replace(rate_aa=0.01, alpha_aa=10.0, alpha_ax=4.0, min_cycle=0.7, max_cycle=0.7),
    GIVEN._replace(rate_aa=3.0, rate_ax=1.0, alpha_bx=0.7, alpha_axb=3.0, max_cytoskeleton=2.0),
    GIVEN._replace(rate_aa=0.4, two_daughters=0.0, rate_bx=2.0),
)
STEPS = 8
# Coordinates along the tissue, which change their sign.
ALONG = ("x", "ax", "bx", "along")
# Names of cells: of two daughters the left one keeps that of the mother.
NAMES = ("id", "mother", "chain")


def mirrored(tissue, closed=False):
    """The same tissue from right to left: each number stays with its cell, each rest length with its junction."""
    n, order = len(tissue.cells.x), slice(None, None, -1)
    made = type(tissue.cells)(*(array[order].copy() for array in tissue.cells))
    for name in ALONG:
        getattr(made, name)[:] *= -1.0
    made = _with_junctions(tissue, made, lambda i: n - 1 - i, closed)
    made.emt.since_x[:] *= -1.0
    return made


def turned(tissue, first, length):
    """The same ring of this length, counted from cell ``first``: the cells before it come behind all others."""
    n = len(tissue.cells.x)
    made = type(tissue.cells)(*(np.roll(array, -first) for array in tissue.cells))
    made.along[n - first :] += length
    return _with_junctions(tissue, made, lambda i: (i - first) % n, closed=True)


def _with_junctions(tissue, made, place, closed):
    """Cells that are in other places now, with the rest lengths of their junctions, their layers and EMT cells."""
    layers = CellLayers(*(np.sort(place(layer)) for layer in tissue.layers))
    rest = {frozenset(place(np.array(ends))): length for *ends, length in junctions(tissue, closed)}
    made.rest_aa[:] = 0.0
    for i, j in zip(*pairs(made, layers, closed), strict=True):
        made.rest_aa[i] = rest[frozenset((i, j))]
    number = made.emt[made.emt >= 0]
    made.emt[made.emt >= 0] = np.arange(len(number))
    emt = Emt(*(np.ascontiguousarray(array[..., number]) for array in tissue.emt))
    return Tissue(made, layers, tissue.next_id, emt)


def junctions(tissue, closed=False):
    """The cells i and j of each junction, and its rest length, from left to right."""
    i, j = pairs(tissue.cells, tissue.layers, closed)
    return sorted(zip(i.tolist(), j.tolist(), tissue.cells.rest_aa[i].tolist(), strict=True))


def compare(one, other, closed=False, rounding=1e-10):
    """Fail unless two tissues are the same to rounding, whatever their cells are called."""
    for a, b in zip(one.layers, other.layers, strict=True):
        np.testing.assert_array_equal(a, b)
    for name, a, b in zip(one.cells._fields, one.cells, other.cells, strict=True):
        if name not in (*NAMES, "rest_aa"):
            np.testing.assert_allclose(a, b, rtol=0.0, atol=rounding, err_msg=name)
    for a, b in zip(junctions(one, closed), junctions(other, closed), strict=True):
        np.testing.assert_allclose(a, b, rtol=0.0, atol=rounding, err_msg="junctions")
    for name, a, b in zip(one.emt._fields, one.emt, other.emt, strict=True):
        np.testing.assert_allclose(a, b, rtol=0.0, atol=rounding, err_msg=name)


def tissue_of(n, seed, names=("a", "b", "s", "p", "ac")):
    """Cells of all types and ages that stand apart; every third one of the last type, with events of its own."""
    rng = np.random.default_rng(seed)
    place = 1.5 * np.arange(n) + rng.uniform(-0.3, 0.3, n)
    kind = rng.choice([CONTROL, NAMED, NAMED + 1, NAMED + 2], n)
    points = (np.column_stack((place + rng.uniform(-0.3, 0.3, n), rng.uniform(*ys, n))) for ys in ((3, 6), (7, 9)))
    fields = {
        "kind": kind,
        "moves": rng.random(n) < 0.7,
        "birth": rng.uniform(-0.9, 0.0, n),
        "cycle": np.where(kind == NAMED, 0.7, 1.0),
        **{f"rest_{name}": rng.uniform(0.2, 1.5, n) for name in ("ax", "bx", "aa")},
    }
    cells = states.tissue(*points, np.column_stack((place, np.zeros(n))), **fields)
    chosen = np.flatnonzero(kind == NAMED + 2)
    cells.emt[chosen], cells.divides[chosen] = np.arange(len(chosen)), False
    times = {name: rng.choice([0.1, 0.3, 0.5, np.inf], len(chosen)) for name in names}
    emt = emt_cells(settled(times or {"a": np.full(len(chosen), np.inf)}))
    return Tissue(cells, states.layers(n), n, emt)


def run(model, state, given=GIVEN):
    """The tissue after all steps."""
    return model.steps(state, 0, STEPS, given, *generators(0), NAMED_NUMBERS)


@both
@pytest.mark.parametrize("bridge", [False, True])
@pytest.mark.parametrize("seed", range(6))
def test_a_mirrored_tissue_has_the_mirrored_run(model, seed, bridge):
    state, given = tissue_of(24, seed), GIVEN._replace(bridge_present=bridge)
    end = run(model, state, given)
    assert len(end.cells.x) > 30
    assert np.isfinite(end.emt.onset_ab).sum() > 3
    compare(run(model, mirrored(state), given), mirrored(end))


def test_groups_at_mirrored_places_mirror_each_other():
    """Whether cells and group are odd or even; in the very middle the left one of two is chosen."""
    for cells, group, k in product(range(1, 13), range(13), range(101)):
        if group <= cells and (k != 50 or (cells - group) % 2 == 0):
            first, other = first_of(cells, group, k / 100), first_of(cells, group, 1 - k / 100)
            assert first + group == cells - other, (cells, group, k)
            assert abs(first - k / 100 * cells + group / 2) <= 0.5 + 1e-9 or first in (0, cells - group)
    assert first_of(45, 10, 0.5) == 17


def test_what_is_on_both_sides_of_a_type_relaxes_alike():
    """A junction has the mean rate of its two cells; between like cells, and none, its own to the last bit."""
    given, slow = GIVEN._replace(rate_aa=1.0), GIVEN._replace(rate_aa=0.01)
    state = kernels.upright(6, kind=[0, 0, NAMED, NAMED, 0, 0], rest_aa=0.7)
    after = kernels.apply_rules(state, 0.1, given, *generators(0), [slow]).cells.rest_aa
    kept = {rate: math.exp(-rate * given.dt) for rate in (1.0, 0.505, 0.01)}
    assert after.tolist() == [0.7 * kept[rate] for rate in (1.0, 0.505, 0.01, 0.505, 1.0, 1.0)]


# Rings


def ring_of(n, seed):
    """Cells of all types inside of a circle, with events; and its curve."""
    state, curve = tissue_of(n, seed, ("a", "b", "s", "p")), ellipse(3.0 * n, 1.0, inside=True, ring=True)
    cells, along = state.cells, 2.0 * state.cells.bx - 1.5 * (n - 1)
    (x, y), (ax, ay) = (curve.above(along + p - cells.bx, q) for p, q in ((cells.x, cells.y), (cells.ax, cells.ay)))
    bx, by = curve.above(along, np.zeros(n))
    cells = cells._replace(x=x, y=y, ax=ax, ay=ay, bx=bx, by=by, along=along)
    return state._replace(cells=cells), curve


def run_of_ring(state, curve):
    """The ring after all steps."""
    held = kernels.held(state, 4 * len(state.cells.x), curve=curve_numbers(curve))
    group = Group([held], GIVEN, [kernels.Random(*generators(0))], named=NAMED_NUMBERS)
    group.advance(0, STEPS)
    assert not group.ended.any()
    return kernels.taken(group.states[0])


@pytest.mark.parametrize("seed", range(4))
def test_a_ring_in_the_mirror(seed):
    state, curve = ring_of(40, seed)
    end = run_of_ring(state, curve)
    compare(run_of_ring(mirrored(state, closed=True), curve), mirrored(end, closed=True), closed=True)


@pytest.mark.parametrize("seed", range(4))
def test_where_a_ring_begins_does_not_matter(seed):
    """Each cell that leaves the apical layer is once the first one of the ring, and once the last one."""
    state, curve = ring_of(40, seed)
    end = run_of_ring(state, curve)
    leaving = np.flatnonzero((state.cells.emt >= 0) & np.isfinite(state.emt.at[row("a")][state.cells.emt]))
    assert len(leaving) > 3
    for cell in {*leaving.tolist(), *(leaving + 1).tolist()} - {40}:
        other = run_of_ring(turned(state, cell, curve.length), curve)
        begin = next(i for i, along in enumerate(other.cells.along) if along > curve.length / 2)
        compare(turned(end, len(end.cells.x) - begin, curve.length), other, closed=True)
