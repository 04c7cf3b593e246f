"""The tissue at one time."""

from __future__ import annotations

from typing import NamedTuple

from tissue.model.basal_curve import LINE, BasalCurve
from tissue.model.cells import CellLayers, Cells


class Frame(NamedTuple):
    """The tissue at one time; lengths in R_soft, times in hours."""

    t: float
    cells: Cells
    layers: CellLayers
    curve: BasalCurve = LINE  # the basal layer
