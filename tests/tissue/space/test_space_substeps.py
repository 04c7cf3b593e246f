"""Substeps in three dimensions equal their plain twins: projections bit for bit, forces and noise to rounding."""

import numpy as np
import pytest

import dincl
from tests.tissue.space import space_calls as kernels
from tests.tissue.space.space_calls import SURFACES, counted, random_tissue
from tests.twins.tissue.space import steps as twins
from tests.twins.tissue.space.state import Steps, distance, still
from tissue.kernels.surface_workspace import SurfaceWorkspaces

# Coordinates are about 10: one rounding is 1e-15. Roots are accurate to 2e-14, sums have some 50 terms.
SUBSTEP = 1e-13
SIZES = (1, 2, 7, 8, 9, 60, 200)
each_surface = pytest.mark.parametrize("name", SURFACES)
each_size = pytest.mark.parametrize("n", SIZES)


@each_surface
@each_size
@pytest.mark.parametrize("power", [1, 2])
def test_forces(n, name, power):
    """No balls, no basal neighbours."""
    state = random_tissue(n, n, SURFACES[name], radius=np.zeros(n), neighbours=np.zeros((0, 2), np.int64))
    steps = Steps(surface=SURFACES[name], power=power)
    made = kernels.make_substeps(state, steps)
    assert distance(made, twins.make_substeps(state, steps)) < SUBSTEP
    assert distance(made, state) > 1e-3


@pytest.mark.parametrize("only", ["stiff_ax", "stiff_bx", "stiff_axb", "k_aa", "repulsion", "runs"])
@pytest.mark.parametrize("name", ["periodic plane", "cylinder"])
def test_each_force_alone(only, name):
    state = random_tissue(60, 4, SURFACES[name], radius=np.zeros(60), neighbours=np.zeros((0, 2), np.int64))
    alone = still(state)._replace(**{only: getattr(state, only)} if only != "repulsion" else {})
    steps = Steps(surface=SURFACES[name], repulsion=0.5 * (only == "repulsion"))
    made = kernels.make_substeps(alone, steps)
    assert distance(made, twins.make_substeps(alone, steps)) < SUBSTEP
    assert distance(made, alone) > 1e-4


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
        expected = twins.make_substeps(state, steps)
        np.testing.assert_array_equal(made.x, expected.x)
        np.testing.assert_array_equal(made.a, expected.a)
        free = state.held == 0.0
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
    assert distance(made, twins.make_substeps(state, steps)) < 1e-10
    assert counts["substeps"] == 20
    assert 1 <= counts["lists"] < 20
    assert counts["corrections"] > 0


@pytest.mark.slow
def test_noise_is_that_of_the_section_and_a_third_coordinate():
    """N(0, variance h) on each coordinate of the nuclei, independent, other numbers in each substep."""
    n, steps = 2000, Steps(repulsion=0.0, variance=0.2, substeps=2)
    state = still(random_tissue(n, 0, SURFACES["open plane"], radius=np.zeros(n)))
    one = kernels.make_substeps(state, steps._replace(substeps=1))
    two = kernels.make_substeps(state, steps)
    kicks = np.vstack((one.x - state.x, two.x - one.x)) / np.sqrt(0.2 * steps.h)
    np.testing.assert_allclose(np.corrcoef(kicks), np.eye(6), atol=0.1)
    np.testing.assert_allclose(kicks.std(axis=1), 1.0, atol=0.06)
    np.testing.assert_array_equal(one.a, state.a)


def test_a_step_forgets_what_was_on_the_board():
    """The same bits on a workspace that has been used, with other lists."""
    surface = SURFACES["periodic plane"]
    steps, (one, other) = Steps(0.0025, 10, surface=surface), (random_tissue(150, seed, surface) for seed in (1, 2))
    shorter = {name: getattr(other, name)[: len(one.junctions)] for name in ("junctions", "rest", "k_aa", "neighbours")}
    workspaces = kernels.workspace_of(one, steps)
    kernels.make_substeps(other._replace(**shorter), steps, workspaces)
    assert distance(kernels.make_substeps(one, steps, workspaces), kernels.make_substeps(one, steps)) == 0.0


@pytest.mark.parametrize("period", [4.0, 0.0, np.nan])
def test_a_period_in_which_nuclei_meet_twice_is_refused(period):
    surface = SURFACES["strip"]._replace(period_z=period)
    with pytest.raises(dincl.InvalidProblem, match=r"surface\.period_z = .*: must be above 4"):
        SurfaceWorkspaces(8, 8, surface)
