"""The events of the epithelial-to-mesenchymal transition (section 2.2 of chapter 4): when they begin, what they do."""

from __future__ import annotations

from dincl.compile import inner
from tissue.kernels.handed import numbers_of
from tissue.kernels.rules import Rules, call_begin, call_last
from tissue.kernels.store import CELLS, Store
from tissue.model.scale import ab_position
from tissue.state.cells import Emt
from tissue.state.numbers import Numbers


@inner
def begin_events(store: Store, t: float, numbers: Numbers, rules: Rules) -> None:
    """Begin each event whose time has come; where it is the first one of a cell, keep its y_AB before it (4.8)."""
    cells, emt = store.cells, store.emt
    if len(emt.new) == 0:
        return
    for i in range(store.sizes[CELLS]):
        if cells.emt[i] >= 0:
            emt.new[cells.emt[i]] = _come(emt, cells.emt[i], t) & ~cells.events[i]
    for i in range(store.sizes[CELLS]):
        k = cells.emt[i]
        if k < 0 or emt.new[k] == 0:
            continue
        if cells.events[i] == 0:
            emt.onset_ab[k] = ab_position(store, i)
        own = numbers_of(numbers, cells.kind[i])
        for event in rules.order:
            if (emt.new[k] >> event) & 1 and rules.begin[event] != 0:
                call_begin(rules.begin[event], store, i, 1 << event, own)
        cells.events[i] |= emt.new[k]


@inner
def _come(emt: Emt, k: int, t: float) -> int:
    """The bits of the events of an EMT cell whose time has come."""
    come = 0
    for event in range(emt.at.shape[0]):
        if t >= emt.at[event, k]:
            come |= 1 << event
    return come


@inner
def last_events(store: Store, i: int, rest_ax: float, rest_bx: float, numbers: Numbers, rules: Rules) -> None:
    """For each dt what the events of cell i put in place of the rules; its rest lengths before these are given."""
    for event in rules.order:
        if (store.cells.events[i] >> event) & 1 and rules.last[event] != 0:
            call_last(rules.last[event], store, i, rest_ax, rest_bx, numbers)
