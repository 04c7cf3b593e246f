"""No pair is missed: lists against all pairs, wherever the nuclei are, however far one is pushed."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.tissue.space.space_calls import SURFACES, counted, make_substeps, random_tissue, taken, workspace_of
from tests.twins.tissue.space import steps as twins
from tests.twins.tissue.space.state import Steps, distance, still
from tissue.kernels import kernel
from tissue.kernels.pair_lists import SKIN, make_lists, row_of
from tissue.kernels.surface_workspace import ALL, FOUND, LISTS, WHOLE, surface_workspace_at, wide_surface_workspace_at
from tissue.kernels.workspace import SOFT
from tissue.model.balls import separate_all_balls
from tissue.model.energy import nearest_image
from tissue.step.substeps import make_surface_substep

seeds = st.integers(0, 2**32 - 1)
surfaces = st.sampled_from(sorted(SURFACES))


def heap(seed, n, size, surface, radius=None):
    """Nuclei in a heap of this size."""
    rng = np.random.default_rng(seed)
    state = still(random_tissue(n, seed % 1000, surface))
    own = rng.choice([0.0, 0.3, 0.7], n) if radius is None else np.full(n, radius)
    return state._replace(x=rng.uniform(-size, size, (3, n)) + np.array([[9.0], [4.0], [-7.0]]), radius=own)


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
    surface = SURFACES[name]
    state = heap(seed, n, size, surface)
    workspaces, pairs = workspace_of(state, Steps(surface=surface)), np.zeros((2, n, n), np.int64)
    soft, hard = _listed(workspaces.flat.address, n, pairs)
    i, j = np.tril_indices(n, -1)
    d = np.sqrt((nearest_image(state.x[:, i] - state.x[:, j], surface) ** 2).sum(axis=0))
    np.testing.assert_array_equal((pairs[0] + pairs[0].T)[i, j], d < SOFT + SKIN)
    assert soft == (d < SOFT + SKIN).sum()
    assert hard in (-1, (d < state.radius[i] + state.radius[j] + SKIN).sum())
    if hard >= 0:
        np.testing.assert_array_equal(pairs[1][i, j], d < state.radius[i] + state.radius[j] + SKIN)
        assert pairs[1].sum() == hard


@pytest.mark.slow_with("0.5")
@pytest.mark.parametrize("size", [0.5, 2.0])
@pytest.mark.parametrize("name", SURFACES)
def test_sweeps_part_heaps_in_the_end(size, name):
    """Nuclei are pushed far beyond those listed; sweeps end when no two of all pairs overlap."""
    state = heap(3, 40, size, SURFACES[name], radius=0.3)
    workspaces = workspace_of(state, Steps(surface=SURFACES[name]))
    flat, wide = workspaces.flat.address, workspaces.wide.address
    assert separate_all_balls(flat, wide, 40, 1e-10, 10_000) > 0
    made, (i, j) = taken(workspaces, state), np.tril_indices(40, -1)
    d = np.sqrt((nearest_image(made.x[:, i] - made.x[:, j], SURFACES[name]) ** 2).sum(axis=0))
    assert d.min() > 0.6 - 2e-10
    assert np.abs(made.x - state.x).max() > 0.5 * SKIN


def test_a_pair_that_overlaps_is_one_correction():
    surface = SURFACES["open plane"]
    state = heap(1, 2, 0.5, surface, radius=0.0)
    state.radius[:], state.x[:, 1] = 0.5, state.x[:, 0] + [0.9, 0.0, 0.0]
    made, counts = counted(state, Steps(repulsion=0.0, surface=surface))
    assert (made.x != state.x).any()
    assert counts["corrections"] == 1


@pytest.mark.slow
@settings(max_examples=30)
@given(seeds, st.floats(0.5, 6.0), surfaces)
def test_pushes_of_heaps(seed, size, name):
    """Several substeps, between which nuclei go far or not: lists serve on, or are made anew."""
    state = heap(seed, 50, size, SURFACES[name], radius=0.0)
    steps = Steps(0.01, 6, repulsion=1.0, surface=SURFACES[name])
    scale = max(1.0, np.abs(state.x).max())
    assert distance(make_substeps(state, steps), twins.make_substeps(state, steps)) < 1e-12 * scale


@pytest.mark.parametrize("away", [50.0, 1e3, 4e5, 1e300, np.inf, np.nan])
def test_one_nucleus_far_away_changes_nothing_for_the_others(away):
    """Nor does one that is lost."""
    steps, none = Steps(0.00125, 3), np.zeros((0, 2), np.int64)
    edges = {"junctions": none, "rest": np.zeros(0), "k_aa": np.zeros(0), "neighbours": none}
    state = still(random_tissue(100, 1, steps.surface, **edges))
    state.x[:, 7] = away
    made = make_substeps(state, steps)
    alone = state._replace(**{name: np.delete(getattr(state, name), 7, axis=-1) for name in state._fields[:12]})
    others = np.delete(made.x, 7, axis=-1)
    np.testing.assert_allclose(others, make_substeps(alone, steps).x, rtol=0.0, atol=1e-13)


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
    assert distance(taken(workspaces, state), twins.make_substeps(state, steps)) < 1e-13
    assert workspaces.flat.value.counts[LISTS] > lists


@pytest.mark.slow
def test_rows_that_find_no_room_are_found_anew():
    """So many pairs that the list is full: the same push."""
    n = 600
    state = heap(1, n, 0.7, SURFACES["tight plane"], radius=0.0)
    steps = Steps(1e-5, 2, repulsion=1.0, surface=SURFACES["tight plane"])
    workspaces = workspace_of(state, steps)
    made, counts = counted(state, steps, workspaces)
    assert counts["pairs"] == 2 * n * (n - 1) // 2
    assert workspaces.flat.value.state[WHOLE] < n
    assert distance(made, twins.make_substeps(state, steps)) < 1e-12


def test_pairs_and_lists_are_counted():
    """One list serves for all substeps where nothing moves, and has the pairs within range and skin."""
    state, steps = still(random_tissue(200, 2, SURFACES["strip"], radius=np.zeros(200))), Steps(1e-9, 5)
    steps = steps._replace(surface=SURFACES["strip"], repulsion=1e-3)
    i, j = np.tril_indices(200, -1)
    d = np.sqrt((nearest_image(state.x[:, i] - state.x[:, j], steps.surface) ** 2).sum(axis=0))
    _, counts = counted(state, steps)
    assert counts["lists"] == 1
    assert counts["pairs"] == 5 * (d < SOFT + SKIN).sum()
    assert counted(state, steps._replace(repulsion=0.0))[1]["pairs"] == 0
