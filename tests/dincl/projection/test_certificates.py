"""What SUCCESS and INFEASIBLE promise: residuals in units of g, empty sets that are proved, wedges that are refused."""

import numpy as np
import pytest

import dincl
from tests.dincl.catalog import PROJECTIONS

SEED = 20260301
OPENINGS = [1e-5, 3e-7, 1e-8, 2e-9, 1e-10, 1e-12]


def rest(t, x):
    return 0 * x


def projected(sets, y, projection):
    """Return the nearest point, or None and the failure."""
    try:
        return dincl.project(sets, y, projection), None
    except dincl.ProjectionFailed as failure:
        return None, failure


def rotation(rng, d):
    """A random rotation, or reflection."""
    q, r = np.linalg.qr(rng.normal(size=(d, d)))
    return q * np.sign(np.diag(r))


def wedge(opening, d, turn, apex, order):
    """Two walls that meet along an edge through ``apex``, and a third one far away; a point within the wedge."""
    along, across = turn[:, 0], turn[:, 1]
    normals = [across, opening * along - across, -along]
    walls = [dincl.HalfSpace(n, float(n @ apex) / np.sqrt(n @ n) - 0.3, 0.3) for n in normals[:2]]
    walls.append(dincl.HalfSpace(-along, float(-along @ apex) - 3.0))
    return [walls[k] for k in order], (apex + along + opening / 2 * across)[None]


def needle(opening, turn, apex):
    """Three planes around a line, which they meet in ``apex``."""
    angles = 0.1 + 2 * np.pi / 3 * np.arange(3)
    normals = np.column_stack([np.full(3, opening), np.cos(angles), np.sin(angles)]) @ turn.T
    return [dincl.HalfSpace(n, float(n @ apex) / np.sqrt(n @ n)) for n in normals], (apex + turn[:, 0])[None]


def scenes_of(opening):
    """Wedges and needles of one opening in any order of their walls: constraints, start, axis, apex."""
    rng = np.random.default_rng(SEED)
    plain = wedge(opening, 2, np.eye(2), np.zeros(2), [0, 1, 2])
    yield *plain, np.eye(2)[0], np.zeros(2)
    for d in (2, 3):
        turn, apex = rotation(rng, d), rng.normal(size=d)
        yield *wedge(opening, d, turn, apex, rng.permutation(3)), turn[:, 0], apex
    turn, apex = rotation(rng, 3), rng.normal(size=3)
    yield *needle(opening, turn, apex), turn[:, 0], apex


@pytest.mark.parametrize("projection", PROJECTIONS)
@pytest.mark.parametrize("opening", OPENINGS)
def test_in_a_wedge_the_nearest_point_is_right_or_refused(projection, opening):
    for walls, start, axis, apex in scenes_of(opening):
        for tol in (1e-8, 1e-10):
            found, failure = projected(dincl.Problem(start, rest, walls), (apex - axis)[None], projection(tol))
            if found is None:
                assert failure.status is dincl.Status.NOT_CONVERGED
                continue
            assert found.residual <= tol
            # Walls are known to rounding, and so their edge to rounding over the opening.
            assert np.abs(found.point - apex).max() <= max(1e-6, 1e-15 / opening)


@pytest.mark.parametrize("scheme", [dincl.CatchUp, dincl.LinearisedCatchUp, dincl.MidpointCatchUp, None])
@pytest.mark.parametrize("opening", OPENINGS[:-1])
def test_a_run_into_a_wedge_ends_at_its_edge_or_is_refused(scheme, opening):
    for walls, start, axis, apex in scenes_of(opening):
        problem = dincl.Problem(start, dincl.drifts.constant(-axis), walls)
        made = dincl.EventDriven(1e-8) if scheme is None else scheme(0.0501, dincl.ActiveSet(1e-9))
        path = dincl.solve(problem, made, [2.0], throw=False)
        if path.status:
            assert np.abs(path.final - apex).max() <= max(1e-5, 1e-15 / opening)
        else:
            assert path.status is dincl.Status.NOT_CONVERGED


def test_a_refused_wedge_names_its_opening():
    walls, start, axis, apex = next(scenes_of(1e-8))
    for problem in (walls, dincl.Problem(start, rest, walls)):
        with pytest.raises(dincl.ProjectionFailed, match=r"opposite to each other but for .* rad") as failed:
            dincl.project(problem, (apex - axis)[None], dincl.Daqp(1e-9))
        assert failed.value.status is dincl.Status.NOT_CONVERGED


