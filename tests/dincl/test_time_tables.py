"""Sets that depend on time alone are tabulated: the same paths as with functions that are called in each step."""

import numpy as np
import pytest

import dincl

X0 = np.array([[-0.6, 0.3], [0.7, 0.4], [0.1, -0.7]])
RADIUS = np.array([0.3, 0.35, 0.25])


def turned(t):
    return np.array([[np.cos(t), -np.sin(t)], [np.sin(t), np.cos(t)]])


def kinked(t):
    return 0.2 * abs(t - 0.6) - 0.12


def apart(x, i, j):
    return ((x[i] - x[j]) ** 2).sum() ** 0.5


PAIRS = [(0, 1), (0, 2), (1, 2)]
BALL = np.array([1.4, -1.0])
CENTRE = np.array([0.5, -0.2])
# A set, and the same one as a function of t and x.
SETS = {
    "a wall that turns": (
        dincl.Moving(dincl.HalfSpace((0, 1), -1.0, RADIUS), dincl.RigidMotion(lambda t: t, lambda t: (0, 0.3 * t))),
        lambda t, x: (x - [0, 0.3 * t]) @ turned(t)[:, 1] + 1.0 - RADIUS,
    ),
    "a wall that turns about a point": (
        dincl.Moving(dincl.HalfSpace((0, 1), -1.0, RADIUS), dincl.RigidMotion(np.sin, centre=CENTRE)),
        lambda t, x: (x - CENTRE) @ turned(np.sin(t))[:, 1] + CENTRE[1] + 1.0 - RADIUS,
    ),
    "a wall that is carried": (
        dincl.Moving(dincl.HalfSpace((1, 0), -1.0, RADIUS), lambda t: (0.5 * t + 0.1 * np.sin(3 * t), 0.0)),
        lambda t, x: x[:, 0] - 0.5 * t - 0.1 * np.sin(3 * t) + 1.0 - RADIUS,
    ),
    "a wall whose offset has a kink": (
        dincl.HalfSpace((1, 0), lambda t: -0.95 + kinked(t), RADIUS),
        lambda t, x: x[:, 0] + 0.95 - kinked(t) - RADIUS,
    ),
    "a wall that jumps": (
        dincl.HalfSpace((1, 0), lambda t: -0.95 if t < 0.55 else -0.8, RADIUS),
        lambda t, x: x[:, 0] + (0.95 if t < 0.55 else 0.8) - RADIUS,
    ),
    "a ball that comes": (
        dincl.Moving(dincl.OutsideBall(BALL, lambda t: 0.5 + 0.1 * t), lambda t: (-t, 0.4 * t)),
        lambda t, x: ((x - BALL - [-t, 0.4 * t]) ** 2).sum(axis=1) ** 0.5 - 0.5 - 0.1 * t,
    ),
    "a ball that turns": (
        dincl.Moving(dincl.OutsideBall(BALL, 0.5), dincl.RigidMotion(lambda t: -t)),
        lambda t, x: ((x - turned(-t) @ BALL) ** 2).sum(axis=1) ** 0.5 - 0.5,
    ),
    "threads that shrink": (
        dincl.MaxDistance([(0, 1), (1, 2)], lambda t: np.array([1.6, 1.5]) * (1 - 0.3 * t)),
        lambda t, x: np.array([1.6, 1.5]) * (1 - 0.3 * t) - np.array([apart(x, 0, 1), apart(x, 1, 2)]),
    ),
    "discs that grow": (
        dincl.NonOverlap(lambda t: RADIUS * (1 + 0.5 * t**2)),
        lambda t, x: np.array([apart(x, i, j) - (1 + 0.5 * t**2) * (RADIUS[i] + RADIUS[j]) for i, j in PAIRS]),
    ),
}
# How far the paths may be apart: compiled code and functions of t and x give velocities of sets in different ways.
SCHEMES = {
    "CatchUp": (dincl.CatchUp(1 / 256, dincl.ActiveSet(1e-13)), 1e-11),
    "LinearisedCatchUp": (dincl.LinearisedCatchUp(1 / 256, dincl.ActiveSet(1e-13)), 1e-11),
    "MidpointCatchUp": (dincl.MidpointCatchUp(1 / 256, dincl.ActiveSet(1e-13)), 1e-11),
    "Penalty": (dincl.Penalty(1 / 512, 50.0), 1e-11),
    "AdaptiveCatchUp": (dincl.AdaptiveCatchUp(1e-5), 1e-8),
    "EventDriven": (dincl.EventDriven(1e-9), 2e-9),
}
TIMES = [0.25, 0.55, 1.0]


def problem(one):
    return dincl.Problem(X0, dincl.drifts.swirl((0.3, 0.0), 1.0), [one])


@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize("name", SETS)
def test_a_tabulated_set_is_the_set(name, scheme):
    one, gap = SETS[name]
    made, apart = SCHEMES[scheme]
    path, called = (dincl.solve(problem(s), made, TIMES) for s in (one, dincl.Smooth(gap)))
    assert np.abs(path.x - called.x).max() <= apart
    # Compiled sweeps and penalties take discs as pairs, whose radii Python writes.
    assert path.stats.callbacks == 0 or (name, scheme) == ("discs that grow", "Penalty")
    assert called.stats.callbacks > 0
    assert path.violation().max() <= called.violation().max() + 1e-12


