"""[B]: loss of basal adhesion (section 2.2.2 of chapter 4)."""

from __future__ import annotations

import math

from tissue.kernels.rules import call_leave
from tissue.plugins import EmtEvent
from tissue.state.numbers import Numbers
from tissue.state.running import TissueState
from tissue.state.space import PRESENT, SUM


def begin(state: TissueState, i: int, bit: int, numbers: Numbers) -> None:
    """Take the basal point of cell i out of the layer: (C2) to (C4) hold for its neighbours without it."""
    bridge = PRESENT if numbers.bridge_present else SUM
    if call_leave(state.space.rules.leave_basal, state, i, bridge):
        state.motion.held[i] = 0.0
        state.cells.stiff_bx[i] = numbers.alpha_bx * numbers.freed_stiffness


def last(state: TissueState, i: int, rest_ax: float, rest_bx: float, numbers: Numbers) -> None:
    """Relax the rest length of the basal spring towards 0, in place of (3.3)."""
    state.cells.rest_bx[i] = rest_bx * math.exp(-numbers.rate_bx * numbers.dt)


EVENT = EmtEvent(
    name="b",
    meaning="loss of basal adhesion: the basal point leaves the basal layer, and its spring contracts",
    source="section 2.2.2 of chapter 4",
    begin=begin,
    last=last,
    frees="basal",
)
