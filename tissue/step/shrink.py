"""The rest lengths of junctions in three dimensions."""

from __future__ import annotations

import math

from dincl.compiled import inner
from tissue.kernels.numbers import numbers_of
from tissue.network.halfedges import set_rest
from tissue.state.numbers import Numbers
from tissue.state.store import Store


@inner
def shrink_junctions(store: Store, numbers: Numbers) -> None:
    """Relax each rest length towards 0 over one dt, eta <- eta exp(-k dt)  (3.6); k is the mean of both cells."""
    network, kind = store.space.apical, store.cells.kind
    rate, kept = 0.0, 1.0
    for h in range(3 * network.triangles[0]):
        i, j = network.corner[h], network.corner[network.twin[h]]
        if 0 <= i < j:
            own = 0.5 * (numbers_of(numbers, kind[i]).rate_aa + numbers_of(numbers, kind[j]).rate_aa)
            if own != rate:  # mostly the same: few exponentials for many junctions
                rate, kept = own, math.exp(-own * numbers.dt)
            set_rest(network, h, network.rest[h] * kept)
