"""State of a running tissue in three dimensions besides its cells: the surface, networks of neighbours, rules."""

from __future__ import annotations

import math
from typing import NamedTuple

from tissue.state.network import Network, grown, no_network
from tissue.state.surface import FLAT_SURFACE, Surface

FLAT, SPATIAL = 2, 3


# Rest lengths of new junctions: the distance of the cells then, or the mean of those that the two cells have; that of a
# junction that closes the gap of a cell that left may be the sum of the two whose place it takes, so that the tension
# stays.
PRESENT, MEAN, SUM = range(3)


class TissueRules(NamedTuple):
    """Where the machine code of the rules is by which cells come and go in slices or on surfaces, see ``tissue.rules``.

    Kernels call them by their addresses, so that a slice does not compile what changes networks.
    """

    split: int = 0  # cells into two daughters
    leave_apical: int = 0  # how a cell leaves a layer
    leave_basal: int = 0


class Space(NamedTuple):
    """The dimension and the rules of a tissue, and for a sheet or a closed surface its networks."""

    dimension: int
    surface: Surface  # which holds the basal points
    apical: Network  # of the junctions
    basal: Network  # of basal points that stay near each other (C2)
    rules: TissueRules
    longest: float = math.inf  # edge at a free boundary, see ``tissue.network.triangulation`` [R_soft]
    new_rest: int = MEAN  # rest length of the junction of new neighbours: PRESENT or MEAN


def no_space(rules: TissueRules = TissueRules()) -> Space:  # noqa: B008  # a tuple of numbers
    """Return the space of a slice with these rules."""
    return Space(FLAT, FLAT_SURFACE, no_network(0), no_network(0), rules)


def with_room(space: Space, capacity: int) -> Space:
    """Return the same networks with room for so many cells; a slice has none."""
    if space.dimension == FLAT:
        return space
    return space._replace(apical=grown(space.apical, capacity), basal=grown(space.basal, capacity))
