"""The substeps of a slice: forces, constraints and noise worked out by hand on a few cells (sections 2.2.6 and 2.2.7 of
chapter 3); crowds equal the plain twins, projections bit for bit, and no contact is overlooked.
"""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import stats

from tests.tissue import kernel_calls as kernels
from tests.tissue import states
from tests.tissue.bits import same_cells
from tests.tissue.kernel_calls import COORDINATES, STILL, Tissue, aged, distance, freed, make_substeps, upright
from tests.tissue.states import cells, layers, numbers, tissue
from tests.twins import tissue as twins
from tissue.files.parameters import preset
from tissue.kernels.workspace import LOST, Workspaces
from tissue.model.discs import separate_all
from tissue.runs.group import Group
from tissue.state.basal_curve import curve_numbers, ellipse
from tissue.state.running import STRAIGHT
from tissue.step.advance import FULL

# With fixed seeds a test either passes always or never; a sound one fails for one seed in a thousand.
RARE = 1e-3
# Coordinates are about 10: one rounding is 1e-15. Roots of the kernels are accurate to 2e-13, and nothing moves by more
# than 0.2 in a substep.
SUBSTEP = 1e-13
OFF = dict.fromkeys(("stiff_ax", "stiff_bx", "stiff_axb"), 0.0)
CIRCLE = curve_numbers(ellipse(60.0, 1.0, inside=True, ring=True))
PRESETS = pytest.mark.parametrize("name", ["thesis", "published"])


def stepped(state, given=STILL):
    """The cells after one substep of h = 0.01 with h / mu = 0.1 and nothing else."""
    return make_substeps(state.cells, state.layers, given._replace(dt=0.01, mu=0.1, substeps=1))


def moves(before, after):
    """How far each point of cell 0 moved, by name, where it moved at all."""
    steps = {name: getattr(after, name)[0] - getattr(before, name)[0] for name in COORDINATES}
    return {name: step for name, step in steps.items() if step}


# 2.2.6 Forces: displacements -(h / mu) grad W with h / mu = 0.1

SPRING = {"x": 0.6, "y": 0.8, "ax": -0.6, "ay": -0.8}
PUSHED = {"x": 0.12, "y": 0.16, "bx": -0.12}
RIGHT_ANGLE = {"ax": -0.4, "by": -0.2, "x": 0.4, "y": 0.2}


@pytest.mark.parametrize(
    ("points", "fields", "basal", "power", "expected"),
    [
        # |X - A| = 5, l = 2, alpha = 3: the force 2 alpha (5 - 2) / l^p is 9 or 4.5, in the direction (3, 4) / 5
        (((0, 0), (3, 4), (0, -7)), {"rest_ax": 1.0, "stiff_ax": 3.0}, [0], 1, {k: 0.9 * v for k, v in SPRING.items()}),
        (
            ((0, 0), (3, 4), (0, -7)),
            {"rest_ax": 1.0, "stiff_ax": 3.0},
            [0],
            2,
            {k: 0.45 * v for k, v in SPRING.items()},
        ),
        # |X - B| = 5, l = 10, alpha = 2: the force 2 alpha (5 - 10) / l = -2 pushes; the line takes up its y
        (((3, 4), (3, 9), (0, 0)), {"rest_bx": 9.0, "stiff_bx": 2.0}, [0], 1, PUSHED),
        (((3, 4), (3, 9), (0, 0)), {"rest_bx": 9.0, "stiff_bx": 2.0}, [], 1, {**PUSHED, "by": -0.16}),
        # W = alpha (cos gamma + 1) at gamma = 90 degrees: turning moments alpha, so forces alpha / 2 and alpha / 4
        (((0, 5), (0, 7), (4, 5)), {"stiff_axb": 8.0}, [], 1, RIGHT_ANGLE),
    ],
)
def test_springs_and_bending(points, fields, basal, power, expected):
    state = Tissue(tissue(*([point] for point in points), **OFF | fields), layers(1, basal=basal), 1)
    found = moves(state.cells, stepped(state, STILL._replace(spring_power=power)))
    assert found == pytest.approx(expected, rel=1e-12, abs=1e-15)


