"""Runs of the event-driven method that are long, go far, or start small."""

import copy

import numpy as np
import pytest

import dincl
from dincl.errors import StepFailure
from dincl.events import run as events
from dincl.work import Work


def test_a_run_of_any_number_of_calls(monkeypatch):
    """Each call may make more steps than the last one, but never more than a run may have."""
    monkeypatch.setattr(events, "FEWEST", 2**61)
    problem = dincl.Problem([[1.0]], lambda t, x: np.full((1, 1), np.cos(5 * t)), [dincl.HalfSpace((1,), -9.0)])
    path = dincl.solve(problem, dincl.EventDriven(1e-5), np.linspace(1, 200, 5))
    assert path.stats.steps > 2000
    assert np.abs(path.x[:, 0, 0] - (1 + np.sin(5 * path.t) / 5)).max() <= path.error.max() <= 1e-5


@pytest.mark.parametrize("start", [1e-12, 1e-9, 1e-6, 0.0])
@pytest.mark.parametrize("seed", [0, 4, 7, 10])
def test_a_start_next_to_the_origin_says_nothing_of_the_size(start, seed):
    """The contacts come at coordinates near 1, where rounding is that of 1."""
    rng = np.random.default_rng(seed)
    count = 1 + seed % 3
    walls = [dincl.HalfSpace(normal, -1.0 - rng.random()) for normal in rng.normal(size=(2, 2))]
    push = 2 * rng.normal(size=(count, 2))
    problem = dincl.Problem(
        start * rng.normal(size=(count, 2)),
        lambda t, x: push * np.cos(t) + x[:, ::-1] * [1, -1],
        [*walls, dincl.InsideBall((0, 0), 2.0)],
    )
    path = dincl.solve(problem, dincl.EventDriven(1e-7), [0.5, 1.0, 2.0, 4.0])
    assert len(path.events) >= 2
    assert path.violation().max() <= 1e-13
    assert path.normal_cone_residual().max() <= 1e-7


@pytest.mark.parametrize("far", [1e2, 1e4])
def test_a_disc_that_pushes_another_far_away_stays_in_contact(far):
    """The gap is kept to the rounding of places that are much larger than those at the start."""
    problem = dincl.Problem([[0.1], [1.1]], lambda t, x: np.array([[2.0], [1.0]]) * far, [dincl.NonOverlap(0.5)])
    path = dincl.solve(problem, dincl.EventDriven(1e-11 * far), [0.1, 1.0])
    exact = 1.5 * far * path.t[:, None] + [0.1, 1.1]
    assert path.events == ()
    assert (np.abs(path.x[:, :, 0] - exact).max(axis=1) <= path.error).all()
    assert path.normal_cone_residual().max() <= 1e-12 * far


def test_a_trajectory_says_the_same_twice_and_so_do_its_copies():
    problem = dincl.Problem(
        [[0.0, 0.5], [1.2, 0.5]],
        lambda t, x: np.array([[1.0, np.sin(4 * t)], [-1.0, -1.0]]),
        [dincl.NonOverlap(0.5), dincl.Moving(dincl.HalfSpace((0, 1)), lambda t: (0.0, 0.1 * np.sin(t)))],
    )
    path, t = dincl.solve(problem, dincl.EventDriven(1e-8), [0.5, 1.0]), np.linspace(0, 1, 7)
    first = path(t)
    for again in (path, copy.copy(path), copy.deepcopy(path)):
        assert np.array_equal(again(t), first)
        assert np.array_equal(again(t[::-1]), first[::-1])
        assert np.array_equal(again.normal_cone_residual(), path.normal_cone_residual())


@pytest.mark.slow
def test_a_finer_run_passes_what_stops_a_coarse_one():
    """With a local tolerance of 3, contacts of a crowd change back and forth at one time."""
    scene = dincl.scenes.pile(40)
    coarse, fine = (dincl.solve(scene, dincl.EventDriven(tol), scene.times[-1]) for tol in (300.0, 1e-6))
    assert np.abs(coarse.x - fine.x).max() <= coarse.error.max() <= 300.0
    system, end = events.EventSystem(scene, coarse.t, 3.0), float(coarse.t[-1])
    first = events.EventRun(system, system.start(Work()), end, 3.0, 1, Work())
    with pytest.raises(StepFailure, match="100 changes"):
        first.integrate()
