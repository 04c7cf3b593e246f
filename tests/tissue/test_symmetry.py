"""No rule knows a direction: a tissue that is mirrored, turned or moved has the run of its image, to rounding.

The one exception is the order of the sweeps over hard discs and basal neighbours: of two pairs that share a cell, the
first is parted first. So cells stand apart here, or hard discs are small and basal neighbours free.
"""

import math
from dataclasses import replace
from itertools import product

import numpy as np
import pytest

from tests.tissue import kernel_calls as kernels
from tests.tissue import states
from tests.tissue.kernel_calls import Tissue, generators
from tests.tissue.space.calls import SURFACES, feet, make_substeps, random_tissue
from tests.tissue.space.in_space import of_surface, parameters
from tests.twins.tissue import SpaceTissue, Steps, distance, mapped
from tissue.events.known import row, settled
from tissue.files.groups import first_of
from tissue.files.parameters import Parameters, preset
from tissue.model.junctions import pairs
from tissue.runs.group import Group
from tissue.runs.simulate import simulate
from tissue.state.basal_curve import curve_numbers, ellipse
from tissue.state.cells import CONTROL, NAMED, CellLayers, Emt, emt_cells
from tissue.state.running import STRAIGHT

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
    return _with_junctions(tissue, made, lambda i: n - 1 - i, closed)


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


def ring_of(n, seed):
    """Such cells inside of a circle, and its curve."""
    state, curve = tissue_of(n, seed, ("a", "b", "s", "p")), ellipse(3.0 * n, 1.0, inside=True, ring=True)
    cells, along = state.cells, 2.0 * state.cells.bx - 1.5 * (n - 1)
    (x, y), (ax, ay) = (curve.above(along + p - cells.bx, q) for p, q in ((cells.x, cells.y), (cells.ax, cells.ay)))
    bx, by = curve.above(along, np.zeros(n))
    cells = cells._replace(x=x, y=y, ax=ax, ay=ay, bx=bx, by=by, along=along)
    return state._replace(cells=cells), curve


def run(state, given=GIVEN, curve=STRAIGHT):
    """The tissue after all steps."""
    held = kernels.held(state, 4 * len(state.cells.x), curve=curve)
    group = Group([held], given, [kernels.Random(*generators(0))], named=NAMED_NUMBERS)
    group.advance(0, STEPS)
    assert not group.ended.any()
    return kernels.taken(group.states[0])


@pytest.mark.parametrize("bridge", [False, True])
@pytest.mark.parametrize("seed", range(6))
def test_a_mirrored_tissue_has_the_mirrored_run(seed, bridge):
    state, given = tissue_of(24, seed), GIVEN._replace(bridge_present=bridge)
    end = run(state, given)
    assert len(end.cells.x) > 30
    assert np.isfinite(end.emt.onset_ab).sum() > 3
    compare(run(mirrored(state), given), mirrored(end))


@pytest.mark.parametrize("seed", range(4))
def test_a_ring_in_the_mirror_or_with_another_beginning(seed):
    """Each cell that leaves the apical layer is once the first one of the ring, and once the last one."""
    state, curve = ring_of(40, seed)
    numbers = curve_numbers(curve)
    end = run(state, curve=numbers)
    compare(run(mirrored(state, closed=True), curve=numbers), mirrored(end, closed=True), closed=True)
    leaving = np.flatnonzero((state.cells.emt >= 0) & np.isfinite(state.emt.at[row("a")][state.cells.emt]))
    assert len(leaving) > 3
    for cell in {*leaving.tolist(), *(leaving + 1).tolist()} - {40}:
        other = run(turned(state, cell, curve.length), curve=numbers)
        begin = next(i for i, along in enumerate(other.cells.along) if along > curve.length / 2)
        compare(turned(end, len(end.cells.x) - begin, curve.length), other, closed=True)


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
    after = kernels.ruled(state, 0.1, given, named=[slow]).cells.rest_aa
    kept = {rate: math.exp(-rate * given.dt) for rate in (1.0, 0.505, 0.01)}
    assert after.tolist() == [0.7 * kept[rate] for rate in (1.0, 0.505, 0.01, 0.505, 1.0, 1.0)]