@pytest.mark.parametrize(("gap", "push"), [(1.5, 0.5), (0.75, 1.25), (2.0, 0.0), (2.5, 0.0)])
def test_soft_repulsion_ends_at_two_radii(gap, push):
    state = upright(2, spacing=gap, **OFF, radius=0.1)
    after = stepped(state, STILL._replace(repulsion=3.0, junction_factor=0.0, max_basal_distance=9.0))
    np.testing.assert_allclose(after.x, [-0.3 * push, gap + 0.3 * push], rtol=1e-12)
    np.testing.assert_array_equal(after.y, 5.0)


@pytest.mark.parametrize(
    ("ax", "apical", "rest", "stiff", "expected"),
    [
        # Distances 3 and 1, rest lengths 1 and 2, k = 5 and 6: forces 10 together and 6 apart; cell 3 has left
        ((0, 3, 4, 5), [0, 1, 2], [1.0, 2.0, 7.0, 7.0], [2.0, 8.0, 4.0, 100.0], [1.0, 1.4, 4.6, 5.0]),
        # Cell 1 has left: its neighbours are joined, with the rest length of the left one, k of both
        ((0, 3, 6), [0, 2], [4.0, 9.0, 9.0], [3.0, 90.0, 7.0], [1.0, 3.0, 5.0]),
    ],
)
def test_junctions_pull_or_push_neighbours_of_the_apical_layer(ax, apical, rest, stiff, expected):
    n = len(ax)
    state = upright(n, **OFF, rest_aa=rest, stiff_aa=stiff)._replace(layers=layers(n, apical=apical))
    state.cells.ax[:] = ax
    after = stepped(state, STILL._replace(max_basal_distance=9.0))
    np.testing.assert_allclose(after.ax, expected, rtol=1e-12)
    np.testing.assert_array_equal(after.x, state.cells.x)


# 2.2.7 Constraints: one sweep, without forces

FREE = {**OFF, "radius": 0.5}
SWEEP = STILL._replace(junction_factor=0.0, repulsion=0.0, max_basal_distance=9.0)


@pytest.mark.parametrize(
    ("x", "y", "expected"),
    [
        ((0.0, 0.3), (5.0, 5.4), ((-0.15, 0.45), (4.8, 5.6))),  # by half of the overlap each
        # i, then j < i: (1, 0): 0, 0.5 -> -0.25, 0.75;  (2, 0): no contact;  (2, 1): 0.75, 1 -> 0.375, 1.375
        ((0.0, 0.5, 1.0), (5.0, 5.0, 5.0), ((-0.25, 0.375, 1.375), (5.0, 5.0, 5.0))),
    ],
)
def test_overlapping_discs_part(x, y, expected):
    state = upright(len(x), **FREE)
    state.cells.x[:], state.cells.y[:] = x, y
    after = stepped(state, SWEEP)
    np.testing.assert_allclose((after.x, after.y), expected, rtol=1e-14)


@pytest.mark.parametrize(
    ("bx", "basal", "largest", "expected"),
    [
        # (0, 1): 1, 0 -> 0.5, 0.5;  then the distance 2.5 of (1, 2) is brought to 2, and (2, 3) is within it
        ((1.0, 0.0, 3.0, 4.0), None, 2.0, [0.5, 0.75, 2.75, 4.0]),
        ((0.0, -5.0, 1.0), [0, 2], 0.5, [0.25, -5.0, 0.75]),  # who left the layer is not ordered
    ],
)
def test_basal_points_in_the_wrong_order_meet_then_come_near(bx, basal, largest, expected):
    state = upright(len(bx), **FREE)._replace(layers=layers(len(bx), basal=basal))
    state.cells.bx[:] = bx
    np.testing.assert_allclose(stepped(state, SWEEP._replace(max_basal_distance=largest)).bx, expected)


# 3.3 Noise


