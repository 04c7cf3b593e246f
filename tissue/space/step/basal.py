"""The basal points: neighbours at most max_basal apart (C2), and on the surface those that it holds (C3)."""

from __future__ import annotations

import math

from dincl.compile import inner
from tissue.kernels.lanes import either, fma, load, root, store
from tissue.space.step.board import BASAL_CORRECTIONS, NEIGHBOURS, SpaceBoard
from tissue.space.step.images import nearest, periods
from tissue.space.surface import PLANE, SPHERE


@inner
def hold_together(board: SpaceBoard) -> None:
    """|B_i - B_j| <= max_basal (C2) for the basal neighbours, one edge after the other, each by half of the excess."""
    x, y, z, ends, most, corrections = board.bx, board.by, board.bz, board.neighbours, board.max_basal, 0
    length_x, by_x, length_z, by_z = periods(board)
    for edge in range(board.sizes[NEIGHBOURS]):
        i, j = ends[edge, 0], ends[edge, 1]
        dx, dy, dz = nearest(x[j] - x[i], length_x, by_x), y[j] - y[i], nearest(z[j] - z[i], length_z, by_z)
        square = dx * dx + dy * dy + dz * dz
        if square > most * most:
            part = 0.5 * (1.0 - most / math.sqrt(square))
            x[i], y[i], z[i] = x[i] + part * dx, y[i] + part * dy, z[i] + part * dz
            x[j], y[j], z[j] = x[j] - part * dx, y[j] - part * dy, z[j] - part * dz
            corrections += 1
    board.counts[BASAL_CORRECTIONS] += corrections


@inner
def put_on_surface(board: SpaceBoard, rows: int) -> None:
    """Bring the basal points that the surface holds to its nearest point: the board is in rows."""
    bends, radius = board.surface.bends, board.surface.radius
    for i in range(rows):
        held, x, y, z = load(board.held, i), load(board.bx, i), load(board.by, i), load(board.bz, i)
        if bends == PLANE:
            store(board.by, i, either(held, 0.0, y))
        else:
            square = fma(x, x, y * y)
            if bends == SPHERE:
                square = fma(z, z, square)
            share = radius / root(square)
            store(board.bx, i, either(held, share * x, x))
            store(board.by, i, either(held, share * y, y))
            if bends == SPHERE:
                store(board.bz, i, either(held, share * z, z))
