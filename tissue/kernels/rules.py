"""The rules that a run may exchange, called by their addresses: kernels neither know nor contain them."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from dincl.compiled import c_function, call, reader, signature, struct_type
from tissue.state.cells import Floats, Integers
from tissue.state.numbers import NUMBERS
from tissue.state.running import STATE
from tissue.state.space import TissueRules

# begin(state, i, bit, numbers) and last(state, i, rest_ax, rest_bx, numbers) of an event.
BEGIN: Any = signature(None, STATE, int, int, NUMBERS)
LAST: Any = signature(None, STATE, int, float, float, NUMBERS)
# splits(state, i, number, numbers) and place(state, i, numbers) of a rule of divisions.
SPLITS: Any = signature(int, STATE, int, float, NUMBERS)
PLACE: Any = signature(None, STATE, int, NUMBERS)
# Rules of slices and of surfaces, see ``tissue.rules``: leave(state, i, bridge), position(state, i) and
# shrink(state, numbers); SPLIT below.
LEAVE: Any = signature(int, STATE, int, int)
POSITION: Any = signature(float, STATE, int)
SHRINK: Any = signature(None, STATE, NUMBERS)


class Rules(NamedTuple):
    """Where the machine code of the rules is; 0: there is none."""

    order: Integers  # (events,): the rows of the events as they are called
    begin: Integers  # (events,): of what happens when an event begins
    last: Integers  # (events,): and in each dt from then on
    splits: int  # of the rule of divisions
    place: int
    frees_apical: int  # the bits of the events after which the apical spring holds nothing
    frees_basal: int
    users: int  # the bits of the events of users: what these leave of a cell is checked
    fault: Floats  # (6,): the first bad value, see ``tissue.model.emt.check_cell``; fault[0] is 0 without one


_EXAMPLE = Rules(np.zeros(1, np.int64), np.zeros(1, np.int64), np.zeros(1, np.int64), 0, 0, 0, 0, 0, np.zeros(6))
RULES = struct_type(_EXAMPLE)
rules_at = reader(_EXAMPLE)
# The rule split(state, splits, numbers, rules), which makes all daughters of one dt.
SPLIT: Any = signature(None, STATE, int, NUMBERS, RULES)
# substeps(flat, wide, n): all substeps of one dt for n cells in the workspace.
SUBSTEPS: Any = signature(int, int, int, int)
# Calls of these functions by their addresses, with the arguments above.
call_begin, call_last, call_splits, call_place = call(BEGIN), call(LAST), call(SPLITS), call(PLACE)
call_substeps = call(SUBSTEPS)
call_split, call_leave, call_position, call_shrink = call(SPLIT), call(LEAVE), call(POSITION), call(SHRINK)
# The rules of slices and of surfaces, for the life of the process.
_COMPILED: list[Any] = []


def compile_rules(*functions: Callable[..., Any]) -> TissueRules:
    """Compile the rules split, leave_apical, leave_basal, position and shrink, and return their addresses."""
    rules = [c_function(*pair) for pair in zip((SPLIT, LEAVE, LEAVE, POSITION, SHRINK), functions, strict=True)]
    _COMPILED.extend(rules)
    return TissueRules(*(rule.address for rule in rules))
