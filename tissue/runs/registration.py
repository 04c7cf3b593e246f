"""How users add to the tissue: events, forces, observables, rules of divisions, from modules of their own."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from types import FunctionType
from typing import Any

from dincl.checks import describe
from dincl.errors import InvalidProblem
from dincl.provenance import provenance
from tissue.events.division import BESIDE
from tissue.events.known import built_in, events
from tissue.plugins import DivisionRule, EmtEvent, Force, Observable, registered, registry
from tissue.runs.tables import BUILT_IN
from tissue.runs.user_code import check_code

# What there may be of each kind: sets of events are bits, and pictures have a colour for each set.
MOST = 8
KINDS = (EmtEvent, Observable, DivisionRule, Force)


def register(*things: Any) -> None:
    """Add events, forces, observables or division rules, by name; again from the same file takes their places.

    Parameters
    ----------
    things
        Each an ``EmtEvent``, ``Force``, ``Observable`` or ``DivisionRule``, whose functions stand at top level of a
        file. Called from that file, ``register`` is called again wherever the file is imported: parameters that list
        it, ``own.modules = ["my_module.py"]``, do so in every process.

    Raises
    ------
    InvalidProblem
        If one is of another kind, its name is that of something else, its functions are in no file, name a field that
        there is not or change what is set anew before it is used, or there are too many.
    """
    for thing in things:
        if not isinstance(thing, KINDS):
            names = ", ".join(f"tissue.{kind.__name__}" for kind in KINDS)
            raise InvalidProblem(f"register({describe(thing)}): must be one of {names}")
        _check(thing)
        registry(type(thing))[thing.name] = thing


def _check(thing: Any) -> None:
    """Refuse what cannot be found again, and a name that is taken."""
    kind, mine = type(thing), registry(type(thing))
    for function in _functions(thing):
        if not Path(function.__code__.co_filename).is_file() or "<" in function.__qualname__:
            raise InvalidProblem(f"{kind.__name__} {thing.name}: {function!r} must stand at top level of a file")
    taken = {one.name for one in (*built_in(), *BUILT_IN, BESIDE) if isinstance(one, kind)}
    if thing.name in taken or (thing.name in mine and _files(mine[thing.name]) != _files(thing)):
        raise InvalidProblem(f"{kind.__name__} {thing.name}: must have another name, this one is taken")
    if isinstance(thing, EmtEvent):
        if thing.mark != thing.name.capitalize() or any(thing.mark in one.mark for one in built_in()):
            raise InvalidProblem(f"EmtEvent {thing.name}: must have another name or mark, {thing.mark} is ambiguous")
        _check_after(thing)
    check_code(thing)
    if thing.name not in mine and len(mine) == MOST:
        raise InvalidProblem(f"{kind.__name__} {thing.name}: must be one of {MOST} at most, these are there")


def _check_after(event: EmtEvent) -> None:
    """Refuse an event that waits for none that is there, or for itself through others."""
    known = {one.name: one for one in events()} | {event.name: event}
    after = event.after
    while after is not None:
        if after not in known or after == event.name:
            names = ", ".join(name for name in known if name != event.name)
            raise InvalidProblem(
                f"EmtEvent {event.name}: after = {describe(after)}: must wait for another one of {names}"
            )
        after = known[after].after


def _functions(thing: Any) -> list[FunctionType]:
    return [value for value in vars(thing).values() if isinstance(value, FunctionType)]


def _files(thing: Any) -> set[str]:
    return {str(Path(function.__code__.co_filename).resolve()) for function in _functions(thing)}


def own_code() -> dict[str, str]:
    """Return a digest of the text of each module that registered functions can reach."""
    functions = list(_every_function())
    code: dict[str, str] = json.loads(provenance(*functions)["code"]) if functions else {}
    return code


def _every_function() -> Iterator[FunctionType]:
    for kind in KINDS:
        for thing in registered(kind):
            yield from _functions(thing)