@pytest.mark.parametrize("in_substeps", [False, True])
def test_noise_has_the_variance_2_d_dt(in_substeps):
    """The sum of the squares over 2 D dt is chi-square with 2 n degrees of freedom; only nuclei move."""
    n = 400
    noisy = SWEEP._replace(
        variance=0.3, dt=0.2, substeps=5, noise_in_substeps=in_substeps, alpha_ax=0.0, hard_radius=0.1
    )
    state = upright(n, **FREE)
    moved = kernels.ruled(state, 0.2, noisy, 8).cells
    if in_substeps:
        assert moves(state.cells, moved) == {}
        moved = kernels.steps(state, 0, 1, noisy, *kernels.generators(8)).cells
    kicks = np.array((moved.x - state.cells.x, moved.y - state.cells.y)) / math.sqrt(0.3 * 0.2)
    for name in ("ax", "ay", "bx", "by"):
        np.testing.assert_array_equal(getattr(moved, name), getattr(state.cells, name))
    assert RARE < stats.chi2(2 * n).cdf((kicks**2).sum()) < 1 - RARE
    assert stats.kstest(kicks.ravel(), stats.norm.cdf).pvalue > RARE
    assert stats.pearsonr(*kicks).pvalue > RARE
    assert stats.pearsonr(kicks[0, 1:], kicks[0, :-1]).pvalue > RARE


@pytest.mark.parametrize("variance", [0.0, 0.2])
def test_substeps_and_steps_have_their_own_noise(variance):
    """Nuclei without forces: after two dt of three substeps each is off by the sum of six pairs."""
    noisy = numbers(
        noise_in_substeps=True, variance=variance, substeps=3, repulsion=0.0, two_daughters=0.0, hard_radius=0.0
    )
    state = Tissue(cells(10, 1, radius=0.0, **OFF), layers(10), 10)
    end = kernels.steps(state, 0, 2, noisy, *kernels.generators(4)).cells
    noise, moved = kernels.generators(4)[1], np.zeros((2, 10))
    for _ in range(2):
        key = [int(2**32 * noise.random()) for _ in range(2)]
        moved += sum(twins.normals(key, state.cells.id, number) for number in range(3))
    moved *= np.sqrt(variance * noisy.dt / 3)
    np.testing.assert_allclose([end.x - state.cells.x, end.y - state.cells.y], moved, atol=1e-11)


# Crowds and the twins

SIZES = pytest.mark.parametrize("n", [1, 2, 7, 8, 9, 60, 200])


@SIZES
@pytest.mark.parametrize("network", [layers, freed])
@pytest.mark.parametrize("only", [None, 1, "stiff_ax", "stiff_bx", "stiff_axb", "stiff_aa", "repulsion"])
def test_forces(n, network, only):
    """All of them with either power of the springs, and each alone."""
    alone = isinstance(only, str)
    off = {name: 0.0 for name in (*OFF, "stiff_aa") if alone and name != only}
    given = numbers(
        substeps=1, dt=0.005, repulsion=float(not alone or only == "repulsion"), spring_power=only == 1 or 2
    )
    state = cells(n, 4, radius=0.0, **off)
    made = make_substeps(state, network(n), given)
    assert distance(made, twins.make_substeps(state, network(n), given)) < SUBSTEP
    assert distance(made, state) > 1e-4 or (alone and n <= 2)


@pytest.mark.parametrize("distance_of_centres", [1.999, 2.0, 2.001, 1e-3])
def test_repulsion_at_the_ends_of_its_range(distance_of_centres):
    x = [(0.0, 4.0), (distance_of_centres, 4.0)]
    state = tissue(x, [(0.0, 8.0), (1.0, 8.0)], [(0.0, 0.0), (0.3, 0.0)], radius=0.0, rest_ax=3.0, rest_bx=3.0)
    given = numbers(substeps=1, dt=0.005, junction_factor=0.0)
    made = make_substeps(state, layers(2), given)
    assert distance(made, twins.make_substeps(state, layers(2), given)) < SUBSTEP


