"""[AC]: apical constriction, as the public TypeScript program has it."""

from __future__ import annotations

import math

from tissue.plugins import EmtEvent
from tissue.rules.slice import find, leave_apical
from tissue.state.numbers import Numbers
from tissue.state.store import APICAL, Store


def begin(store: Store, i: int, bit: int, numbers: Numbers) -> None:
    """The apical point of cell i leaves the layer, together with those beside it that constrict in the same step.

    The junctions between them stay, so they are a chain apart; those to other cells are cut. The cells on both sides of
    the gap are joined, and the new junction rests at their present distance. At an end of the layer nothing is joined,
    and a chain does not go on where a ring begins.
    A cell that has lost its apical adhesion [A] has nothing to lose.
    """
    cells = store.cells
    if find(store.layers.apical, store.sizes[APICAL], i) < 0:
        return
    _, left, right = leave_apical(store, i)
    cells.chain[i] = cells.id[i] + 1
    before = left if left < i else -1  # in a ring the last cell is on the left of the first one
    for j in range(i - 1, before, -1):  # who stood there has left the layer, now or before
        k = cells.emt[j]
        if k >= 0 and store.emt.new[k] & bit and cells.chain[j] > 0:
            cells.chain[i] = cells.chain[j]
            break
    if left >= 0 and right >= 0:
        cells.rest_aa[left] = math.hypot(cells.ax[right] - cells.ax[left], cells.ay[right] - cells.ay[left])


EVENT = EmtEvent(
    name="ac",
    meaning="apical constriction: the cells that constrict together leave the apical layer as a chain of their own",
    source="the public TypeScript program",
    begin=begin,
)
