"""Cells exchange neighbours: an edge becomes the other diagonal where that is shorter by a margin."""

from __future__ import annotations

from dincl.compile import inner
from tissue.kernels import kernel
from tissue.space.network.chart import squared_distance
from tissue.space.network.halfedges import (
    flip,
    following,
    is_flippable,
    other_diagonal,
    rest_after_flip,
    set_rest,
)
from tissue.space.network.ring import beyond, list_all, list_around
from tissue.space.network.state import Network
from tissue.space.surface import Surface
from tissue.state.cells import Floats


@kernel
def relax(
    surface: Surface, network: Network, px: Floats, py: Floats, pz: Floats, margin: float, reach: float, rule: int
) -> int:
    """Flip edges of length l whose other diagonal is shorter than (1 - margin) l in space, until there is none.

    At the boundary of a patch an edge longer than ``reach`` is given up, and a notch is filled if the closing edge is
    shorter than (1 - margin) ``reach``. The flips are made that ``is_flippable`` allows, so nothing ever crosses.

    It ends. Take the sum of (l^2 - reach^2) over all edges between cells, with the reach 0 if there is no boundary,
    where their number never changes. A flip inside replaces l^2 by a smaller number; an edge that is given up takes a
    term > 0 out, one that fills a notch brings a term < 0. So the sum falls with each flip, also as computed, since
    the length of a pair is always the same number; no network comes twice, and there are finitely many.

    Parameters
    ----------
    px, py, pz
        The points, where ``follow`` has brought the network.
    margin
        From 0 to 1.
    reach
        Of edges at a boundary; of no meaning without.
    rule
        Of the rest lengths of new junctions: PRESENT or MEAN.

    Returns
    -------
    int
        The number of flips.
    """
    flips = 0
    begin, waiting = 0, list_all(network)
    while waiting > 0:
        h = network.desk.edges[begin]
        begin, waiting = beyond(network, begin + 1), waiting - 1
        network.desk.listed[h] = 0
        if not _is_better_flipped(surface, network, px, py, pz, h, (1.0 - margin) ** 2, reach * reach):
            continue
        h = flip(network, h)
        set_rest(network, h, rest_after_flip(surface, network, px, py, pz, h, rule))
        flips += 1
        waiting = list_around(network, h, begin, waiting)
    return flips


@inner
def _is_better_flipped(
    surface: Surface, network: Network, px: Floats, py: Floats, pz: Floats, h: int, factor: float, reach: float
) -> bool:
    """Whether to flip h; ``reach`` and factor of squares."""
    i, j = network.corner[h], network.corner[following(h)]
    left, right = other_diagonal(network, h)
    # Without a diagonal between cells, its place is taken by the reach.
    before = squared_distance(surface, px, py, pz, i, j) if min(i, j) >= 0 else reach
    after = squared_distance(surface, px, py, pz, left, right) if min(left, right) >= 0 else reach
    bound = before if min(left, right) < 0 else factor * before
    return after < bound and is_flippable(surface, network, h)
