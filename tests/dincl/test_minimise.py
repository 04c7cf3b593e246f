"""The minimisers find known minima and certify them, converge up to their limits, and report what stops them."""

from dataclasses import replace

import numpy as np
import pytest

import dincl
from dincl.errors import StepFailure
from dincl.minimise import (
    ArrowHurwicz,
    DampedArrowHurwicz,
    MinimisationFailed,
    RelativeMove,
    Stationary,
    Uzawa,
    free_minimum,
)
from dincl.minimise import minimise as find
from dincl.status import Status

TOL = 1e-9
STOP = Stationary(TOL)
ANCHORS = np.array([[-0.3, 0.0], [0.3, 0.0]])
WALL = dincl.HalfSpace(normal=(1,))
DISCS = dincl.NonOverlap(0.5)


def damped(alpha=0.1, beta=0.1, gamma=1.0, damping=2.0, dtau=1.0, stop=STOP, limit=20_000, squared=False):
    return DampedArrowHurwicz(alpha, beta, gamma, damping, dtau, stop, limit, squared)


def arrow(alpha, beta, limit=5000, squared=False):
    return ArrowHurwicz(alpha, beta, STOP, limit, squared)


def pressed(drift=lambda t, x: ANCHORS - x):
    """Two discs of radius 1/2, W = sum |X_i - a_i|^2/2 with |a_0 - a_1| = 0.6: pressed together with (1 - 0.6)/2."""
    return dincl.Problem([[-1.0, 0.0], [1.0, 0.0]], drift, [DISCS])


def together():
    """Two discs of radius 1/2, W = |x|^2/2."""
    return dincl.Problem([[-0.6, 0.1], [0.7, 0.0]], lambda t, x: -x, [DISCS])


def on_wall(slope, x0=0.05):
    """x >= 0 with W' = slope(x)."""
    return dincl.Problem([[x0]], lambda t, x: -slope(x), [WALL])


def weight(force):
    """x >= 0, W = force x: x = 0 with the multiplier ``force``, and no curvature."""
    return on_wall(lambda x: force + 0 * x, 0.01)


def concave():
    """W = x - x^2/4 on x >= 0: a strict local minimum at 0, where W - lambda x is concave."""
    return on_wall(lambda x: 1 - x / 2)


def spring(stiffness, x0=1.0):
    """W = stiffness (x - 0)^2/2, free."""
    return dincl.Problem([[x0]], lambda t, x: -stiffness * x)


METHODS = [
    pytest.param(ArrowHurwicz(0.1, 0.1, STOP), id="ArrowHurwicz"),
    pytest.param(damped(), id="Damped"),
    pytest.param(damped(alpha=0.4, damping=1.0, dtau=0.5, gamma=2.0), id="Damped-two-step"),
    pytest.param(damped(squared=True), id="Damped-squared"),
    pytest.param(Uzawa(0.5, STOP), id="Uzawa"),
]


@pytest.mark.parametrize("method", METHODS)
def test_known_minima_with_their_multipliers_and_each_evaluation_counted(method):
    calls = []
    problem = pressed(lambda t, x: calls.append(t) or ANCHORS - x)
    calls.clear()
    found = find(problem, method)
    assert (found.status, found.detail) == (Status.SUCCESS, "")
    np.testing.assert_allclose(found.x, [[-0.5, 0.0], [0.5, 0.0]], atol=5 * TOL)
    assert found.reactions() == {(0, "particle 1 and 0"): pytest.approx(0.2, abs=5 * TOL)}
    assert found.residual <= TOL * (1 + 1e-6)
    assert found.iterations == found.stats.steps > 0
    assert found.stats.drift_evaluations == len(calls) > 5
    assert find(problem, replace(method, limit=found.iterations)).iterations == found.iterations
    free = find(dincl.Problem([[0.0, 0.0]], lambda t, x: 2 * (np.array([[1.0, -2.0]]) - x)), method)
    np.testing.assert_allclose(free.x, [[1.0, -2.0]], atol=TOL)
    assert free.multipliers.shape == free.families.shape == (0,)
    carried = dincl.Moving(WALL, lambda t: np.array([2.0 + t]))  # is taken at t = 0
    walls = find(dincl.Problem([[3.0]], lambda t, x: -x, [carried, WALL]), method)
    assert walls.reactions() == {(0, "particle 0"): pytest.approx(2.0, abs=1e-7)}


@pytest.mark.slow
def test_stack_with_its_multipliers():
    """Packed at c: the contact below interval i carries sum_{k >= i} c_k, the wall all of them."""
    centres = np.array([0.5, 1.25, 1.875, 2.75, 3.5, 4.125])
    carried = np.cumsum(centres[::-1])[::-1]
    found = find(dincl.scenes.stack(), arrow(0.1, 0.1, 100_000))
    np.testing.assert_allclose(found.x[:, 0], centres, atol=20 * TOL)
    expected = {(1, "particle 0"): carried[0]} | {(0, f"particle {i} and {i - 1}"): carried[i] for i in range(1, 6)}
    assert found.reactions() == pytest.approx(expected, rel=1e-7)


