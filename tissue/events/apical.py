"""[A]: loss of apical adhesion (section 2.2.1 of chapter 4)."""

from __future__ import annotations

import math

from tissue.plugins import EmtEvent
from tissue.rules.slice import leave_apical
from tissue.state.numbers import Numbers
from tissue.state.store import Store


def begin(store: Store, i: int, bit: int, numbers: Numbers) -> None:
    """The apical point of cell i leaves the layer, and a new junction joins its neighbours.

    The rest length of this junction is the sum of the two it stands for, or the present distance; the thesis has none.
    """
    cells = store.cells
    inside, left, right = leave_apical(store, i)
    if not inside:
        return
    if left >= 0 and right >= 0:
        if numbers.bridge_present:
            cells.rest_aa[left] = math.hypot(cells.ax[right] - cells.ax[left], cells.ay[right] - cells.ay[left])
        else:
            cells.rest_aa[left] += cells.rest_aa[i]
    cells.stiff_ax[i] = numbers.alpha_ax * numbers.freed_stiffness


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
