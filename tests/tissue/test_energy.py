"""The energy against the formulas typed out, the forces against the energy, and what mechanics asks of both."""

from itertools import pairwise

import numpy as np
import pytest

import dincl
from tests.tissue.space.calls import SURFACES, random_tissue
from tests.tissue.states import cells, layers, numbers, tissue
from tests.twins.tissue import Steps, elastic
from tissue.model.energy import Parts, energy, forces, forces_of, parts, parts_of
from tissue.state.basal_curve import LINE, ellipse
from tissue.state.cells import Forces

STEP = 1e-30
TUBE = ellipse(40.0, 1.0, inside=True, ring=True)
PARTS = Parts._fields
COORDINATES = Forces._fields
anywhere = pytest.mark.parametrize("seed", range(6))
each_part = pytest.mark.parametrize("part", [*PARTS, "all"])
each_curve = pytest.mark.parametrize("curve", [LINE, TUBE], ids=["line", "tube"])
each_power = pytest.mark.parametrize("power", [1, 2])


def wild(seed, n=9):
    """A state like no tissue: points anywhere, layers of some cells in any order, the others in two chains."""
    rng = np.random.default_rng(seed)
    state = cells(n, seed)._replace(**{name: rng.uniform(-2.0, 2.0, n) for name in COORDINATES})
    inside, basal = rng.permutation(n), rng.permutation(n)[: n - 3]
    state.chain[np.sort(inside[n - 5 :])] = 3, 8, 8, 3, 3
    return state, layers(n, apical=inside[: n - 5], basal=basal)


def only(part, state, given):
    """The state and the numbers with all stiffnesses zero but those of one part."""
    if part == "all":
        return state, given
    off = {f"stiff_{name}": 0.0 * state.x for name in ("ax", "bx", "axb", "aa") if name != part}
    return state._replace(**off), given._replace(repulsion=given.repulsion * (part == "xx"))


def slope(state, network, given, curve, name, k):
    """dW/d(coordinate) of cell k by a complex step: exact to rounding, there is no difference to cancel."""
    moved = getattr(state, name).astype(complex)
    moved[k] += STEP * 1j
    return energy(state._replace(**{name: moved}), network, given, curve).imag / STEP


def joined(state, network, curve):
    """The junctions: of the layer, of a closed one that of its ends, and of each chain."""
    for line in (network.apical, *(np.flatnonzero(state.chain == number) for number in {*state.chain} - {0})):
        yield from pairwise(line)
    if curve.ring:
        yield network.apical[-1], network.apical[0]


def typed_out(state, network, given, curve):
    """(3.9)-(3.13) in units of R_soft, cell by cell and pair by pair."""
    n = len(state.x)
    x, a, b = (np.column_stack(part) for part in ((state.x, state.y), (state.ax, state.ay), (state.bx, state.by)))
    w = dict.fromkeys(PARTS, 0.0)
    for i in range(n):
        l_ax, l_bx = 1 + state.rest_ax[i], 1 + state.rest_bx[i]
        w["ax"] += state.stiff_ax[i] / l_ax**given.spring_power * (np.linalg.norm(x[i] - a[i]) - l_ax) ** 2
        w["bx"] += state.stiff_bx[i] / l_bx**given.spring_power * (np.linalg.norm(x[i] - b[i]) - l_bx) ** 2
        u, v = a[i] - x[i], b[i] - x[i]
        w["axb"] += state.stiff_axb[i] * (u @ v / (np.linalg.norm(u) * np.linalg.norm(v)) + 1)
        for j in range(i):
            d = np.linalg.norm(x[i] - x[j])
            w["xx"] += given.repulsion / 2 * (d - 2) ** 2 if d <= 2 else 0.0
    for i, j in joined(state, network, curve):
        mean = (state.stiff_aa[i] + state.stiff_aa[j]) / 2
        w["aa"] += given.junction_factor * mean / 2 * (np.linalg.norm(a[i] - a[j]) - state.rest_aa[i]) ** 2
    return w


