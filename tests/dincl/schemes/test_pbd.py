"""First-order PBD against the method as printed, and what its speed rests on."""

import numpy as np
import pytest

import dincl


def literal_pbd(x, drift, radius, walls, dt, steps):
    """Method 2.3 with Example 2.5, typed from the text: all pairs j < i, then the walls, one after another."""
    x = x.copy()
    for k in range(steps):
        x = x + dt * drift(k * dt, x)
        for i in range(len(x)):
            for j in range(i):
                distance = np.sqrt(((x[i] - x[j]) ** 2).sum())
                overlap = radius[i] + radius[j] - distance
                if overlap > 0:
                    unit = (x[j] - x[i]) / distance
                    x[i] = x[i] - overlap / 2 * unit
                    x[j] = x[j] + overlap / 2 * unit
        for normal, offset in walls:
            for i in range(len(x)):
                lack = offset + radius[i] - normal @ x[i]
                if lack > 0:
                    x[i] = x[i] + lack * normal
    return x


def crowd(rng, n, d):
    """A jittered lattice of unequal discs, numbered at random."""
    side = int(np.ceil(n ** (1 / d)))
    lattice = np.stack(np.unravel_index(rng.permutation(side**d)[:n], (side,) * d), axis=1)
    return 1.1 * lattice + rng.uniform(-0.05, 0.05, size=(n, d)) + 0.6, rng.uniform(0.2, 0.5, size=n)


def test_only_those_among_the_discs_meet(rng):
    """The discs move as if they were alone, the points as if there were no discs."""
    x0, radius = crowd(rng, 60, 2)
    discs = rng.permutation(60)[:25]
    pull = lambda t, x: -x  # noqa: E731
    problem = dincl.Problem(x0, pull, [dincl.NonOverlap(radius[discs], among=discs)])
    path = dincl.solve(problem, dincl.PBD(0.01), t=[0.8])
    alone = dincl.solve(dincl.Problem(x0[discs], pull, [dincl.NonOverlap(radius[discs])]), dincl.PBD(0.01), t=[0.8])
    assert alone.stats.constraint_projections > 60
    assert path.final[discs].tolist() == alone.final.tolist()
    points = np.setdiff1d(np.arange(60), discs)
    assert path.final[points] == pytest.approx(x0[points] * 0.99**80, rel=1e-12)
    assert path.stats.candidate_pairs == alone.stats.candidate_pairs
    assert path.violation()[0] == pytest.approx(alone.violation()[0])


def test_discs_that_coincide_are_named_as_particles():
    away = lambda t, x: np.array([[0.0], [-1.0], [1.0]])  # noqa: E731
    problem = dincl.Problem([[0.0], [1.5], [-1.5]], away, [dincl.NonOverlap(0.5, among=[2, 1])])
    path = dincl.solve(problem, dincl.PBD(1.5), t=[1.5], throw=False)
    assert path.status is dincl.Status.COINCIDENT_CENTRES
    assert "Particles 1 and 2 lie" in path.detail


@pytest.mark.parametrize("d", [1, 2, 3])
@pytest.mark.parametrize("dt", [0.3, 0.01])
def test_equals_the_printed_method(d, dt, rng):
    x0, radius = crowd(rng, 30, d)
    walls = [(np.eye(d)[k], 0.0) for k in range(d)]
    pull = lambda t, x: -x * (1 + t)  # noqa: E731
    problem = dincl.Problem(x0, pull, [dincl.NonOverlap(radius), *(dincl.HalfSpace(n, o, radius) for n, o in walls)])
    path = dincl.solve(problem, dincl.PBD(dt), t=[60 * dt])
    assert path.stats.steps == 60
    assert path.stats.constraint_projections > 60
    assert path.final == pytest.approx(literal_pbd(x0, pull, radius, walls, dt, 60), abs=1e-12)


def test_a_disc_that_meets_no_other_pays_for_no_pair():
    x0 = np.stack([3.0 * np.arange(100), np.zeros(100)], axis=1)
    problem = dincl.Problem(x0, lambda t, x: np.full_like(x, -1.0), [dincl.NonOverlap(0.5)])
    path = dincl.solve(problem, dincl.PBD(0.01), t=[1.0])
    assert path.stats.candidate_pairs == 0
    assert path.stats.constraint_projections == 0
    assert path.stats.solver_calls == 0


