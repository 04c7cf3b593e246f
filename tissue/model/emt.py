"""The events of the epithelial-to-mesenchymal transition (section 2.2 of chapter 4): when they begin, what they do."""

from __future__ import annotations

from dincl.compiled import inner
from tissue.kernels.rules import Rules, call_begin, call_last
from tissue.model.scale import ab_position
from tissue.state.numbers import Numbers, numbers_of
from tissue.state.running import CELLS, EMT_CELLS, Kind, TissueState


@inner
def begin_events(state: TissueState, t: float, numbers: Numbers, rules: Rules, kind: Kind) -> None:
    """Begin each event whose time has come; where it is the first one of a cell, keep its y_AB before it (4.8).

    One event after the other, each in all cells: so what a cell meets does not depend on which neighbour is before it.
    """
    cells, emt = state.cells, state.emt
    if len(emt.new) == 0:
        return
    come, n = 0, state.sizes[CELLS]
    for i in range(n):
        k = cells.emt[i]
        if k >= 0:
            emt.new[k] = 0
            for event in range(emt.at.shape[0]):
                if t >= emt.at[event, k]:
                    emt.new[k] |= 1 << event
            emt.new[k] &= ~cells.events[i]
            come |= emt.new[k]
            if emt.new[k] != 0 and cells.events[i] == 0:
                emt.onset_ab[k] = ab_position(state, i, kind)
    for event in rules.order:
        if (come >> event) & 1 and rules.begin[event] != 0:
            for i in range(n):
                k = cells.emt[i]
                if k >= 0 and (emt.new[k] >> event) & 1:
                    call_begin(rules.begin[event], state, i, 1 << event, numbers_of(numbers, cells.kind[i]))
    for i in range(n if come else 0):
        if cells.emt[i] >= 0:
            cells.events[i] |= emt.new[cells.emt[i]]


@inner
def last_events(state: TissueState, i: int, rest_ax: float, rest_bx: float, numbers: Numbers, rules: Rules) -> None:
    """For each dt what the events of cell i put in place of the rules; its rest lengths before these are given."""
    for event in rules.order:
        if (state.cells.events[i] >> event) & 1 and rules.last[event] != 0:
            call_last(rules.last[event], state, i, rest_ax, rest_bx, numbers)


@inner
def inherit_events(state: TissueState, i: int) -> None:
    """Give daughter i, a copy of her mother, an entry of her own among the EMT cells, if the mother has one."""
    emt, k, number = state.emt, state.cells.emt[i], state.sizes[EMT_CELLS]
    if k < 0:
        return
    for event in range(emt.at.shape[0]):
        emt.at[event, number] = emt.at[event, k]
    emt.new[number] = emt.new[k]
    emt.onset_ab[number], emt.side[number], emt.since[number] = emt.onset_ab[k], emt.side[k], emt.since[k]
    state.cells.emt[i] = number
    state.sizes[EMT_CELLS] += 1
