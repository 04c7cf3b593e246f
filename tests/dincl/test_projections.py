"""Each back end on feasible, degenerate, empty, narrow and curved programs; the certificate is recomputed here."""

import functools
import re

import numpy as np
import pytest
from scipy.optimize import nnls

import dincl
from dincl.projection import FeasibleSet
from tests.dincl.catalog import PROJECTIONS

SEED = 20260301
TOL = 1e-10
EVERY = pytest.mark.parametrize("projection", PROJECTIONS)


def rest(t, x):
    return 0 * x


def projected(sets, y, projection, **options):
    """Return the nearest point, or None and the failure."""
    try:
        return dincl.project(sets, y, projection, **options), None
    except dincl.ProjectionFailed as failure:
        return None, failure


def certified(problem, y, x, tol, at=None):
    """Return the residual of a point for all rows of a problem, or those linearised, with multipliers found here."""
    rows = problem.rows_within(0.0, x, np.inf)
    base = x if at is None else at
    jacobian = rows.jacobian(base).toarray()
    g = rows.values(base) + jacobian @ (x - base).ravel()
    active, multipliers = g <= tol, np.zeros(len(g))
    multipliers[active], _ = nnls(jacobian[active].T, (x - y).ravel())
    misfit = (x - y).ravel() - multipliers @ jacobian
    return max(np.max(-g, initial=0.0), np.abs(misfit).max(), np.abs(np.minimum(multipliers, g)).max(initial=0.0))


# Polyhedra.


@EVERY
def test_an_empty_polyhedron_is_proved_to_be_empty(projection):
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
        _, failure = projected(walls, rng.normal(size=(1, n)), projection(1e-8))
        assert failure.status is dincl.Status.INFEASIBLE
        assert re.search(r"mu >= 0 of sum 1 with \|A\^T mu\| = .* prove it", str(failure))


# Clusters of balls, with one more kind of set each.


def ellipsoid(x):
    """Inside a long ellipsoid, one row for each ball."""
    return 100.0 - (x * x * np.arange(1, 1 + x.shape[1])).sum(axis=1)


def ellipsoid_jacobian(x):
    count, d = x.shape
    full = np.zeros((count, count, d))
    full[np.arange(count), np.arange(count)] = -2 * x * np.arange(1, 1 + d)
    return full


EXTRAS = {
    "discs": lambda x: [],
    "threads": lambda x: [dincl.MaxDistance([[0, 1], [2, 3]], np.sqrt(((x[[0, 2]] - x[[1, 3]]) ** 2).sum(axis=1)))],
    "order": lambda x: [dincl.Ordered(np.argsort(x[:4, axis]), axis) for axis in range(x.shape[1])],
    "function": lambda x: [dincl.Smooth(ellipsoid, ellipsoid_jacobian)],
    "obstacle": lambda x: [dincl.OutsideBall(np.full(x.shape[1], -1.5), 1.4)],
}


@functools.cache
def cluster(extra, count, d):
    """Balls of unequal radii near a lattice on a floor, and a point pulled together that overlaps everywhere."""
    rng = np.random.default_rng(SEED)
    side = int(np.ceil(count ** (1 / d)))
    sites = np.stack(np.meshgrid(*[np.arange(side)] * d, indexing="ij"), axis=-1).reshape(-1, d)[:count]
    x0 = 1.04 * sites + rng.uniform(-0.02, 0.02, (count, d))
    radius = rng.uniform(0.42, 0.5, count)
    floor = dincl.HalfSpace(np.eye(d)[-1], offset=-0.5 - 0.02, radius=radius)
    problem = dincl.Problem(x0, rest, [dincl.NonOverlap(radius), floor, *EXTRAS[extra](x0)])
    pull = 0.08 * (x0.mean(axis=0) - x0) - 0.1 * np.eye(d)[-1]
    return problem, x0 + pull + rng.uniform(-0.03, 0.03, (count, d))


def hexagonal():
    """Equal discs in closest packing between walls, pressed down and aside: far more contacts than unknowns."""
    x0 = np.vstack([np.column_stack([np.arange(6) + 0.5 * (k % 2), np.full(6, k * np.sqrt(0.75))]) for k in range(6)])
    walls = [dincl.HalfSpace((0, 1)), dincl.HalfSpace((1, 0)), dincl.HalfSpace((-1, 0), offset=-5.5)]
    problem = dincl.Problem(x0, rest, [dincl.NonOverlap(0.5 * (1 - 1e-12)), *walls])
    return problem, x0 + [0.01, -0.03] + 0.002 * np.sin(7 * np.arange(x0.size)).reshape(x0.shape)


