"""The network follows its points: what costs nothing, what is in the way, what cannot be, and ends all the same."""

import numpy as np
import pytest

from tests.tissue.space.by_address import follow
from tests.tissue.space.invariants import check, edges_of
from tests.tissue.space.tissues import CLOSED, KINDS
from tests.tissue.space.walk import Walk
from tests.twins.tissue.space.network import lengths_of, triangles_of
from tissue.network.follow import STUCK
from tissue.network.start import triangulated
from tissue.state import surface as s
from tissue.state.space import MEAN, PRESENT

every = pytest.mark.parametrize("name", KINDS)


def rotation(rng):
    """A random rotation of space."""
    q, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    return q * np.linalg.det(q)


@every
def test_who_stands_still_costs_nothing(name):
    walk = Walk(name, 60, 1)
    before = triangles_of(walk.network)
    assert walk.follow() == 0
    assert triangles_of(walk.network) == before
    walk.check()


@pytest.mark.parametrize("name", CLOSED)
def test_a_motion_of_the_whole_costs_nothing(name):
    # Over many edges, and around periods.
    walk = Walk(name, 60, 2)
    before = triangles_of(walk.network)
    for _ in range(3):
        if walk.surface.bends == s.SPHERE:
            walk.points = walk.points @ rotation(walk.rng)
        elif walk.surface.bends == s.CYLINDER:
            angle = walk.rng.uniform(0, 6)
            turned = np.array([[np.cos(angle), np.sin(angle), 0], [-np.sin(angle), np.cos(angle), 0], [0, 0, 1]])
            walk.points = walk.points @ turned + (0, 0, walk.rng.uniform(-20, 20))
        else:
            walk.points = walk.points + walk.rng.uniform(-20, 20, 3) * (1, 0, 1)
        walk.points = np.asfortranarray(walk.points)
        assert walk.follow() == 0
        walk.check()
    assert triangles_of(walk.network) == before


@pytest.mark.parametrize("name", ["sphere outside", "sphere inside"])
def test_a_rotated_sphere_has_the_same_history(name):
    first, second = Walk(name, 60, 3), Walk(name, 60, 3)
    turned = rotation(np.random.default_rng(8))
    second.points[:60] = first.points[:60] @ turned
    assert second.follow() == 0
    for seed in range(8):
        # In the frame of the first.
        step = np.random.default_rng(seed).normal(size=(60, 3)) * 0.3
        first.points[:60] = s.laid(first.surface, first.points[:60] + step)
        second.points[:60] = first.points[:60] @ turned
        assert first.follow() == second.follow()
        assert first.relax() == second.relax()
        assert triangles_of(first.network) == triangles_of(second.network)
    assert first.work > 0


def hexagon(extra=()):
    """Six points around one in the middle; more are far outside of their patch."""
    angles = np.arange(6) * np.pi / 3
    ring = np.column_stack((np.cos(angles), np.zeros(6), np.sin(angles)))
    return np.vstack(([[0.0, 0.0, 0.0]], ring, *extra))


def columns_of(points):
    return np.array(points.T, order="C")


def test_a_point_that_crosses_an_edge_takes_its_place():
    points = hexagon([3 * hexagon()[1:]])
    network = triangulated(s.plane(), points, np.copy)
    columns = columns_of(points)
    # Through the middle between points 1 and 2, to behind their edge.
    columns[:, 0] = 1.1 * (columns[:, 1] + columns[:, 2]) / 2
    assert [1, 2] in edges_of(network).tolist()
    assert follow(s.plane(), network, *columns, PRESENT) > 0
    check(s.plane(), network, columns.T)
    assert [1, 2] not in edges_of(network).tolist()


@pytest.mark.parametrize("rule", [PRESENT, MEAN])
def test_the_rest_length_of_an_exchanged_junction(rule):
    # A kite whose points on the right and left come to each other until one is across the edge of the others.
    points = np.array([[1.0, 0, 0], [0, 0, 3.0], [-1.0, 0, 0], [0, 0, -3.0]])
    rests = {}

    def rest(lengths):
        rests.update(enumerate(lengths))
        return np.arange(1.0, len(lengths) + 1)

    network, columns = triangulated(s.plane(), points, rest), columns_of(points)
    before = lengths_of(network)
    assert (0, 2) in before
    columns[0, 1], columns[2, 1] = 0.1, -0.1
    assert follow(s.plane(), network, *columns, rule) > 0
    after = lengths_of(network)
    assert (0, 2) not in after or (1, 3) not in after
    new = [pair for pair in after if pair not in before and min(pair) >= 0]
    for i, j in new:
        assert after[i, j] == after[j, i]
        if rule == PRESENT:
            assert after[i, j] == pytest.approx(np.linalg.norm(columns[:, i] - columns[:, j]))
        else:
            assert min(before.values()) <= after[i, j] <= max(before.values())
    assert all(after[pair] == before[pair] for pair in after if pair in before)


@every
@pytest.mark.parametrize("kind", ["coincident", "all in one", "no number", "infinite"])
def test_what_cannot_be_ends_and_says_so(name, kind):
    walk = Walk(name, 60, 4)
    walk.points = np.asfortranarray(walk.points)
    aim = walk.points.copy()
    if kind == "coincident":
        i, j = edges_of(walk.network)[0]
        walk.points[i] = walk.points[j]
    elif kind == "all in one":
        walk.points[:60] = walk.points[0]
    else:
        walk.points[7] = np.nan if kind == "no number" else np.inf
    assert follow(walk.surface, walk.network, *walk.columns, PRESENT) == STUCK
    # It is still a network, from which a way leads back.
    walk.points[:] = aim
    assert follow(walk.surface, walk.network, *walk.columns, PRESENT) >= 0
    walk.check()


def test_two_points_that_change_places_pass_each_other():
    points = hexagon([2 * hexagon()[1:] @ np.diag((1, 1, 1.001))])
    network, columns = triangulated(s.plane(), points, np.copy), columns_of(points)
    columns[:, [0, 1]] = columns[:, [1, 0]]
    assert follow(s.plane(), network, *columns, PRESENT) > 0
    check(s.plane(), network, columns.T)


@every
def test_points_that_change_places_at_random(name):
    # The largest motion there is: each point goes to the place of another one.
    walk = Walk(name, 60, 5)
    target = walk.points[walk.rng.permutation(60)]
    if name in ("plane", *(kind for kind in KINDS if "cylinder" in kind and kind in CLOSED)) or "band" in name:
        # Where edges must be shorter than half of a period, in steps.
        target = walk.points[:60] + np.clip(target - walk.points[:60], -0.7, 0.7)
        target = s.laid(walk.surface, target)
    walk.points[:60] = target
    walk.follow()
    walk.check()


def test_the_same_bits_again():
    walks = [Walk("cylinder outside", 60, 9) for _ in range(2)]
    for walk in walks:
        for _ in range(10):
            walk.step(0.3)
            walk.relax()
            walk.insert()
    first, second = (walk.network for walk in walks)
    for name in ("corner", "twin", "rest", "out", "u", "v"):
        assert (getattr(first, name) == getattr(second, name)).all()


@pytest.mark.slow
def test_work_is_that_of_what_moved():
    # A motion of a twentieth of an edge concerns few, whatever the number.
    work = []
    for n in (40, 160):
        walk = Walk("sphere outside", n, 3, capacity=n)
        length = 0.05 * np.sqrt(4 * np.pi * walk.surface.radius**2 / n)
        for _ in range(20):
            walk.step(length)
            walk.relax()
        work.append(walk.work / (20 * n))
    assert max(work) < 0.1
