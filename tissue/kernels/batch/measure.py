"""Positions on the apical-basal scale of the EMT cells of all replicates, and what they are compared with."""

from __future__ import annotations

from tissue.cells import Floats, Integers
from tissue.kernels._numba import kernel
from tissue.kernels.batch.board import RUNNING
from tissue.kernels.batch.rows import row
from tissue.kernels.lanes import WIDTH
from tissue.kernels.scale import measure
from tissue.kernels.store import Store


@kernel
def measure_all(group: Store, ended: Integers, positions: Floats, controls: Floats) -> None:
    """``scale.measure`` of each replicate that runs: (WIDTH, m) positions, (WIDTH, 4) of the control cells."""
    for k in range(WIDTH):
        if ended[k] == RUNNING:
            measure(row(group, k), positions[k], controls[k])
