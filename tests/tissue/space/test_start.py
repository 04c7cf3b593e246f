"""The network at the start: invariants on every surface, the property of Delaunay, and what is refused."""

import math

import numpy as np
import pytest

from tests.tissue.space.invariants import check, edges_of, euler
from tests.tissue.space.tissues import EULER, KINDS, spread_points
from tissue.space import surface as s
from tissue.space.network.start import triangulated


@pytest.mark.parametrize("name", KINDS)
@pytest.mark.parametrize("n", [40, 80])
def test_it_is_a_network(name, n, rng):
    points = spread_points(name, n, rng)
    network = triangulated(KINDS[name], points, np.copy, capacity=n + 5)
    check(KINDS[name], network, points)
    assert euler(network) == EULER[name]
    assert network.capacity == n + 5
    i, j = edges_of(network)[0]
    h = next(
        h for h in range(3 * network.triangles[0]) if network.corner[h] == i and network.corner[network.twin[h]] == j
    )
    d = s.differences(KINDS[name], *(points[i] - points[j]))
    assert network.rest[h] == pytest.approx(math.hypot(*d))
