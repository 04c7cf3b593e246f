"""What two cells of different types have together: R_i + R_j, the mean of repulsions and of basal distances."""

import numpy as np
import pytest

from tests.tissue import kernel_calls as kernels
from tests.tissue import states
from tests.tissue.kernel_calls import aged, generators
from tissue.files.parameters import preset
from tissue.runs.group import Group
from tissue.state.basal_curve import curve_numbers, ellipse
from tissue.state.cells import NAMED

SHORT = {"numerics.t_end": "3 h", "numerics.keep": "1 h"}
BIG = {"types.big.cells": 9, "types.big.place": 0.3}
OWN = {"soft_radius": "7 um", "alpha_xx": 4, "max_basal_distance": "2/3 R_soft"}
# Only nuclei push each other, once.
PUSHES = states.numbers(substeps=1, variance=0.0, hard_radius=0.0, junction_factor=0.0, two_daughters=0.0)
STILL = dict.fromkeys(("stiff_ax", "stiff_bx", "stiff_axb"), 0.0)


def kinds(power):
    """The numbers of control cells and of two types, by their power of the springs."""
    given = PUSHES._replace(spring_power=power, repulsion=0.8)
    named = given._replace(soft_radius=1.6, repulsion=2.0), given._replace(soft_radius=0.4, repulsion=0.5)
    return given, named


def crowd(n, seed):
    """Cells of all types in a crowd, which do not move but by the repulsion."""
    kind = np.random.default_rng(seed).choice([0, NAMED, NAMED + 1], n)
    return aged(n, seed, kind=kind, radius=0.0, **STILL)


def moved_by_pairs(cells, given, named):
    """Where one step brings the nuclei, pair by pair."""
    of = [(given, given, *named)[k] for k in cells.kind]
    x, scale = np.stack((cells.x, cells.y)), given.dt / given.mu
    for i, one in enumerate(of):
        for j, other in enumerate(of):
            arrow = np.array((cells.x[i] - cells.x[j], cells.y[i] - cells.y[j]))
            d, reach = np.hypot(*arrow), one.soft_radius + other.soft_radius
            if 0 < d < reach:
                k = (one.repulsion + other.repulsion) / 2 * (2 / reach) ** given.spring_power
                x[:, i] += scale * k * (reach - d) * arrow / d
    return x


@pytest.mark.parametrize("power", [1, 2])
@pytest.mark.parametrize("bent", [False, True])
def test_pairs_of_different_soft_discs(power, bent):
    """Alone and side by side, on a line and on a curve, as pair by pair."""
    (given, named), curve = kinds(power), curve_numbers(ellipse(300.0, 1.0, inside=True, ring=False)) if bent else None
    states_of = [crowd(n, n) for n in (40, 9, 24, 1, 33, 17, 28, 12)]
    for chosen in (states_of[:1], states_of):
        held = [kernels.held(one, **({"curve": curve} if bent else {})) for one in chosen]
        group = Group(held, given, named=named)
        group.make_substeps()
        for one, kept in zip(chosen, group.states, strict=True):
            cells = kernels.taken(kept).cells
            expected = moved_by_pairs(one.cells, given, named)
            np.testing.assert_allclose((cells.x, cells.y), expected, atol=1e-11)
            assert np.abs(expected - (one.cells.x, one.cells.y)).max() > 0.1 or len(cells.x) == 1


@pytest.mark.parametrize("closed", [False, True])
def test_basal_neighbours_are_at_most_the_mean_of_both_apart(closed):
    """One cell of each pair is far away: by half of the excess each, one pair after the other."""
    named = [PUSHES._replace(max_basal_distance=2.0)]
    given = PUSHES._replace(repulsion=0.0, max_basal_distance=1.0)
    kind = np.array([0, NAMED, NAMED, 0, 0, NAMED])
    allowed = [1.5, 2.0, 1.5, 1.0, 1.5]
    b = np.cumsum([0.0, 1.6, 1.9, 1.7, 0.9, 3.0])
    state = kernels.upright(6, kind=kind, **STILL)
    cells = state.cells._replace(bx=b.copy(), along=b.copy())
    length = b[-1] + 1.8
    curve = curve_numbers(ellipse(length, 1.0, inside=False, ring=True)) if closed else None
    group = Group(
        [kernels.held(state._replace(cells=cells), **({"curve": curve} if closed else {}))], given, named=named
    )
    group.make_substeps()
    found = kernels.taken(group.states[0]).cells
    for k, most in enumerate(allowed):
        half = max(0.0, (b[k + 1] - b[k] - most) / 2)
        b[k : k + 2] += (half, -half)
    if closed:
        half = max(0.0, (b[0] + length - b[-1] - 1.5) / 2)
        b[[0, -1]] += (-half, half)
    np.testing.assert_allclose(found.along if closed else found.bx, b, atol=1e-12)


def test_springs_and_rest_lengths_have_the_radius_of_the_type():
    """l = R_soft + eta, and eta tends to d - R_soft; in G2 the basal one to |A - B| - 2 R_soft."""
    given = states.numbers(dt=20.0, floor_rest_length=False)
    named = [given._replace(soft_radius=1.6)]
    state = kernels.upright(2, kind=NAMED, birth=[0.0, -11.3], rest_ax=0.5, rest_bx=0.5)
    after = kernels.apply_rules(state, 0.0, given, *generators(0), named).cells
    np.testing.assert_allclose(after.rest_ax, [3.0 - 1.6, 0.0], atol=1e-12)
    np.testing.assert_allclose(after.rest_bx, [5.0 - 1.6, 8.0 - 3.2], atol=1e-12)
    once = given._replace(dt=0.1, substeps=1, repulsion=0.0, junction_factor=0.0)
    group = Group([kernels.held(state)], once, named=[once._replace(soft_radius=1.6)])
    group.make_substeps()
    rest = 1.6 + 0.5
    pull = 0.1 / once.mu * 2 * 2.0 * (3.0 - rest) / rest
    np.testing.assert_allclose(kernels.taken(group.states[0]).cells.ay, 8.0 - pull, rtol=1e-12)


# From files


def test_the_unit_of_length_stays():
    """Lengths of a type in R_soft are of that of [cell]."""
    own = {
        "types.big.soft_radius": "10 um",
        "types.big.hard_radius": "1 R_soft",
        "types.big.enlarged_radius": "2 R_soft",
    }
    (found,) = preset("thesis").changed(BIG | own).named_numbers()
    assert (found.soft_radius, found.hard_radius, found.enlarged_radius) == (2.0, 1.0, 2.0)
    assert preset("thesis").numbers().soft_radius == 1.0
