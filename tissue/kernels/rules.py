"""The rules that a run may exchange, called by their addresses: kernels neither know nor contain them."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from llvmlite import ir
from numba import types

from dincl.compile import inner
from dincl.kernels.handles import reader
from tissue.kernels.handed import NUMBERS, kind_of_handle
from tissue.kernels.lanes import instruction
from tissue.kernels.scale import ab_position
from tissue.kernels.store import CELLS, STORE, Store
from tissue.model.cells import Emt, Integers
from tissue.model.numbers import Numbers

# begin(store, i, bit, numbers) and last(store, i, rest_ax, rest_bx, numbers) of an event.
BEGIN: Any = types.void(STORE, types.int64, types.int64, NUMBERS)
LAST: Any = types.void(STORE, types.int64, types.float64, types.float64, NUMBERS)
# splits(store, i, number, numbers) and place(store, i, numbers) of a rule of divisions.
SPLITS: Any = types.int64(STORE, types.int64, types.float64, NUMBERS)
PLACE: Any = types.void(STORE, types.int64, NUMBERS)


class Rules(NamedTuple):
    """Where the machine code of the rules is; 0: there is none."""

    order: Integers  # (events,): the rows of the events as they are called
    begin: Integers  # (events,): of what happens when an event begins
    last: Integers  # (events,): and in each dt from then on
    splits: int  # of the rule of divisions
    place: int


_EXAMPLE = Rules(np.zeros(1, np.int64), np.zeros(1, np.int64), np.zeros(1, np.int64), 0, 0)
RULES = kind_of_handle(_EXAMPLE)
rules_at = reader(_EXAMPLE)


@instruction
def call_begin(typing: Any, address: Any, store: Any, i: Any, bit: Any, numbers: Any) -> Any:
    """Call a function ``begin`` by its address."""
    return _called(BEGIN)


@instruction
def call_last(typing: Any, address: Any, store: Any, i: Any, rest_ax: Any, rest_bx: Any, numbers: Any) -> Any:
    """Call a function ``last`` by its address."""
    return _called(LAST)


@instruction
def call_splits(typing: Any, address: Any, store: Any, i: Any, number: Any, numbers: Any) -> Any:
    """Call a function ``splits`` by its address."""
    return _called(SPLITS)


@instruction
def call_place(typing: Any, address: Any, store: Any, i: Any, numbers: Any) -> Any:
    """Call a function ``place`` by its address."""
    return _called(PLACE)


def _called(signature: Any) -> Any:
    """A call of what has this signature; the address comes first."""
    silent = signature.return_type == types.void

    def generate(context: Any, builder: Any, known: Any, values: Any) -> Any:
        kinds = [context.get_value_type(kind) for kind in signature.args]
        function = ir.FunctionType(ir.VoidType() if silent else context.get_value_type(signature.return_type), kinds)
        result = builder.call(builder.inttoptr(values[0], function.as_pointer()), values[1:])
        return context.get_dummy_value() if silent else result

    return signature.return_type(types.int64, *signature.args), generate


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
        for event in rules.order:
            if (emt.new[k] >> event) & 1 and rules.begin[event] != 0:
                call_begin(rules.begin[event], store, i, 1 << event, numbers)
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