def tube(seed, angle=0.0, dts=5):
    """The points (3, 2, n) of a tube of equal cells, or with random springs, after some dt, turned back."""
    n, perimeter = 60, 120.0
    curve, radius = ellipse(perimeter, 1.0, inside=True, ring=True), perimeter / (2 * math.pi)
    s = angle * radius + perimeter / n * np.arange(n)
    points = [np.column_stack(curve.above(s, np.full(n, height))) for height in (4.0, 8.0, 0.0)]
    cells = states.tissue(*points, along=s)
    if seed is not None:
        cells.stiff_ax[:] *= np.random.default_rng(seed).uniform(0.5, 2.0, n)
    held = kernels.held(Tissue(cells, states.layers(n), n), curve=curve_numbers(curve))
    group = Group([held], states.numbers(variance=0.0, max_basal_distance=2.0))
    for _ in range(dts):
        assert group.make_substeps()
    cells, c, sine = kernels.taken(group.states[0]).cells, math.cos(angle), math.sin(angle)
    found = np.array([[cells.x, cells.y - radius], [cells.ax, cells.ay - radius], [cells.bx, cells.by - radius]])
    return np.einsum("ij,kjn->kin", [[c, sine], [-sine, c]], found)


def test_a_symmetric_tube_stays_symmetric_and_a_turned_one_turns():
    far = np.hypot(*tube(None, dts=50).transpose(1, 0, 2))
    assert np.ptp(far, axis=1).max() < 1e-12
    assert abs(far[1, 0] - (120 / (2 * math.pi) - 8.0)) > 0.1  # so the tube did not just stand still
    assert np.abs(tube(3) - tube(3, angle=0.9)).max() < 1e-10


# In space: substeps

# One dt of 40 substeps: rounding grows by the dynamics.
ROUNDING = 1e-12


def rotation(x, y, z):
    """The matrix of the rotation by the vector (Rodrigues)."""
    angle = float(np.hypot(np.hypot(x, y), z))
    k = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]]) / angle
    return np.eye(3) + np.sin(angle) * k + (1.0 - np.cos(angle)) * k @ k


# Surface, matrix and shift of an image.
SAME = np.eye(3)
MAPS = {
    "a plane shifted": ("open plane", SAME, (3.7, 0.0, -11.2)),
    "a plane turned": ("open plane", rotation(0.0, 0.7, 0.0), (0.0, 0.0, 0.0)),
    "a plane mirrored": ("open plane", np.diag([1.0, 1.0, -1.0]), (0.0, 0.0, 0.0)),
    "a periodic plane shifted": ("periodic plane", SAME, (2.9, 0.0, -31.7)),
    "a tight plane shifted by a period": ("tight plane", SAME, (4.01, 0.0, -4.3)),
    "a periodic plane mirrored": ("periodic plane", np.diag([-1.0, 1.0, 1.0]), (0.0, 0.0, 0.0)),
    "a cylinder turned": ("cylinder", rotation(0.0, 0.0, 2.1), (0.0, 0.0, 0.0)),
    "a cylinder shifted": ("cylinder", SAME, (0.0, 0.0, 5.3)),
    "a cylinder mirrored": ("open cylinder", np.diag([1.0, 1.0, -1.0]), (0.0, 0.0, 0.0)),
    "a sphere turned": ("sphere", rotation(0.4, -2.0, 0.8), (0.0, 0.0, 0.0)),
    "the inside of a sphere turned": ("inside of a sphere", rotation(1.1, 0.0, 0.0), (0.0, 0.0, 0.0)),
    "a sphere mirrored": ("sphere", np.diag([1.0, -1.0, 1.0]), (0.0, 0.0, 0.0)),
}