@PRESETS
@pytest.mark.parametrize("key", [None, (3, 2**32 - 5)])
def test_a_whole_dt(name, key):
    """Contacts come and go, cells are of all sizes. Rounding grows at most as neighbouring states part."""
    given = preset(name).numbers()._replace(noise_in_substeps=key is not None, variance=2.0)
    for n, seed in ((1, 3), (9, 3), (30, 6)):
        state = aged(n, seed, freed)
        near = {one: getattr(state.cells, one) + 1e-8 * np.cos(np.arange(n)) for one in COORDINATES[:5]}
        expected = twins.make_substeps(state.cells, state.layers, given, key)
        beside = twins.make_substeps(state.cells._replace(**near), state.layers, given, key)
        growth = max(1.0, distance(beside, expected) / 1e-8)
        made = make_substeps(state.cells, state.layers, given, key)
        assert distance(made, expected) < SUBSTEP * given.substeps * growth
        assert distance(made, state.cells) > 1e-2


# Sweeps

seeds = st.integers(0, 2**32 - 1)


def heap(rng, n, size, kind):
    """Discs that overlap in heaps: anywhere in a square, in a column, in a row, or in two heaps far apart."""
    x, y = rng.uniform(0.0, size, (2, n))
    if kind == "column":
        x[:] = 1.0
    elif kind == "row":
        y[:] = 1.0
    elif kind == "two heaps":
        x[::2] += 5.0
    points = (np.column_stack((x, height)) for height in (y, y + 4.0, 0.0 * y))
    return Tissue(tissue(*points, radius=rng.choice([1 / 3, 0.7], n)), layers(n), n)


def assert_swept(states_of, given, curve=STRAIGHT):
    """What the twins make of each; on a curve of the nuclei alone."""
    for state, found in zip(states_of, kernels.swept(states_of, given, curve), strict=True):
        expected = twins.swept(state.cells, state.layers, given)
        for name in COORDINATES if curve is STRAIGHT else "xy":
            np.testing.assert_array_equal(getattr(found, name), getattr(expected, name))


@pytest.mark.slow
@settings(max_examples=100)
@given(
    seeds,
    st.floats(0.3, 8.0),
    st.sampled_from(["square", "column", "row", "two heaps"]),
    st.sampled_from([1, 8]),
    st.booleans(),
)
def test_sweeps_of_heaps_overlook_no_contact(seed, size, kind, width, bent):
    """Discs on top of each other are pushed far, in some tissues and in others not; by windows and by boxes."""
    rng = np.random.default_rng(seed)
    heaps = [heap(rng, n, size, kind) for n in (40, 5, 30, 33, 20, 12, 1, 25)[:width]]
    assert_swept(heaps, numbers(), CIRCLE if bent else STRAIGHT)


def test_a_nucleus_that_many_push_a_little_meets_one_that_was_far():
    """Three to its left push the first one by a seventh each; the last one was farther than is looked at."""
    state = cells(5, 1)
    state.radius[:] = [0.8, 0.1, 0.1, 0.1, 0.5]
    x, y = -0.11, 0.0
    state.x[0], state.y[0], state.x[4], state.y[4] = x, y, x + 0.8 + 0.5 + 0.32, 0.0
    for i, angle in enumerate(np.radians([40, -40, 0]), start=1):
        state.x[i], state.y[i] = x - 0.62 * np.cos(angle), y - 0.62 * np.sin(angle)
        x, y = x + 0.14 * np.cos(angle), y + 0.14 * np.sin(angle)
    one = Tissue(state, layers(5), 5)
    assert_swept([one], numbers())
    assert kernels.swept([one], numbers())[0].x[4] > state.x[4]


@pytest.mark.slow
@given(seeds, st.floats(0.05, 1.0))
def test_basal_sweeps(seed, largest):
    """Alone and side by side, where cells have left the layer, one or all of them."""
    rng, rows = np.random.default_rng(seed), []
    for n, share in zip((1, 40, 17, 2, 3, 9, 12, 30), (0.8, 0.8, 0.5, 1.0, 1.0, 0.0, 0.1, 0.8), strict=True):
        state = cells(n, 0, radius=0.0)._replace(bx=np.cumsum(rng.normal(0.3, 0.5, n)))
        rows.append(Tissue(state, layers(n, basal=np.flatnonzero(rng.uniform(size=n) < share)), n))
    for some in (rows, *([one] for one in rows)):
        assert_swept(some, numbers(max_basal_distance=largest))


