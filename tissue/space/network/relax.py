"""Cells exchange neighbours: an edge becomes the other diagonal where that is shorter by a margin."""

from __future__ import annotations

from tissue.kernels import kernel
from tissue.space.network.exchange import IN_SPACE, exchange
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
    return exchange(surface, network, px, py, pz, IN_SPACE, (1.0 - margin) ** 2, reach * reach, rule)