CLUSTERS = {f"{extra} {count} {d}": (extra, count, d) for extra in EXTRAS for count, d in ((4, 3), (10, 2), (30, 3))}


@EVERY
@pytest.mark.parametrize("scene", [*CLUSTERS, "redundant"])
@pytest.mark.parametrize("linearised", [True, False], ids=["linearised", "curved"])
def test_clusters(projection, scene, linearised):
    problem, y = cluster(*CLUSTERS[scene]) if scene in CLUSTERS else hexagonal()
    at, before = problem.x0 if linearised else None, y.copy()
    found = dincl.project(problem, y, projection(TOL), linearised_at=at)
    assert (y == before).all()
    assert found.residual <= TOL
    assert (found.multipliers >= 0).all()
    assert (found.multipliers > 1e-3).sum() >= 2
    # The multipliers found here belong to all rows at the point, up to the gaps of those that are active.
    assert certified(problem, y, found.point, 2 * TOL, at) <= 10 * TOL
    assert problem.violation(0.0, found.point) <= TOL


@EVERY
def test_a_feasible_point_comes_back_unchanged(projection):
    problem, _ = cluster("discs", 10, 2)
    found = dincl.project(problem, problem.x0, projection(TOL))
    assert found.point.tobytes() == problem.x0.tobytes()
    assert found.residual == 0.0
    assert not found.multipliers.any()
    assert not found.solved


@EVERY
def test_a_tolerance_that_cannot_be_met_is_a_failure(projection):
    problem, y = cluster("discs", 10, 2)
    _, failure = projected(problem, y, projection(1e-40))
    assert failure.status is dincl.Status.NOT_CONVERGED


@EVERY
@pytest.mark.parametrize("tol", [0.0, -1e-9, np.nan, np.inf, "small", None])
def test_a_tolerance_is_a_positive_number(projection, tol):
    with pytest.raises(dincl.InvalidProblem, match="tol = "):
        projection(tol)


@EVERY
def test_a_moving_wall_pushes_until_the_linearised_set_is_empty(projection):
    wall = dincl.Moving(dincl.HalfSpace((1, 0), radius=0.5), lambda t: (t, 0.0))
    problem = dincl.Problem([[0.5, 0.0], [1.5, 0.0]], rest, [wall, dincl.NonOverlap(0.5)])
    pushed = dincl.project(problem, problem.x0, projection(TOL), t=0.25)
    assert pushed.point == pytest.approx(np.array([[0.75, 0.0], [1.75, 0.0]]), abs=100 * TOL)
    stop = dincl.HalfSpace((-1, 0), offset=-2.0, radius=0.5)
    narrow = dincl.Problem([[0.6, 0.5], [1.4, 1.2]], rest, [wall, stop, dincl.NonOverlap(0.5)])
    _, failure = projected(narrow, narrow.x0, projection(TOL), t=1.5, linearised_at=narrow.x0)
    assert failure.status is dincl.Status.INFEASIBLE


# Wedges, in which rounding is magnified.

OPENINGS = [1e-5, 3e-7, 1e-8, 2e-9, 1e-10, 1e-12]


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
    yield *wedge(opening, 2, np.eye(2), np.zeros(2), [0, 1, 2]), np.eye(2)[0], np.zeros(2)
    for d in (2, 3):
        turn, apex = rotation(rng, d), rng.normal(size=d)
        yield *wedge(opening, d, turn, apex, rng.permutation(3)), turn[:, 0], apex
    turn, apex = rotation(rng, 3), rng.normal(size=3)
    yield *needle(opening, turn, apex), turn[:, 0], apex


@EVERY
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
        _, failure = projected(problem, (apex - axis)[None], dincl.Daqp(1e-9))
        assert failure.status is dincl.Status.NOT_CONVERGED
        assert re.search("opposite to each other but for .* rad", str(failure))


