"""[AC]: apical constriction, as the public TypeScript program has it."""

from __future__ import annotations

from tissue.kernels.layers import find
from tissue.kernels.rules import call_leave
from tissue.plugins import EmtEvent
from tissue.state.numbers import Numbers
from tissue.state.running import APICAL, TissueState
from tissue.state.space import PRESENT


def begin(state: TissueState, i: int, bit: int, numbers: Numbers) -> None:
    """Take the apical point of cell i out of the layer, with those beside it that constrict in the same step.

    The junctions between them stay, so they are a chain apart; those to other cells are cut. The cells on both sides of
    the gap are joined, and the new junction rests at their present distance. At an end of the layer nothing is joined,
    and a chain does not go on where a ring begins.
    A cell that has lost its apical adhesion [A] has nothing to lose.
    """
    cells, layer = state.cells, state.layers.apical
    place = find(layer, state.sizes[APICAL], i)
    if place < 0:
        return
    before = layer[place - 1] if place > 0 else -1
    call_leave(state.space.rules.leave_apical, state, i, PRESENT)
    cells.chain[i] = cells.id[i] + 1
    for j in range(i - 1, before, -1):  # who stood there has left the layer, now or before
        k = cells.emt[j]
        if k >= 0 and state.emt.new[k] & bit and cells.chain[j] > 0:
            cells.chain[i] = cells.chain[j]
            break


EVENT = EmtEvent(
    name="ac",
    meaning="apical constriction: the cells that constrict together leave the apical layer as a chain of their own",
    source="the public TypeScript program",
    begin=begin,
)
