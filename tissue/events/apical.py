"""[A]: loss of apical adhesion (section 2.2.1 of chapter 4)."""

from __future__ import annotations

import math

from tissue.kernels.rules import call_leave
from tissue.plugins import EmtEvent
from tissue.state.numbers import Numbers
from tissue.state.running import TissueState
from tissue.state.space import PRESENT, SUM


def begin(state: TissueState, i: int, bit: int, numbers: Numbers) -> None:
    """Take the apical point of cell i out of the layer, and join its neighbours by new junctions.

    It rests at the sum of the two it stands for, or at the present distance; the thesis does not say.
    """
    bridge = PRESENT if numbers.bridge_present else SUM
    if call_leave(state.space.rules.leave_apical, state, i, bridge):
        state.cells.stiff_ax[i] = numbers.alpha_ax * numbers.freed_stiffness


def last(state: TissueState, i: int, rest_ax: float, rest_bx: float, numbers: Numbers) -> None:
    """Relax the rest length of the apical spring towards 0, in place of (3.2)."""
    state.cells.rest_ax[i] = rest_ax * math.exp(-numbers.rate_ax * numbers.dt)


EVENT = EmtEvent(
    name="a",
    meaning="loss of apical adhesion: the cell leaves the apical layer, and its apical spring contracts",
    source="section 2.2.1 of chapter 4",
    begin=begin,
    last=last,
    frees="apical",
)
