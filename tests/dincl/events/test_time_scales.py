"""Functions of time that come and go: the event-driven method resolves sets and drifts that it need not meet."""

import numpy as np
import pytest

import dincl
from dincl.system.kinks import NO_KINKS, kinks_and_pieces, smooth_around
from dincl.system.time_scales import TimeScales, time_scales

SHAKER = dincl.Moving(dincl.HalfSpace(normal=(1, 0)), lambda t: (0.6 * np.sin(t), 0.0))
BUMP = dincl.Moving(dincl.HalfSpace(normal=(1, 0)), lambda t: (np.exp(-(((t - 0.713) / 0.05) ** 2)), 0.0))
SHAKEN = dincl.Problem([[0.5, 0.0]], lambda t, x: 0 * x + np.floor(7 * t), [SHAKER])
BALL = dincl.OutsideBall(centre=lambda t: (t - 2.0, 0.0), distance=0.3)


@pytest.mark.parametrize(
    ("moving", "start", "t", "exact"), [(SHAKER, 0.5, 100.0, 0.6), (BUMP, 0.5, 4.0, 1.0), (BALL, 0.0, 4.0, 2.3)]
)
def test_a_set_that_comes_and_goes_pushes_what_is_at_rest(moving, start, t, exact):
    """Nothing else limits the step: a wall that shakes 16 times, one that comes once, a ball whose centre is met."""
    problem = dincl.Problem([[start, 0.0]], lambda t, x: 0 * x, [moving])
    path = dincl.solve(problem, dincl.EventDriven(1e-9), [t])
    assert path.final[0, 0] == pytest.approx(exact, abs=1e-9)
    assert abs(path.final[0, 0] - exact) <= path.error[0]


def test_a_contact_that_is_missed_is_no_success(monkeypatch):
    """Steps as long as the run meet no wall; the overlap between the output times says so."""
    unseen = TimeScales(NO_KINKS, NO_KINKS, None, 0)
    monkeypatch.setattr("dincl.events.run.time_scales", lambda problem, end: unseen)
    problem = dincl.Problem([[0.5, 0.0]], lambda t, x: 0 * x, [SHAKER])
    path = dincl.solve(problem, dincl.EventDriven(1e-9), [100.0], throw=False)
    assert path.status is dincl.Status.NOT_CONVERGED
    assert path.error[0] > 0.05


def test_scales_of_functions_of_time():
    """A straight path asks for four steps, a jump or a root of the drift for few more, a shaker for two a period."""
    wall = dincl.HalfSpace(normal=(1,))

    def shortest(path, drift=lambda t: 0.0):
        problem = dincl.Problem([[2.0]], lambda t, x: 0 * x + drift(t), [dincl.Moving(wall, lambda t: [path(t)])])
        return time_scales(problem, 1.0).shortest

    assert shortest(lambda t: -t) == 0.25
    assert shortest(lambda t: -t, lambda t: float(t > 0.3)) > 0.05
    assert shortest(lambda t: -t, lambda t: abs(t - 0.3) ** 0.5) > 1e-4
    assert 0.004 < shortest(lambda t: -np.sin(200 * t)) < np.pi / 200
    assert (time_scales(SHAKEN, 1.0).pieces[:, 1] > 0).all()


def test_a_pulse_of_the_drift_is_seen():
    """It takes a fortieth of the run, before and after which nothing moves: x = 1/2 + sqrt(pi)."""
    pulse = dincl.Problem([[0.5]], lambda t, x: 0 * x + np.exp(-(((t - 0.713) / 0.03) ** 2)) / 0.03)
    path = dincl.solve(pulse, dincl.EventDriven(1e-9), [2.0])
    assert abs(path.final[0, 0] - 0.5 - np.sqrt(np.pi)) <= path.error[0]
    assert path.stats.drift_evaluations > 500


@pytest.mark.slow
def test_kinks_of_paths_are_found_to_rounding(rng):
    paths = [
        lambda t: np.array([min(1.0, 2 * t), 0.0]),
        lambda t: np.array([np.cos(30 * t), abs((3 * t) % 1 - 0.5)]),
    ]
    found, pieces = kinks_and_pieces(paths, 1.2)
    assert np.abs(found - np.array([1, 2, 3, 4, 5, 6, 7])[:, None] / 6).max() <= 2e-15
    assert pieces[:, 1].max() < 0.5 * 2 * np.pi / 30  # half a period
    assert len(kinks_and_pieces([lambda t: np.array([1e3 + np.cos(40 * t)])], 2.0)[0]) == 0
    assert [len(one) for one in kinks_and_pieces([lambda t: rng.random(1)], 1.0)] == [0, 0]
    assert smooth_around(0.0, found) == (0.0, found[0, 0])
    assert smooth_around(0.4, found) == (found[1, 1], found[2, 0])
    assert smooth_around(9.0, found) == (found[-1, 1], np.inf)