def test_candidates_grow_linearly(rng):
    counts = []
    for n in (400, 1600):
        x0, radius = crowd(rng, n, 2)
        problem = dincl.Problem(x0, lambda t, x: np.full_like(x, -1.0), [dincl.NonOverlap(radius)])
        counts.append(dincl.solve(problem, dincl.PBD(0.01), t=[0.5]).stats.candidate_pairs / n)
    assert counts[1] < 1.25 * counts[0]


def test_an_unused_family_changes_no_counter(rng):
    x0, radius = crowd(rng, 60, 2)
    used = [dincl.NonOverlap(radius)]
    unused = [dincl.MaxDistance(np.zeros((0, 2)), 1.0), dincl.Ordered([], axis=0), dincl.OutsideBall((1e3, 1e3), 0.5)]
    pull = lambda t, x: -x  # noqa: E731
    for scheme in (dincl.PBD(0.01), dincl.Penalty(0.01, 20.0), dincl.CatchUp(0.02, dincl.Daqp(1e-9))):
        lean = dincl.solve(dincl.Problem(x0, pull, used), scheme, t=[0.5])
        full = dincl.solve(dincl.Problem(x0, pull, used + unused), scheme, t=[0.5])
        counters = [{**vars(path.stats), "neighbour_builds": None} for path in (lean, full)]
        assert counters[0] == counters[1]
        assert lean.final == pytest.approx(full.final, abs=1e-8)


def test_more_sweeps_leave_less_overlap(rng):
    x0, radius = crowd(rng, 60, 2)
    problem = dincl.Problem(x0, lambda t, x: -x, [dincl.NonOverlap(radius)])
    left = [dincl.solve(problem, dincl.PBD(0.05, sweeps=k), t=[6.0]).violation()[0] for k in (1, 4, 32)]
    assert left[0] > left[1] > left[2] > 0


def test_moving_wall_pushes():
    wall = dincl.Moving(dincl.HalfSpace((1.0,), radius=0.5), lambda t: np.array([2.0 * t]))
    problem = dincl.Problem([[1.0]], lambda t, x: x * 0, [wall])
    path = dincl.solve(problem, dincl.PBD(0.1), t=[0.2, 0.5, 1.0])
    assert path.x.ravel() == pytest.approx([1.0, 1.5, 2.5], abs=1e-13)


def test_second_order_is_symplectic_euler_and_stops_at_the_wall():
    fall = dincl.Problem([[0.0, 2.0]], lambda t, x: np.array([[0.0, -1.0]]), [dincl.HalfSpace((0, 1), radius=0.5)])
    scheme = dincl.SecondOrderPBD(0.01, v0=[[1.0, 0.0]])
    path = dincl.solve(fall, scheme, t=[1.0, 4.0])
    # x_k = v0 t, y_k = 2 - dt^2 k (k + 1) / 2 exactly, then rest on the wall while sliding on.
    assert path.x[0] == pytest.approx(np.array([[1.0, 2.0 - 1e-4 * 100 * 101 / 2]]), abs=1e-13)
    assert path.x[1] == pytest.approx(np.array([[4.0, 0.5]]), abs=1e-12)


def test_penalty_forces():
    """Two discs overlap after one step: the spring pushes by strength times overlap, the printed force by strength."""
    pair = dincl.Problem([[-0.5], [0.5]], lambda t, x: -x, [dincl.NonOverlap(0.5)])
    spring = dincl.solve(pair, dincl.Penalty(0.1, strength=3.0), t=[0.1, 0.2]).x[:, 1, 0]
    printed = dincl.solve(pair, dincl.Penalty(0.1, strength=3.0, exponent=1), t=[0.1, 0.2]).x[:, 1, 0]
    assert spring == pytest.approx([0.45, 0.45 + 0.1 * (-0.45 + 3.0 * 0.1)])
    assert printed == pytest.approx([0.45, 0.45 + 0.1 * (-0.45 + 3.0)])
