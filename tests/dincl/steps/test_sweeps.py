"""Compiled steps of position based dynamics and of the penalty method against their reference implementation."""

from dataclasses import dataclass

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

import dincl
from dincl.neighbours import ALL_PAIRS
from dincl.rows import CustomSweep
from dincl.schemes.base import run_steps
from dincl.steps.grid import StepState
from dincl.steps.stepper import CompiledStepper
from dincl.steps.sweeping import pbd
from tests.dincl.catalog import SCENES
from tests.dincl.own_constraints import InBall, InEllipse
from tests.twins import sweeps as reference

SCHEMES = [
    pytest.param(dincl.PBD(0.02), id="PBD"),
    pytest.param(dincl.PBD(0.02, sweeps=3), id="PBD-3-sweeps"),
    pytest.param(dincl.SecondOrderPBD(0.02), id="SecondOrderPBD"),
    pytest.param(dincl.Penalty(0.02, strength=20.0), id="Penalty"),
    pytest.param(dincl.Penalty(0.02, strength=2.0, exponent=1), id="Penalty-printed"),
]


def both(problem, scheme, times):
    """The run, and the same by the reference implementation."""

    def bind():
        if isinstance(scheme, dincl.Penalty):
            return reference.PushingStepper(problem, scheme)
        v0 = np.zeros_like(problem.x0) if isinstance(scheme, dincl.SecondOrderPBD) else None
        return reference.SweepingStepper(problem, scheme.sweeps, v0)

    found = dincl.solve(problem, scheme, t=times, throw=False)
    return found, run_steps(bind, scheme.dt, np.array(times))


def agree(found, other):
    assert found.t.tolist() == other.t.tolist()
    assert found.x.tobytes() == other.x.tobytes()
    for name in ("steps", "drift_evaluations", "constraint_projections"):
        assert getattr(found.stats, name) == getattr(other.stats, name)


def mixed(rng, d):
    """Discs of two kinds that do not meet, threads, an order, a wall, an obstacle, a container: all of them push."""
    side = np.stack(np.unravel_index(rng.permutation(16), (4,) * 2), axis=1)
    x0 = np.zeros((16, d))
    x0[:, : min(d, 2)] = 1.3 * side[:, : min(d, 2)]
    x0 += rng.uniform(-0.05, 0.05, size=x0.shape)
    if d == 1:
        x0 = 1.3 * rng.permutation(16)[:, None] + rng.uniform(-0.05, 0.05, size=(16, 1))
    order = np.argsort(x0[:, 0])
    ends = np.column_stack((order[:-1:3], order[1::3]))
    sets = [
        dincl.HalfSpace(np.arange(1, d + 1), offset=-0.5, radius=rng.uniform(0.1, 0.3, size=16)),
        dincl.NonOverlap(rng.uniform(0.4, 0.6, size=9), among=rng.permutation(16)[:9]),
        dincl.MaxDistance(ends, np.linalg.norm(x0[ends[:, 0]] - x0[ends[:, 1]], axis=1) + 0.01),
        dincl.Ordered(order, axis=0),
        dincl.NonOverlap(0.5, among=rng.permutation(16)[:7]),
        dincl.OutsideBall(np.full(d, -3.0), 1.5),
        dincl.InsideBall(x0.mean(axis=0), np.linalg.norm(x0 - x0.mean(axis=0), axis=1).max() + 0.05),
    ]
    wind = rng.normal(size=(16, d))
    return dincl.Problem(x0, lambda t, x: wind * np.cos(3 * t) - 0.5 * x, sets)


@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize("scene", SCENES, ids=lambda scene: scene.name)
def test_every_scene_has_the_bits_of_the_reference(scene, scheme):
    found, other = both(scene, scheme, [0.1, 0.5])
    if isinstance(scheme, dincl.Penalty):  # whose forces the reference adds up in another order
        assert found.x == pytest.approx(other.x, abs=1e-12)
    else:
        agree(found, other)


@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize("d", [1, 2, 3, 4])
def test_all_kinds_of_rows(scheme, d, rng):
    found, other = both(mixed(rng, d), scheme, [0.3, 2.0])
    assert found.status is dincl.Status.SUCCESS
    if isinstance(scheme, dincl.Penalty):
        assert found.x == pytest.approx(other.x, abs=1e-12)
    else:
        agree(found, other)
        assert found.stats.constraint_projections > 100


