"""What is measured of all replicates at a kept time."""

from __future__ import annotations

from tissue.kernels._numba import kernel
from tissue.kernels.batch.board import RUNNING
from tissue.kernels.batch.rows import row
from tissue.kernels.extents import measure_extents
from tissue.kernels.lanes import WIDTH
from tissue.kernels.scale import measure
from tissue.kernels.store import Store
from tissue.model.cells import Floats, Integers


@kernel
def measure_all(group: Store, ended: Integers, positions: Floats, controls: Floats, extents: Floats) -> None:
    """``scale.measure`` and ``measure_extents`` of each replicate that runs.

    (WIDTH, m) positions of its EMT cells, (WIDTH, 4) of its control cells, (WIDTH, 5) of the tissue.
    """
    for k in range(WIDTH):
        if ended[k] == RUNNING:
            measure(row(group, k), positions[k], controls[k])
            measure_extents(row(group, k), extents[k])
