"""The quasi-steady model: a frozen tissue as a problem of dincl, DAHA on it, and the runs made of its minima."""

import math
from itertools import pairwise

import numpy as np
import pytest
from scipy.optimize import nnls

import dincl
from dincl.status import Status
from tests.tissue.states import cells, divided, layers, numbers, start, tissue
from tests.twins.tissue import make_substeps
from tissue.files.parameters import preset
from tissue.model.energy import energy, forces
from tissue.rules.slice import in_plane
from tissue.runs.group import Group
from tissue.runs.simulate import simulate
from tissue.state.cells import COORDINATES, Cells
from tissue.state.checkpoint import streams
from tissue.state.running import contents, new_state
from verification.thesis.chapter3.accuracy import left_over
from verification.thesis.chapter3.growing import Frozen
from verification.thesis.quasi_steady.daha import Stopped, TissueArrowHurwicz, simulate_quasi_steady, violation
from verification.thesis.quasi_steady.frozen import cells_at, constraints, frozen_problem, made_feasible, particles
from verification.thesis.quasi_steady.iteration import TABLE_4

# The frozen tissue

N = 60
T_END = 0.1
IPOPT = dincl.Ipopt(1e-9)


def farthest(x, y):
    return float(np.sqrt(((x - y) ** 2).sum(axis=1)).max())


@pytest.mark.parametrize("changes", [{}, {"spring_power": 2, "junction_factor": 0.25, "repulsion": 0.5}])
@pytest.mark.parametrize("detached", [[], [7, 20]])
def test_pbd_is_the_substep_of_the_model(changes, detached):
    state, given = cells(30, 4), numbers(max_basal_distance=0.4, dt=0.2, substeps=100, **changes)
    network = layers(30, apical=np.delete(np.arange(30), [3, 11]), basal=np.delete(np.arange(30), detached))
    state.by[detached] = 0.4
    state = cells_at(particles(state), state, network)
    expected = make_substeps(state, network, given)
    path = dincl.solve(frozen_problem(state, network, given), dincl.PBD(0.002), t=[0.2])
    assert path.stats.constraint_projections > 100
    assert path.final == pytest.approx(particles(expected), abs=1e-11)
    assert (path.final[60:, 1] == 0).sum() == 30 - len(detached)


@pytest.fixture(scope="module")
def begun():
    """60 cells as a run begins, and where they are after 0.1 h: second order, so four times the error at twice h."""
    problem = frozen_problem(start(N, 0), layers(N), numbers())
    coarse, fine = (midpoint(problem, steps) for steps in (400, 800))
    exact = fine + (fine - coarse) / 3
    assert farthest(exact, fine) < 2e-5
    return problem, exact


def midpoint(problem, steps):
    return dincl.solve(problem, dincl.MidpointCatchUp(T_END / steps, dincl.ProjectedCG(1e-10)), t=[T_END]).final


SCHEMES = {
    # name: (scheme of h, order, number of steps, error at the last one, overlap left at most)
    "PBD": (dincl.PBD, 1, [80, 160, 320, 640], 5e-3, 1e-3),
    "LinearisedCatchUp": (lambda h: dincl.LinearisedCatchUp(h, dincl.Piqp(1e-9)), 1, [20, 40, 80, 160], 1e-2, 1e-9),
    "MidpointCatchUp": (
        lambda h: dincl.MidpointCatchUp(h, dincl.ProjectedCG(1e-10)),
        2,
        [20, 40, 80, 160],
        2e-4,
        1e-9,
    ),
}


@pytest.mark.slow_with("PBD", "LinearisedCatchUp")
@pytest.mark.parametrize("name", SCHEMES)
def test_schemes_converge_together_in_their_orders(name, begun):
    problem, exact = begun
    scheme, order, steps, last, overlap = SCHEMES[name]
    paths = [dincl.solve(problem, scheme(T_END / m), t=[T_END]) for m in steps]
    errors = [farthest(path.final, exact) for path in paths]
    assert abs(-np.polyfit(np.log(steps), np.log(errors), 1)[0] - order) < 0.25
    assert errors[-1] < last
    assert paths[-1].violation()[0] < overlap
    assert (paths[-1].final[2 * N :, 1] == 0).all()
    assert farthest(exact, problem.x0) > 0.5


