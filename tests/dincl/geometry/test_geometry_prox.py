"""The constants of prox-regularity: proofs against sampling, sampling against closed forms."""

import math

import numpy as np
import pytest

import dincl
from dincl.geometry import (
    chain_constant,
    hypomonotonicity,
    normal_cone,
    printed_constant,
    proved_constant,
    prox_regularity,
)

RADIUS = 0.5
DISTANCE, TOL = 1e-3, 1e-12


def discs(x, radius=RADIUS):
    return dincl.Problem(x, lambda t, x: 0 * x, [dincl.NonOverlap(radius)])


def row(count, d=2):
    return np.arange(count, dtype=float)[:, None] * np.eye(d)[0]


def search(verb, problem, rng, samples=12, **more):
    settings = {"points": problem.x0, "distance": DISTANCE, "samples": samples, "tol": TOL, "rng": rng}
    return verb(problem, **(settings | more))


@pytest.mark.slow_with("2.0", "radius", "0.5-3")
@pytest.mark.parametrize("d", [2, 3])
@pytest.mark.parametrize("radius", [0.5, 2.0, (0.5, 0.75)])
def test_two_discs_are_the_outside_of_a_cylinder(d, radius, rng):
    """In (X_0 - X_1)/sqrt(2), S is the outside of a ball of radius (r_0 + r_1)/sqrt(2), which is its reach."""
    distance = float(np.sum(np.broadcast_to(radius, 2)))
    problem = discs(distance * row(2, d), radius)
    exact = distance / math.sqrt(2)
    found = search(prox_regularity, problem, rng)
    assert found.eta == pytest.approx(exact, rel=1e-5)
    assert 1 / search(hypomonotonicity, problem, rng).constant == pytest.approx(exact, rel=1e-5)


@pytest.mark.slow
def test_the_pair_shows_the_constant(rng):
    """Both points are feasible, the normal is a unit one, and the ratio is that of the pair."""
    problem = discs(row(3))
    found = search(prox_regularity, problem, rng)
    assert max(problem.violation(0.0, found.x), problem.violation(0.0, found.y)) <= TOL
    cone = normal_cone(problem, 0.0, found.x, 1e-11)
    assert cone.contains(found.normal)
    assert math.sqrt((found.normal**2).sum()) == pytest.approx(1.0)
    step = found.y - found.x
    assert found.eta == pytest.approx(float((step**2).sum() / (2 * (found.normal * step).sum())), rel=1e-6)
    other = search(hypomonotonicity, problem, rng)
    step = other.x - other.y
    product = -float(((other.normal_x - other.normal_y) * step).sum() / (step**2).sum())
    assert other.constant == pytest.approx(product, rel=1e-6)


@pytest.mark.parametrize("count", [3, 4, 5, 10])
def test_straight_rows_attain_their_constant(count, rng):
    assert search(prox_regularity, discs(row(count)), rng).eta == pytest.approx(chain_constant(count, RADIUS), rel=3e-4)


@pytest.mark.slow
def test_the_search_straightens_a_bent_row(rng):
    bent = np.array([[0.0, 0.0], [1.0, 0.0], [1.0 + math.cos(0.3), math.sin(0.3)]])
    found = search(prox_regularity, discs(bent), rng, samples=300)
    assert found.eta == pytest.approx(math.sqrt(8) / 3 * RADIUS, rel=1e-3)
    assert found.samples > 300


@pytest.mark.slow
def test_convex_sets_have_no_limit(rng):
    walls = [dincl.HalfSpace(normal=(1, 2)), dincl.HalfSpace(normal=(0, 1)), dincl.InsideBall((1.0, 0.0), 1.0)]
    problem = dincl.Problem([[0.0, 0.0], [1.0, 0.5]], lambda t, x: 0 * x, walls)
    found = search(prox_regularity, problem, rng, samples=40)
    assert found.eta == math.inf
    assert not found.normal.any()
    assert search(hypomonotonicity, problem, rng, samples=40).constant == 0.0