@pytest.mark.parametrize("name", MAPS)
def test_steps_go_with_the_symmetries(name):
    """To rounding: balls keep the order of the cells, sums have another. Each cell may lie in a period of its own."""
    where, matrix, shift = MAPS[name]
    surface = SURFACES[where]
    state, steps = random_tissue(120, 11, surface), Steps(0.00125, 4, surface=surface)
    periods = np.array([[surface.period_x], [0.0], [surface.period_z]])
    away = np.random.default_rng(0).integers(-3, 4, (3, 120)) * np.where(np.isfinite(periods), periods, 0.0)
    made = make_substeps(state, steps)
    for image in (lambda p: matrix @ p + np.array(shift)[:, None], lambda p: p + away):
        assert distance(make_substeps(mapped(state, image), steps), mapped(made, image)) < ROUNDING
    assert distance(made, state) > 1e-2


def section(cells, numbers):
    """The slice in the plane z = 0: chains of junctions and of basal neighbours."""
    n = len(cells.x)
    chain = np.column_stack((np.arange(n - 1), np.arange(1, n)))
    flat, on, off = 0.0 * cells.x, np.ones(n), np.zeros(n)
    points = (np.array([*pair, flat]) for pair in ((cells.x, cells.y), (cells.ax, cells.ay), (cells.bx, cells.by)))
    k = numbers.junction_factor * (cells.stiff_aa[:-1] + cells.stiff_aa[1:]) / 2
    stiff = cells.stiff_ax, cells.stiff_bx, cells.stiff_axb
    lengths = 1 + cells.rest_ax, 1 + cells.rest_bx
    return SpaceTissue(*points, cells.radius, *stiff, *lengths, on, on, off, chain, cells.rest_aa[:-1], k, chain)


@pytest.mark.parametrize(("name", "seed", "substeps"), [("published", 0, 40), ("published", 1, 40), ("thesis", 2, 8)])
def test_the_planar_limit_is_the_step_of_two_dimensions(name, seed, substeps):
    """From the start of a run, and with the published parameters after an hour.

    In these substeps no basal point meets another, so that their order (C4) never comes up: it is no constraint here.
    """
    given = preset(name).changed({"numerics.t_end": "1 h", "numerics.keep": "1 h"})
    numbers = given.numbers()
    h = numbers.dt / numbers.substeps
    numbers = numbers._replace(dt=substeps * h, substeps=substeps)
    for frame in simulate(given, seed).frames[: 1 if name == "thesis" else 2]:
        expected = kernels.make_substeps(frame.cells, frame.layers, numbers)
        steps = Steps(h, substeps, numbers.mu, numbers.spring_power, numbers.repulsion, numbers.max_basal_distance)
        made = make_substeps(section(frame.cells, numbers), steps)
        found = {"x": made.x[0], "y": made.x[1], "ax": made.a[0], "ay": made.a[1], "bx": made.b[0], "by": made.b[1]}
        for field, line in found.items():
            np.testing.assert_allclose(line, getattr(expected, field), rtol=0.0, atol=ROUNDING)
        np.testing.assert_array_equal([made.x[2], made.a[2], made.b[2]], 0.0)
        assert abs(expected.x - frame.cells.x).max() > 1e-2


# In space: runs. The direction of a division turns with a cylinder; sheets and spheres are turned without divisions

