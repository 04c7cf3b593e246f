"""Runs of many particles: sparse factors, short steps that end by their dense output, redundant contacts."""

import numpy as np
import pytest

import dincl
from dincl.events import run as events
from tests.dincl.events.test_event_driven import farthest, random_discs, turned

TOL = 1e-8


def hexagon(k):
    """The 3 k (k + 1) + 1 places of a hexagonal lattice with k rings: 3 k (3 k + 1) contacts of discs of radius 1/2."""
    steps = np.arange(-k, k + 1)
    return np.array([(a + b / 2, b * np.sqrt(3) / 2) for a in steps for b in steps if abs(a + b) <= k])


@pytest.mark.slow
def test_three_hundred_discs():
    """The stated error holds against a run with a tighter tolerance, and both see the same events."""
    scene, t = dincl.scenes.pile(300), [0.1, 0.2]
    coarse, fine = (dincl.solve(scene, dincl.EventDriven(tol), t) for tol in (1e-6, 1e-10))
    assert coarse.error.max() <= 1e-6
    assert fine.error.max() <= 1e-10
    assert (farthest(coarse.x, fine.x) <= coarse.error).all()
    assert [event[1:] for event in coarse.events] == [event[1:] for event in fine.events]
    assert len(fine.events) > 250
    assert fine.violation().max() <= 1e-13
    assert fine.normal_cone_residual().max() <= 1e-10


@pytest.mark.slow
def test_midpoint_catch_up_converges_to_it():
    """Catch-up shares neither the steps nor the search for events; contacts keep its order below two."""
    scene, t = dincl.scenes.pile(300), [0.1, 0.2]
    path = dincl.solve(scene, dincl.EventDriven(TOL), t)
    steps = (1 / 250, 1 / 1000, 1 / 4000)
    runs = [dincl.solve(scene, dincl.MidpointCatchUp(h, dincl.ProjectedNewton(1e-12)), t) for h in steps]
    coarse, middle, fine = (farthest(run.x, path.x).max() for run in runs)
    assert fine < middle / 3 < coarse / 9
    assert fine <= 1e-5


@pytest.mark.parametrize(("n", "d", "kind", "seed"), [(30, 2, "drawn", 0), (24, 2, "shaken", 5), (16, 3, "stirred", 1)])
def test_what_many_particles_need_is_right_for_few(n, d, kind, seed, monkeypatch):
    problem, t = random_discs(n, d, kind, seed), [0.5, 1.0, 2.0]
    few = dincl.solve(problem, dincl.EventDriven(TOL), t)
    monkeypatch.setattr(events, "MANY", 0)
    many = dincl.solve(problem, dincl.EventDriven(TOL), t)
    assert (farthest(few.x, many.x) <= few.error + many.error).all()
    assert [event[1:] for event in few.events] == [event[1:] for event in many.events]
    assert many.violation().max() <= 1e-13


@pytest.mark.slow
def test_a_lattice_turns_as_one():
    """127 discs have 342 contacts and 251 relative freedoms."""
    places = hexagon(6)
    problem = dincl.Problem(places, lambda t, x: turned(x, np.pi / 2) - x, [dincl.NonOverlap(0.5)])
    path = dincl.solve(problem, dincl.EventDriven(TOL), [1.0, 3.0])
    error = farthest(path.x, np.array([turned(places, t) for t in path.t]))
    assert (error <= path.error).all()


@pytest.mark.slow
def test_a_lattice_opens_and_closes_at_once():
    places = hexagon(6)
    opens = dincl.Problem(places, lambda t, x: (t - 1) * x, [dincl.NonOverlap(0.5)])
    path = dincl.solve(opens, dincl.EventDriven(TOL), [1.0, 2.0])
    assert farthest(path.final, places * np.exp(0.5)) <= path.error[-1]
    assert [event.kind for event in path.events] == ["release"] * 342
    closes = dincl.Problem(2 * places, lambda t, x: -x, [dincl.NonOverlap(0.5)])
    path = dincl.solve(closes, dincl.EventDriven(TOL), [0.5, 3.0])
    assert (farthest(path.x, np.array([2 * np.exp(-0.5) * places, places])) <= path.error).all()
    assert np.ptp([event.t for event in path.events][:342]) <= 1e-8


@pytest.mark.slow
def test_moving_walls_squeeze_many_discs():
    """A wall that moves is asked for in every stage; the discs in front of it pile up."""
    discs = dincl.scenes.pile(120)
    wall = dincl.Moving(dincl.HalfSpace((1, 0), radius=discs.radius), lambda t: (0.5 * t, 0.0))
    problem = dincl.Problem(discs.x0, lambda t, x: np.tile([0.0, -1.0], (len(x), 1)), [*discs.constraints, wall])
    t = [0.1, 0.3]
    coarse, fine = (dincl.solve(problem, dincl.EventDriven(tol), t) for tol in (1e-6, 1e-9))
    assert (farthest(coarse.x, fine.x) <= coarse.error + fine.error).all()
    assert fine.violation().max() <= 1e-12


def test_a_path_of_several_parts_is_one(monkeypatch):
    """Times in any order, before, at and after the places where a path is divided."""
    scene = dincl.scenes.pile(30)
    whole = dincl.solve(scene, dincl.EventDriven(TOL), [1.0])
    monkeypatch.setattr(events, "FEWEST", 7)
    monkeypatch.setattr(events, "SHORT", 0.0)
    parts = dincl.solve(scene, dincl.EventDriven(TOL), [1.0])
    t = np.linspace(0, 1, 300)[::-1]
    assert len(parts.events) == len(whole.events)
    assert np.array_equal(parts(t), whole(t))
    assert np.array_equal(parts.normal_cone_residual(), whole.normal_cone_residual())
