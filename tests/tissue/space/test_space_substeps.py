"""Substeps in three dimensions equal their plain twins, projections bit for bit, and no pair of nuclei is missed."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import dincl
from tests.tissue.space.calls import SURFACES, counted, heap, make_substeps, random_tissue, taken, workspace_of
from tests.twins import tissue as twins
from tests.twins.tissue import Steps, distance, still
from tissue.kernels import kernel
from tissue.kernels.pair_lists import SKIN, make_lists, row_of
from tissue.kernels.surface_workspace import (
    ALL,
    FOUND,
    LISTS,
    WHOLE,
    SurfaceWorkspaces,
    surface_workspace_at,
    wide_surface_workspace_at,
)
from tissue.kernels.workspace import SOFT
from tissue.model.balls import separate_all_balls
from tissue.model.energy import nearest_image
from tissue.step.substeps import make_surface_substep

# Coordinates are about 10: one rounding is 1e-15. Roots are accurate to 2e-14, sums have some 50 terms.
SUBSTEP = 1e-13
each_surface = pytest.mark.parametrize("name", SURFACES)
each_size = pytest.mark.parametrize("n", [1, 2, 7, 8, 9, 60, 200])
seeds, surfaces = st.integers(0, 2**32 - 1), st.sampled_from(sorted(SURFACES))


def apart(state, surface):
    """The distances of all pairs j < i, to the nearest image, and these pairs."""
    i, j = np.tril_indices(state.x.shape[1], -1)
    return np.sqrt((nearest_image(state.x[:, i] - state.x[:, j], surface) ** 2).sum(axis=0)), (i, j)


# Substeps


@each_surface
@each_size
@pytest.mark.parametrize("power", [1, 2])
def test_forces(n, name, power):
    """No balls, no basal neighbours."""
    state = random_tissue(n, n, SURFACES[name], radius=np.zeros(n), neighbours=np.zeros((0, 2), np.int64))
    steps = Steps(surface=SURFACES[name], power=power)
    made = make_substeps(state, steps)
    assert distance(made, twins.make_substeps_in_space(state, steps)) < SUBSTEP
    assert distance(made, state) > 1e-3


@each_surface
@each_size
def test_projections_are_the_same_bits(n, name):
    """Balls and basal neighbours, where nothing else acts; on curved surfaces the last projection to rounding.

    More cells on the tight plane are a heap, in which a sweep pushes nuclei beyond those listed.
    """
    n = min(n, 60) if name == "tight plane" else n
    state, steps = still(random_tissue(n, n + 1, SURFACES[name])), Steps(surface=SURFACES[name], repulsion=0.0)
    corrections = np.zeros(2, np.int64)
    for _ in range(3):
        made, counts = counted(state, steps)
        expected, free = twins.make_substeps_in_space(state, steps), state.held == 0.0
        np.testing.assert_array_equal(made.x, expected.x)
        np.testing.assert_array_equal(made.a, expected.a)
        np.testing.assert_array_equal(made.b[:, free], expected.b[:, free])
        np.testing.assert_allclose(made.b, expected.b, rtol=0.0, atol=1e-14)
        corrections += np.array([counts["corrections"], counts["basal_corrections"]])
        state = made
    assert n < 200 or (corrections > 0).all()


@each_surface
@pytest.mark.parametrize("variance", [0.0, 0.2])
def test_a_whole_dt(name, variance):
    """Contacts come and go; lists are made and serve for several substeps."""
    n = 60 if name == "tight plane" else 120
    state, steps = random_tissue(n, 6, SURFACES[name]), Steps(0.0025, 20, surface=SURFACES[name], variance=variance)
    made, counts = counted(state, steps)
    assert distance(made, twins.make_substeps_in_space(state, steps)) < 1e-10
    assert counts["substeps"] == 20
    assert 1 <= counts["lists"] < 20
    assert counts["corrections"] > 0


@pytest.mark.slow
def test_noise_is_that_of_the_section_and_a_third_coordinate():
    """N(0, variance h) on each coordinate of the nuclei, independent, other numbers in each substep."""
    n, steps = 2000, Steps(repulsion=0.0, variance=0.2, substeps=2)
    state = still(random_tissue(n, 0, SURFACES["open plane"], radius=np.zeros(n)))
    one, two = make_substeps(state, steps._replace(substeps=1)), make_substeps(state, steps)
    kicks = np.vstack((one.x - state.x, two.x - one.x)) / np.sqrt(0.2 * steps.h)
    np.testing.assert_allclose(np.corrcoef(kicks), np.eye(6), atol=0.1)
    np.testing.assert_allclose(kicks.std(axis=1), 1.0, atol=0.06)
    np.testing.assert_array_equal(one.a, state.a)


def test_a_step_forgets_what_was_on_the_workspace():
    """The same bits on a workspace that has been used, with other lists."""
    surface = SURFACES["periodic plane"]
    steps, (one, other) = Steps(0.0025, 10, surface=surface), (random_tissue(150, seed, surface) for seed in (1, 2))
    shorter = {name: getattr(other, name)[: len(one.junctions)] for name in ("junctions", "rest", "k_aa", "neighbours")}
    workspaces = workspace_of(one, steps)
    make_substeps(other._replace(**shorter), steps, workspaces)
    assert distance(make_substeps(one, steps, workspaces), make_substeps(one, steps)) == 0.0


@pytest.mark.parametrize("period", [4.0, 0.0, np.nan])
def test_a_period_in_which_nuclei_meet_twice_is_refused(period):
    with pytest.raises(dincl.InvalidProblem, match=r"surface\.period_z = .*: must be above 4"):
        SurfaceWorkspaces(8, 8, SURFACES["strip"]._replace(period_z=period))


# Pairs


@kernel
def _listed(flat, n, pairs):
    """Both lists: how many soft pairs, how many of hard balls; -1 if these found no room."""
    work = surface_workspace_at(flat)
    make_lists(work, n)
    soft = 0
    for p in range(n):
        begin, end = row_of(work, p, n)
        for k in range(begin, end):
            pairs[0, work.order[p], work.order[work.listed[k]]] += 1
            soft += 1
    for i in range(n):
        for k in range(work.hard_row[i], work.hard_row[i + 1]):
            pairs[1, i, work.hard[k]] += 1
    return soft, -1 if work.state[ALL] else work.state[FOUND]


@pytest.mark.slow
@settings(max_examples=60)
@given(seeds, st.integers(1, 90), st.floats(0.1, 12.0), surfaces)
def test_lists_are_those_of_all_pairs(seed, n, size, name):
    """Each pair within range and skin once; no other."""
    state = heap(seed, n, size, SURFACES[name])
    workspaces, pairs = workspace_of(state, Steps(surface=SURFACES[name])), np.zeros((2, n, n), np.int64)
    soft, hard = _listed(workspaces.flat.address, n, pairs)
    d, (i, j) = apart(state, SURFACES[name])
    touch = d < state.radius[i] + state.radius[j] + SKIN
    np.testing.assert_array_equal((pairs[0] + pairs[0].T)[i, j], d < SOFT + SKIN)
    assert soft == (d < SOFT + SKIN).sum()
    assert hard in (-1, touch.sum())
    if hard >= 0:
        np.testing.assert_array_equal(pairs[1][i, j], touch)
        assert pairs[1].sum() == hard


@pytest.mark.slow_with("0.5")
@pytest.mark.parametrize("size", [0.5, 2.0])
@each_surface
def test_sweeps_part_heaps_in_the_end(size, name):
    """Nuclei are pushed far beyond those listed; sweeps end when no two of all pairs overlap."""
    state = heap(3, 40, size, SURFACES[name], radius=0.3)
    workspaces = workspace_of(state, Steps(surface=SURFACES[name]))
    assert separate_all_balls(workspaces.flat.address, workspaces.wide.address, 40, 1e-10, 10_000) > 0
    made = taken(workspaces, state)
    assert apart(made, SURFACES[name])[0].min() > 0.6 - 2e-10
    assert np.abs(made.x - state.x).max() > 0.5 * SKIN


@kernel
def _substep(flat, wide, n):
    """One substep with the lists that there are."""
    make_surface_substep(surface_workspace_at(flat), n, wide_surface_workspace_at(wide), (n + 7) // 8, 0)


@pytest.mark.slow
@settings(max_examples=60)
@given(seeds, st.integers(20, 90), st.integers(1, 24), st.floats(SKIN, 6.0), surfaces)
def test_lists_are_made_anew_when_one_has_gone_far(seed, n, many, far, name):
    """Some nuclei go anywhere after the lists were made: their pushes are those of all pairs."""
    rng, steps = np.random.default_rng(seed), Steps(surface=SURFACES[name], repulsion=1.0)
    state = heap(seed, n, 3.0, SURFACES[name], radius=0.0)
    workspaces = workspace_of(state, steps)
    _substep(workspaces.flat.address, workspaces.wide.address, n)
    state = taken(workspaces, state)
    gone = rng.permutation(n)[:many]
    state.x[:, gone] += far * rng.choice([-1.0, 1.0], (3, len(gone)))
    workspace_of(state, steps, workspaces)
    lists = workspaces.flat.value.counts[LISTS]
    _substep(workspaces.flat.address, workspaces.wide.address, n)
    assert distance(taken(workspaces, state), twins.make_substeps_in_space(state, steps)) < 1e-13
    assert workspaces.flat.value.counts[LISTS] > lists


@pytest.mark.slow
def test_rows_that_find_no_room_are_found_anew():
    """So many pairs that the list is full: the same push."""
    n, surface = 600, SURFACES["tight plane"]
    state, steps = heap(1, n, 0.7, surface, radius=0.0), Steps(1e-5, 2, repulsion=1.0, surface=surface)
    workspaces = workspace_of(state, steps)
    made, counts = counted(state, steps, workspaces)
    assert counts["pairs"] == 2 * n * (n - 1) // 2
    assert workspaces.flat.value.state[WHOLE] < n
    assert distance(made, twins.make_substeps_in_space(state, steps)) < 1e-12


def test_what_is_counted():
    """A pair that overlaps is one correction; one list serves for all substeps where nothing moves, and has the pairs
    within range and skin; none is looked at without repulsion.
    """
    surface = SURFACES["open plane"]
    state = heap(1, 2, 0.5, surface, radius=0.5)
    state.x[:, 1] = state.x[:, 0] + [0.9, 0.0, 0.0]
    made, counts = counted(state, Steps(repulsion=0.0, surface=surface))
    assert (made.x != state.x).any()
    assert counts["corrections"] == 1
    state = still(random_tissue(200, 2, SURFACES["strip"], radius=np.zeros(200)))
    steps = Steps(1e-9, 5, surface=SURFACES["strip"], repulsion=1e-3)
    _, counts = counted(state, steps)
    assert counts["lists"] == 1
    assert counts["pairs"] == 5 * (apart(state, steps.surface)[0] < SOFT + SKIN).sum()
    assert counted(state, steps._replace(repulsion=0.0))[1]["pairs"] == 0


@pytest.mark.parametrize("away", [50.0, 1e3, 4e5, 1e300, np.inf, np.nan])
def test_one_nucleus_far_away_changes_nothing_for_the_others(away):
    """Nor does one that is lost."""
    steps, none = Steps(0.00125, 3), np.zeros((0, 2), np.int64)
    edges = {"junctions": none, "rest": np.zeros(0), "k_aa": np.zeros(0), "neighbours": none}
    state = still(random_tissue(100, 1, steps.surface, **edges))
    state.x[:, 7] = away
    alone = state._replace(**{name: np.delete(getattr(state, name), 7, axis=-1) for name in state._fields[:12]})
    others = np.delete(make_substeps(state, steps).x, 7, axis=-1)
    np.testing.assert_allclose(others, make_substeps(alone, steps).x, rtol=0.0, atol=1e-13)
