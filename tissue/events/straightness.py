"""[S]: loss of straightness (section 2.2.3 of chapter 4)."""

from __future__ import annotations

from tissue.plugins import EmtEvent
from tissue.state.numbers import Numbers
from tissue.state.running import TissueState


def begin(state: TissueState, i: int, bit: int, numbers: Numbers) -> None:
    """Weaken the bending spring of cell i, to 0 in the thesis."""
    state.cells.stiff_axb[i] = numbers.bent_stiffness


EVENT = EmtEvent(
    name="s",
    meaning="loss of straightness: the bending spring weakens",
    source="section 2.2.3 of chapter 4",
    begin=begin,
)
