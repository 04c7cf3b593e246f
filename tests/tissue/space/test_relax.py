"""Exchange of neighbours: the margin, the boundary of a patch, and that it comes to an end."""

import math

import numpy as np
import pytest

from tests.tissue.space.by_address import follow, relax
from tests.tissue.space.invariants import check, edges_of
from tests.tissue.space.tissues import KINDS
from tests.tissue.space.walk import Walk, is_relaxed
from tests.twins.tissue.space.network import lengths_of, triangles_of
from tissue.network.halfedges import flip, is_flippable, set_rest
from tissue.network.start import triangulated
from tissue.state import surface as s
from tissue.state.space import MEAN, PRESENT


def kite(width):
    """Two points at a distance of 2, and two others between them, ``width`` apart."""
    return np.array([[1.0, 0, 0], [0, 0, width / 2], [-1.0, 0, 0], [0, 0, -width / 2]])


def relaxed(width, margin, rule=PRESENT):
    """The network of a kite that was as wide as long, with one edge across, when it has become narrower."""
    network = triangulated(s.plane(), kite(2.2), np.copy)
    columns = np.array(kite(width).T, order="C")
    assert follow(s.plane(), network, *columns, PRESENT) == 0
    before = lengths_of(network)
    flips = relax(s.plane(), network, *columns, margin, math.inf, rule)
    check(s.plane(), network, columns.T)
    return flips, before, lengths_of(network)


@pytest.mark.parametrize(("width", "margin", "flips"), [(1.81, 0.1, 0), (1.79, 0.1, 1), (1.99, 0.0, 1), (0.1, 1.0, 0)])
def test_an_edge_is_exchanged_beyond_the_margin(width, margin, flips):
    found, _, after = relaxed(width, margin)
    assert found == flips
    assert ((1, 3) in after) == (flips == 1)


def test_the_rest_length_is_the_distance_or_the_mean_of_four():
    _, before, after = relaxed(1.0, 0.1, PRESENT)
    assert after[1, 3] == pytest.approx(1.0)
    _, before, after = relaxed(1.0, 0.1, MEAN)
    around = [before[pair] for pair in ((0, 1), (1, 2), (2, 3), (3, 0))]
    assert after[1, 3] == pytest.approx(np.mean(around))


@pytest.mark.parametrize("name", KINDS)
def test_nothing_is_left_to_exchange(name):
    walk = Walk(name, 60, 11)
    walk.step(0.3)
    before = total(walk)
    flips = walk.relax()
    assert flips > 0
    assert is_relaxed(walk)
    assert walk.relax() == 0
    if "patch" not in name and "band" not in name:
        assert total(walk) < before
    walk.check()


def total(walk):
    """Length of all edges."""
    return sum(lengths(walk))


def lengths(walk):
    d = [s.differences(walk.surface, *(walk.points[i] - walk.points[j])) for i, j in edges_of(walk.network)]
    return np.linalg.norm(np.array(d), axis=1)


def test_long_edges_of_a_boundary_are_given_up_and_notches_filled():
    # A strip of cells with a notch: the convex hull closes it by an edge of length 2.
    points = np.array([[0.0, 0, 0], [1, 0, 0.7], [2, 0, 0], [2.2, 0, 1.5], [1, 0, 1.8], [-0.2, 0, 1.5]])
    columns = np.array(points.T, order="C")
    network = triangulated(s.plane(), points, np.copy)
    assert (0, 2) in lengths_of(network)
    assert relax(s.plane(), network, *columns, 0.1, 1.9, PRESENT) == 1
    assert (0, 2) not in lengths_of(network)
    check(s.plane(), network, points)
    # Within the margin of the reach it stays open, and then it is filled.
    assert relax(s.plane(), network, *columns, 0.1, 2.2, PRESENT) == 0
    assert relax(s.plane(), network, *columns, 0.1, 2.3, PRESENT) == 1
    assert lengths_of(network)[0, 2] == 2.0
    check(s.plane(), network, points)


def test_a_flip_and_its_way_back(rng):
    walk = Walk("sphere outside", 40, 3)
    before, lengths_before = triangles_of(walk.network), lengths_of(walk.network)
    for h in range(0, 3 * walk.network.triangles[0], 5):
        if is_flippable(walk.surface, walk.network, h):
            rest = walk.network.rest[h]
            new = flip(walk.network, h)
            assert triangles_of(walk.network) != before
            walk.check()
            assert is_flippable(walk.surface, walk.network, new)
            set_rest(walk.network, flip(walk.network, new), rest)
            assert triangles_of(walk.network) == before
            assert lengths_of(walk.network) == lengths_before


def test_what_may_not_be_flipped():
    # A vertex with three neighbours: its edges would become edges that are there; a reflex corner would be crossed.
    points = np.array([[0.0, 0, 0], [3, 0, 0], [0, 0, 3], [1, 0, 1]])
    network = triangulated(s.plane(), points, np.copy)
    for h in range(3 * network.triangles[0]):
        assert not is_flippable(s.plane(), network, h)