@pytest.mark.parametrize("scheme", SCHEMES)
def test_sets_that_move(scheme, rng):
    """Up to rounding: the reference carries sets along in another order."""
    still = mixed(rng, 2)
    sets = [dincl.Moving(one, lambda t: np.array([0.3 * np.sin(t), -0.1 * t])) for one in still.constraints]
    found, other = both(dincl.Problem(still.x0, still.drift, sets), scheme, [0.3, 1.0])
    assert found.status is other.status is dincl.Status.SUCCESS
    assert found.x == pytest.approx(other.x, abs=1e-11)
    assert found.stats.callbacks == found.stats.steps


@pytest.mark.parametrize("n", [ALL_PAIRS - 10, ALL_PAIRS + 10])
@pytest.mark.parametrize("among", [None, slice(None, None, -3)])
def test_lists_of_few_and_many_discs(n, among, rng):
    """All pairs are compared, or a grid is searched: the bits are those of looking at every pair in every sweep."""
    x0 = np.stack(np.unravel_index(rng.permutation(144)[:n], (12, 12)), axis=1) * 1.1
    discs = None if among is None else np.arange(n)[among]
    radius = rng.uniform(0.4, 0.54, n if discs is None else len(discs))
    problem = dincl.Problem(x0, lambda t, x: 5 - x, [dincl.NonOverlap(radius, among=discs)])
    found, other = both(problem, dincl.PBD(0.05), [2.0])
    agree(found, other)
    assert found.stats.constraint_projections > (100 if discs is None else 10)
    assert 3 < found.stats.neighbour_builds < 40


def test_the_list_changes_nothing(rng, monkeypatch):
    """The same bits with a list that is made anew at every step, serves for long, or holds all pairs."""
    crowd = np.stack(np.unravel_index(np.arange(150), (15, 10)), axis=1) * 1.0
    for problem in (mixed(rng, 2), dincl.Problem(crowd, lambda t, x: -x, [dincl.NonOverlap(0.49)])):
        finals = []
        for first, widest in [(0.05, 1.0), (1e-9, 1e-9), (1e-9, 50.0), (100.0, 100.0)]:
            monkeypatch.setattr("dincl.steps.swept_sets.FIRST_SKIN", first)
            monkeypatch.setattr("dincl.steps.swept_sets.WIDEST_SKIN", widest)
            path = dincl.solve(problem, dincl.PBD(0.05), t=[1.0])
            finals.append((path.final.tobytes(), path.stats.constraint_projections))
        assert len(set(finals)) == 1


@given(data=st.data(), d=st.sampled_from([1, 2, 3, 4]), n=st.integers(1, 12))
def test_a_sweep_over_any_discs(data, d, n):
    """Also over discs that lie on one point, which has no direction."""
    x = data.draw(hnp.arrays(np.float64, (n, d), elements=st.floats(-2.0, 2.0)))
    radius = data.draw(hnp.arrays(np.float64, n, elements=st.floats(0.01, 1.5)))
    apart = 4.0 * np.arange(n)[:, None] * np.eye(d)[0]
    problem = dincl.Problem(apart, lambda t, x: 0 * x, [dincl.NonOverlap(radius)])
    stepper = CompiledStepper.sweeping(problem, pbd, [1])
    expected = x.copy()
    try:
        reference.sweep(problem, 0.0, expected)
    except reference.Coincident:
        with pytest.raises(dincl.StepFailure, match="lie on one point"):
            stepper.step(0.0, 1.0, StepState(x))
    else:
        assert stepper.step(0.0, 1.0, StepState(x)).x.tobytes() == expected.tobytes()


def test_between_kept_times_and_step_by_step(rng):
    """A path that is asked between kept times makes the step again; by hand, steps give the same as a run."""
    problem = mixed(rng, 2)
    scheme = dincl.SecondOrderPBD(0.02, v0=rng.normal(size=problem.x0.shape))
    path = dincl.solve(problem, scheme, t=[0.2, 0.6])
    every = dincl.solve(problem, scheme, t=np.arange(1, 31) * 0.02)
    assert path(0.34).tobytes() == every.x[16].tobytes()
    stepper = scheme.stepper(problem)
    state = stepper.start()
    for k in range(30):
        state = stepper.step(k * 0.6 / 30, 0.6 / 30, state)
    assert state.x.tobytes() == path.final.tobytes()


