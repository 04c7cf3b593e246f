"""The forces on the points of the cells."""

from __future__ import annotations

from typing import NamedTuple

from tissue.state.cells import Floats


class Forces(NamedTuple):
    """-grad W for each cell, shape (n,): on the nucleus, the apical point and the basal point [1 / R_soft].

    ``by`` is given for all cells; the caller leaves it out for those that the basal line holds  (C3).
    """

    x: Floats
    y: Floats
    ax: Floats
    ay: Floats
    bx: Floats
    by: Floats
