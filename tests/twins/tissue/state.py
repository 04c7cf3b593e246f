"""What the twins of the tissue kernels work on."""

from typing import NamedTuple

from tissue.state.cells import CellLayers, Cells, Emt, no_emt


class Tissue(NamedTuple):
    """What changes in a run."""

    cells: Cells
    layers: CellLayers
    next_id: int
    emt: Emt = no_emt()