@pytest.mark.parametrize("squared", [False, True])
def test_four_discs_reach_a_rhombus(squared):
    """All rhombi of touching discs have W = 1, since their diagonals obey a^2 + b^2 = 4."""
    found = find(dincl.scenes.four_disks(), damped(squared=squared))
    assert (found.x**2).sum() / 2 == pytest.approx(1, abs=1e-7)
    assert len(found.reactions()) == 4


@pytest.mark.slow
def test_uzawa_converges_up_to_its_limit(rng):
    """min x^T A x/2 - f.x, B x >= b with A definite; all rows active: x and lambda solve the saddle point system."""
    root = rng.normal(size=(4, 4))
    a, b = root @ root.T + np.eye(4), rng.normal(size=(2, 4))
    x, lam = rng.normal(size=4), rng.uniform(0.5, 1.5, 2)
    f, bound = a @ x - b.T @ lam, b @ x
    start = x + np.linalg.lstsq(b, np.ones(2), rcond=None)[0]
    rows = dincl.Smooth(lambda z: b @ z.ravel() - bound, lambda z: b)
    problem = dincl.Problem(start.reshape(2, 2), lambda t, z: (f - a @ z.ravel()).reshape(2, 2), [rows])
    limit = 2 / np.linalg.eigvalsh(b @ np.linalg.solve(a, b.T))[-1]
    found = find(problem, Uzawa(0.95 * limit, STOP, 800))
    np.testing.assert_allclose(found.x.ravel(), x, atol=1e-8)
    np.testing.assert_allclose(found.multipliers, lam, atol=1e-7)
    assert not find(problem, Uzawa(1.05 * limit, STOP, 800), throw=False).status


@pytest.mark.slow
@pytest.mark.parametrize(
    ("problem", "method", "ends"),
    [
        # W = k (x + 1)^2/2 on a wall: alpha (2 k + beta) < 4.
        *[(on_wall(lambda x: x + 1), arrow(a, k * (4 / a - 2)), k < 1) for a in (0.1, 0.5) for k in (0.98, 1.02)],
        # A free spring: dtau^2 alpha k < 4, whatever the damping.
        *[(spring(1.0), damped(k / h**2, damping=c, dtau=h, limit=10_000), k < 4)
          for k in (3.95, 4.05) for c in (0.5, 20.0) for h in (0.5, 1.0)],
        # A weight swings for ever without damping; with c dtau = 2 it rests where alpha beta dtau < gamma lambda*.
        (weight(1.0), arrow(0.1, 0.1), False),
        (weight(1.0), damped(0.01, 0.25, 0.1), True),
        (weight(0.1), damped(0.01, 0.25, 0.1, limit=10_000), True),
        (weight(0.02), damped(0.01, 0.25, 0.1, limit=10_000), False),
        # Squared, the curvature of the Lagrangian across the contact of discs drawn to one point is zero.
        (together(), arrow(0.1, 0.1), True),
        (together(), arrow(0.1, 0.1, squared=True), False),
        (together(), damped(squared=True, limit=5000), True),
        # alpha h < 0 drives Arrow-Hurwicz away.
        (concave(), arrow(0.1, 1.0), False),
        (concave(), damped(0.1, 0.1, 0.5), True),
        (dincl.scenes.four_disks(), arrow(0.1, 0.1), False),
    ],
)  # fmt: skip
def test_methods_converge_where_their_docstrings_say(problem, method, ends):
    assert bool(find(problem, method, throw=False).status) is ends


@pytest.mark.slow
def test_relative_move_stops_at_twice_eps_over_alpha():
    """Remark 3.6 with the step alpha/2 that c dtau = 2 leaves."""
    assert DampedArrowHurwicz.published(7) == damped(1e-4, 0.25, 1e-3, 2.0, 1.0, RelativeMove(1e-6), 7, squared=True)
    rest = np.array([3.0, -4.0])
    found = find(dincl.Problem([1.03 * rest], lambda t, x: rest - x, []), DampedArrowHurwicz.published())
    assert 0.0199 < np.linalg.norm(found.x - rest) / np.linalg.norm(found.x) <= 0.02
    assert found.iterations == pytest.approx(np.log(0.03 / (1 + 0.03) / 0.02) / 5e-5, rel=0.1)


def test_relative_move_counts_the_length_of_the_step():
    """Halving dtau with all else scaled as in Remark 3.5 changes nothing, to the last bit."""
    scene, dtau = dincl.scenes.four_disks(), 0.25
    one = find(scene, damped(damping=1.5, stop=RelativeMove(1e-5)))
    other = find(scene, damped(0.1 / dtau**2, 0.1 / dtau, 1 / dtau**2, 1.5 / dtau, dtau, RelativeMove(1e-5 / dtau)))
    assert one.iterations == other.iterations
    np.testing.assert_array_equal(one.x, other.x)


