"""The frozen tissue: a dincl problem with the motion of the model, on which all schemes agree in the limit."""

import numpy as np
import pytest
from scipy.optimize import nnls

import dincl
from tests.tissue.states import cells, divided, layers, numbers, start, tissue
from tests.twins.tissue import make_substeps
from tissue.model.energy import forces
from tissue.state.cells import Forces
from verification.thesis.quasi_steady.frozen import cells_at, frozen_problem, made_feasible, particles

N = 60
T_END = 0.1
IPOPT = dincl.Ipopt(1e-9)


def distance(x, y):
    return float(np.sqrt(((x - y) ** 2).sum(axis=1)).max())


def test_particles_and_back():
    state, network = cells(9, 1), layers(9, basal=[0, 2, 3, 8])
    state.by[[1, 4]] = 0.3, -0.7
    x = particles(state)
    assert x[3].tolist() == [state.x[3], state.y[3]]
    assert x[9 + 3].tolist() == [state.ax[3], state.ay[3]]
    assert x[18 + 4].tolist() == [state.bx[4], -0.7]
    again = cells_at(x, state, network)
    for name in state._fields:
        assert getattr(again, name).tolist() == getattr(state, name).tolist()
    moved = cells_at(x + 1.0, state, network)
    assert (moved.by - state.by).tolist() == pytest.approx([0, 1, 0, 0, 1, 1, 1, 1, 0])
    assert moved.bx.tolist() == (state.bx + 1).tolist()


def test_drift_is_force_over_damping_and_the_line_holds_its_points():
    state, network = cells(12, 2), layers(12, basal=np.r_[0:5, 6:12])
    state.by[5] = 1.2
    given = numbers(mu=0.2)
    on = forces(state, network, given)
    assert min(abs(on.by)) > 0
    held = on._replace(by=np.where(np.arange(12) == 5, on.by, 0.0))
    velocity = frozen_problem(state, network, given).velocity(0.0, particles(state))
    assert velocity == pytest.approx(particles(Forces(*(part / 0.2 for part in held))), rel=1e-14)


def test_the_problem_keeps_its_own_copy():
    state, network = cells(6, 3), layers(6)
    problem = frozen_problem(state, network, numbers())
    before = problem.velocity(0.0, problem.x0)
    for array in (*state, *network):
        array[:] = 0
    assert problem.velocity(0.0, problem.x0).tolist() == before.tolist()


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
    assert distance(exact, fine) < 2e-5
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
    errors = [distance(path.final, exact) for path in paths]
    assert abs(-np.polyfit(np.log(steps), np.log(errors), 1)[0] - order) < 0.25
    assert errors[-1] < last
    assert paths[-1].violation()[0] < overlap
    assert (paths[-1].final[2 * N :, 1] == 0).all()
    assert distance(exact, problem.x0) > 0.5


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


def test_made_feasible_moves_points_only():
    state = divided(start(3, 0), 1)
    found = made_feasible(state, layers(4), numbers(), IPOPT)
    changed = {name for name in state._fields if getattr(found, name) != pytest.approx(getattr(state, name), abs=1e-9)}
    assert changed == {"x"}


def test_a_feasible_state_stays_where_it_is():
    state = cells(10, 6)
    found = made_feasible(state, layers(10), numbers(), IPOPT)
    assert particles(found).tolist() == particles(state).tolist()


BAD = {
    "off the line": ({"by": [0.0, 0.1]}, r"cells.by\[1\] = 0.1: must be 0 in the basal layer"),
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
