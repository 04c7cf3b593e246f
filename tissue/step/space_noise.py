"""The noise of a substep on the nuclei in three dimensions."""

from __future__ import annotations

from dincl.compiled import inner
from dincl.compiled.lanes import fma, load, store
from tissue.kernels.normals import normals, shake
from tissue.step.space_board import SpaceBoard

# Added to the number of a substep where the depth is drawn: along x and y the noise is that of the section z = 0.
DEPTH = 1 << 31


@inner
def shake_nuclei(board: SpaceBoard, rows: int, number: int) -> None:
    """Add the noise of substep ``number``, if it comes in substeps; the board is in rows."""
    if board.deviation > 0.0:
        shake(board.x, board.y, board.id, rows, board.deviation, board.noise_key, number)
        for i in range(rows):
            depth, _ = normals(board.noise_key, board.id, i, DEPTH + number)
            store(board.z, i, fma(board.deviation, depth, load(board.z, i)))
