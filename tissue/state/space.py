"""What a running tissue has in three dimensions besides its cells: the surface, networks of neighbours, rules."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from tissue.state.cells import Integers
from tissue.state.network import Network, grown, no_network
from tissue.state.surface import FLAT_SURFACE, Surface

FLAT, SPATIAL = 2, 3


# Rest lengths of new junctions: the distance of the cells then, or the mean of those beside it; that of a junction that
# closes the gap of a cell that left may be the sum of the two whose place it takes, so that the tension stays.
PRESENT, MEAN, SUM = range(3)


class TissueRules(NamedTuple):
    """Where the machine code of the rules is that differ between slices and surfaces, see ``tissue.rules``.

    They are chosen once, when a tissue is made; the kernels call them by their addresses.
    """

    split: int = 0  # cells into two daughters
    leave_apical: int = 0  # how a cell leaves a layer
    leave_basal: int = 0
    position: int = 0  # y_AB of a nucleus
    shrink: int = 0  # rest lengths of junctions


class Exchange(NamedTuple):
    """How cells exchange neighbours, see ``tissue.network``."""

    margin: float = 0.0  # the other diagonal must be shorter by this part
    longest: float = math.inf  # of edges at a boundary [R_soft]
    new_rest: int = 0  # rule of the rest length of a junction between new neighbours: PRESENT or MEAN


class Space(NamedTuple):
    """The dimension and the rules of a tissue, and for a sheet or a closed surface its networks."""

    dimension: int
    surface: Surface  # which holds the basal points
    apical: Network  # of the junctions
    basal: Network  # of basal points that stay near each other (C2)
    exchange: Exchange
    rules: TissueRules
    torn: Integers  # (1,): whether a network could not follow its points, 1 or 0


def no_space(rules: TissueRules = TissueRules()) -> Space:  # noqa: B008  # a tuple of numbers
    """Return the space of a slice with these rules."""
    return Space(FLAT, FLAT_SURFACE, no_network(0), no_network(0), Exchange(), rules, np.zeros(1, np.int64))


def with_room(space: Space, capacity: int) -> Space:
    """Return the same networks with room for so many cells; a slice has none."""
    if space.dimension == FLAT:
        return space
    return space._replace(apical=grown(space.apical, capacity), basal=grown(space.basal, capacity))
