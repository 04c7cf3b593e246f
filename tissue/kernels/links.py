"""How the junctions within chains pull: there are few, so cell by cell, the same alone and in company."""

from __future__ import annotations

import math

from dincl.compile import inner
from tissue.kernels.board import Board


@inner
def pull_links(board: Board) -> None:
    """Add to the displacements of the apical points what the junctions of chains do, pulls k (d - eta).

    The board is seen flat.
    """
    ax, ay, drag_x, drag_y, links = board.ax, board.ay, board.drag_x, board.drag_y, board.links
    for number in range(links[0]):
        i, j = links[1 + 2 * number], links[2 + 2 * number]
        dx, dy = ax[i] - ax[j], ay[i] - ay[j]
        d = math.sqrt(dx * dx + dy * dy)
        if d > 0.0:
            pull = board.k_aa[i] * (1.0 - board.rest[i] / d)
            drag_x[i] -= pull * dx
            drag_y[i] -= pull * dy
            drag_x[j] += pull * dx
            drag_y[j] += pull * dy
