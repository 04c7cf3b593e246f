"""All events of all EMT cells: what begins at a time, and what lasts."""

from __future__ import annotations

from dincl.compile import inner
from tissue.events import apical, basal, bits, protrusion, straightness
from tissue.kernels.scale import ab_position
from tissue.kernels.store import CELLS, Store
from tissue.model.numbers import Numbers


@inner
def begin_events(store: Store, t: float, numbers: Numbers) -> None:
    """Begin each event whose time has come; where it is the first one of a cell, keep its y_AB before it (4.8)."""
    cells, emt = store.cells, store.emt
    if len(emt.at_a) == 0:
        return
    for i in range(store.sizes[CELLS]):
        k = cells.emt[i]
        if k < 0:
            continue
        come = bits.A * (t >= emt.at_a[k]) + bits.B * (t >= emt.at_b[k])
        come += bits.S * (t >= emt.at_s[k]) + bits.P * (t >= emt.at_p[k])
        new = come & ~cells.events[i]
        if new and cells.events[i] == 0:
            emt.onset_ab[k] = ab_position(store, i)
        if new & bits.A:
            apical.begin(store, i, numbers)
        if new & bits.B:
            basal.begin(store, i, numbers)
        if new & bits.S:
            straightness.begin(store, i, numbers)
        cells.events[i] |= new


@inner
def last_events(store: Store, i: int, rest_ax: float, rest_bx: float, numbers: Numbers) -> None:
    """For each dt what the events of cell i put in place of the rules; its rest lengths before these are given."""
    events = store.cells.events[i]
    if events & bits.A:
        apical.last(store, i, rest_ax, numbers)
    if events & bits.P:
        protrusion.last(store, i, rest_bx, numbers)
    elif events & bits.B:
        basal.last(store, i, rest_bx, numbers)