@pytest.mark.parametrize("n", [2, 9, 30])
def test_sweep_stays_in_its_arrays(n):
    """What lies behind the last cell is not looked at, and stays."""
    state = heap(np.random.default_rng(n), n, 0.6, "square").cells
    workspaces = Workspaces(n + 1, 1, [[numbers()]], np.zeros(1), STRAIGHT)
    work = workspaces.flat.value
    lines = {name: line for name, line in work._asdict().items() if getattr(line, "shape", None) == work.x.shape}
    for line in lines.values():
        line.view(np.float64)[:] = np.nan
    work.x[:n], work.y[:n], work.radius[:n], work.counts[:] = state.x, state.y, state.radius, 0.0
    assert separate_all(workspaces.flat.address, workspaces.wide.address, n, 0.0, 1) == -1
    expected = twins.separate(np.array([state.x, state.y, 0.0 * state.x]), state.radius)
    np.testing.assert_array_equal((work.x[:n], work.y[:n]), expected[:2])
    for name, line in lines.items():
        assert np.isnan(line[n:].view(np.float64)).all(), name


@pytest.mark.parametrize("curve", [CIRCLE, STRAIGHT], ids=["ring", "straight"])
@pytest.mark.parametrize("width", [1, 8])
def test_the_pairs_that_are_looked_at_are_counted(width, curve):
    """Of a row those that are near, at most all; in a company they are those of the widest window of all."""
    n, given = 160, states.numbers()
    row = cells(n, 0)._replace(x=0.6 * np.arange(n), y=np.zeros(n), radius=np.full(n, 1 / 3))
    group = Group([kernels.held(Tissue(row, layers(n), n), curve=curve) for _ in range(width)], given)
    assert group.make_substeps()
    assert n - 1 <= group.pairs / given.substeps < n * (n - 1) / 4


# Room for cells


@PRESETS
def test_a_state_that_grows_loses_nothing(name):
    given = preset(name).numbers()._replace(two_daughters=1.0, min_cycle=1.0, max_cycle=3.0, dt=0.1)
    found = []
    for capacity in (6, 600):
        group = Group([kernels.held(aged(6, 0), capacity)], given, [kernels.Random(*kernels.generators(1))])
        group.advance(0, 60)
        found.append(kernels.taken(group.states[0]))
    assert len(found[0].cells.x) > 2 * 6  # it grew twice
    assert found[0].next_id == found[1].next_id
    assert same_cells(*found)


def test_a_full_state_stops_before_the_step():
    """No room for a daughter that may come: nothing is changed, and nothing drawn."""
    state = aged(8, 0, divides=False)
    state.cells.birth[3] = -state.cells.cycle[3]
    kept, draws = kernels.held(state, 8), kernels.generators(0)
    before = [generator.bit_generator.state for generator in draws]
    assert Group([kept], numbers(), [kernels.Random(*draws)]).call(0, 5) == (0, FULL)
    assert all(np.array_equal(a, b) for a, b in zip(kernels.taken(kept).cells, state.cells, strict=True))
    assert [generator.bit_generator.state for generator in draws] == before


@pytest.mark.parametrize("where", [0.3 * LOST, 0.4 * LOST, 1e3 * LOST, 1e30, np.inf, np.nan])
def test_cells_far_out_are_lost(where):
    """Of nucleus, apical and basal point, the magnitudes count together."""
    kept = kernels.held(aged(60, 0), 60)
    for points in (kept.cells.x, kept.cells.ax, kept.cells.bx):
        points[:60] += where
    group = Group([kept], numbers(variance=0.0), [kernels.Random(*kernels.generators(0))])
    group.advance(0, 3)
    assert group.ended[0] == (0 if 3 * where < LOST else 1)
