"""Proved balls contain exact solutions, shrink as asked for, and what cannot be proved is refused with a reason."""

import mpmath
import numpy as np
import pytest

import dincl
import verification as v
from dincl import scenes
from dincl.drifts import attraction, constant

EXACT = {
    "sliding_disc": (1.5, 3.0),
    "two_disks": (2.0, 4.0),
    "stack": (0.5, 1.0, 1.5),
    "step_inclusion": (0.5, 1.0),
    "sweeping_interval": (1.0, 2.0, 10.0),
}


@pytest.mark.slow_with("sweeping_interval")
@pytest.mark.parametrize("name", EXACT)
def test_balls_contain_the_exact_solution(name):
    scene = getattr(scenes, name)()
    proof = v.prove(scene, EXACT[name], bound=1e-25)
    assert proof.bound <= 1e-25
    assert (proof.radius <= 1e-25).all()
    with mpmath.workdps(60):
        for t, ball, radius in zip(proof.t, proof.certificate.balls, proof.radius, strict=True):
            centre = [mpmath.mpf(m) * mpmath.mpf(2) ** e for m, e in ball.centre]
            off = [c - x for c, x in zip(centre, scene.exact.digits(t).ravel(), strict=True)]
            assert mpmath.norm(off) <= radius


def test_two_proofs_of_one_scene_overlap():
    scene = scenes.four_disks()
    coarse, fine = v.prove(scene, [1.0, 2.0], bound=1e-6), v.prove(scene, [1.0, 2.0], bound=1e-20)
    assert fine.bound <= 1e-20
    assert (np.linalg.norm((coarse.x - fine.x).reshape(2, -1), axis=1) <= coarse.radius + 1e-15).all()


@pytest.mark.slow
def test_ten_discs_in_a_corner():
    proof = v.prove(scenes.ten_disks_corner(), [3.0], bound=1e-12)
    path = dincl.solve(scenes.ten_disks_corner(), dincl.EventDriven(1e-11), t=[3.0])
    assert proof.bound <= 1e-12
    assert proof.errors(path.x)[0] <= path.error[0]


def test_a_wrong_state_has_a_large_error():
    scene = scenes.two_disks()
    proof = v.prove(scene, [2.0], bound=1e-12)
    moved = proof.x + 0.25
    assert proof.errors(moved)[0] == pytest.approx(0.25 * np.sqrt(2))


SETS = {
    "threads": (
        [[0.0, 0.0], [1.0, 0.0]],
        constant([[0.0, 0.0], [1.0, 0.5]]),
        [dincl.MaxDistance([(0, 1)], 1.5)],
    ),
    "container": ([[0.2, 0.1, 0.0]], constant([1.0, 0.5, 0.2]), [dincl.InsideBall((0.0, 0.0, 0.0), 1.0)]),
    "order": ([[0.5], [1.0], [2.0]], attraction(0.0, [0.1, 3.0, 2.0]), [dincl.Ordered([0, 1, 2], 0)]),
    "four balls": (
        [[1.0, 0.1, 0.2], [-1.0, 0.3, 0.1], [0.1, 1.2, 0.0], [0.0, 0.2, -1.3]],
        attraction(0),
        [dincl.NonOverlap([0.5, 0.4, 0.5, 0.6])],
    ),
    "floor twice": (
        [[0.0, 1.0], [1.4, 1.2]],
        constant([[0.3, -1.0], [-0.2, -1.0]]),
        [dincl.NonOverlap(0.5), dincl.HalfSpace((0, 1), 0.0, 0.5), dincl.HalfSpace((0, 1), 0.0, 0.5)],
    ),
    "three walls for two coordinates": (
        [[1.0, 0.9]],
        constant([-1.0, -0.8]),
        [dincl.HalfSpace((1, 0)), dincl.HalfSpace((0, 1)), dincl.HalfSpace((1, 1))],
    ),
    "contact at the start": ([[0.0, 0.0], [1.0, 0.0], [2.0, 0.5]], attraction(0), [dincl.NonOverlap(0.5)]),
    "three discs in a corner": (
        [[1.0, 0.7], [0.9, 2.0], [2.3, 0.8]],
        constant([-1.0, -0.8]),
        [dincl.NonOverlap(0.5), dincl.HalfSpace((1, 0), 0.0, 0.5), dincl.HalfSpace((0, 1), 0.0, 0.5)],
    ),
}


@pytest.mark.parametrize("name", SETS)
def test_all_sets_agree_with_events(name):
    problem = dincl.Problem(*SETS[name])
    proof = v.prove(problem, [0.7, 1.4], bound=1e-15)
    path = dincl.solve(problem, dincl.EventDriven(1e-11), t=[0.7, 1.4])
    assert path.events
    assert proof.bound <= 1e-15
    assert (proof.errors(path.x) <= 1e-11).all()


def wall(t):
    """Return a wall that swings: 0.3 sin(2 t) upwards."""
    return 0.0, 0.3 * np.sin(2 * t)


def swung(t, x):
    """Return a drift that depends on time and is not linear."""
    return np.stack([np.cos(t) - x[:, 0] ** 3, -1 - np.sin(x[:, 0]) * x[:, 1]], axis=1)


