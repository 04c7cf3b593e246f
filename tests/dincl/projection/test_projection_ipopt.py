"""Ipopt: one compiled program for many steps, and what only a nonlinear program meets."""

import numpy as np
import pytest

import dincl
from dincl.projection import ipopt

TOL = 1e-11


@pytest.fixture
def compiled(monkeypatch):
    """Count the programs that are compiled."""
    from dincl.projection import nlp

    made = []
    build = nlp.Program.__init__

    def counted(self, blocks, shape):
        made.append(shape)
        build(self, blocks, shape)

    monkeypatch.setattr(nlp.Program, "__init__", counted)
    return made


@pytest.mark.slow
def test_a_program_serves_many_steps(compiled):
    run = dincl.solve(dincl.scenes.ten_disks_corner(), dincl.CatchUp(0.005, dincl.Ipopt(TOL)), t=[3.0])
    assert run.stats.solver_calls > 400
    assert len(compiled) < run.stats.solver_calls / 10


def test_programs_are_dropped_when_there_are_too_many(compiled, monkeypatch):
    monkeypatch.setattr(ipopt, "MOST_PROGRAMS", 2)
    solver = dincl.Ipopt(TOL).solver()
    x = np.array([[0.0, 0.5], [2.0, 0.5], [4.0, 0.5]])
    for particle in (0, 1, 2, 2, 1, 0):
        problem = dincl.Problem(x, lambda t, x: 0 * x, [dincl.MaxDistance([[particle, (particle + 1) % 3]], 4.0)])
        y = x.copy()
        y[particle, 1] += 9.0
        solver.nearest(problem.rows_within(0.0, y, 10.0), y, x)
    assert len(compiled) == 4


def test_coincident_centres_at_the_start_are_parted():
    problem = dincl.Problem([[0.0, 0.0], [1.5, 0.0]], lambda t, x: 0 * x, [dincl.NonOverlap(0.5)])
    rows = problem.rows_within(0.0, problem.x0, 1.0)
    y = np.array([[0.2, 0.0], [0.2, 0.0]])
    found = dincl.Ipopt(TOL).solver().nearest(rows, y, problem.x0)
    assert found.point == pytest.approx(np.array([[-0.3, 0.0], [0.7, 0.0]]), abs=10 * TOL)


def test_multipliers_belong_to_the_distance_also_away_from_contact():
    problem = dincl.Problem(
        [[0.0, 0.0], [3.0, 0.0]], lambda t, x: 0 * x, [dincl.NonOverlap(0.5), dincl.HalfSpace((0, 1))]
    )
    rows = problem.rows_within(0.0, problem.x0, 5.0)
    y = problem.x0 - [0.0, 1.0]
    found = dincl.Ipopt(TOL).solver().nearest(rows, y, problem.x0)
    assert found.residual <= TOL
    assert found.multipliers == pytest.approx([0.0, 1.0, 1.0], abs=TOL)


def bowl(fails_after):
    """g(x) = 4 - |x|^2 for one particle, which returns NaN after some calls; its Jacobian."""
    calls = []

    def g(x):
        calls.append(1)
        return np.array([np.nan if len(calls) > fails_after else 4.0 - (x * x).sum()])

    return dincl.Smooth(g, lambda x: -2 * x.reshape(1, -1))


def test_a_smooth_row_is_met_to_tolerance():
    problem = dincl.Problem([[1.0, 0.0]], lambda t, x: 0 * x, [bowl(10**6)])
    found = dincl.project(problem, [[3.0, 4.0]], dincl.Ipopt(TOL))
    assert found.point == pytest.approx(np.array([[1.2, 1.6]]), abs=10 * TOL)
    assert found.multipliers == pytest.approx([0.75], abs=10 * TOL)


def test_a_smooth_row_that_fails_inside_ipopt_is_told_apart():
    problem = dincl.Problem([[1.0, 0.0]], lambda t, x: 0 * x, [bowl(6)])
    with pytest.raises(dincl.ProjectionFailed, match="g returned nan") as caught:
        dincl.project(problem, [[3.0, 4.0]], dincl.Ipopt(TOL))
    assert caught.value.status is dincl.Status.CONSTRAINT_FAILED


def test_one_unknown_and_a_family_without_near_rows():
    problem = dincl.Problem([[0.5]], lambda t, x: 0 * x - 1, [dincl.HalfSpace((1,)), dincl.HalfSpace((-1,), -9.0)])
    path = dincl.solve(problem, dincl.CatchUp(0.1, dincl.Ipopt(1e-9)), [1.0])
    assert abs(path.final[0, 0]) <= 1e-9
