"""What holds for every scheme, run over the list of all of them."""

import numpy as np
import pytest

import dincl
from tests.dincl.catalog import FIRST_ORDER, SCHEMES, spring
from verification.instruments.order import estimate

# The last step is for springs, which come into their order late.
STEPS = 0.01 * 2.0 ** -np.arange(6)


def order(make):
    """What the scheme promises; it evaluates the drift as often in a step."""
    return 2 if isinstance(make(0.1), dincl.MidpointCatchUp) else 1


def crowd(d):
    """Five balls drawn together on a floor."""
    x0 = np.column_stack([[0.0, 1.2, 2.5, 3.9, 5.0], [0.9, 0.4, 2.1, 1.0, 2.2], [0.0, 0.1, -0.2, 0.3, 0.1]])[:, :d]
    floor = dincl.HalfSpace(np.eye(d)[-1], offset=-1.0, radius=0.5)
    return dincl.Problem(x0, lambda t, x: 0.5 - x, [dincl.NonOverlap(0.5), floor])


@pytest.mark.parametrize("make", SCHEMES)
@pytest.mark.parametrize("d", [1, 2, 3])
def test_a_run_is_finite_and_repeatable(make, d):
    problem = crowd(d)
    start = problem.x0.copy()
    first, second = (dincl.solve(problem, make(0.02), t=[0.5, 1.0]) for _ in range(2))
    assert first.status is dincl.Status.SUCCESS
    assert first.x.shape == (2, 5, d)
    assert np.isfinite(first.x).all()
    assert first.x.tobytes() == second.x.tobytes()
    assert first.stats == second.stats
    assert first.stats.steps == 50
    assert first.stats.drift_evaluations == 50 * order(make)
    assert problem.x0.tobytes() == start.tobytes()
    assert (first.violation() < 0.2).all()


@pytest.mark.parametrize("make", SCHEMES)
def test_one_particle_without_constraints_is_moved_by_its_drift_alone(make):
    path = dincl.solve(dincl.Problem([[0.5]], lambda t, x: x * 0 + 1.0), make(0.1), t=[1.0])
    assert 0.9 < path.final[0, 0] < 1.6
    assert path.violation()[0] == 0.0
    assert path.stats.solver_calls == 0


@pytest.mark.parametrize("make", SCHEMES)
def test_a_drift_that_fails_ends_every_scheme_alike(make):
    problem = dincl.Problem([[0.5]], lambda t, x: x * 0 + (np.nan if t > 0.25 else 1.0))
    path = dincl.solve(problem, make(0.1), t=[0.1, 1.0], throw=False)
    assert path.status is dincl.Status.DRIFT_FAILED
    assert path.t == pytest.approx([0.1, 0.3])


@pytest.mark.slow_with(
    "sliding_disc-CatchUp", "sliding_disc-MidpointCatchUp", "two_disks-CatchUp", "two_disks-MidpointCatchUp"
)
@pytest.mark.parametrize("make", FIRST_ORDER)
@pytest.mark.parametrize("name", ["sliding_disc", "two_disks", "stack"])
def test_order_against_the_exact_solution(make, name):
    scene = getattr(dincl.scenes, name)()
    exact = scene.exact(np.array(scene.times))
    steps = 2 * STEPS[:-1] if hasattr(make(0.1), "projection") else STEPS
    errors = [np.abs(dincl.solve(scene, make(dt), t=scene.times).x - exact).max() for dt in steps]
    found = estimate(steps, errors)
    assert found.slope == pytest.approx(order(make), abs=0.1), found.verdict
    assert errors[-1] < 0.05


@pytest.mark.slow_with("sweeping_interval-MidpointCatchUp")
@pytest.mark.parametrize("make", FIRST_ORDER)
@pytest.mark.parametrize("name", ["step_inclusion", "sweeping_interval"])
def test_sets_that_catch_up_meets_exactly(make, name):
    """One flat constraint at a time: what is left is a reversal missed by part of a step, or the give of a spring."""
    scene = getattr(dincl.scenes, name)()
    for dt in (0.04, 0.01):
        path = dincl.solve(scene, make(dt), t=scene.times)
        error = np.abs(path.x - scene.exact(path.t)).max()
        assert error < (4 * dt if make is spring else dt**2)


@pytest.mark.parametrize("make", FIRST_ORDER)
def test_infeasibility_vanishes_with_the_step(make):
    scene = dincl.scenes.four_disks()
    left = [dincl.solve(scene, make(dt), t=[1.0, 2.0]).violation().max() for dt in (0.04, 0.01, 0.0025)]
    assert left[2] <= max(0.12 * left[0], 1e-9)
