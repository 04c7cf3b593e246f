"""The rules that a run may exchange, called by their addresses: kernels neither know nor contain them."""

from __future__ import annotations

from collections.abc import Callable
from threading import Lock
from typing import Any, NamedTuple

import numpy as np

from dincl.compiled import c_function, call, reader, signature, struct_type
from tissue.state.cells import Integers
from tissue.state.numbers import NUMBERS
from tissue.state.running import STATE
from tissue.state.space import TissueRules

# begin(state, i, bit, numbers) and last(state, i, rest_ax, rest_bx, numbers) of an event.
BEGIN: Any = signature(None, STATE, int, int, NUMBERS)
LAST: Any = signature(None, STATE, int, float, float, NUMBERS)
# splits(state, i, number, numbers) and place(state, i, numbers) of a rule of divisions.
SPLITS: Any = signature(int, STATE, int, float, NUMBERS)
PLACE: Any = signature(None, STATE, int, NUMBERS)
# Rules of slices and of surfaces, see ``tissue.rules``: leave(state, i, bridge); SPLIT below.
LEAVE: Any = signature(int, STATE, int, int)


class Rules(NamedTuple):
    """Where the machine code of the rules is; 0: there is none."""

    order: Integers  # (events,): the rows of the events as they are called
    begin: Integers  # (events,): of what happens when an event begins
    last: Integers  # (events,): and in each dt from then on
    splits: int  # of the rule of divisions
    place: int
    frees_apical: int  # the bits of the events after which the apical spring holds nothing
    frees_basal: int


_EXAMPLE = Rules(np.zeros(1, np.int64), np.zeros(1, np.int64), np.zeros(1, np.int64), 0, 0, 0, 0)
RULES = struct_type(_EXAMPLE)
rules_at = reader(_EXAMPLE)
# The rule split(state, splits, numbers, rules), which makes all daughters of one dt.
SPLIT: Any = signature(None, STATE, int, NUMBERS, RULES)
# substeps(flat, wide, n): all substeps of one dt for n cells in the workspace.
ALL_SUBSTEPS: Any = signature(int, int, int, int)
# Calls of these functions by their addresses, with the arguments above.
call_begin, call_last, call_splits, call_place = call(BEGIN), call(LAST), call(SPLITS), call(PLACE)
call_substeps, call_split, call_leave = call(ALL_SUBSTEPS), call(SPLIT), call(LEAVE)
# Machine code by signature and function, for the life of the process; threads come one at a time.
_COMPILED: dict[Any, Any] = {}
_COMPILING = Lock()


def address_of(described: Any, function: Callable[..., Any]) -> int:
    """Return the address of the machine code of a function of this signature, compiled on first use."""
    with _COMPILING:
        key = described, function
        if key not in _COMPILED:
            _COMPILED[key] = c_function(described, function)
    address: int = _COMPILED[key].address
    return address


def compile_rules(*functions: Callable[..., Any]) -> TissueRules:
    """Compile the rules split, leave_apical and leave_basal, and return their addresses."""
    return TissueRules(*map(address_of, (SPLIT, LEAVE, LEAVE), functions))