@pytest.fixture(scope="module")
def division():
    """A settled tissue in which one cell has just divided, the number of that cell, and the problem when feasible."""
    state, given = start(N, 1), numbers()
    settled = dincl.solve(frozen_problem(state, layers(N), given), dincl.PBD(0.005), t=[1.0]).final
    middle = int(np.argmin(np.abs(settled[:N, 0]) + np.abs(settled[:N, 1] - np.median(settled[:N, 1]))))
    split = divided(cells_at(settled, state, layers(N)), middle)
    feasible = made_feasible(split, layers(N + 1), given, IPOPT)
    return split, middle, frozen_problem(feasible, layers(N + 1), given)


def test_made_feasible_is_locally_the_nearest_state(division):
    """The move is a combination with weights >= 0 of the gradients of constraints that are active: Definition 1.24."""
    state, _, problem = division
    move = (problem.x0 - particles(state)).ravel()
    active = problem.rows_within(0.0, problem.x0, 1e-8)
    weights, left_over = nnls(active.jacobian(problem.x0).toarray().T, move)
    assert problem.violation(0.0, problem.x0) < 1e-8
    assert weights.max() > 0.2
    assert left_over < 1e-7


def test_a_feasible_state_stays_where_it_is():
    state = cells(10, 6)
    found = made_feasible(state, layers(10), numbers(), IPOPT)
    assert particles(found).tolist() == particles(state).tolist()


BAD = {
    "off the line": ({"by": [0.0, 0.1]}, r"cells.by\[1\] = 0.1: must be 0 in the basal layer"),
    "apart": ({"chain": [0, 1]}, r"cells.chain\[1\] = 1: must be 0, the energy has the junctions of the layer"),
    "overlap": ({"radius": [1.0, 1.5]}, "violates NonOverlap by 1.5"),
    "order": ({"bx": [0.1, 0.0]}, "violates Ordered by 0.1"),
    "too far": ({"bx": [0.0, 1.0]}, "violates MaxDistance by 0.667"),
}


@pytest.mark.parametrize("case", BAD)
def test_starts_outside_of_the_set_are_refused(case):
    change, message = BAD[case]
    good = tissue([[0.0, 2.5], [1.0, 2.5]], [[0.0, 5.0], [1.0, 5.0]], [[0.0, 0.0], [0.3, 0.0]])
    frozen_problem(good, layers(2), numbers())
    bad = good._replace(**{name: np.array(values) for name, values in change.items()})
    with pytest.raises(dincl.InvalidProblem, match=message):
        frozen_problem(bad, layers(2), numbers())


# DAHA

NEVER = 1e-100  # an eps that no move meets


def found(state, network, given, **changes):
    return TissueArrowHurwicz(TABLE_4._replace(**changes)).minimise(state, network, given)


def steps_of(count, **changes):
    return {"eps": NEVER, "most_iterations": count, **changes}


def moved(state, rng, by):
    return state._replace(
        **{name: getattr(state, name) + by * rng.standard_normal(len(state.x)) for name in ("x", "y", "bx")}
    )