def test_outside_of_a_moving_ball(rng):
    """Its reach is its radius; at t = 1 it has moved by 3."""
    ball = dincl.Moving(dincl.OutsideBall((0.0, 0.0), 0.7), lambda t: (3 * t, 0.0))
    problem = dincl.Problem([[0.7, 0.0]], lambda t, x: 0 * x, [ball])
    found = search(prox_regularity, problem, rng, points=[[3.7, 0.0]], t=1.0)
    assert found.eta == pytest.approx(0.7, rel=1e-5)


def test_same_seed_same_result():
    found = [search(prox_regularity, discs(row(3)), np.random.default_rng(5)) for _ in range(2)]
    assert found[0].eta == found[1].eta
    assert (found[0].y == found[1].y).all()


def test_several_points_are_all_looked_at(rng):
    far = 5.0 * row(3)
    points = np.stack((far, row(3)))
    found = prox_regularity(discs(far), points, distance=DISTANCE, samples=2, tol=TOL, rng=rng)
    assert found.eta == pytest.approx(math.sqrt(8) / 3 * RADIUS, rel=1e-3)


def test_printed_constant():
    assert printed_constant(3, 0.5, 2) == pytest.approx(0.5 / 18 * (math.sqrt(3) / 6) ** 2)
    assert printed_constant(4, 2.0, 3) == pytest.approx(2 / 24 / 27)
    assert printed_constant(2, 1.0, 2) == 0.0


def test_proved_constant():
    assert proved_constant(2, 1.5) == pytest.approx(1.5 * math.sqrt(2))
    assert proved_constant(3, 1.0) == pytest.approx(chain_constant(3, 1.0))
    assert proved_constant(4, 1.0) == pytest.approx(math.sqrt(0.4))
    assert proved_constant(1, 1.0) == math.inf


def test_proof_and_row_enclose_and_meet():
    """Proved <= row, equal for N = 2 and 3, and of the same first order R / sqrt(N)."""
    for count in range(2, 60):
        assert (
            proved_constant(count, 1.0)
            <= chain_constant(count, 1.0) * (1 + 1e-12)
            <= 1.17 * proved_constant(count, 1.0)
        )
    assert chain_constant(3000, 1.0) * math.sqrt(3000) == pytest.approx(1.0, abs=0.02)
    assert proved_constant(3000, 1.0) * math.sqrt(3000) == pytest.approx(1.0, abs=0.001)


@pytest.mark.parametrize("count", [4, 8, 20])
def test_no_weights_buckle_a_row_more(count, rng):
    """L |n| / max Q by dense algebra for random weights, none below the constant; uniform ones in closed form."""
    place = np.arange(1, count) / count
    trials = [np.sin(np.pi * place) ** power for power in (0.5, 1, 2, 8)] + list(rng.exponential(size=(200, count - 1)))
    edges = np.diff(np.eye(count), axis=0)
    for weights in trials:
        force = math.sqrt(((edges.T @ weights) ** 2).sum())
        eta = 2 * force / np.linalg.eigvalsh(edges.T @ (weights[:, None] * edges))[-1]
        assert eta >= chain_constant(count, 1.0)
    assert chain_constant(count, 1.0) <= math.sqrt(2) / (2 * math.cos(math.pi / (2 * count)) ** 2)


def clusters(rng, d):
    """Random arrangements in contact: each disc is put onto one before, where it overlaps none."""
    for _ in range(60):
        x = [np.zeros(d)]
        while len(x) < 8:
            step = rng.normal(size=d) * np.where(np.arange(d) > 0, rng.uniform(0, 1), 1.0)
            place = x[rng.integers(len(x))] + step / math.sqrt(step @ step)
            if min(math.dist(place, other) for other in x) > 1 - 1e-12:
                x.append(place)
        yield np.array(x)