@anywhere
@each_power
@each_curve
def test_energy_is_the_formulas(seed, power, curve):
    for state, network in (wild(seed), (cells(30, seed), layers(30))):
        given = numbers(spring_power=power, junction_factor=1.7, repulsion=0.6)
        expected = typed_out(state, network, given, curve)
        assert parts(state, network, given, curve)._asdict() == pytest.approx(expected, rel=1e-13)
        assert energy(state, network, given, curve) == pytest.approx(sum(expected.values()), rel=1e-13)
        assert min(expected.values()) > 0


@anywhere
@each_power
@each_part
@each_curve
def test_forces_are_the_slope_of_the_energy(seed, power, part, curve):
    for drawn, network in (wild(seed), (cells(9, seed), layers(9))):
        state, given = only(part, drawn, numbers(spring_power=power, junction_factor=1.7, repulsion=0.6))
        found = forces(state, network, given, curve)
        largest = np.abs(found).max()
        assert largest > 0
        for name in COORDINATES:
            exact = [-slope(state, network, given, curve, name, k) for k in range(9)]
            assert getattr(found, name) == pytest.approx(exact, abs=1e-10 * largest)


@pytest.mark.parametrize("name", ["open plane", "tight plane", "cylinder"])
@each_power
def test_forces_in_space_are_the_slope_of_the_energy(name, power):
    steps, state = Steps(power=power, surface=SURFACES[name]), random_tissue(20, 3, SURFACES[name])
    points, of = np.array([state.x, state.a, state.b]), elastic(state, steps)
    slopes = np.zeros(points.shape)
    for place in np.ndindex(points.shape):
        shifted = points.astype(complex)
        shifted[place] += 1j * STEP
        slopes[place] = sum(parts_of(*shifted, of, steps.surface)).imag / STEP
    found = forces_of(*points, of, steps.surface)
    np.testing.assert_allclose(found, -slopes, rtol=0.0, atol=1e-12 * abs(slopes).max())
    if name == "tight plane":  # cells are where their images are
        images = points + np.array([steps.surface.period_x, 0.0, -steps.surface.period_z])[:, None] * (
            np.arange(20) % 2
        )
        moved = forces_of(*images, of, steps.surface)
        np.testing.assert_allclose(moved, found, rtol=0.0, atol=1e-12 * abs(slopes).max())


def test_cost_does_not_grow_with_the_number_of_all_pairs():
    """40,000 cells: the table of all pairs would not fit into the memory of a small machine."""
    row, copies = cells(40, 5), 1000
    shift = np.repeat(11.0 * np.arange(copies), 40)
    many = row._replace(**{name: np.tile(array, copies) for name, array in row._asdict().items()})
    many = many._replace(x=many.x + shift, ax=many.ax + shift, bx=many.bx + shift)
    bare, given = only("xx", many, numbers())
    one = parts(row, layers(40), given).xx
    assert energy(bare, layers(40_000), given) == pytest.approx(copies * one, rel=1e-9)


BAD = {
    "nan": ({"ay": [0.0, np.nan]}, "a has coordinates that are not finite"),
    "infinite": ({"x": [np.inf, 0.0]}, "x has coordinates that are not finite"),
    "nuclei met": ({"x": [1.0, 1.0], "y": [2.0, 2.0]}, "nuclei of cells 1 and 0 lie on one point"),
    "apical met": ({"ax": [1.0, 1.0], "ay": [7.0, 7.0]}, "apical points of cells 0 and 1 lie on one point"),
    "nucleus on apical": ({"x": [0.0, 1.0], "y": [3.0, 5.0]}, "nucleus and apical point of cell 1 lie on one point"),
    "nucleus on basal": ({"x": [0.0, 3.0], "y": [0.0, 3.0]}, "nucleus and basal point of cell 0 lie on one point"),
    "no rest length": ({"rest_bx": [0.0, -1.0]}, "rest_bx = -1.0: must be above -1"),
}


@pytest.mark.parametrize("case", BAD)
@pytest.mark.parametrize("function", [parts, energy, forces])
def test_bad_states_are_refused(case, function):
    change, message = BAD[case]
    good = tissue([[0.0, 2.5], [1.0, 2.5]], [[0.0, 5.0], [1.0, 5.0]], [[0.0, 0.0], [1.0, 0.0]])
    function(good, layers(2), numbers())
    bad = good._replace(**{name: np.array(values) for name, values in change.items()})
    with pytest.raises(dincl.InvalidProblem, match=message):
        function(bad, layers(2), numbers())
