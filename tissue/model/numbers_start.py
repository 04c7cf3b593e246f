"""The start of a run as plain numbers: lengths in units of R_soft."""

from __future__ import annotations

from typing import NamedTuple


class StartNumbers(NamedTuple):
    """What the first state is made from; made from the parameters of a file by ``Parameters.start_numbers``.

    Apical points lie at y = height, basal points at y = 0, each row evenly spaced and centred on the box of the nuclei.
    """

    cells: int
    height: float
    width: float  # of the box of the nuclei
    apical_spacing: float
    basal_spacing: float
    nuclei: str  # x: "box" anywhere in the width, "even" spacing dx = width/(cells + 1) plus U(-dx, dx), "own_basal"
    nuclei_low: float  # y: between these two heights
    nuclei_high: float
    rest_length: float  # eta of both cytoskeleton springs, without the radius R_soft
    junction: float  # eta of the apical junctions