def literal(state, network, given, daha):
    """Method 3.4 on all pairs, typed from the text, with max(0, .).

    Also the multipliers, and of (C1), (C4), (C2) the largest number of rows that pushed at once.
    """
    i, j = np.tril_indices(len(state.x), -1)
    left, right = network.basal[:-1], network.basal[1:]
    reach = state.radius[i] + state.radius[j]
    z = np.array([getattr(state, name) for name in COORDINATES])
    before, multipliers, pushed = z, [np.zeros(len(i)), np.zeros(len(left)), np.zeros(len(left))], np.zeros(3)
    for _ in range(daha.most_iterations):
        slope = -np.array(forces(state._replace(**dict(zip(COORDINATES, z, strict=True))), network, given))
        slope[5, network.basal] = 0.0
        dx, dy, db = z[0, i] - z[0, j], z[1, i] - z[1, j], z[4, right] - z[4, left]
        values = [dx**2 + dy**2 - reach**2, db, given.max_basal_distance**2 - db**2]
        p = daha.alpha * slope
        for row, at, fro, arrow, g, own in [
            (0, i, j, 2 * dx, values[0], multipliers[0]),
            (1, i, j, 2 * dy, values[0], multipliers[0]),
            (4, right, left, np.ones(len(db)), values[1], multipliers[1]),
            (4, right, left, -2 * db, values[2], multipliers[2]),
        ]:
            weight = own * (daha.alpha - daha.gamma * g) * arrow
            np.subtract.at(p[row], at, weight)
            np.add.at(p[row], fro, weight)
        multipliers = [
            np.maximum(0.0, own - daha.dtau * daha.beta * g) for own, g in zip(multipliers, values, strict=True)
        ]
        pushed = np.maximum(pushed, [(own > 0).sum() for own in multipliers])
        half = daha.c * daha.dtau / 2
        z, before = (2 * z - (1 - half) * before - daha.dtau**2 * p) / (1 + half), z
    return state._replace(**dict(zip(COORDINATES, z, strict=True))), multipliers, pushed.tolist()


def broken(state, network, given):
    return violation(constraints(state, network, given), state)


def distance(one, other):
    return max(abs(getattr(one, name) - getattr(other, name)).max() for name in COORDINATES)


CASES = {
    "table 4": ({}, {}),
    "published energies": ({}, {"spring_power": 2, "junction_factor": 0.25, "repulsion": 0.5}),
    "overdamped": ({"c": 5.0, "dtau": 2.0}, {}),
}


@pytest.mark.parametrize("case", CASES)
def test_the_kernel_is_the_method(case, rng):
    """From a state outside of S, with cells that left a layer; constraints of all kinds push."""
    choices, changes = CASES[case]
    state, given = moved(cells(21, 3), rng, 0.1), numbers(max_basal_distance=0.17, **changes)
    network = layers(21, apical=np.delete(np.arange(21), 4), basal=np.delete(np.arange(21), [0, 9]))
    state.by[[0, 9]] = 0.2, -0.4
    steps = steps_of(400, alpha=1e-3, **choices)
    expected, _, pushed = literal(state, network, given, TABLE_4._replace(**steps))
    assert min(pushed) > 0
    reached = found(state, network, given, **steps)
    assert distance(state, expected) > 0.1
    assert distance(reached.cells, expected) < 1e-11
    assert (reached.status, reached.iterations) == (dincl.Status.NOT_CONVERGED, 400)
    assert reached.violation == pytest.approx(broken(expected, network, given), abs=1e-10)
    assert reached.energy == pytest.approx(energy(expected, network, given), rel=1e-11)


def test_is_explicit_euler_with_half_of_alpha():
    """Where no constraint is near: n iterations are n substeps of PBD with h/mu = alpha/2; (3.32) has alpha."""
    state, network = cells(30, 5, radius=1e-3), layers(30)
    n, dt = 200, 0.1
    reached = found(state, network, numbers(max_basal_distance=9.0), **steps_of(n))
    for factor, same in [(0.5, True), (1.0, False)]:
        given = numbers(dt=dt, substeps=n, mu=dt / (n * factor * TABLE_4.alpha), max_basal_distance=9.0)
        group = Group([new_state(state, network, capacity=30, space=in_plane())], given)
        assert group.make_substeps()
        assert (distance(contents(group.states[0])[0], reached.cells) < 1e-12) == same
        assert distance(state, reached.cells) > 0.05


def test_stops_at_the_first_short_move():
    """(3.24) with dtau, from literal moves; |z| depends on the origin, and far from it the rule is met at once."""
    state, network, given = cells(10, 6), layers(10), numbers()
    rule = {"alpha": 1e-3, "c": 1.0, "dtau": 2.0, "eps": 1e-3}
    reached = found(state, network, given, **rule)
    assert reached.status is dincl.Status.SUCCESS
    assert reached.detail == ""
    assert 10 < reached.iterations < 1000
    z = [
        particles(literal(state, network, given, TABLE_4._replace(**rule, most_iterations=n))[0])
        for n in range(reached.iterations + 1)
    ]
    short = [np.linalg.norm(b - a) / 2.0 <= 1e-3 * np.linalg.norm(a) for a, b in pairwise(z)]
    assert short == [False] * (reached.iterations - 1) + [True]
    away = state._replace(**{name: getattr(state, name) + 1e4 for name in ("x", "ax", "bx")})
    assert found(away, network, given, **rule).iterations == 1