@pytest.mark.parametrize(
    "scheme", [dincl.PBD(1e-4), dincl.XPBD(1e-4), dincl.CatchUp(1e-4, dincl.ActiveSet(1e-10))], ids=repr
)
def test_a_function_of_time_is_called_less_often_than_there_are_steps(scheme):
    calls = []

    def angle(t):
        calls.append(t)
        return float(np.sin(t))

    wall = dincl.Moving(dincl.HalfSpace((0, 1), -1.0, RADIUS), dincl.RigidMotion(angle))
    assert dincl.solve(problem(wall), scheme, TIMES).stats.steps == 10_000
    assert len(calls) < 3_000
    assert max(calls) <= 1.0


@pytest.mark.parametrize(
    ("height", "places", "scheme", "most"),
    [
        # Two kinks, one close to a time that is looked at, or at an output time, are two breaks.
        (
            lambda t: abs(t) + 1e-3 * abs(t + 0.113),
            [0.236, 0.25, 0.5, 0.66219, 0.75, 0.764],
            dincl.AdaptiveCatchUp(1e-3),
            550,
        ),
        # Beside a root pieces become short from either side.
        (lambda t: np.sqrt(max(t, 0.0)), [0.2, 0.81], dincl.AdaptiveCatchUp(1e-3), 2800),
        (lambda t: np.sqrt(max(-t, 0.0)), [0.2, 0.81], dincl.AdaptiveCatchUp(1e-3), 2800),
        # A set that Python evaluates is compared once with where it was, at each of the times of a step.
        (lambda t: t, [0.5], dincl.MidpointCatchUp(1 / 36, dincl.ActiveSet(1e-10)), 360),
        (lambda t: t, [0.5], dincl.LinearisedCatchUp(1 / 36, dincl.ActiveSet(1e-10)), 144),
        # From 40 steps on it is looked at before the run.
        (lambda t: t, [0.5], dincl.MidpointCatchUp(1 / 50, dincl.ActiveSet(1e-10)), 120),
    ],
    ids=["kinks", "root", "root before", "midpoint", "linearised", "looked at before"],
)
def test_a_function_of_time_is_called_seldom(height, places, scheme, most):
    for place in places:
        calls = []

        def path(t, place=place, calls=calls):
            calls.append(t)
            return 0.0, 0.2 * height(t - place)

        floor = dincl.Moving(dincl.HalfSpace((0, 1), -1.3, 0.1), path)
        at = dincl.Problem(X0, dincl.drifts.swirl((0.3, 0.0), 1.0), [floor], mobility=[1.0, 2.0, 1.0])
        assert dincl.solve(at, scheme, [0.25, 0.5, 0.75, 1.0]).status
        assert len(calls) <= most


def test_what_a_set_refuses_between_steps_that_are_looked_at_ends_the_run():
    """A radius that is negative for a tenth of the run, and a pulse of 32 steps at an output time."""
    shrinks = dincl.InsideBall(centre=(0, 0), distance=lambda t: 4 * (t - 0.5) ** 2 - 0.01)
    at = dincl.Problem([[0.0, 0.2]], dincl.drifts.constant((0.0, 0.0)), [shrinks])
    for scheme in (dincl.PBD(1 / 400), dincl.EventDriven(1e-9), dincl.Auto(1e-3)):
        assert dincl.solve(at, scheme, [1.0], throw=False).status.name == "CONSTRAINT_FAILED"
    stroke = dincl.Moving(
        dincl.HalfSpace(normal=(0, 1)),
        lambda t: (0.0, np.cos(np.pi / 2 * (t - 0.5) / 0.0016) ** 2 if abs(t - 0.5) < 0.0016 else 0.0),
    )
    struck = dincl.solve(dincl.Problem(at.x0, at.drift, [stroke]), dincl.PBD(1e-4), [0.5, 1.0])
    assert struck.x[:, 0, 1] == pytest.approx(1.0)


def test_a_rough_function_is_called_in_each_step():
    """What is not resolved by the calls that a run may make is as it was: the same steps as with few of them."""
    noise = np.random.default_rng(0).normal(size=20_001)

    def path(t):
        return 0.0, -1e-3 * abs(noise[round(2e4 * t)])

    moving = problem(dincl.Moving(dincl.HalfSpace((0, 1), -0.95, RADIUS), path))
    scheme = dincl.CatchUp(1 / 400, dincl.ActiveSet(1e-12))
    whole, first = dincl.solve(moving, scheme, [0.25, 1.0]), dincl.solve(moving, scheme, [0.25])
    assert whole.stats.callbacks >= 400
    assert np.array_equal(whole.x[0], first.x[0])
    assert whole.violation().max() <= 1e-11


def test_what_fails_late_is_said_late():
    def path(t):
        if t > 0.7:
            raise ValueError("no path any more")
        return 0.0, 0.2 * t

    moving = problem(dincl.Moving(dincl.HalfSpace((0, 1), -0.95, RADIUS), path))
    for scheme in (dincl.PBD(1e-3), dincl.CatchUp(1e-3, dincl.ActiveSet(1e-10)), dincl.EventDriven(1e-8)):
        run = dincl.solve(moving, scheme, [0.5, 1.0], throw=False)
        assert run.status is dincl.Status.CONSTRAINT_FAILED
        assert "no path any more" in run.detail
        assert 0.4 <= run.t[-1] <= 0.71
