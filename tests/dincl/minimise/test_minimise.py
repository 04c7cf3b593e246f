"""The minimisers: they find known minima and certify them."""

import numpy as np
import pytest

import dincl
from dincl.minimise import (
    ArrowHurwicz,
    DampedArrowHurwicz,
    RelativeMove,
    Uzawa,
    minimise,
)
from tests.dincl.minimise.problems import (
    ANCHORS,
    STOP,
    TOL,
    WALL,
    damped,
    on_wall,
    pressed,
    program,
    towards_origin,
    weight,
)

METHODS = [
    pytest.param(ArrowHurwicz(0.1, 0.1, STOP), id="ArrowHurwicz"),
    pytest.param(damped(), id="Damped"),
    pytest.param(damped(alpha=0.4, damping=1.0, dtau=0.5, gamma=2.0), id="Damped-two-step"),
    pytest.param(damped(squared=True), id="Damped-squared"),
    pytest.param(Uzawa(0.5, STOP), id="Uzawa"),
]


@pytest.mark.parametrize("method", METHODS)
def test_two_discs_pressed_together(method):
    found = minimise(pressed(), method)
    assert found.status is dincl.Status.SUCCESS
    assert found.detail == ""
    np.testing.assert_allclose(found.x, [[-0.5, 0.0], [0.5, 0.0]], atol=5 * TOL)
    assert found.reactions() == {(0, "particle 1 and 0"): pytest.approx(0.2, abs=5 * TOL)}
    assert found.residual <= TOL * (1 + 1e-6)
    assert found.iterations == found.stats.steps > 0


@pytest.mark.parametrize("method", METHODS)
def test_free_minimum(method):
    rest = np.array([[1.0, -2.0]])
    problem = dincl.Problem([[0.0, 0.0]], lambda t, x: 2 * (rest - x), [])
    found = minimise(problem, method)
    np.testing.assert_allclose(found.x, rest, atol=TOL)
    assert found.multipliers.shape == found.families.shape == (0,)


@pytest.mark.slow
def test_stack_with_its_multipliers():
    """Packed at c: the contact below interval i carries sum_{k >= i} c_k, the wall all of them."""
    centres = np.array([0.5, 1.25, 1.875, 2.75, 3.5, 4.125])
    carried = np.cumsum(centres[::-1])[::-1]
    found = minimise(dincl.scenes.stack(), ArrowHurwicz(0.1, 0.1, STOP))
    np.testing.assert_allclose(found.x[:, 0], centres, atol=20 * TOL)
    reactions = found.reactions()
    assert reactions.pop((1, "particle 0")) == pytest.approx(carried[0], rel=1e-7)
    below = [reactions.pop((0, f"particle {i} and {i - 1}")) for i in range(1, 6)]
    np.testing.assert_allclose(below, carried[1:], rtol=1e-7)
    assert reactions == {}
    assert found.residual <= TOL * (1 + 1e-6)


@pytest.mark.parametrize("squared", [False, True])
def test_four_discs_reach_the_energy_of_the_long_run(squared):
    """All rhombi of touching discs have W = 1, since their diagonals obey a^2 + b^2 = 4."""
    scene = dincl.scenes.four_disks()
    rest = dincl.solve(scene, dincl.CatchUp(0.05, dincl.Daqp(1e-10)), t=15.0).final
    found = minimise(scene, damped(squared=squared))
    assert (rest**2).sum() / 2 == pytest.approx(1, abs=1e-6)
    assert (found.x**2).sum() / 2 == pytest.approx(1, abs=1e-7)
    assert len(found.reactions()) == 4
    assert scene.violation(0.0, found.x) <= TOL


@pytest.mark.slow
def test_uzawa_converges_up_to_its_limit(rng):
    problem, x, lam, limit = program(rng)
    found = minimise(problem, Uzawa(0.95 * limit, STOP, 800))
    np.testing.assert_allclose(found.x.ravel(), x, atol=1e-8)
    np.testing.assert_allclose(found.multipliers, lam, atol=1e-7)
    beyond = minimise(problem, Uzawa(1.05 * limit, STOP, 800), throw=False)
    assert beyond.status is dincl.Status.NOT_CONVERGED
    assert beyond.residual > 1e-3


def test_uzawa_lets_go_of_rows_that_do_not_hold(rng):
    """A row that the minimum does not touch keeps no multiplier, wherever the iteration has been."""
    problem = dincl.Problem([[3.0]], lambda t, x: 1 - x, [WALL, dincl.HalfSpace(normal=(1,), offset=2.0)])
    found = minimise(problem, Uzawa(1.5, STOP))
    assert found.reactions() == {(1, "particle 0"): pytest.approx(1.0, abs=1e-8)}


@pytest.mark.slow_with("0.5", "0.3")
@pytest.mark.parametrize(("alpha", "k"), [(0.1, 1.0), (0.5, 1.0), (0.3, 3.0)])
def test_arrow_hurwicz_converges_up_to_its_limit(alpha, k):
    """The iteration matrix ((1 - a k, a), (-b (1 - a k), 1 - a b)) has its eigenvalues inside for a (2 k + b) < 4."""
    beta = 4 / alpha - 2 * k
    assert minimise(on_wall(k), ArrowHurwicz(alpha, 0.98 * beta, STOP, 5000)).status
    assert not minimise(on_wall(k), ArrowHurwicz(alpha, 1.02 * beta, STOP, 5000), throw=False).status


