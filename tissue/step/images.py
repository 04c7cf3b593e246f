"""Differences of points of a periodic tissue: of all images the nearest one."""

from __future__ import annotations

from typing import Any

from dincl.compiled import inner
from dincl.compiled.lanes import floored, fma
from tissue.step.space_board import SpaceBoard

Lane = Any  # a double, or eight


@inner
def nearest(d: Lane, length: float, inverse: float) -> Lane:
    """d - length floor(d / length + 1/2), at most half a period in magnitude; d where both numbers are 0."""
    return d - length * floored(fma(d, inverse, 0.5))


@inner
def periods(board: SpaceBoard) -> tuple[float, float, float, float]:
    """The period along x and its inverse, then along z."""
    along_x, along_z = board.along_x, board.along_z
    return along_x.length, along_x.inverse, along_z.length, along_z.inverse