@pytest.mark.slow
def test_a_moving_wall_and_a_drift_of_your_own():
    problem = dincl.Problem(
        [[0.3, 1.0], [1.6, 1.2]], swung, [dincl.NonOverlap(0.5), dincl.Moving(dincl.HalfSpace((0, 1), 0.0, 0.5), wall)]
    )
    proof = v.prove(problem, [1.0, 2.0], bound=1e-12)
    path = dincl.solve(problem, dincl.EventDriven(1e-11), t=[1.0, 2.0])
    assert len(path.events) >= 2
    assert (proof.errors(path.x) <= 1e-10).all()
    assert any("swung" in one for one in proof.assumed)


@pytest.mark.slow
def test_a_moving_container():
    ball = dincl.Moving(dincl.InsideBall((0.1, -0.2), 1.0), wall)
    problem = dincl.Problem([[0.2, 0.1]], constant([1.0, 0.5]), [ball])
    proof = v.prove(problem, [1.0, 2.0], bound=1e-12)
    path = dincl.solve(problem, dincl.EventDriven(1e-11), t=[1.0, 2.0])
    assert path.events
    assert (proof.errors(path.x) <= 1e-10).all()


def test_what_cannot_be_proved_is_refused_with_a_reason():
    ring = [[1.0, 0.0], [0.0, 0.0], [-1.0, 0.0]]
    smooth = dincl.Problem(ring, attraction(0), [dincl.Smooth(lambda x: 2 - (x**2).sum(axis=1))])
    with pytest.raises(dincl.InvalidProblem, match="Smooth: proofs know"):
        v.prove(smooth, [1.0])
    with pytest.raises(dincl.InvalidProblem, match="must be a function at the top of a module"):
        v.prove(dincl.Problem(ring, lambda t, x: -x), [1.0])
    growing = dincl.Problem([[0.0, 0.0], [3.0, 0.0]], attraction(0), [dincl.NonOverlap(lambda t: 0.5 + 0.1 * t)])
    with pytest.raises(dincl.InvalidProblem, match="NonOverlap must rest, or be translated"):
        v.prove(growing, [1.0])
    turning = dincl.Moving(dincl.HalfSpace((0, 1)), dincl.RigidMotion(lambda t: t))
    with pytest.raises(dincl.InvalidProblem, match="Moving must rest, or be translated"):
        v.prove(dincl.Problem([[0.0, 1.0]], attraction(0), [turning]), [1.0])
    with pytest.raises(dincl.InvalidProblem, match="increasing times"):
        v.prove(dincl.Problem(ring, attraction(0)), [1.0, 0.5])


def rooted(t, x):
    """Return a drift with a power that is no whole number."""
    return -(x**1.5)


def branching(t, x):
    """Return a drift that asks for the side of a line."""
    return np.where(x > 0, -x, x)


def bent(t, x):
    """Return a drift with the absolute value of a number."""
    return 0 * x + [abs(t - 1.0), 0.0]


def largest(t, x):
    """Return a drift with the larger of two numbers."""
    return 0 * x + [max(0.0, t - 1.0), 0.0]


def converted(t, x):
    """Return a drift that makes the time a double number."""
    return 0 * x + [np.sin(float(t)), 0.0]


@pytest.mark.parametrize("drift", [rooted, branching, bent, largest, converted])
def test_functions_that_treat_balls_otherwise_than_numbers_are_refused(drift):
    with pytest.raises(v.NotProved, match=f"{drift.__name__} cannot be evaluated on balls: .* not if, abs or max"):
        v.prove(dincl.Problem([[1.0, 0.5]], drift), [1.0])


def still(t, x):
    """Return a drift of zero."""
    return 0 * x


def kinked(t):
    """Return a path that ends at a time by a comparison."""
    return (t if t < 0.8 else 0.8), 0.0


def narrow(t):
    """Return a path with poles near the real times."""
    return 0.4 / (1 + ((t - 0.3) / 1e-2) ** 2), 0.0


@pytest.mark.parametrize(
    ("path", "reason"), [(kinked, "not if, abs or max"), (narrow, "a ball contains a zero of a denominator")]
)
def test_a_path_that_cannot_be_evaluated_is_named(path, reason):
    wall = dincl.Moving(dincl.HalfSpace((1.0, 0.0)), path)
    with pytest.raises(v.NotProved, match=f"{path.__name__} cannot be evaluated on balls: .*{reason}"):
        v.prove(dincl.Problem([[0.5, 0.0]], still, [wall]), [0.6], bound=1e-6)


def test_a_bound_that_cannot_be_reached_is_not_claimed():
    # The start is feasible only up to rounding, so nothing below it can be proved.
    off = dincl.Problem([[0.0, 0.0], [0.8 - 1e-13, 0.6]], attraction(0), [dincl.NonOverlap(0.5)])
    proof = v.prove(off, [1.0], bound=1e-9)
    assert 1e-13 <= proof.bound <= 1e-9
    assert any("feasible up to rounding" in one for one in proof.assumed)
    with pytest.raises(v.NotProved) as failed:
        v.prove(off, [1.0], bound=1e-16)
    assert 1e-13 <= failed.value.best <= 1e-9
