"""What the twins of the tissue kernels work on."""

from typing import NamedTuple

from tissue.cells import Cells, Emt, Layers, no_emt


class Tissue(NamedTuple):
    """What changes in a run."""

    cells: Cells
    layers: Layers
    next_id: int
    emt: Emt = no_emt()