@pytest.mark.parametrize("scheme", [dincl.PBD(1.0), dincl.SecondOrderPBD(1.0), dincl.Penalty(1.0, strength=1e-9)])
@pytest.mark.parametrize(
    ("one", "target", "words"),
    [
        pytest.param(dincl.NonOverlap(0.5), 0.0, "Particles 1 and 0 lie on one point", id="NonOverlap"),
        pytest.param(dincl.NonOverlap(0.5, [1, 0]), 0.0, "Particles 0 and 1 lie on one point", id="NonOverlap of some"),
        pytest.param(dincl.OutsideBall((0.75,), 0.7), 0.75, "Particle 1 lies on a fixed centre", id="OutsideBall"),
    ],
)
def test_coincident_centres_are_named(scheme, one, target, words):
    """The second point lands, in one step, on the first one or on a fixed centre."""
    problem = dincl.Problem([[0.0], [1.5]], lambda t, x: np.array([[0.0], [target - 1.5]]), [one])
    found = dincl.solve(problem, scheme, t=[2.0], throw=False)
    assert found.status is dincl.Status.COINCIDENT_CENTRES
    assert words in found.detail


@pytest.mark.parametrize("scheme", SCHEMES)
def test_numbers_that_grow_too_large(scheme):
    """A constraint is there so that the drift alone does not decide."""
    problem = dincl.Problem([[1.0]], lambda t, x: np.full((1, 1), 1e99), [dincl.HalfSpace((1.0,))])
    found, other = both(problem, type(scheme)(**{**vars(scheme), "dt": 20.0}), [400.0])
    agree(found, other)
    assert found.status is other.status is dincl.Status.NON_FINITE


def test_a_path_that_fails_ends_the_run():
    def path(t):
        if t > 0.25:
            raise ValueError("no wall")
        return np.zeros(1)

    problem = dincl.Problem([[1.0]], lambda t, x: -x, [dincl.Moving(dincl.HalfSpace((1.0,)), path)])
    for scheme in (dincl.PBD(0.1), dincl.Penalty(0.1, strength=1.0)):
        found, other = both(problem, scheme, [1.0])
        assert found.status is other.status is dincl.Status.CONSTRAINT_FAILED
        assert found.t.tolist() == other.t.tolist()
        assert "no wall" in found.detail


@dataclass(frozen=True, eq=False)
class OrderedFromTheEnd(dincl.Ordered):
    """With projections of its own."""

    def sweep_rows(self, x):
        return Backwards()


class Backwards(CustomSweep):
    def sweep(self, t, x, work):
        x[:] = np.sort(x, axis=0)


def test_projections_of_the_user_are_made():
    problem = dincl.Problem([[1.0], [1.5], [2.0]], lambda t, x: 3 - 2 * x, [OrderedFromTheEnd([0, 1, 2], axis=0)])
    path = dincl.solve(problem, dincl.PBD(1.0), t=[1.0])
    assert path.final.ravel().tolist() == [1.0, 1.5, 2.0]


@pytest.mark.parametrize("carried", [False, True])
@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize("one", [InEllipse((1.0, 2.0)), InBall(1.0)], ids=["rows", "projections"])
def test_sets_that_python_knows_cost_callbacks_for_themselves_only(one, scheme, carried):
    x0 = np.array([[0.1, 0.1], [0.7, 0.1]])
    constraint = dincl.Moving(one, lambda t: np.array([0.1 * t, 0.0])) if carried else one
    discs = dincl.Problem(x0, lambda t, x: 2 * x, [dincl.NonOverlap(0.25), constraint])
    found, other = both(discs, scheme, [1.0])
    assert found.x == pytest.approx(other.x, abs=1e-11)
    assert found.stats.callbacks >= found.stats.steps
    free = dincl.solve(dincl.Problem(x0, discs.drift, [dincl.NonOverlap(0.25)]), scheme, t=[1.0])
    assert free.stats.callbacks == 0


def test_a_jacobian_that_outgrows_its_room(monkeypatch):
    """Sparse rows whose entries become more, in a run of compiled steps."""
    monkeypatch.setattr("dincl.system.sets_pointer.MOST_DENSE", 1)
    x0 = np.array([[0.1, 0.1], [0.7, 0.1]])
    problem = dincl.Problem(x0, lambda t, x: 2 * x, [InEllipse((1.0, 2.0))])
    found, other = both(problem, dincl.PBD(0.05), [1.0])
    assert found.x == pytest.approx(other.x, abs=1e-12)