def test_a_stop_is_no_minimum_and_need_not_be_feasible():
    """The gradient left is up to 2 eps |z| / alpha, Remark 3.6 prints half of it; nobody asks for (C1)."""
    state, network, given = cells(30, 7), layers(30), numbers()
    reached = found(state, network, given, eps=1e-5)
    assert reached.status is dincl.Status.SUCCESS
    assert 1e-4 < reached.violation < 0.05
    state, network, given = cells(30, 7, radius=1e-3), layers(30, basal=[]), numbers()
    reached = found(state, network, given, eps=1e-5)
    assert reached.status is dincl.Status.SUCCESS
    slope = np.linalg.norm(forces(reached.cells, network, given))
    bound = 2 * 1e-5 * np.linalg.norm(particles(reached.cells)) / TABLE_4.alpha
    assert 0.99 * bound < slope < 1.001 * bound


def test_converges_to_a_minimum_with_a_certificate():
    """Stopped late enough it is at a state that meets the optimality conditions, with constraints that push."""
    given, network = numbers(max_basal_distance=0.15), layers(8)
    state = cells(8, 4, rest_ax=3.0, rest_bx=3.0)
    quick = {"alpha": 2e-2, "gamma": 2e-1, "eps": 1e-12, "most_iterations": 1_000_000}
    reached = found(state._replace(radius=1.5 * state.radius), network, given, **quick)
    assert reached.status is dincl.Status.SUCCESS
    assert left_over(reached.cells, Frozen(reached.cells, network, given)) < 1e-8
    free = reached.cells._replace(radius=0.5 * state.radius)  # where the discs do not push
    assert left_over(free, Frozen(free, network, given)) > 0.1
    assert reached.violation < 1e-8


def two(gap):
    """Two upright cells whose hard discs are ``gap`` apart.

    A little pull on the apical points keeps (3.24) from stopping at once because nothing moves yet.
    """
    half = 1 / 3 + gap / 2
    places = np.array([[-half, 4.0], [half, 4.0]])
    return tissue(places, places + np.array((0.0, 4.0)), places * (1, 0), stiff_ax=0.01, stiff_bx=0.01, stiff_axb=0.0)


FREE = numbers(junction_factor=0.0, repulsion=0.0, max_basal_distance=9.0)


@pytest.mark.parametrize(("side", "terminates"), [(1.03, True), (0.97, False)])
def test_a_nucleus_too_near_to_its_apical_point_never_rests(side, terminates):
    """The bending energy has the curvature 2 alpha_axb / |A - X|^2: stable where alpha/2 of it is below 2."""
    limit = math.sqrt(TABLE_4.alpha * 15.0 / 2)
    length = limit * side
    state = tissue([(1e-3, 8.0 - length)], [(0.0, 8.0)], [(0.0, 0.0)], rest_ax=length - 1, rest_bx=7.0 - length)
    reached = found(state, layers(1), numbers(), most_iterations=20_000)
    assert reached.status is (dincl.Status.SUCCESS if terminates else dincl.Status.NOT_CONVERGED)
    if not terminates:
        assert "did not terminate in 20,000 iterations" in reached.detail
        end = reached.cells
        assert np.hypot(end.x - end.ax, end.y - end.ay)[0] == pytest.approx(limit, rel=3e-3)
        later = found(state, layers(1), numbers(), most_iterations=20_001).cells
        assert abs(end.x - end.ax)[0] > 1e-4
        assert (later.x - later.ax)[0] == pytest.approx(-(end.x - end.ax)[0], rel=0.02)


