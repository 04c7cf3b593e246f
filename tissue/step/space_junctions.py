"""The junctions of neighbours in the apical network (3.11), and of those that have left it together."""

from __future__ import annotations

from dincl.compiled import inner
from dincl.compiled.lanes import fma, twice_rsqrt, where_positive
from tissue.step.images import nearest, periods
from tissue.step.space_board import JUNCTIONS, SpaceBoard


@inner
def pull_along_edges(board: SpaceBoard, n: int) -> None:
    """Displacement of the apical points of n cells by their junctions, pulls k (d - eta), one edge after the other.

    A junction without length has no direction, and does nothing.
    """
    ax, ay, az = board.ax, board.ay, board.az
    drag_x, drag_y, drag_z, ends = board.drag_x, board.drag_y, board.drag_z, board.junctions
    length_x, by_x, length_z, by_z = periods(board)
    for i in range(n):
        drag_x[i] = drag_y[i] = drag_z[i] = 0.0
    for edge in range(board.sizes[JUNCTIONS]):
        i, j, k = ends[edge, 0], ends[edge, 1], board.k_aa[edge]
        dx, dy, dz = nearest(ax[j] - ax[i], length_x, by_x), ay[j] - ay[i], nearest(az[j] - az[i], length_z, by_z)
        square = fma(dx, dx, fma(dy, dy, dz * dz))
        pull = where_positive(square, k - 0.5 * k * board.rest[edge] * twice_rsqrt(square))
        drag_x[i], drag_y[i], drag_z[i] = (
            fma(pull, dx, drag_x[i]),
            fma(pull, dy, drag_y[i]),
            fma(pull, dz, drag_z[i]),
        )
        drag_x[j], drag_y[j], drag_z[j] = (
            fma(-pull, dx, drag_x[j]),
            fma(-pull, dy, drag_y[j]),
            fma(-pull, dz, drag_z[j]),
        )
