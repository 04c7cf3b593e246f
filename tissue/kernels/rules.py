"""The rules that a run may exchange, called by their addresses: kernels neither know nor contain them."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from llvmlite import ir
from numba import types

from dincl.compiled.structs import reader
from tissue.kernels.handed import NUMBERS, kind_of_handle
from tissue.kernels.lanes import instruction
from tissue.kernels.store import STORE
from tissue.state.cells import Integers

# begin(store, i, bit, numbers) and last(store, i, rest_ax, rest_bx, numbers) of an event.
BEGIN: Any = types.void(STORE, types.int64, types.int64, NUMBERS)
LAST: Any = types.void(STORE, types.int64, types.float64, types.float64, NUMBERS)
# splits(store, i, number, numbers) and place(store, i, numbers) of a rule of divisions.
SPLITS: Any = types.int64(STORE, types.int64, types.float64, NUMBERS)
PLACE: Any = types.void(STORE, types.int64, NUMBERS)
# Rules of three dimensions: split(store, i, turn, numbers), leave(store, i) and position(store, i).
SPLIT_IN_SPACE: Any = types.void(STORE, types.int64, types.float64, NUMBERS)
LEAVE: Any = types.void(STORE, types.int64)
POSITION: Any = types.float64(STORE, types.int64)


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
    return called(BEGIN)


@instruction
def call_last(typing: Any, address: Any, store: Any, i: Any, rest_ax: Any, rest_bx: Any, numbers: Any) -> Any:
    """Call a function ``last`` by its address."""
    return called(LAST)


@instruction
def call_splits(typing: Any, address: Any, store: Any, i: Any, number: Any, numbers: Any) -> Any:
    """Call a function ``splits`` by its address."""
    return called(SPLITS)


@instruction
def call_place(typing: Any, address: Any, store: Any, i: Any, numbers: Any) -> Any:
    """Call a function ``place`` by its address."""
    return called(PLACE)


@instruction
def call_split_in_space(typing: Any, address: Any, store: Any, i: Any, turn: Any, numbers: Any) -> Any:
    """Call a function ``split`` by its address."""
    return called(SPLIT_IN_SPACE)


@instruction
def call_leave(typing: Any, address: Any, store: Any, i: Any) -> Any:
    """Call a function ``leave`` by its address."""
    return called(LEAVE)


@instruction
def call_position(typing: Any, address: Any, store: Any, i: Any) -> Any:
    """Call a function ``position`` by its address."""
    return called(POSITION)


def called(signature: Any) -> Any:
    """A call of what has this signature; the address comes first."""
    silent = signature.return_type == types.void

    def generate(context: Any, builder: Any, known: Any, values: Any) -> Any:
        kinds = [context.get_value_type(kind) for kind in signature.args]
        function = ir.FunctionType(ir.VoidType() if silent else context.get_value_type(signature.return_type), kinds)
        result = builder.call(builder.inttoptr(values[0], function.as_pointer()), values[1:])
        return context.get_dummy_value() if silent else result

    return signature.return_type(types.int64, *signature.args), generate