def test_divergence_is_told():
    reached = found(cells(12, 1), layers(12), numbers(), alpha=3.0)
    assert np.isfinite(particles(reached.cells)).all()
    assert reached.status is dincl.Status.NON_FINITE
    assert reached.iterations < 1000
    assert (reached.energy, reached.violation) == (math.inf, math.inf)
    assert "did not terminate" in reached.detail


def test_violation_is_the_largest_of_all():
    state = cells(5, 1, radius=1e-3)._replace(bx=np.array([0.0, 0.1, 0.05, 0.25, 0.35]))
    assert broken(state, layers(5), numbers(max_basal_distance=0.2)) == pytest.approx(0.05)
    assert broken(state, layers(5), numbers(max_basal_distance=0.12)) == pytest.approx(0.08)
    assert broken(two(-0.1), layers(2), FREE) == pytest.approx(0.1)
    assert broken(two(0.1), layers(2), FREE) == 0.0


# Runs

AGES = ("birth", "cycle", "id", "mother", "radius", "moves", "divides")
QUICK = {
    "tissue.cells": 12,
    "numerics.t_end": "1 h",
    "numerics.keep": "0.2 h",
    "rules.floor_rest_length": True,
}
DAHA = TABLE_4._replace(alpha=1e-3, gamma=1e-2)


def parameters(**changes):
    return preset("thesis").changed({**QUICK, **changes})


def same(one, other, names=Cells._fields):
    return all((getattr(one, name) == getattr(other, name)).all() for name in names)


@pytest.mark.parametrize(("end", "daughters"), [("15 h", 0.5), ("45 h", 1.0)])
def test_rules_and_divisions_are_those_of_the_first_order_model(end, daughters):
    changes = {"numerics.t_end": end, "numerics.keep": "3 h", "tissue.two_daughters": daughters}
    chosen = parameters(**changes)
    minima, moving = simulate_quasi_steady(chosen, 3, DAHA._replace(eps=1e-3)), simulate(chosen, 3)
    assert minima.status is Status.SUCCESS
    assert minima.stats["divisions"] == moving.stats["divisions"] > 0
    assert minima.stats["substeps"] == 0
    for a, b in zip(minima.frames, moving.frames, strict=True):
        assert a.t == b.t
        assert same(a.cells, b.cells, AGES)
        assert same(a.layers, b.layers, a.layers._fields)
    assert not same(minima.final.cells, moving.final.cells, "x")


def test_each_step_begins_with_the_noise_on_what_was_left(monkeypatch):
    seen = []

    def stays(self, cells, layers, numbers):
        seen.append(cells)
        return Stopped(cells, float(len(seen)), 0.1, len(seen), Status.SUCCESS, "")

    monkeypatch.setattr(TissueArrowHurwicz, "minimise", stays)
    run = simulate_quasi_steady(parameters(**{"tissue.two_daughters": 0.0}), 5, DAHA)
    noise, deviation = streams(5).noise, np.sqrt(0.2 * 0.1)
    x, y = run.frames[0].cells.x.copy(), run.frames[0].cells.y.copy()
    for state in seen:
        drawn = deviation * noise.standard_normal((12, 2))
        x, y = x + drawn[:, 0], y + drawn[:, 1]
        assert state.x == pytest.approx(x, abs=1e-14)
        assert state.y == pytest.approx(y, abs=1e-14)
    assert same(run.final.cells, seen[-1])
    assert same(run.final.cells, run.frames[0].cells, ("ax", "ay", "bx", "by"))
    assert run.iterations.tolist() == run.energy.tolist() == list(range(1, 11))


def test_a_step_that_fails_ends_the_run():
    run = simulate_quasi_steady(parameters(), 0, DAHA._replace(most_iterations=30))
    assert (run.status, run.iterations.tolist(), run.terminated.tolist()) == (Status.NOT_CONVERGED, [30], [False])
    assert run.final.t == pytest.approx(0.1)
    assert "t = 0.1 h: DAHA did not terminate in 30 iterations" in run.detail
    run = simulate_quasi_steady(parameters(), 0, DAHA._replace(alpha=2.0))
    assert run.status is Status.NON_FINITE
    assert run.energy.tolist() == run.violation.tolist() == [np.inf]
