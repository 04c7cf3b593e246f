"""The machine code of the rules that a run may exchange: compiled alone, when a run first needs them."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from threading import Lock
from types import TracebackType
from typing import Any, NamedTuple

import numpy as np

from dincl.callables import UserFunction
from dincl.compiled import StructPointer, c_function, collect_errors
from dincl.status import Status
from tissue.events.division import BESIDE
from tissue.events.known import acting, bit, built_in, events
from tissue.kernels.rules import BEGIN, LAST, PLACE, RULES, SPLITS, Rules
from tissue.model.emt import BEGUN, CHECKED
from tissue.plugins import POINTS, DivisionRule, EmtEvent, Force
from tissue.runs.user_code import check_code
from tissue.state.cells import Integers
from tissue.state.running import TissueState
from tissue.step.user_forces import ENERGY, PART, PUSH, USER_FORCES, UserForces, evaluate, follow

# By function, for the life of the process; threads come one at a time.
_COMPILED: dict[Callable[..., Any], Any] = {}
_COMPILING = Lock()
# Of each function of a user, by its file and name: what messages say of it.
_KNOWN: dict[tuple[str, str], UserFunction] = {}
# The same by the address of the machine code.
_AT: dict[int, UserFunction] = {}


class _Part(NamedTuple):
    """A function that events, rules or forces may have: its name there, how it is called."""

    name: str
    signature: Any
    arguments: tuple[str, ...]


_BEGIN = _Part("begin", BEGIN, ("state", "i", "bit", "numbers"))
_LAST = _Part("last", LAST, ("state", "i", "rest_ax", "rest_bx", "numbers"))
_SPLITS = _Part("splits", SPLITS, ("state", "i", "number", "numbers"))
_PLACE = _Part("place", PLACE, ("state", "i", "numbers"))
_PUSH = _Part("push", PUSH, ("state", "on", "strength", "numbers"))
_ENERGY = _Part("energy", ENERGY, ("state", "strength", "numbers"))


def rules_pointer(states: Iterable[TissueState], division: DivisionRule = BESIDE) -> Any:
    """Return the rules of tissues that are stepped together, as a struct; of the events those that begin in one of
    them.
    """
    emt = [state.emt for state in states]
    wanted = [any(np.isfinite(one.at[k : k + 1]).any() for one in emt) for k in range(len(events()))]
    used = [event if want else None for event, want in zip(events(), wanted, strict=True)]
    (splits,), (place,) = _addresses(_SPLITS, [division]), _addresses(_PLACE, [division])
    order = np.array(acting(), np.int64)
    apical, basal = (sum(bit(event.name) for event in events() if event.frees == point) for point in POINTS)
    begin, last = _addresses(_BEGIN, used), _addresses(_LAST, used)
    users = sum(bit(event.name) for event in events()[len(built_in()) :])
    return StructPointer(Rules(order, begin, last, int(splits), int(place), apical, basal, users, np.zeros(6)), RULES)


def forces_pointer(forces: Sequence[tuple[Force, float]], states: Integers, numbers: int, scale: float) -> Any:
    """Return the forces of users with their strengths, for tissues and numbers at these addresses; ``scale`` =
    h / mu.
    """
    push = _addresses(_PUSH, [force for force, _ in forces])
    strengths = np.array([strength for _, strength in forces])
    parts = (_compiled(PART, evaluate).address, _compiled(PART, follow).address)
    return StructPointer(UserForces(push, strengths, states, numbers, scale, *parts), USER_FORCES)


def push_and_energy(force: Force) -> tuple[int, int]:
    """Return the machine code of a force, and of its energy; 0 if it has none."""
    check_code(force)
    (push,), (energy,) = _addresses(_PUSH, [force]), _addresses(_ENERGY, [force])
    return int(push), int(energy)


@contextmanager
def answered(rules: Any = None, forces: Any = None) -> Iterator[None]:
    """Raise FunctionFailed behind a call of kernels if a function of a user raised in it; its error is the cause.

    Also if an event of a user among these rules left a bad value, see ``tissue.model.emt.check_cell``. An index beyond
    an array has no traceback: the error names all functions of users among these rules and forces.
    """
    with collect_errors() as errors:
        yield
    if errors:
        found = _origin(errors[0].__traceback__) or _one_of(rules, forces)
        raise found.failed(errors[0], "raised") from errors[0]
    if rules is not None and rules.value.fault[0]:
        _refuse_value(*rules.value.fault.tolist())


def _refuse_value(part: float, event: float, cell: float, field: float, value: float, least: float) -> None:
    """Raise FunctionFailed for a value that a function of an event left."""
    function = _BEGIN if part == BEGUN else _LAST
    what = f"set cells.{CHECKED[int(field)]} of cell {cell:.0f} to {value:g}: must be finite and at least {least:g}."
    _known(function, events()[int(event)]).refuse(what)


def _origin(trace: TracebackType | None) -> UserFunction | None:
    """Return the function of a user that an error came out of, by its traceback; None if it does not tell."""
    while trace is not None:
        code = trace.tb_frame.f_code
        if (code.co_filename, code.co_name) in _KNOWN:
            return _KNOWN[code.co_filename, code.co_name]
        trace = trace.tb_next
    return None


def _one_of(rules: Any, forces: Any) -> UserFunction:
    """Return the functions of users among these rules and forces as one."""
    addresses = [] if forces is None else forces.value.push.tolist()
    if rules is not None:
        addresses += [*rules.value.begin.tolist(), *rules.value.last.tolist(), rules.value.splits, rules.value.place]
    found = [_AT[address] for address in addresses if address in _AT]
    if len(found) == 1:
        return found[0]
    names = " or ".join(one.name for one in found) or "a function of an event, a force or a rule"
    return UserFunction(names, ("...",), Status.FUNCTION_FAILED)


def _addresses(part: _Part, things: Sequence[EmtEvent | DivisionRule | Force | None]) -> Integers:
    """Return the machine code of this function of each; 0 for none."""
    found = [0 if thing is None else _address(part, thing) for thing in things]
    return np.array(found, np.int64)


def _address(part: _Part, thing: EmtEvent | DivisionRule | Force) -> int:
    function = getattr(thing, part.name)
    if function is None:
        return 0
    known = _known(part, thing)
    _KNOWN[function.__code__.co_filename, function.__code__.co_name] = known
    try:
        address = int(_compiled(part.signature, function).address)
    except MemoryError:
        raise
    except Exception as error:
        raise known.failed(error, "cannot be compiled:") from error
    if thing not in built_in() and thing is not BESIDE:
        _AT[address] = known
    return address


def _known(part: _Part, thing: EmtEvent | DivisionRule | Force) -> UserFunction:
    name = f"{type(thing).__name__} {thing.name}: {part.name}"
    return UserFunction(name, part.arguments, Status.FUNCTION_FAILED)


def _compiled(signature: Any, function: Callable[..., Any]) -> Any:
    """Compiled on first use."""
    with _COMPILING:
        if function not in _COMPILED:
            _COMPILED[function] = c_function(signature, function)
        return _COMPILED[function]
