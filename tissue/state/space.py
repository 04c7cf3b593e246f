"""What a running tissue has in three dimensions besides its cells: the surface, networks of neighbours, rules."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from tissue.state.cells import Integers
from tissue.state.network import Network, grown, no_network
from tissue.state.surface import FLAT_SURFACE, Surface

FLAT, SPATIAL = 2, 3


class SpaceRules(NamedTuple):
    """Where the machine code of the rules is that differ from those in the plane; 0 there. See ``tissue.rules.sheet``.

    The kernels of a tissue in the plane neither know nor contain them.
    """

    split: int = 0
    leave_apical: int = 0
    leave_basal: int = 0
    position: int = 0


class Exchange(NamedTuple):
    """How cells exchange neighbours, see ``tissue.network``."""

    margin: float = 0.0  # the other diagonal must be shorter by this part
    reach: float = math.inf  # of edges at a boundary [R_soft]
    new_rest: int = 0  # rule of the rest length of a junction between new neighbours: PRESENT or MEAN
    bridge: int = 0  # rule of the rest lengths of the junctions that close the gap of a cell: PRESENT or SUM


class Space(NamedTuple):
    """The third dimension of a tissue; in the plane ``dimension`` is 2, and nothing else is used."""

    dimension: int
    surface: Surface  # which holds the basal points
    apical: Network  # of the junctions
    basal: Network  # of basal points that stay near each other (C2)
    exchange: Exchange
    rules: SpaceRules
    torn: Integers  # (1,): whether a network could not follow its points, 1 or 0


def no_space() -> Space:
    """That of a tissue in the plane."""
    return Space(FLAT, FLAT_SURFACE, no_network(0), no_network(0), Exchange(), SpaceRules(), np.zeros(1, np.int64))


def with_room(space: Space, capacity: int) -> Space:
    """The same networks with room for so many cells; that of the plane as it is."""
    if space.dimension == FLAT:
        return space
    return space._replace(apical=grown(space.apical, capacity), basal=grown(space.basal, capacity))
