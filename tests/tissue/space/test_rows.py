"""Points in no general position: a single row, as in two dimensions, and lattices whose rows glide along each other."""

import numpy as np
import pytest

from tests.tissue.space.by_address import follow, insert, relax, remove
from tests.tissue.space.invariants import check, check_vertices, edges_of, triangles_of
from tissue.network.halfedges import is_row
from tissue.network.start import triangulated
from tissue.state import surface as s
from tissue.state.space import PRESENT, SUM

RING = s.plane(period_x=8.0)


def row(capacity=8):
    """Eight cells one behind the other, around a period."""
    points = np.full((capacity, 3), np.nan)
    points[:8] = 0.0
    points[:8, 0] = np.arange(8) + 0.5
    return triangulated(RING, points[:8], np.copy, capacity), np.array(points.T, order="C")


def chain(*cells):
    """The edges of a closed chain."""
    return sorted([min(pair), max(pair)] for pair in zip(cells, cells[1:] + cells[:1], strict=True))


def test_a_row_keeps_its_order_and_its_junctions_wherever_the_points_go(rng):
    network, columns = row()
    rests = network.rest.copy()
    for _ in range(20):
        columns[0] = rng.permutation(columns[0])
        assert follow(RING, network, *columns, PRESENT) == 0
        check_vertices(network, triangles_of(network))
        assert sorted(edges_of(network).tolist()) == chain(*range(8))
        assert relax(RING, network, *columns, 0.1, 3.0, PRESENT) == 0
    assert network.rest.tolist() == rests.tolist()


def test_a_row_is_one_whichever_corner_of_a_triangle_its_ghost_is():
    network, _ = row()
    corners = network.corner[: 3 * network.triangles[0]].reshape(-1, 3)
    for _ in range(3):
        assert is_row(network)
        corners[:] = np.roll(corners, 1, axis=1)
    corners[0] = [0, 1, 2]
    assert not is_row(network)


def test_cells_come_and_go_in_a_row():
    network, columns = row(9)
    assert insert(RING, network, *columns, 5, 8, 1.0, 0.0, 0.0, 0.2, 0.5) == 0.2
    check(RING, network, columns.T)
    assert sorted(edges_of(network).tolist()) == chain(0, 1, 2, 3, 4, 5, 8, 6, 7)
    assert remove(RING, network, *columns, 2, SUM) == 1
    check(RING, network, columns.T)
    assert sorted(edges_of(network).tolist()) == chain(0, 1, 3, 4, 5, 8, 6, 7)


def test_cells_come_and_go_in_a_row_that_is_out_of_order():
    """The daughter goes past two neighbours, and a cell leaves from between two that have passed each other."""
    network, columns = row(9)
    assert insert(RING, network, *columns, 4, 8, 1.0, 0.0, 0.0, 3.0, 0.5) == 3.0
    assert columns[0, [4, 8]].tolist() == [3.0, 6.0]
    columns[0, 0] = 2.2
    assert follow(RING, network, *columns, PRESENT) == 0
    assert remove(RING, network, *columns, 1, SUM) == 1
    check_vertices(network, triangles_of(network))
    assert sorted(edges_of(network).tolist()) == chain(0, 2, 3, 4, 8, 5, 6, 7)


@pytest.mark.parametrize("period_z", [4.0, np.inf])
def test_rows_glide_along_each_other(period_z, rng):
    points = np.array([(i + 0.5, 0.0, k + 0.5) for k in range(4) for i in range(6)])
    surface, columns = s.plane(period_x=6.0, period_z=period_z), np.array(points.T, order="C")
    network, exchanged = triangulated(surface, points, np.copy), 0
    for _ in range(30):
        columns[0] += np.repeat(rng.choice((-0.5, 0.0, 0.25, 0.5), 4), 6)
        assert follow(surface, network, *columns, PRESENT) >= 0
        check(surface, network, columns.T)
        exchanged += relax(surface, network, *columns, 0.1, 2.0, PRESENT)
        check(surface, network, columns.T)
    assert exchanged > 20