@pytest.mark.parametrize("projection", [dincl.ProjectedCG, dincl.ActiveSet])
def test_a_wedge_of_functions_is_seen_where_a_slope_is_zero(projection):
    """A gradient along an axis has one entry, that of the other wall two."""
    matrix = np.array([[-1.0, -3e-8], [1.0, 0.0]])
    sets = [dincl.Smooth(lambda x: matrix @ x[0], lambda x: matrix)]
    with pytest.raises(dincl.ProjectionFailed, match="opposite to each other"):
        dincl.project(sets, [[-0.3, 2.0]], projection(1e-6))


# Curved sets.


@EVERY
def test_a_curved_set_is_not_empty_because_a_linearisation_is(projection):
    """Two discs side by side do not fit between the walls, one above the other they do."""
    slab = [dincl.HalfSpace((1, 0), radius=0.5), dincl.HalfSpace((-1, 0), -1.2, radius=0.5)]
    problem = dincl.Problem([[0.6, 0.0], [0.6, 1.5]], rest, [*slab, dincl.NonOverlap(0.5)])
    found, failure = projected(problem, [[0.5, 0.0], [0.7, 0.0]], projection(1e-9))
    if found is None:
        assert failure.status is dincl.Status.NOT_CONVERGED
    else:
        assert problem.violation(0.0, found.point) <= 1e-9


def ellipse(axes):
    return dincl.Smooth(lambda x: 1 - ((x / axes) ** 2).sum(axis=1))


@pytest.mark.parametrize("projection", [dincl.ActiveSet, dincl.Daqp, dincl.ProjectedCG])
def test_points_many_radii_outside_of_containers(projection):
    """Balls, whose nearest points are known, and ellipses joined by cords, whose certificate is."""
    rng = np.random.default_rng(7)
    for distance in (1e-3, 0.5, 1.9, 2.1, 30.0, 1e4):
        for d in (2, 3):
            toward = rng.normal(size=(3, d))
            toward /= np.linalg.norm(toward, axis=1)[:, None]
            sets = [dincl.InsideBall(np.zeros(d), 0.5)]
            found = dincl.project(sets, 0.5 * (1 + distance) * toward, projection(1e-9))
            assert np.abs(found.point - 0.5 * toward).max() <= 1e-8
    for _ in range(8):
        axes = 10 ** rng.uniform(-1, 0.5, (3, 2))
        start = 0.3 * axes * rng.uniform(-1, 1, (3, 2))
        cords = [dincl.MaxDistance([(k, k + 1)], 1.1 * np.linalg.norm(start[k] - start[k + 1])) for k in range(2)]
        problem = dincl.Problem(start, rest, [ellipse(axes), *cords])
        y = start + rng.uniform(0.1, 1.0) * rng.normal(size=(3, 2))
        found = dincl.project(problem, y, projection(1e-9))
        assert certified(problem, y, found.point, 1e-8) <= 1e-7


@pytest.mark.parametrize("projection", [dincl.ActiveSet, dincl.Daqp])
def test_a_failure_names_the_curvature(projection):
    """The tip of an ellipse, whose radius of curvature is 0.002, seen from a distance of 15."""
    problem = dincl.Problem([[0.0, 0.0]], rest, [ellipse(np.array([0.67, 0.034]))])
    with pytest.raises(dincl.ProjectionFailed, match=r"strongly curved on the scale of a step: .* smaller dt"):
        dincl.project(problem, [[5.9, -14.7]], projection(1e-9))


# Runs, in which a projection is one argument.


def chain(grip):
    """Four beads on links, the first one held by a ball of radius 0.05 that moves by a fifth of it in each step."""
    x0 = [[0.27 * k, 1.6 - 0.05 * k] for k in range(4)]
    hand = dincl.Moving(grip, lambda t: (0.3 * np.sin(2 * t), -0.5 * t))
    links = dincl.MaxDistance([(k, k + 1) for k in range(3)], length=0.3)
    return dincl.Problem(x0, dincl.drifts.constant((0.0, -1.0)), [links, dincl.NonOverlap(radius=0.13), hand])


