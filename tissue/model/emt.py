"""The events of the epithelial-to-mesenchymal transition (section 2.2 of chapter 4): when they begin, what they do."""

from __future__ import annotations

import math

from dincl.compiled import inner
from tissue.kernels.rules import Rules, call_begin, call_last
from tissue.model.scale import ab_position
from tissue.state.cells import Emt
from tissue.state.numbers import Numbers, numbers_of
from tissue.state.running import CELLS, EMT_CELLS, TissueState

# What events of users must leave finite and not negative; the first two are without R_soft, so at least -R_soft.
CHECKED = ("rest_ax", "rest_bx", "rest_aa", "stiff_ax", "stiff_bx", "stiff_axb", "stiff_aa", "radius")
BEGUN, LASTED = 1.0, 2.0


@inner
def begin_events(state: TissueState, t: float, numbers: Numbers, rules: Rules) -> None:
    """Begin each event whose time has come; where it is the first one of a cell, keep its y_AB before it (4.8).

    One event after the other, each in all cells: so what a cell meets does not depend on which neighbour is before it.
    """
    cells, emt = state.cells, state.emt
    if len(emt.new) == 0:
        return
    come = 0
    for i in range(state.sizes[CELLS]):
        k = cells.emt[i]
        if k >= 0:
            emt.new[k] = _come(emt, k, t) & ~cells.events[i]
            come |= emt.new[k]
            if emt.new[k] != 0 and cells.events[i] == 0:
                emt.onset_ab[k] = ab_position(state, i)
    if come == 0:
        return
    for event in rules.order:
        if (come >> event) & 1 and rules.begin[event] != 0:
            _begin_in_all(state, event, numbers, rules)
    for i in range(state.sizes[CELLS]):
        if cells.emt[i] >= 0:
            cells.events[i] |= emt.new[cells.emt[i]]


@inner
def _begin_in_all(state: TissueState, event: int, numbers: Numbers, rules: Rules) -> None:
    """Begin an event in all cells whose time for it has come."""
    cells, emt = state.cells, state.emt
    for i in range(state.sizes[CELLS]):
        k = cells.emt[i]
        if k >= 0 and (emt.new[k] >> event) & 1:
            own = numbers_of(numbers, cells.kind[i])
            least_ax, least_bx = min(-own.soft_radius, cells.rest_ax[i]), min(-own.soft_radius, cells.rest_bx[i])
            call_begin(rules.begin[event], state, i, 1 << event, own)
            if (rules.users >> event) & 1:
                check_cell(state, i, event, BEGUN, least_ax, least_bx, rules)


@inner
def _come(emt: Emt, k: int, t: float) -> int:
    """Return the bits of the events of an EMT cell whose time has come."""
    come = 0
    for event in range(emt.at.shape[0]):
        if t >= emt.at[event, k]:
            come |= 1 << event
    return come


@inner
def last_events(state: TissueState, i: int, rest_ax: float, rest_bx: float, numbers: Numbers, rules: Rules) -> None:
    """For each dt what the events of cell i put in place of the rules; its rest lengths before these are given."""
    cells = state.cells
    for event in rules.order:
        if (cells.events[i] >> event) & 1 and rules.last[event] != 0:
            least_ax = min(-numbers.soft_radius, rest_ax, cells.rest_ax[i])
            least_bx = min(-numbers.soft_radius, rest_bx, cells.rest_bx[i])
            call_last(rules.last[event], state, i, rest_ax, rest_bx, numbers)
            if (rules.users >> event) & 1:
                check_cell(state, i, event, LASTED, least_ax, least_bx, rules)


@inner
def check_cell(
    state: TissueState, i: int, event: int, part: float, least_ax: float, least_bx: float, rules: Rules
) -> None:
    """Note the first field of CHECKED of cell i that an event of a user left bad: part, event, id, field, value, least.

    Rest lengths that the rules alone had made less than -R_soft may stay so.
    """
    if rules.fault[0] != 0.0:
        return
    cells = state.cells
    values = (
        *(cells.rest_ax[i], cells.rest_bx[i], cells.rest_aa[i]),
        *(cells.stiff_ax[i], cells.stiff_bx[i], cells.stiff_axb[i], cells.stiff_aa[i]),
        cells.radius[i],
    )
    for k in range(len(values)):
        least = least_ax if k == 0 else least_bx if k == 1 else 0.0
        if not least <= values[k] < math.inf:
            rules.fault[0], rules.fault[1], rules.fault[2] = part, event, cells.id[i]
            rules.fault[3], rules.fault[4], rules.fault[5] = k, values[k], least
            return


@inner
def inherit_events(state: TissueState, i: int) -> None:
    """Give daughter i, a copy of her mother, an entry of her own among the EMT cells, if the mother has one."""
    emt, k, number = state.emt, state.cells.emt[i], state.sizes[EMT_CELLS]
    if k < 0:
        return
    for event in range(emt.at.shape[0]):
        emt.at[event, number] = emt.at[event, k]
    emt.new[number] = emt.new[k]
    emt.onset_ab[number], emt.side[number] = emt.onset_ab[k], emt.side[k]
    emt.since[number], emt.since_x[number] = emt.since[k], emt.since_x[k]
    state.cells.emt[i] = number
    state.sizes[EMT_CELLS] += 1
