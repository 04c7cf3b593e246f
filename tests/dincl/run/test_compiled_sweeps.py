"""Compiled steps of position based dynamics and of the penalty method against those that larger problems take."""

from dataclasses import dataclass

import numpy as np
import pytest

import dincl
from dincl.rows.affine import AffineSweeper
from dincl.run.compiled_sweeps import CompiledPenalty, CompiledSweeps
from dincl.run.loop import run_steps
from dincl.schemes.pbd import PBDStepper
from dincl.schemes.penalty import PenaltyStepper
from dincl.schemes.second_order_pbd import SecondOrderStepper
from tests.dincl.catalog import SCENES
from tests.dincl.own_constraints import InBall, InEllipse

SCHEMES = [
    pytest.param(dincl.PBD(0.02), id="PBD"),
    pytest.param(dincl.PBD(0.02, sweeps=3), id="PBD-3-sweeps"),
    pytest.param(dincl.SecondOrderPBD(0.02), id="SecondOrderPBD"),
    pytest.param(dincl.Penalty(0.02, strength=20.0), id="Penalty"),
    pytest.param(dincl.Penalty(0.02, strength=2.0, exponent=1), id="Penalty-printed"),
]
# How long lists last is not the same for discs of unequal radii, nor what the penalty method keeps.
LISTS = ("neighbour_builds", "candidate_pairs")


def witness(problem, scheme):
    """The steps that are not compiled."""
    if isinstance(scheme, dincl.Penalty):
        return PenaltyStepper(problem, scheme)
    if isinstance(scheme, dincl.SecondOrderPBD):
        return SecondOrderStepper(problem, np.zeros_like(problem.x0), scheme.sweeps)
    return PBDStepper(problem, scheme.sweeps)


def both(problem, scheme, times):
    """The run with compiled steps, and the other one."""
    assert isinstance(scheme.stepper(problem), CompiledPenalty | CompiledSweeps)
    found = dincl.solve(problem, scheme, t=times, throw=False)
    return found, run_steps(lambda: witness(problem, scheme), scheme.dt, np.array(times))


def agree(found, other, apart=LISTS):
    assert (found.status, found.detail) == (other.status, other.detail)
    assert found.t.tolist() == other.t.tolist()
    assert found.x.tobytes() == other.x.tobytes()
    counted, expected = ({k: v for k, v in vars(one.stats).items() if k not in apart} for one in (found, other))
    assert counted == expected


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
def test_every_scene_keeps_its_bits(scene, scheme):
    agree(*both(scene, scheme, [0.5, 1.0]))


@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize("d", [1, 2, 3])
def test_all_kinds_of_rows_keep_their_bits(scheme, d, rng):
    found, other = both(mixed(rng, d), scheme, [0.3, 2.0])
    agree(found, other)
    assert found.status is dincl.Status.SUCCESS
    assert isinstance(scheme, dincl.Penalty) or found.stats.constraint_projections > 100


def test_lists_of_equal_discs_are_counted_alike(rng):
    """Pairs looked at and lists made, too, are those of the sweeps of larger problems."""
    x0 = np.stack(np.unravel_index(rng.permutation(49)[:40], (7, 7)), axis=1) * 1.1
    problem = dincl.Problem(x0, lambda t, x: 2 - x, [dincl.NonOverlap(0.5), dincl.HalfSpace((0, 1), 0.0)])
    found, other = both(problem, dincl.PBD(0.05), [4.0])
    agree(found, other, apart=())
    assert found.stats.neighbour_builds > 3


def test_the_list_changes_nothing(rng, monkeypatch):
    """The same bits with a list that is made anew at every step, kept for long, or holds all pairs."""
    problem = mixed(rng, 2)
    finals = []
    for first, widest in [(0.05, 1.0), (1e-9, 1e-9), (1e-9, 50.0), (100.0, 100.0)]:
        monkeypatch.setattr("dincl.rows.pairs.FIRST_SKIN", first)
        monkeypatch.setattr("dincl.rows.pairs.WIDEST_SKIN", widest)
        path = dincl.solve(problem, dincl.PBD(0.05), t=[2.0])
        finals.append((path.final.tobytes(), path.stats.constraint_projections))
    assert len(set(finals)) == 1


