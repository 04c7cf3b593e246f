"""Positions of all cells and the height at every output time of the page, at a small part of the cost of a run."""

from __future__ import annotations

from typing import Any

from tissue.kernels import kernel
from tissue.kernels.curve import height_of
from tissue.model.scale import ab_position
from tissue.state.running import APICAL, CELLS, TissueState


@kernel
def scaled(state: TissueState, positions: Any) -> Any:
    """Write y_AB of all cells as 32-bit numbers, shape (n,); return the mean height of the apical layer.

    The apical layer must have a cell. A position without a value, where the layer touches the basal one, is not finite.
    """
    cells, n = state.cells, state.sizes[APICAL]
    for i in range(state.sizes[CELLS]):
        positions[i] = ab_position(state, i)
    total = 0.0
    for k in range(n):
        i = state.layers.apical[k]
        total += height_of(state.curve, cells.ax[i], cells.ay[i])
    return total / n