@pytest.mark.slow
def test_a_weight_swings_for_ever_without_damping():
    """W has no curvature, so x'' = -alpha beta x about the floor: the oscillation neither grows nor dies."""
    early, late = (minimise(weight(1.0), ArrowHurwicz(0.1, 0.1, STOP, n), throw=False) for n in (500, 5000))
    assert early.status is late.status is dincl.Status.NOT_CONVERGED
    assert 0.5 < late.residual < 2.0
    found = minimise(weight(1.0), damped(0.01, 0.25, 0.1))
    assert found.x[0, 0] == pytest.approx(0, abs=TOL)
    assert found.multipliers == pytest.approx([1.0], abs=1e-8)


@pytest.mark.slow
def test_a_weight_that_is_too_light_does_not_come_to_rest():
    """With c dtau = 2: alpha beta dtau < gamma lambda*, here lambda* > 0.025."""
    for force, ends in ((0.02, False), (0.1, True)):
        found = minimise(weight(force), damped(0.01, 0.25, 0.1, limit=10_000), throw=False)
        assert bool(found.status) is ends, found
    assert found.multipliers == pytest.approx([0.1], abs=1e-8)


@pytest.mark.slow
def test_squared_distances_stop_arrow_hurwicz_and_damping_mends_it():
    """Two discs drawn to one point: squared, the curvature of the Lagrangian across the contact is zero."""
    problem = towards_origin()
    assert minimise(problem, ArrowHurwicz(0.1, 0.1, STOP, 5000)).status
    swinging = minimise(problem, ArrowHurwicz(0.1, 0.1, STOP, 5000, squared=True), throw=False)
    assert swinging.status is dincl.Status.NOT_CONVERGED
    assert swinging.residual > 0.1
    assert minimise(problem, damped(squared=True, limit=5000)).status


@pytest.mark.slow
def test_concave_energy_needs_the_damping_of_the_constraint():
    """W = x - x^2/4 on x >= 0: a strict local minimum at 0, where alpha h < 0 drives Arrow-Hurwicz away."""
    problem = dincl.Problem([[0.05]], lambda t, x: x / 2 - 1, [WALL])
    assert not minimise(problem, ArrowHurwicz(0.1, 1.0, STOP, 5000), throw=False).status
    found = minimise(problem, damped(0.1, 0.1, 0.5))
    assert found.x[0, 0] == pytest.approx(0, abs=TOL)


@pytest.mark.slow
def test_four_discs_cycle_without_damping():
    found = minimise(dincl.scenes.four_disks(), ArrowHurwicz(0.1, 0.1, STOP, 5000), throw=False)
    assert found.status is dincl.Status.NOT_CONVERGED
    assert found.residual > 0.1
    assert np.abs(found.x).max() < 3


@pytest.mark.slow
@pytest.mark.parametrize("damping", [0.5, 2.0, 20.0])
@pytest.mark.parametrize("dtau", [0.5, 1.0])
def test_free_limit_of_the_damped_method_does_not_depend_on_damping(damping, dtau):
    """Dtau^2 alpha k < 4."""
    problem = dincl.Problem([[1.0]], lambda t, x: -x, [])
    for pull, ends in ((3.95, True), (4.05, False)):
        method = damped(pull / dtau**2, damping=damping, dtau=dtau, limit=10_000)
        assert bool(minimise(problem, method, throw=False).status) is ends


@pytest.mark.slow
def test_relative_move_stops_at_twice_eps_over_alpha():
    """Remark 3.6 with the step alpha/2 that c dtau = 2 leaves."""
    rest = np.array([3.0, -4.0])
    problem = dincl.Problem([1.03 * rest], lambda t, x: rest - x, [])
    found = minimise(problem, DampedArrowHurwicz.published())
    ratio = np.linalg.norm(found.x - rest) / np.linalg.norm(found.x)
    assert 0.0199 < ratio <= 0.02
    assert found.status
    assert found.residual > 0.05
    n = np.log(0.03 / (1 + 0.03) / 0.02) / 5e-5
    assert found.iterations == pytest.approx(n, rel=0.1)


def test_published_parameters_are_those_of_table_4():
    table = DampedArrowHurwicz(1e-4, 0.25, 1e-3, 2.0, 1.0, RelativeMove(1e-6), 7, squared=True)
    assert DampedArrowHurwicz.published(7) == table


def test_relative_move_counts_the_length_of_the_step():
    """Halving dtau with all else scaled as in Remark 3.5 changes nothing, to the last bit."""
    scene, dtau = dincl.scenes.four_disks(), 0.25
    one = minimise(scene, damped(damping=1.5, stop=RelativeMove(1e-5)))
    scaled = damped(0.1 / dtau**2, 0.1 / dtau, 1 / dtau**2, 1.5 / dtau, dtau, RelativeMove(1e-5 / dtau))
    other = minimise(scene, scaled)
    assert one.iterations == other.iterations
    np.testing.assert_array_equal(one.x, other.x)


def test_limit_that_is_just_enough():
    steps = minimise(pressed(), damped()).iterations
    assert minimise(pressed(), damped(limit=steps)).status
    assert not minimise(pressed(), damped(limit=steps - 1), throw=False).status


def test_uzawa_goes_downhill_from_a_maximum():
    """W = (x^2 - 1)^2/4: from near the maximum at 0, where Newton's method alone would stay, to the minimum at 1."""
    problem = dincl.Problem([[1e-3]], lambda t, x: x - x**3, [])
    found = minimise(problem, Uzawa(0.5, STOP))
    assert found.x[0, 0] == pytest.approx(1, abs=1e-8)


@pytest.mark.parametrize("method", METHODS)
def test_each_evaluation_of_the_drift_is_counted(method):
    calls = []

    def drift(t, x):
        calls.append(t)
        return ANCHORS - x

    problem = dincl.Problem([[-1.0, 0.0], [1.0, 0.0]], drift, [dincl.NonOverlap(0.5)])
    calls.clear()
    counted = minimise(problem, method).stats.drift_evaluations
    assert counted == len(calls) - 1 > 5  # one more certifies the result