@pytest.mark.parametrize("scheme", SCHEMES)
def test_sets_that_move(scheme, rng):
    """Up to rounding only: compiled steps do not carry pairs along, whose gaps know no place."""
    still = mixed(rng, 2)
    sets = [dincl.Moving(one, lambda t: np.array([0.3 * np.sin(t), -0.1 * t])) for one in still.constraints]
    found, other = both(dincl.Problem(still.x0, still.drift, sets), scheme, [0.3, 1.0])
    assert found.status is other.status is dincl.Status.SUCCESS
    assert found.x == pytest.approx(other.x, abs=1e-11)


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
    ("one", "target"),
    [
        pytest.param(dincl.NonOverlap(0.5), 0.0, id="NonOverlap"),
        pytest.param(dincl.NonOverlap(0.5, among=[1, 0]), 0.0, id="NonOverlap of some"),
        pytest.param(dincl.OutsideBall((0.75,), 0.7), 0.75, id="OutsideBall"),
    ],
)
def test_coincident_centres_are_named(scheme, one, target):
    """The second point lands, in one step, on the first one or on a fixed centre."""
    problem = dincl.Problem([[0.0], [1.5]], lambda t, x: np.array([[0.0], [target - 1.5]]), [one])
    found, other = both(problem, scheme, [2.0])
    agree(found, other)
    assert found.status is dincl.Status.COINCIDENT_CENTRES


@pytest.mark.parametrize("scheme", SCHEMES)
def test_numbers_that_grow_too_large(scheme):
    """A constraint is there so that the drift alone does not decide."""
    problem = dincl.Problem([[1.0]], lambda t, x: np.full((1, 1), 1e99), [dincl.HalfSpace((1.0,))])
    found, other = both(problem, type(scheme)(**{**vars(scheme), "dt": 20.0}), [400.0])
    agree(found, other)
    assert found.status is dincl.Status.NON_FINITE


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
class AffineByHand(dincl.HalfSpace):
    """A wall whose projections are those of affine rows, with other last bits than a wall's."""

    def sweeper(self, x):
        return self.select(x, np.inf).sweeper(x.shape[1])


def test_the_projections_are_those_of_the_sweeper(rng):
    problem = dincl.Problem(rng.uniform(1, 2, (20, 3)), lambda t, x: -x, [AffineByHand((1, 2, 3), 0.7)])
    found, other = both(problem, dincl.PBD(0.1), [2.0])
    agree(found, other)
    wall = dincl.Problem(problem.x0, problem.drift, [dincl.HalfSpace((1, 2, 3), 0.7)])
    plain = dincl.solve(wall, dincl.PBD(0.1), t=[2.0])
    assert plain.final == pytest.approx(found.final)
    assert plain.final.tobytes() != found.final.tobytes()


@dataclass(frozen=True, eq=False)
class OrderedFromTheEnd(dincl.Ordered):
    """With a sweeper that derives from one of the package."""

    def sweeper(self, x):
        return Backwards(self.rows(x))


class Backwards(AffineSweeper):
    def sweep(self, t, x, work):
        x[:] = np.sort(x, axis=0)


def test_a_sweeper_that_overrides_one_of_the_package_is_asked():
    problem = dincl.Problem([[1.0], [1.5], [2.0]], lambda t, x: 3 - 2 * x, [OrderedFromTheEnd([0, 1, 2], axis=0)])
    assert isinstance(dincl.PBD(1.0).stepper(problem), PBDStepper)
    assert dincl.solve(problem, dincl.PBD(1.0), t=[1.0]).final.ravel().tolist() == [1.0, 1.5, 2.0]


def test_what_only_python_knows_is_not_compiled():
    """Functions, and projections of one's own: also of a set that is carried."""
    still = lambda t, x: 0 * x  # noqa: E731
    for one in (InEllipse((1.0, 2.0)), InBall(1.0)):
        for constraint in (one, dincl.Moving(one, lambda t: np.zeros(2))):
            problem = dincl.Problem([[0.1, 0.1]], still, [dincl.HalfSpace((0, 1)), constraint])
            assert isinstance(dincl.PBD(0.1).stepper(problem), PBDStepper)
            assert isinstance(dincl.SecondOrderPBD(0.1).stepper(problem), SecondOrderStepper)
            assert isinstance(dincl.Penalty(0.1, 1.0).stepper(problem), PenaltyStepper)