QUIET = {
    "tissue__diffusion": "0 um^2/h",
    "cell__hard_radius": "1e-3 R_soft",
    "cell__enlarged_radius": "1e-3 R_soft",
    "tissue__max_basal_distance": "5 R_soft",
    "start__nuclei": "own_basal",
    "types__slow__cells": 20,
    "types__slow__place": "scattered",
    "types__slow__rate_aa": "0.01 1/h",
    "types__slow__alpha_aa": 20,
    "types__leaving__cells": 6,
    "types__leaving__place": "scattered",
    "types__leaving__divides": False,
    "types__leaving__rate_aa": "5 1/h",
    "types__leaving__a": "0.5 h",
    "types__leaving__b": "0.5 h to 1 h",
    "types__leaving__p": "1 h",
    "numerics__t_end": "1.5 h",
}
STAYS, OUTSIDE = {"tissue__two_daughters": 0}, {"layer__side": "outside"}
TURNS = {
    "cylinder, with divisions": ("cylinder", OUTSIDE, (0.0, 0.0, 2.0)),
    "cylinder upside down": ("cylinder", OUTSIDE | STAYS, (np.pi, 0.0, 0.0)),
    "open sheet": ("open", STAYS, (0.0, 0.7, 0.0)),
    "periodic sheet by half a turn": ("plane", STAYS, (0.0, np.pi, 0.0)),
    "sphere": ("sphere", STAYS, (0.4, -1.1, 0.8)),
}


def points_of(cells):
    """X, A and B, (3, 3, n)."""
    return np.array([[getattr(cells, letter + axis) for axis in "xyz"] for letter in ("", "a", "b")])


@pytest.mark.parametrize("name", TURNS)
def test_a_turned_tissue_has_the_turned_run(name, monkeypatch):
    surface, changes, turn = TURNS[name]
    given, lattice = of_surface(surface, **{**QUIET, **changes}), Parameters.lattice
    matrix = rotation(*turn)

    def final(rotated):
        """The end of the run from a lattice out of order: in order, edges would be as long as others."""

        def basal(parameters):
            found = lattice(parameters)
            moved = found.basal + 0.1 * found.spacing * np.random.default_rng(0).uniform(-1, 1, found.basal.shape)
            points = feet(found.surface, moved.T).T
            return replace(found, basal=np.ascontiguousarray(rotated @ points))

        monkeypatch.setattr(Parameters, "lattice", basal)
        return simulate(given, 1).final

    frame, other = final(np.eye(3)), final(matrix)
    assert (frame.cells.events[frame.cells.kind == NAMED + 1] > 0).all()
    assert (len(frame.cells.x) > given.tissue.cells) == ("with divisions" in name)
    np.testing.assert_allclose(
        points_of(other.cells), np.einsum("ij,ajn->ain", matrix, points_of(frame.cells)), atol=1e-9
    )
    for rest in ("rest_ax", "rest_bx"):
        np.testing.assert_allclose(getattr(other.cells, rest), getattr(frame.cells, rest), atol=1e-9)
    one, two = (
        dict(zip(map(tuple, mesh.edges.tolist()), mesh.rest.tolist(), strict=True))
        for mesh in (frame.sheets.apical, other.sheets.apical)
    )
    assert one.keys() == two.keys()
    assert max(abs(one[ends] - two[ends]) for ends in one) < 1e-9
    assert np.ptp(list(one.values())) > 0.1


# Neither noise nor a phase in which a cell is larger, and nuclei that do not touch at the start.
CALM = {
    "tissue__diffusion": "0 um^2/h",
    "cell__g2": "0 h",
    "cell__mitosis": "0 h",
    "tissue__two_daughters": 0,
    "tissue__apical_spacing": "0.8 R_soft",
    "tissue__basal_spacing": "0.8 R_soft",
    "tissue__max_basal_distance": "0.8 R_soft",
    "start__nuclei": "own_basal",
    "start__nuclei_height": [0.5, 0.5],
}


def test_a_symmetric_sheet_stays_symmetric():
    """Each cell of a periodic lattice is as any other: springs, junctions and repulsion have no direction."""
    frames = simulate(parameters(**CALM), 0).frames
    start, cells = frames[0].cells, frames[-1].cells
    for name in ("y", "ay", "rest_ax"):
        assert np.ptp(getattr(cells, name)) < 1e-9, name
    for now, then in ((cells.x, start.bx), (cells.z, start.bz), (cells.ax, start.bx), (cells.az, start.bz)):
        assert np.abs(now - then).max() < 1e-9
    assert np.abs(cells.ay - start.ay).max() > 0.1
