"""What holds for every projection, run over the list of all of them, on random clusters of balls."""

import functools

import numpy as np
import pytest

import dincl
from dincl.projection import FeasibleSet
from tests.dincl.catalog import PROJECTIONS

TOL = 1e-10
# Points may differ by the residuals times the condition of the active rows.
AGREE = 100 * TOL
RADIUS_RANGE = (0.42, 0.5)
SEED = 20260101


def ellipsoid(x):
    """Inside a long ellipsoid, one row for each ball."""
    return 100.0 - (x * x * np.arange(1, 1 + x.shape[1])).sum(axis=1)


def ellipsoid_jacobian(x):
    count, d = x.shape
    full = np.zeros((count, count, d))
    full[np.arange(count), np.arange(count)] = -2 * x * np.arange(1, 1 + d)
    return full


def cluster(rng, count, d, extra=lambda x: []):
    """Balls of unequal radii near a lattice on a floor, and a point pulled together that overlaps everywhere."""
    side = int(np.ceil(count ** (1 / d)))
    sites = np.stack(np.meshgrid(*[np.arange(side)] * d, indexing="ij"), axis=-1).reshape(-1, d)[:count]
    x0 = 1.04 * sites + rng.uniform(-0.02, 0.02, (count, d))
    radius = rng.uniform(*RADIUS_RANGE, count)
    floor = dincl.HalfSpace(np.eye(d)[-1], offset=-0.5 - 0.02, radius=radius)
    problem = dincl.Problem(x0, lambda t, x: 0 * x, [dincl.NonOverlap(radius), floor, *extra(x0)])
    pull = 0.08 * (x0.mean(axis=0) - x0) - 0.1 * np.eye(d)[-1]
    return problem, x0 + pull + rng.uniform(-0.03, 0.03, (count, d))


EXTRAS = {
    "discs": lambda x: [],
    "threads": lambda x: [dincl.MaxDistance([[0, 1], [2, 3]], np.sqrt(((x[[0, 2]] - x[[1, 3]]) ** 2).sum(axis=1)))],
    "order": lambda x: [dincl.Ordered(np.argsort(x[:4, axis]), axis) for axis in range(x.shape[1])],
    "smooth": lambda x: [dincl.Smooth(ellipsoid, ellipsoid_jacobian)],
    "obstacle": lambda x: [dincl.OutsideBall(np.full(x.shape[1], -1.5), 1.4)],
}


@pytest.mark.parametrize("projection", PROJECTIONS)
def test_a_feasible_point_comes_back_unchanged(projection, rng):
    problem, _ = cluster(rng, 10, 2)
    found = dincl.project(problem, problem.x0, projection(TOL))
    assert found.point.tobytes() == problem.x0.tobytes()
    assert found.residual == 0.0
    assert not found.multipliers.any()


@functools.cache
def judged(extra, count, d, linearised):
    """A problem, a point, and its projection by one of the back ends, to compare the others with."""
    problem, y = cluster(np.random.default_rng(SEED), count, d, EXTRAS[extra])
    at = problem.x0 if linearised else None
    return problem, y, dincl.project(problem, y, dincl.Clarabel(TOL), linearised_at=at)


@pytest.mark.parametrize("projection", PROJECTIONS)
@pytest.mark.parametrize("extra", EXTRAS)
@pytest.mark.parametrize(("count", "d"), [(4, 2), (4, 3), (10, 2), (10, 3), (30, 2), (30, 3)])
@pytest.mark.parametrize("linearised", [True, False], ids=["linearised", "curved"])
def test_back_ends_agree_on_point_and_multipliers(projection, extra, count, d, linearised):
    problem, y, judge = judged(extra, count, d, linearised)
    before = y.copy()
    found = dincl.project(problem, y, projection(TOL), linearised_at=problem.x0 if linearised else None)
    assert y.tobytes() == before.tobytes()
    assert found.residual <= TOL
    assert problem.violation(0.0, found.point) <= TOL
    assert (found.multipliers >= 0).all()
    assert (found.multipliers > 1e-3).sum() >= 2
    assert found.point == pytest.approx(judge.point, abs=AGREE)
    assert found.multipliers == pytest.approx(judge.multipliers, abs=AGREE)


@pytest.mark.parametrize("projection", PROJECTIONS)
def test_the_certificate_is_that_of_the_rows(projection, rng):
    problem, y = cluster(rng, 10, 2)
    feasible = FeasibleSet(problem, projection(TOL).solver(), dincl.Work(), linearised=False)
    found = feasible.nearest(0.0, y, problem.x0, 1.0)
    rows = feasible.near_rows.at(0.0)
    reaction = rows.jacobian(found.point).toarray().T @ found.multipliers
    values = rows.values(found.point)
    assert found.stationarity == pytest.approx(np.abs((found.point - y).ravel() - reaction).max(), abs=1e-15)
    assert found.violation == pytest.approx(max(0.0, -values.min()), abs=1e-15)
    assert found.complementarity == pytest.approx(np.abs(np.minimum(values, found.multipliers)).max(), abs=1e-15)
    assert 0.5 * ((found.point - y) ** 2).sum() < 0.5 * ((problem.x0 - y) ** 2).sum()


