"""Isolated cells of a sheet that begin away from its edge."""

from __future__ import annotations

import numpy as np

from tissue.files.parameters import Parameters
from tissue.runs.cell_groups import crowd_of
from tissue.state.cells import CONTROL, Flags
from tissue.state.checkpoint import streams

# In distances of neighbours. Cells up to here leave less often, in sheets of 196, 784 and 1,764 cells of the study of
# choices; those beyond it do alike in the last two.
EDGE = 3.0
# Parts of the cells of a sheet.
WHOLE, INNER = "all", "inner"


def are_inner(parameters: Parameters) -> Flags:
    """Return whether each isolated cell (m,) begins farther than EDGE from the edge of a flat sheet.

    All do in a periodic sheet, which has none.
    """
    lattice = parameters.lattice()
    crowd = crowd_of(parameters.groups(), parameters.tissue.cells, streams(0), lattice)
    sheet = lattice.basal[::2]
    cells = sheet[:, crowd.kind != CONTROL]
    away = np.minimum(cells - sheet.min(axis=1)[:, None], sheet.max(axis=1)[:, None] - cells).min(axis=0)
    inner: Flags = (away > EDGE * lattice.spacing) | (parameters.space.boundary == "periodic")
    return inner
