"""Random scenes, each run certified from its problem: none is lost without a Status, and no Status is wrong.

``--xslow`` runs a thousand of them, and more in plain Python; without it, those of a few seeds.
"""

import numpy as np
import pytest

import dincl
from tests.dincl.random_scenes import random_scene
from tests.twins.events.scheme import PlainEventDriven

TIMES = np.linspace(0, 1, 5)
STEP = 1 / 32
STEPS = [dincl.CatchUp, dincl.LinearisedCatchUp, dincl.MidpointCatchUp]
FEW, MANY = range(10), [pytest.param(range(k, k + 50), marks=pytest.mark.xslow) for k in range(0, 1000, 50)]
# In these a moving set leaves no place at all, for the plain forms as well.
EMPTY = {3, 460, 518, 547, 617, 733, 836, 859}


def farthest(x, y):
    return np.sqrt(((x - y) ** 2).sum(axis=-1)).max(axis=-1)


def certify_events(scene, seed):
    """A run of the event-driven method is feasible at all times, at rest on its contacts, as close as it says."""
    problem = scene.problem
    run = dincl.solve(problem, dincl.EventDriven(1e-9), TIMES, throw=False)
    assert np.isfinite(run.x).all(), scene.words
    assert bool(run.status) == (seed not in EMPTY), (scene.words, run.detail)
    if not run.status:
        return
    size = 1 + np.abs(run.x).max()
    between = np.linspace(0, TIMES[-1], 41)
    violations = [problem.violation(t, x) for t, x in zip(between, run(between), strict=True)]
    assert max(violations) <= 1e-10, scene.words
    assert run.violation().max() <= 1e-12 * size, scene.words
    assert run.normal_cone_residual().max() <= 1e-7, scene.words
    assert [event.t for event in run.events] == sorted(event.t for event in run.events), scene.words
    fine = dincl.solve(problem, dincl.EventDriven(1e-11), TIMES, throw=False)
    assert (farthest(run.x, fine.x) <= run.error + fine.error).all(), scene.words


def certify_steps(scene, scheme):
    """A run of a catch-up scheme ends as with another library, at the same states, which obey the conditions."""
    run = dincl.solve(scene.problem, scheme(STEP, dincl.ActiveSet(1e-10)), TIMES, throw=False)
    other = dincl.solve(scene.problem, scheme(STEP, dincl.Daqp(1e-10)), TIMES, throw=False)
    assert np.isfinite(run.x).all(), scene.words
    assert run.status is other.status, (scene.words, run.detail, other.detail)
    assert np.array_equal(run.t, other.t), scene.words
    assert farthest(run.x, other.x).max() <= 1e-8, scene.words
    if run.status and scheme is dincl.CatchUp:
        assert run.violation().max() <= 3e-9, scene.words
        assert run.normal_cone_residual()[1:].max() <= 1e-7, scene.words


@pytest.mark.slow
@pytest.mark.parametrize("seeds", [FEW, *MANY], ids=lambda seeds: f"{seeds[0]} to {seeds[-1]}")
def test_event_driven_runs(seeds):
    for seed in seeds:
        certify_events(random_scene(seed), seed)


@pytest.mark.parametrize("seeds", [FEW, *MANY], ids=lambda seeds: f"{seeds[0]} to {seeds[-1]}")
@pytest.mark.parametrize("scheme", STEPS)
def test_catch_up_runs(scheme, seeds):
    for seed in seeds:
        certify_steps(random_scene(seed), scheme)


# Discs with many contacts and releases, in all kinds of company.
BUSY = (13, 77, 81, *(pytest.param(seed, marks=pytest.mark.xslow) for seed in (83, 98)))


@pytest.mark.slow
@pytest.mark.parametrize("seed", BUSY)
def test_events_as_in_plain_python(seed):
    """The same events in the same order; a push that vanishes linearly leaves its time known to a threshold."""
    scene, t = random_scene(seed), np.linspace(0, 3, 7)
    run, plain = (dincl.solve(scene.problem, make(1e-9), t) for make in (dincl.EventDriven, PlainEventDriven))
    assert [event[1:] for event in run.events] == [event[1:] for event in plain.events], scene.words
    assert [event.t for event in run.events] == pytest.approx([event.t for event in plain.events], abs=2e-8)
    assert (farthest(run.x, plain.x) <= run.error + plain.error).all(), scene.words
