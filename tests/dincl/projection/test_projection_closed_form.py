"""ClosedForm: exact where there is a formula, refused where there is none."""

import numpy as np
import pytest

import dincl

TOL = 1e-11
ROUNDING = 1e-14
BOX = [
    dincl.HalfSpace(normal, offset, radius=0.2)
    for normal, offset in [((1, 0), 0.0), ((-1, 0), -1.0), ((0, 1), 0.0), ((0, -1), -1.0)]
]
TILTED = [dincl.HalfSpace((3, 4)), dincl.HalfSpace((4, -3)), dincl.HalfSpace((3, 4), offset=0.1)]
PAIR = [[0.0, 0.0], [1.0, 0.0]]
INSIDE = [[0.3, 0.4], [0.5, 0.5], [0.7, 0.3]]
SERVED = {
    "inside balls": ([dincl.InsideBall((0, 0), [0.6, 0.8, 0.8])], INSIDE),
    "outside balls": ([dincl.OutsideBall((1.3, 1.2), 1.0)], INSIDE),
    "box": (BOX, INSIDE),
    "walls at right angles": (TILTED, [[0.3, 0.2], [0.4, 0.1], [0.2, 0.2]]),
    "one half space": ([dincl.HalfSpace((1, 2), radius=[0.1, 0.2, 0.3])], INSIDE),
    "one pair": ([dincl.NonOverlap([0.5, 0.3])], PAIR),
    "one thread": ([dincl.MaxDistance([[0, 1]], 1.0)], PAIR),
    "threads of different particles": ([dincl.MaxDistance([[0, 3], [2, 1]], 1.5)], [*PAIR, [1.0, 1.0], [0.0, 1.0]]),
    "an order": ([dincl.Ordered([0, 1], axis=1)], PAIR),
    "an order across walls": ([dincl.Ordered([0, 1], axis=1), dincl.HalfSpace((1, 0))], PAIR),
    "nothing": ([], PAIR),
}
REFUSED = {
    "NonOverlap": ([dincl.NonOverlap(0.1)], INSIDE),
    "HalfSpace": ([dincl.HalfSpace((0, 1)), dincl.HalfSpace((1, 1))], INSIDE),
    "Smooth": ([dincl.Smooth(lambda x: x[:, 0], lambda x: np.eye(x.size)[::2])], INSIDE),
    "Ordered": ([dincl.Ordered([0, 1, 2], axis=0)], np.sort(INSIDE, axis=0)),
    "InsideBall": ([dincl.HalfSpace((0, 1)), dincl.InsideBall((0, 0), 1.0)], INSIDE),
    "MaxDistance": ([dincl.NonOverlap(0.1), dincl.MaxDistance([[0, 1]], 2.0)], PAIR),
}


def at_rest(constraints, x0):
    return dincl.Problem(x0, lambda t, x: 0 * x, constraints)


@pytest.mark.parametrize("case", SERVED)
@pytest.mark.parametrize("linearised", [True, False], ids=["linearised", "curved"])
def test_the_formula_is_the_nearest_point(case, linearised, rng):
    problem = at_rest(*SERVED[case])
    moved = 0
    for _ in range(20):
        y = problem.x0 + rng.normal(scale=0.25, size=problem.x0.shape)
        at = problem.x0 if linearised else None
        found = dincl.project(problem, y, dincl.ClosedForm(), linearised_at=at)
        judge = dincl.project(problem, y, dincl.Ipopt(TOL), linearised_at=at)
        assert found.residual <= 3 * ROUNDING
        assert found.point == pytest.approx(judge.point, abs=10 * TOL)
        assert found.multipliers == pytest.approx(judge.multipliers, abs=10 * TOL)
        moved += found.point.tobytes() != y.tobytes()
    assert moved >= 3 or case == "nothing"


def test_a_corner_of_the_box_is_exact():
    found = dincl.project(at_rest(BOX, [[0.5, 0.5]]), [[-3.0, 0.1]], dincl.ClosedForm())
    assert found.point == pytest.approx(np.array([[0.2, 0.2]]), abs=1e-15)
    assert found.multipliers == pytest.approx([3.2, 0.0, 0.1, 0.0], abs=1e-15)


@pytest.mark.parametrize("name", REFUSED)
def test_what_has_no_formula_is_refused_by_name(name):
    problem = at_rest(*REFUSED[name])
    message = rf"projection = ClosedForm\(\): has no formula for {name} "
    with pytest.raises(dincl.InvalidProblem, match=message):
        dincl.project(problem, problem.x0, dincl.ClosedForm())
    with pytest.raises(dincl.InvalidProblem, match=message):
        dincl.solve(problem, dincl.LinearisedCatchUp(0.1, dincl.ClosedForm()), t=[1.0])


def test_a_moving_set_is_served_where_it_is():
    problem = at_rest([dincl.Moving(dincl.InsideBall((0, 0), 1.0), lambda t: (t, 0.0))], [[0.0, 0.0]])
    found = dincl.project(problem, [[0.0, 0.0]], dincl.ClosedForm(), t=3.0)
    assert found.point == pytest.approx(np.array([[2.0, 0.0]]), abs=ROUNDING)


def test_walls_that_closed_are_infeasible():
    gate = dincl.Moving(dincl.HalfSpace((-1, 0), offset=-1.0), lambda t: (-t, 0.0))
    problem = at_rest([dincl.HalfSpace((1, 0)), gate], [[0.5, 0.0]])
    with pytest.raises(dincl.ProjectionFailed) as caught:
        dincl.project(problem, [[0.5, 0.0]], dincl.ClosedForm(), t=1.5)
    assert caught.value.status is dincl.Status.INFEASIBLE


def test_the_centre_of_an_obstacle_has_no_nearest_point():
    problem = at_rest([dincl.OutsideBall((0, 0), 1.0)], [[2.0, 0.0]])
    with pytest.raises(dincl.ProjectionFailed) as caught:
        dincl.project(problem, [[0.0, 0.0]], dincl.ClosedForm())
    assert caught.value.status is dincl.Status.COINCIDENT_CENTRES


@pytest.mark.slow
def test_a_run_agrees_with_an_iterative_projection():
    ball = dincl.Moving(dincl.InsideBall((0, 0), 0.5), lambda t: (np.sin(3 * t), t))
    problem = dincl.Problem([[0.1, 0.0], [0.0, 0.2]], lambda t, x: -x, [ball])
    exact, judge = (
        dincl.solve(problem, dincl.CatchUp(0.01, projection), t=[1.0, 2.0])
        for projection in (dincl.ClosedForm(), dincl.Ipopt(TOL))
    )
    assert exact.x == pytest.approx(judge.x, abs=10 * TOL)
    assert exact.stats.back_ends == ("closed form",)
