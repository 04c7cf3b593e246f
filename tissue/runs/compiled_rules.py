"""The machine code of the rules that a run may exchange: compiled alone, when a run first needs them."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from traceback import walk_tb
from types import FunctionType
from typing import Any

import numpy as np

from dincl.callables import UserFunction
from dincl.compiled import StructPointer, collect_errors
from dincl.errors import FunctionFailed
from dincl.status import Status
from tissue.events.division import BESIDE
from tissue.events.known import BUILT_IN, acting, bit, events
from tissue.kernels.rules import BEGIN, LAST, PLACE, RULES, SPLITS, Rules, address_of
from tissue.plugins import POINTS, DivisionRule, EmtEvent, Force
from tissue.state.cells import Integers
from tissue.state.running import TissueState
from tissue.step import user_forces as forces_of

# The functions that events, rules and forces may have: how compiled code calls them, and their arguments in messages.
FUNCTIONS: dict[str, tuple[Any, tuple[str, ...]]] = {
    "begin": (BEGIN, ("state", "i", "bit", "numbers")),
    "last": (LAST, ("state", "i", "rest_ax", "rest_bx", "numbers")),
    "splits": (SPLITS, ("state", "i", "number", "numbers")),
    "place": (PLACE, ("state", "i", "numbers")),
    "push": (forces_of.PUSH, ("state", "on", "strength", "numbers")),
    "energy": (forces_of.ENERGY, ("state", "strength", "numbers")),
}
# What numba says, and what it means to a user, of which the first that is found counts.
MEANINGS = (
    (
        r"Unknown attribute '(\w+)'",
        "there is no field {0}, nor a variable or parameter of this name that is registered",
    ),
    (r"Untyped global name '(\w+)'[^<]*<class 'function'>", "{0} is plain Python: mark helpers with @tissue.inner"),
    (r"Untyped global name '(\w+)'", "{0} is neither a number nor an array nor a function marked with @tissue.inner"),
    (r"name '(\w+)' is not defined", "{0} is not defined"),
    (
        r"NRT required|Only accept returning of array",
        "an array, list or text is made: use numbers, or a tissue.Variable",
    ),
    (r"No definition for lowering Struct\(.*\)\.(\w+) = ", "{0} cannot be replaced: write to entries of arrays"),
    (r"given, but function takes (\d+)", "the function takes {0} arguments, not these"),
    (r"No implementation of function \S+ ?\S* ?(\w+)>\) found", "{0} does not take these values"),
    (r"(Cannot unify \w+ and \w+)", "a name is of two kinds, such as a number and a text: {0}"),
)
PAGE = "functions are numbers, loops, math and the arrays of the state, see docs/extend/cell.md"
# A function of a user for messages, and its file and name, by which tracebacks know it.
Known = tuple[UserFunction, tuple[str, str]]
# By the addresses of their machine code.
_USERS: dict[int, Known] = {}


def rules_pointer(states: Sequence[TissueState], division: DivisionRule = BESIDE) -> Any:
    """Return the rules of tissues that are stepped together, as a struct; of the events those that begin in one of
    them, or that these start.
    """
    timed = [
        event for k, event in enumerate(events()) if any(np.isfinite(state.emt.at[k : k + 1]).any() for state in states)
    ]
    names = {name for event in timed for name in (event.name, *event.starts)}
    used = [event if event.name in names else None for event in events()]
    (splits,), (place,) = code_of("splits", [division]), code_of("place", [division])
    order = np.array(acting(), np.int64)
    apical, basal = (sum(bit(event.name) for event in events() if event.frees == point) for point in POINTS)
    begin, last = code_of("begin", used), code_of("last", used)
    return StructPointer(Rules(order, begin, last, int(splits), int(place), apical, basal), RULES)


def forces_pointer(forces: Sequence[Force], *of_tissues: Any, in_space: bool) -> Any:
    """Return the forces of users; ``of_tissues``: strengths to ``blame`` of ``UserForces``."""
    signature: Any = forces_of.PART_IN_SPACE if in_space else forces_of.PART
    addresses = (address_of(signature, part) for part in (forces_of.evaluate_forces, forces_of.follow_forces))
    return StructPointer(forces_of.UserForces(code_of("push", forces), *of_tissues, *addresses), forces_of.USER_FORCES)


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
            how = f"cannot be compiled: {_meaning(str(error), function)}; {PAGE}."
            raise FunctionFailed(known.status, f"{known.name}({', '.join(arguments)}) {how}") from error
        if thing not in BUILT_IN and thing is not BESIDE:
            _USERS[int(code[k])] = known, (function.__code__.co_filename, function.__code__.co_name)
    return code


def _meaning(said: str, function: FunctionType) -> str:
    """Return the line of a function of a user that numba refuses, and why."""
    path = Path(function.__code__.co_filename)
    found = re.search(rf'File "[^"]*{path.name}", line (\d+)|{path.name}[ :](?:\()?(\d+)', said)
    line = next(filter(None, found.groups())) if found else function.__code__.co_firstlineno
    lines = [one for one in map(str.strip, said.splitlines()) if one and not one.startswith("Failed in nopython")]
    meanings = (text.format(*match.groups()) for known, text in MEANINGS if (match := re.search(known, said)))
    return f"{path.name}, line {line}: {next(meanings, lines[0] if lines else 'numba refuses it')}"


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
