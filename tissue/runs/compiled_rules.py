"""The machine code of the rules that a run may exchange: compiled alone, when a run first needs them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from traceback import walk_tb
from typing import Any

import numpy as np

from dincl.callables import UserFunction
from dincl.compiled import StructPointer, collect_errors
from dincl.status import Status
from tissue.events.division import BESIDE
from tissue.events.known import BUILT_IN, acting, bit, events
from tissue.kernels.rules import BEGIN, LAST, PLACE, RULES, SPLITS, Rules, address_of
from tissue.plugins import POINTS, DivisionRule, EmtEvent, Force
from tissue.state.cells import Floats, Integers
from tissue.state.running import TissueState
from tissue.step.user_forces import ENERGY, PART, PUSH, USER_FORCES, UserForces, evaluate_forces, follow_forces

# The functions that events, rules and forces may have: how compiled code calls them, and their arguments in messages.
FUNCTIONS: dict[str, tuple[Any, tuple[str, ...]]] = {
    "begin": (BEGIN, ("state", "i", "bit", "numbers")),
    "last": (LAST, ("state", "i", "rest_ax", "rest_bx", "numbers")),
    "splits": (SPLITS, ("state", "i", "number", "numbers")),
    "place": (PLACE, ("state", "i", "numbers")),
    "push": (PUSH, ("state", "on", "strength", "numbers")),
    "energy": (ENERGY, ("state", "strength", "numbers")),
}
# A function of a user for messages, and its file and name, by which tracebacks know it.
Known = tuple[UserFunction, tuple[str, str]]
# By the addresses of their machine code.
_USERS: dict[int, Known] = {}


def rules_pointer(states: Sequence[TissueState], division: DivisionRule = BESIDE) -> Any:
    """Return the rules of tissues that are stepped together, as a struct; of the events those that begin in one of
    them.
    """
    used = [
        event if any(np.isfinite(state.emt.at[k : k + 1]).any() for state in states) else None
        for k, event in enumerate(events())
    ]
    (splits,), (place,) = code_of("splits", [division]), code_of("place", [division])
    order = np.array(acting(), np.int64)
    apical, basal = (sum(bit(event.name) for event in events() if event.frees == point) for point in POINTS)
    begin, last = code_of("begin", used), code_of("last", used)
    return StructPointer(Rules(order, begin, last, int(splits), int(place), apical, basal), RULES)


def forces_pointer(
    forces: Sequence[Force], strengths: Floats, states: Integers, numbers: Integers, scale: Floats
) -> Any:
    """Return the forces of users with their strengths, (forces, tissues), for tissues and numbers at these addresses;
    ``scale`` = h / mu of each tissue.
    """
    push = code_of("push", forces)
    parts = (address_of(PART, evaluate_forces), address_of(PART, follow_forces))
    return StructPointer(UserForces(push, strengths, states, numbers, scale, *parts), USER_FORCES)


def code_of(part: str, things: Sequence[EmtEvent | DivisionRule | Force | None]) -> Integers:
    """Return the machine code of one of FUNCTIONS for each thing, 0 where there is none; raises FunctionFailed for what
    numba does not compile.
    """
    code, (signature, arguments) = np.zeros(len(things), np.int64), FUNCTIONS[part]
    for k, thing in enumerate(things):
        function = getattr(thing, part, None)
        if thing is None or function is None:
            continue
        known = UserFunction(f"{type(thing).__name__} {thing.name}: {part}", arguments, Status.FUNCTION_FAILED)
        try:
            code[k] = address_of(signature, function)
        except MemoryError:
            raise
        except Exception as error:
            raise known.failed(error, "cannot be compiled:") from error
        if thing not in BUILT_IN and thing is not BESIDE:
            _USERS[int(code[k])] = known, (function.__code__.co_filename, function.__code__.co_name)
    return code


def users_of(rules: Any = None, more: Sequence[int] | Integers = ()) -> list[Known]:
    """Return the functions of users among rules and ``more`` machine code."""
    code = [*map(int, more)]
    if rules is not None:
        code += [*rules.value.begin.tolist(), *rules.value.last.tolist(), rules.value.splits, rules.value.place]
    return [_USERS[address] for address in code if address in _USERS]


def together(users: Sequence[Known], error: BaseException | None = None) -> UserFunction:
    """Return functions of users as one, for a message: the one that the traceback of an error names, or all.

    An index beyond an array has no traceback.
    """
    trace = walk_tb(error.__traceback__) if error else ()
    places = {(frame.f_code.co_filename, frame.f_code.co_name) for frame, _ in trace}
    found = [one for one, place in users if place in places] or [one for one, _ in users]
    if len(found) == 1:
        return found[0]
    names = " or ".join(one.name for one in found) or "a compiled function"
    return UserFunction(names, ("...",), Status.FUNCTION_FAILED)


@contextmanager
def answered(users: Sequence[Known]) -> Iterator[None]:
    """Raise FunctionFailed behind a call of kernels if a function of a user raised in it; its error is the cause."""
    with collect_errors() as errors:
        yield
    if errors:
        raise together(users, errors[0]).failed(errors[0], "raised") from errors[0]
