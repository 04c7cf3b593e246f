"""[A]: loss of apical adhesion (section 2.2.1 of chapter 4)."""

from __future__ import annotations

import math

from tissue.kernels.rules import call_leave
from tissue.plugins import EmtEvent
from tissue.state.numbers import Numbers
from tissue.state.space import PRESENT, SUM
from tissue.state.store import Store


def begin(store: Store, i: int, bit: int, numbers: Numbers) -> None:
    """The apical point of cell i leaves the layer, and new junctions join its neighbours.

    It rests at the sum of the two it stands for, or at the present distance; the thesis does not say.
    """
    bridge = PRESENT if numbers.bridge_present else SUM
    if call_leave(store.space.rules.leave_apical, store, i, bridge):
        store.cells.stiff_ax[i] = numbers.alpha_ax * numbers.freed_stiffness


def last(store: Store, i: int, rest_ax: float, rest_bx: float, numbers: Numbers) -> None:
    """The spring relaxes from its length before towards 0, and (3.2) holds no more."""
    store.cells.rest_ax[i] = rest_ax * math.exp(-numbers.rate_ax * numbers.dt)


EVENT = EmtEvent(
    name="a",
    meaning="loss of apical adhesion: the cell leaves the apical layer, and its apical spring contracts",
    source="section 2.2.1 of chapter 4",
    begin=begin,
    last=last,
    frees="apical",
)