@pytest.mark.parametrize("d", [1, 2, 3])
def test_steps_of_the_proof_hold_for_random_contacts(d, rng):
    """w_i + w_j <= sqrt(4N - 6) |n| in a contact, and max Q <= max (w_i + w_j), by eigenvalues."""
    for x in clusters(rng, d):
        i, j = np.triu_indices(len(x), 1)
        touching = np.sqrt(((x[i] - x[j]) ** 2).sum(axis=1)) < 1 + 1e-9
        i, j = i[touching], j[touching]
        for power in (1, 4):
            weights = rng.exponential(size=len(i)) ** power
            force, total = np.zeros_like(x), np.zeros(len(x))
            laplacian = np.zeros((len(x), len(x)))
            for a, b, weight in zip(i, j, weights, strict=True):
                force[a] += weight * (x[a] - x[b])
                force[b] -= weight * (x[a] - x[b])
                total[[a, b]] += weight
                laplacian[np.ix_([a, b], [a, b])] += weight * np.array([[1, -1], [-1, 1]])
            degrees = (total[i] + total[j]).max()
            assert degrees <= math.sqrt(4 * len(x) - 6) * math.sqrt((force**2).sum()) * (1 + 1e-12)
            assert np.linalg.eigvalsh(laplacian)[-1] <= degrees * (1 + 1e-12)


def test_feasible_pairs_keep_to_the_proved_constant(rng):
    """n . (y - x) <= |y - x|^2 / (2 eta) for random normals n of random clusters x and random feasible y."""
    checked = positive = 0
    for x in clusters(rng, 2):
        problem, eta = discs(x), proved_constant(len(x), RADIUS)
        cone = normal_cone(problem, 0.0, x, 1e-9)
        normal = -np.tensordot(rng.exponential(size=len(cone.names)), cone.generators, 1)
        normal /= math.sqrt((normal**2).sum())
        for size in (0.01, 0.03, 1.0, 3.0):
            y = x + size * rng.normal(size=x.shape) + rng.uniform(0, size) * normal
            if size < 0.1:
                y = dincl.project(problem, y, dincl.Daqp(tol=1e-12)).point
            if problem.violation(0.0, y) <= 1e-12:
                checked += 1
                along = float((normal * (y - x)).sum())
                positive += along > 0
                assert along <= ((y - x) ** 2).sum() / (2 * eta) + 1e-9
    assert checked > 120
    assert positive > 10


@pytest.mark.parametrize(
    ("change", "match"),
    [
        ({"distance": 0.0}, "distance = "),
        ({"samples": 1}, "samples = "),
        ({"tol": -1.0}, "tol = "),
        ({"rng": 7}, "rng = "),
        ({"t": -1.0}, "t = "),
    ],
)
@pytest.mark.parametrize("verb", [prox_regularity, hypomonotonicity])
def test_bad_input(verb, change, match, rng):
    with pytest.raises(dincl.InvalidProblem, match=match):
        search(verb, discs(row(2)), **({"rng": rng} | change))


@pytest.mark.parametrize(
    ("points", "match"),
    [
        (np.zeros(2), "points of shape"),
        (np.zeros((0, 2, 2)), "points"),
        (0.9 * row(2), "outside of S"),
        (row(3), "x = .*of shape"),
    ],
)
def test_bad_points(points, match, rng):
    with pytest.raises(dincl.InvalidProblem, match=match):
        prox_regularity(discs(row(2)), points, distance=DISTANCE, samples=2, tol=TOL, rng=rng)


@pytest.mark.parametrize("call", [lambda: printed_constant(2, 1.0, 0), lambda: proved_constant(0, 1.0)])
def test_bad_constants(call):
    with pytest.raises(dincl.InvalidProblem, match=">= 1"):
        call()


def test_no_row_of_one_disc():
    with pytest.raises(dincl.InvalidProblem, match="count = 1"):
        chain_constant(1, 1.0)