def hexagonal(layers):
    """Equal discs in closest packing between walls, pressed down and aside: far more contacts than unknowns."""
    rows = [np.column_stack([np.arange(6) + 0.5 * (k % 2), np.full(6, k * np.sqrt(0.75))]) for k in range(layers)]
    x0 = np.vstack(rows)
    walls = [dincl.HalfSpace((0, 1)), dincl.HalfSpace((1, 0)), dincl.HalfSpace((-1, 0), offset=-5.5)]
    problem = dincl.Problem(x0, lambda t, x: 0 * x, [dincl.NonOverlap(0.5 * (1 - 1e-12)), *walls])
    return problem, x0 + [0.01, -0.03] + 0.002 * np.sin(7 * np.arange(x0.size)).reshape(x0.shape)


@pytest.mark.parametrize("projection", PROJECTIONS)
@pytest.mark.parametrize("linearised", [True, False], ids=["linearised", "curved"])
def test_redundant_contacts(projection, linearised):
    problem, y = hexagonal(6)
    rows, tol = problem.rows_within(0.0, problem.x0, 0.1), 1e-11
    feasible = FeasibleSet(problem, projection(tol).solver(), dincl.Work(), linearised=linearised)
    found = feasible.nearest(0.0, y, problem.x0, 0.1)
    active = dincl.rows.linearised(rows, found.point).take(rows.values(found.point) <= tol).matrix.toarray()
    assert len(active) > np.linalg.matrix_rank(active)
    assert found.residual <= tol


@pytest.mark.parametrize("projection", PROJECTIONS)
def test_an_empty_linearised_set_is_called_infeasible(projection):
    gate = dincl.Moving(dincl.HalfSpace((-1, 0), offset=-2.0, radius=0.5), lambda t: (-t, 0.0))
    x0 = [[0.6, 0.5], [1.5, 1.2]]
    problem = dincl.Problem(x0, lambda t, x: 0 * x, [dincl.HalfSpace((1, 0), radius=0.5), gate, dincl.NonOverlap(0.5)])
    with pytest.raises(dincl.ProjectionFailed) as caught:
        dincl.project(problem, x0, projection(TOL), t=1.5, linearised_at=x0)
    assert caught.value.status is dincl.Status.INFEASIBLE


@pytest.mark.parametrize("projection", PROJECTIONS)
def test_a_moving_wall_pushes(projection):
    wall = dincl.Moving(dincl.HalfSpace((1, 0), radius=0.5), lambda t: (t, 0.0))
    problem = dincl.Problem([[0.5, 0.0], [1.5, 0.0]], lambda t, x: 0 * x, [wall, dincl.NonOverlap(0.5)])
    found = dincl.project(problem, problem.x0, projection(TOL), t=0.25)
    assert found.point == pytest.approx(np.array([[0.75, 0.0], [1.75, 0.0]]), abs=AGREE)


@pytest.mark.parametrize("projection", PROJECTIONS)
def test_nothing_that_was_handed_over_is_changed(projection, rng):
    problem, y = cluster(rng, 10, 2)
    rows = dincl.rows.linearised(problem.rows_within(0.0, problem.x0, 1.0), problem.x0)
    guess = problem.x0.copy()
    held = [rows.matrix.indptr, rows.matrix.indices, rows.matrix.data, rows.bound, y, guess]
    before = [array.copy() for array in held]
    solver = projection(TOL).solver()
    first, second = (solver.nearest(rows, y, guess) for _ in range(2))
    assert all(array.tobytes() == copy.tobytes() for array, copy in zip(held, before, strict=True))
    assert second.point == pytest.approx(first.point, abs=AGREE)


@pytest.mark.slow_with("CatchUp-CvxpyQP")
@pytest.mark.parametrize("projection", PROJECTIONS)
@pytest.mark.parametrize("scheme", [dincl.CatchUp, dincl.LinearisedCatchUp])
def test_swapping_a_projection_changes_one_argument(scheme, projection):
    scene = dincl.scenes.four_disks()
    run, judge = (dincl.solve(scene, scheme(0.02, each), t=[1.0, 2.0]) for each in (projection(TOL), dincl.Daqp(TOL)))
    assert run.x == pytest.approx(judge.x, abs=AGREE)
    assert run.stats.solver_calls > 10
    assert len(run.stats.back_ends) == 1


@pytest.mark.parametrize("projection", PROJECTIONS)
def test_a_tolerance_that_cannot_be_met_is_a_failure_not_a_wrong_point(projection, rng):
    problem, y = cluster(rng, 10, 2)
    with pytest.raises(dincl.ProjectionFailed) as caught:
        dincl.project(problem, y, projection(1e-40))
    assert caught.value.status is dincl.Status.NOT_CONVERGED


@pytest.mark.parametrize("projection", PROJECTIONS)
@pytest.mark.parametrize("tol", [0.0, -1e-9, np.nan, np.inf, "small", None])
def test_a_tolerance_is_a_positive_number(projection, tol):
    with pytest.raises(dincl.InvalidProblem, match="tol = "):
        projection(tol)


@pytest.mark.parametrize("projection", PROJECTIONS)
def test_a_feasible_point_has_no_multipliers_also_after_another_one(projection, rng):
    problem, y = cluster(rng, 10, 2)
    feasible = FeasibleSet(problem, projection(TOL).solver(), dincl.Work(), linearised=False)
    assert feasible.nearest(0.0, y, problem.x0, 1.0).multipliers.max() > 0.0
    inside = feasible.nearest(0.0, problem.x0, problem.x0, 1.0)
    assert inside.point.tolist() == problem.x0.tolist()
    assert not inside.multipliers.any()
    assert inside.residual <= TOL
    assert inside.back_end == "none"