BALL = dincl.InsideBall(centre=(0.0, 1.6), distance=np.array([0.05, 50.0, 50.0, 50.0]))
SQUARE = dincl.Smooth(lambda x: np.array([0.05**2 - ((x[0] - np.array([0.0, 1.6])) ** 2).sum()]))
STEEP = 400 * np.array([[0.0, 1.0], [1.0, 1.0]])
RUNS = {
    "four discs": (dincl.scenes.four_disks(), 0.02, 1.0),
    "held by a ball": (chain(BALL), 0.02, 0.1),
    "held by a function": (chain(SQUARE), 0.02, 0.1),
    "steep rows": (
        dincl.Problem(
            [[0.5, 1.0]], dincl.drifts.constant((-1.0, -1.0)), [dincl.Smooth(lambda x: STEEP @ x[0], lambda x: STEEP)]
        ),
        0.1,
        1.0,
    ),
}


@functools.cache
def run(name, scheme, projection):
    problem, dt, end = RUNS[name]
    return dincl.solve(problem, scheme(dt, projection(1e-9)), np.linspace(end / 5, end, 5))


@EVERY
@pytest.mark.parametrize("scheme", [dincl.CatchUp, dincl.LinearisedCatchUp, dincl.MidpointCatchUp])
@pytest.mark.parametrize("name", RUNS)
def test_swapping_a_projection_changes_one_argument(name, scheme, projection):
    path, judge = run(name, scheme, projection), run(name, scheme, dincl.ActiveSet)
    assert np.abs(path.x - judge.x).max() <= 2e-7
    assert path.stats.solver_calls >= 2
    assert len(path.stats.back_ends) == 1
    if scheme is dincl.CatchUp:
        assert path.violation().max() <= 1.1e-9


def test_multipliers_outlive_rows_that_come_and_go():
    """Of 300 discs only near rows are listed; after a search for more rows the contacts keep their multipliers."""
    scene = dincl.scenes.pile(300)
    x = dincl.solve(scene, dincl.LinearisedCatchUp(0.005, dincl.ActiveSet(1e-9)), t=[0.5]).final
    feasible = FeasibleSet(scene, dincl.ProjectedCG(1e-9).solver(), dincl.Work(), linearised=True)
    found = [feasible.nearest(0.0, x - [0.0, 0.005], x, reach) for reach in (0.02, 0.1, 0.6)]
    assert len(found[0].multipliers) < len(found[1].multipliers) < len(found[2].multipliers)
    assert max(found[1].iterations, found[2].iterations) < found[0].iterations / 4


# What only a nonlinear program meets.


@pytest.fixture
def compiled(monkeypatch):
    """List the programs that CasADi compiles."""
    import casadi

    made, build = [], casadi.nlpsol
    monkeypatch.setattr(casadi, "nlpsol", lambda *arguments: made.append(1) or build(*arguments))
    return made


def test_a_compiled_program_serves_many_steps_and_more_than_64_are_not_kept(compiled):
    run = dincl.solve(dincl.scenes.ten_disks_corner(), dincl.CatchUp(0.02, dincl.Ipopt(TOL)), t=[3.0])
    assert run.stats.solver_calls > 100
    assert len(compiled) < run.stats.solver_calls / 5
    del compiled[:]
    x, solver = np.arange(66.0)[:, None] * [[2.0, 0.0]], dincl.Ipopt(TOL).solver()
    problem = dincl.Problem(x, rest, [dincl.NonOverlap(0.5)])
    for disc in (*range(65), 0, 64):
        y = x.copy()
        y[disc, 0] += 1.5
        solver.nearest(problem.rows_within(0.0, y, 0.1), y, y)
    assert len(compiled) == 66


def test_coincident_centres_at_the_start_are_parted():
    x0 = np.array([[0.0, 0.0], [1.5, 0.0]])
    feasible = FeasibleSet(
        dincl.Problem(x0, rest, [dincl.NonOverlap(0.5)]), dincl.Ipopt(TOL).solver(), dincl.Work(), linearised=False
    )
    found = feasible.nearest(0.0, np.array([[0.2, 0.0], [0.2, 0.0]]), x0, 2.0)
    assert found.point == pytest.approx(np.array([[-0.3, 0.0], [0.7, 0.0]]), abs=10 * TOL)


def bowl(fails_after):
    """g(x) = 4 - |x|^2 for one particle, which returns NaN after some calls; its Jacobian."""
    calls = []

    def g(x):
        calls.append(1)
        return np.array([np.nan if len(calls) > fails_after else 4.0 - (x * x).sum()])

    return dincl.Smooth(g, lambda x: -2 * x.reshape(1, -1))