def test_only_near_pairs_are_looked_at():
    """Discs on a wide grid, pressed in pairs: rows stay few, however many discs there are."""
    corner = np.array([[4.0 * i, 4.0 * j] for i in range(20) for j in range(20)])
    rest, x0 = (np.concatenate((corner, corner + np.array([step, 0.0]))) for step in (0.6, 1.1))
    found = find(
        dincl.Problem(x0, lambda t, x: rest - x, [DISCS]), damped(gamma=0.5, stop=Stationary(1e-7), limit=2000)
    )
    np.testing.assert_allclose(found.multipliers, np.full(400, 0.2), atol=1e-6)
    assert found.stats.neighbour_builds < found.iterations / 5


@pytest.mark.parametrize("start", [0.0, 63.9, 99.0, 101.0, 130.0])
def test_newton_steps_double_along_a_plateau_and_are_bisected_beyond_a_narrow_bottom(start):
    def well(x):
        return -1 + 3 / (1 + np.exp(-np.clip(50 * (x - 100), -500, 500)))

    found, _ = free_minimum(well, np.array([start]), 1e-9)
    assert found[0] == pytest.approx(100 - np.log(2) / 50, abs=1e-9)


def test_uzawa_goes_downhill_from_a_maximum():
    """W = (x^2 - 1)^2/4: from near the maximum at 0, where Newton's method alone would stay, to the minimum at 1."""
    found = find(dincl.Problem([[1e-3]], lambda t, x: x - x**3), Uzawa(0.5, STOP))
    assert found.x[0, 0] == pytest.approx(1, abs=1e-8)


@pytest.mark.parametrize("slope", [lambda x: -np.ones_like(x), lambda x: -np.exp(-x)])
def test_a_slope_without_end_is_reported(slope):
    with pytest.raises(StepFailure, match=r"not minimised|no minimum"):
        free_minimum(slope, np.zeros(1), 1e-200)


def ends_above_one(t, x):
    if x[0, 0] > 1:
        raise ValueError
    return np.ones_like(x)


@pytest.mark.parametrize(
    ("problem", "method", "status"),
    [
        (pressed(), arrow(0.1, 0.1, 3), Status.NOT_CONVERGED),
        (pressed(), damped(limit=3), Status.NOT_CONVERGED),
        (pressed(), Uzawa(0.5, STOP, 1), Status.NOT_CONVERGED),
        (together(), arrow(30.0, 30.0), Status.NON_FINITE),
        (together(), damped(30.0, squared=True), Status.NON_FINITE),
        # W alone puts both discs on one point, where Uzawa's first step leaves them.
        (dincl.Problem([[-1.0], [1.0]], lambda t, x: -x, [DISCS]), Uzawa(0.5, STOP, 50), Status.COINCIDENT_CENTRES),
        (dincl.Problem([[0.0]], ends_above_one), arrow(0.3, 0.1), Status.DRIFT_FAILED),
        (weight(1.0), Uzawa(0.5, STOP, 50), Status.NOT_CONVERGED),
        (concave(), Uzawa(0.5, STOP, 50), Status.NOT_CONVERGED),
    ],
)
def test_what_stops_an_iteration_is_reported(problem, method, status):
    with pytest.raises(
        MinimisationFailed, match=f"{status.name}: .* After .* of at most {method.limit} steps"
    ) as failure:
        find(problem, method)
    found = failure.value.minimum
    assert found.status is status
    assert np.isfinite(found.x).all()
    assert np.isfinite(found.multipliers).all()
    assert found.residual > TOL


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: ArrowHurwicz(0.0, 0.1, STOP), r"alpha = 0\.0: must be a finite number > 0"),
        (lambda: ArrowHurwicz(0.1, 0.1, 1e-6), r"stop = 1e-06: must be Stationary"),
        (lambda: ArrowHurwicz(0.1, 0.1, STOP, 0), r"limit = 0: must be an integer >= 1"),
        (lambda: ArrowHurwicz(0.1, 0.1, STOP, 10, 1), r"squared = 1: must be True or False"),
        (lambda: damped(gamma=-1.0), r"gamma = -1\.0: must be a finite number >= 0"),
        (lambda: damped(dtau=np.nan), r"dtau = nan"),
        (lambda: Uzawa(0.1, RelativeMove(1e-3)), r"stop = .*: must be Stationary"),
        (lambda: Stationary(0.0), r"tol = 0\.0"),
        (lambda: RelativeMove(-1.0), r"eps = -1\.0"),
        (lambda: find(None, damped()), r"problem = None: must be a dincl\.Problem"),
        (lambda: find(pressed(), dincl.PBD(0.1)), r"minimiser = .*: must be a minimiser"),
    ],
)
def test_bad_input_is_refused(make, words):
    with pytest.raises(dincl.InvalidProblem, match=words):
        make()