def polyhedron(rng):
    """Rows A x >= b of lengths 1e-3 to 1e3 that a known point meets, some redundant or repeated; and a point."""
    n = int(rng.integers(1, 31))
    m = int(rng.integers(1, 3 * n + 2))
    a, inside = rng.normal(size=(m, n)), rng.normal(size=n)
    if m > 4:
        a[m // 2 :] = np.abs(rng.normal(size=(m - m // 2, m // 2))) @ a[: m // 2]
    a /= np.linalg.norm(a, axis=1)[:, None]
    b = a @ inside - rng.exponential(size=m) * (rng.random(m) < 0.5)
    length = 10.0 ** rng.uniform(-3, 3, m)
    a, b = length[:, None] * a, length * b
    return a, b, inside, inside + rng.normal(size=n)


@pytest.mark.parametrize("projection", [one for one in PROJECTIONS if one.id != "Ipopt"])
def test_the_tolerance_is_that_of_the_certificate_in_units_of_g(projection):
    rng = np.random.default_rng(SEED)
    reached = 0
    for _ in range(25):
        a, b, inside, y = polyhedron(rng)
        rows = dincl.Smooth(lambda x, a=a, b=b: a @ x.ravel() - b, lambda x, a=a: a)
        tol = 10.0 ** -int(rng.integers(6, 10))
        problem = dincl.Problem(inside[:, None], rest, [rows])
        found, failure = projected(problem, y[:, None], projection(tol))
        if found is None:
            assert failure.status is dincl.Status.NOT_CONVERGED
            continue
        reached += 1
        g, lam = a @ found.point.ravel() - b, found.multipliers
        stationarity = np.abs(found.point.ravel() - y - lam @ a).max()
        assert max(-g.min(), stationarity, np.abs(np.minimum(lam, g)).max()) <= tol * (1 + 1e-6)
    assert reached >= 23


def test_the_tolerance_of_a_step_is_that_of_a_projection():
    slopes = 400 * np.array([[0.0, 1.0], [1.0, 1.0]])
    steep = dincl.Smooth(lambda x: slopes @ x[0], lambda x: slopes)
    problem = dincl.Problem([[0.5, 1.0]], lambda t, x: np.array([[-1.0, -1.0]]), [steep])
    for projection in (dincl.ActiveSet, dincl.ProjectedCG, dincl.Clarabel, dincl.Daqp):
        for scheme in (dincl.CatchUp, dincl.LinearisedCatchUp):
            path = dincl.solve(problem, scheme(0.1, projection(1e-9)), np.linspace(0.1, 2, 20))
            assert path.violation().max() <= 1e-9


@pytest.mark.parametrize("projection", PROJECTIONS)
def test_an_empty_polyhedron_is_called_infeasible_with_its_proof(projection):
    """Walls with a known combination sum_k mu_k n_k = 0, mu_k > 0, and sum_k mu_k b_k > 0, among others."""
    rng = np.random.default_rng(SEED)
    for _ in range(4):
        n = int(rng.integers(1, 12))
        k = int(rng.integers(1, n + 1))
        normals, mu = rng.normal(size=(k, n)), rng.uniform(0.2, 2, k)
        normals /= np.linalg.norm(normals, axis=1)[:, None]
        last = -mu @ normals
        normals, mu = np.vstack((normals, last / np.linalg.norm(last))), np.append(mu, np.linalg.norm(last))
        offset = rng.normal(size=k + 1)
        offset[-1] += (0.5 - mu @ offset) / mu[-1]
        others = [dincl.HalfSpace(v, -2.0) for v in rng.normal(size=(3, n))]
        walls = [*others, *(dincl.HalfSpace(v, float(b)) for v, b in zip(normals, offset, strict=True))]
        with pytest.raises(dincl.ProjectionFailed, match=r"mu >= 0 of sum 1 with \|A\^T mu\| = .* prove it") as failed:
            dincl.project(walls, rng.normal(size=(1, n)), projection(1e-8))
        assert failed.value.status is dincl.Status.INFEASIBLE


@pytest.mark.parametrize("projection", PROJECTIONS)
def test_a_curved_set_is_not_empty_because_a_linearisation_is(projection):
    """Two discs side by side do not fit between the walls, one above the other they do."""
    slab = [dincl.HalfSpace((1, 0), radius=0.5), dincl.HalfSpace((-1, 0), -1.2, radius=0.5)]
    problem = dincl.Problem([[0.6, 0.0], [0.6, 1.5]], rest, [*slab, dincl.NonOverlap(0.5)])
    found, failure = projected(problem, [[0.5, 0.0], [0.7, 0.0]], projection(1e-9))
    if found is None:
        assert failure.status is dincl.Status.NOT_CONVERGED
    else:
        assert problem.violation(0.0, found.point) <= 1e-9


def test_constraints_alone_are_projected_onto_without_a_start():
    sets = [dincl.HalfSpace((0, 1)), dincl.NonOverlap(0.5)]
    found = dincl.project(sets, [[0.0, -1.0], [0.5, -1.0]], dincl.Daqp(1e-12))
    assert found.point == pytest.approx(np.array([[-0.25, 0.0], [0.75, 0.0]]), abs=1e-10)
    started = dincl.Problem(found.point, rest, sets)
    assert started.violation(0.0, found.point) <= 1e-12


@pytest.mark.parametrize(
    ("sets", "y", "message"),
    [
        ([3], [[0.0]], r"problem = \[3\]: must be a dincl.Problem, or a list of dincl constraints"),
        (dincl.HalfSpace((1,)), [[0.0]], "problem = HalfSpace.*: must be a dincl.Problem, or a list"),
        ([dincl.HalfSpace((1,))], [0.0], r"y of shape \(1,\): must have shape \(N, d\)"),
        ([dincl.HalfSpace((1,))], [[0.0, 0.0]], "normal of shape"),
    ],
)
def test_constraints_alone_are_checked(sets, y, message):
    with pytest.raises(dincl.InvalidProblem, match=message):
        dincl.project(sets, y, dincl.Daqp(1e-9))


@pytest.mark.parametrize("projection", [dincl.GaussSeidel, dincl.ProjectedCG, dincl.ActiveSet])
def test_a_wedge_of_functions_is_seen_where_a_slope_is_zero(projection):
    """A gradient along an axis has one entry, that of the other wall two."""
    matrix = np.array([[-1.0, -3e-8], [1.0, 0.0]])
    wedge = [dincl.Smooth(lambda x: matrix @ x[0], lambda x: matrix)]
    with pytest.raises(dincl.ProjectionFailed, match="opposite to each other"):
        dincl.project(wedge, [[-0.3, 2.0]], projection(1e-6))