def test_a_function_is_met_to_tolerance_or_its_failure_is_named():
    problem = dincl.Problem([[1.0, 0.0]], rest, [bowl(10**6)])
    found = dincl.project(problem, [[3.0, 4.0]], dincl.Ipopt(TOL))
    assert found.point == pytest.approx(np.array([[1.2, 1.6]]), abs=10 * TOL)
    assert found.multipliers == pytest.approx([0.75], abs=10 * TOL)
    failing = dincl.Problem([[1.0, 0.0]], rest, [bowl(6)])
    with pytest.raises(dincl.ProjectionFailed, match="g returned nan") as caught:
        dincl.project(failing, [[3.0, 4.0]], dincl.Ipopt(TOL))
    assert caught.value.status is dincl.Status.CONSTRAINT_FAILED


@EVERY
def test_one_unknown_and_a_family_without_near_rows(projection):
    problem = dincl.Problem([[0.5]], lambda t, x: 0 * x - 1, [dincl.HalfSpace((1,)), dincl.HalfSpace((-1,), -9.0)])
    path = dincl.solve(problem, dincl.CatchUp(0.1, projection(1e-9)), [1.0])
    assert abs(path.final[0, 0]) <= 1e-9


# The verb.

PAIR = dincl.Problem([[0.0, 0.0], [2.0, 0.0]], rest, [dincl.NonOverlap(0.5)])
OVERLAP = np.array([[0.5, 0.0], [1.0, 0.0]])


def test_constraints_alone_are_projected_onto_without_a_start():
    sets = [dincl.HalfSpace((0, 1)), dincl.NonOverlap(0.5)]
    found = dincl.project(sets, [[0.0, -1.0], [0.5, -1.0]], dincl.Daqp(1e-12))
    assert found.point == pytest.approx(np.array([[-0.25, 0.0], [0.75, 0.0]]), abs=1e-10)


def test_a_far_point_is_projected_with_rows_that_reach_it():
    x0 = np.column_stack([1.001 * np.arange(8), np.zeros(8)])
    floor = dincl.HalfSpace((1, 0), radius=0.5, offset=-0.5)
    problem = dincl.Problem(x0, rest, [dincl.NonOverlap(0.5), floor])
    found = dincl.project(problem, x0 - [3.0, 0.0], dincl.Daqp(1e-12))
    assert problem.violation(0.0, found.point) <= 1e-12


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"problem": None}, "problem = None: must be"),
        ({"problem": [3]}, r"problem = \[3\]: must be a dincl.Problem, or a list of dincl constraints"),
        ({"problem": dincl.HalfSpace((1,))}, "problem = HalfSpace.*: must be a dincl.Problem, or a list"),
        ({"problem": [dincl.HalfSpace((1,))], "y": [0.0]}, r"y of shape \(1,\): must have shape \(N, d\)"),
        ({"problem": [dincl.HalfSpace((1,))]}, "normal of shape"),
        ({"projection": "daqp"}, "projection = 'daqp': must be"),
        ({"projection": dincl.Daqp}, "projection = .*: must be"),
        ({"y": [0.0, 0.0]}, r"y = .*: must be finite real numbers of shape \(2, 2\), not \(2,\)"),
        ({"y": [[np.nan, 0.0], [1.0, 0.0]]}, r"y = nan at index \(0, 0\)"),
        ({"linearised_at": [[0.0, 0.0]]}, r"linearised_at = .*of shape \(2, 2\)"),
        ({"t": np.inf}, "t = inf: must be"),
    ],
)
def test_bad_input_is_named(change, message):
    with pytest.raises(dincl.InvalidProblem, match=message):
        dincl.project(**({"problem": PAIR, "y": OVERLAP, "projection": dincl.Daqp(1e-9)} | change))


def test_a_point_without_direction_fails_with_its_status():
    for projection in (dincl.Daqp(1e-9), dincl.ActiveSet(1e-9)):
        with pytest.raises(dincl.ProjectionFailed, match="Particle 1 lies on particle 0") as caught:
            dincl.project(PAIR, np.zeros((2, 2)), projection)
        assert caught.value.status is dincl.Status.COINCIDENT_CENTRES
