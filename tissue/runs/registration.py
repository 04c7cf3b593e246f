"""How users add to the tissue, from modules of their own."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from types import FunctionType
from typing import Any

from dincl.checks import describe
from dincl.compiled.cache import PACKAGES, sources
from dincl.errors import InvalidProblem
from tissue.events.division import BESIDE
from tissue.events.known import BUILT_IN, events
from tissue.files.sections import Own
from tissue.plugins import DivisionRule, EmtEvent, Force, Observable, Parameter, Variable, registered, registry
from tissue.runs.tables import SUMMARY_NAMES
from tissue.state.cells import Cells
from tissue.state.numbers import Numbers

# What there may be of each kind: sets of events are bits, and pictures have a colour for each set.
MOST = 8
# Names that variables and parameters do not take.
FIELDS, NUMBERS = frozenset(dir(Cells)), frozenset((*dir(Numbers), *dir(Own), "modules"))
KINDS = (EmtEvent, Observable, DivisionRule, Force, Variable, Parameter)


def register(*things: Any) -> None:
    """Add what users make, by name; again from the same file takes its place.

    Parameters
    ----------
    things
        Each an ``EmtEvent``, ``Force``, ``Observable`` or ``DivisionRule``, whose functions stand at top level of a
        file, or a ``Variable`` or ``Parameter``, which they use. Called from that file, ``register`` is called again
        wherever the file is imported: parameters that list it, ``own.modules = ["my_module.py"]``, do so in every
        process.

    Raises
    ------
    InvalidProblem
        If one is of another kind, its name is that of something else, its functions are in no file, or there are too
        many.
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
    taken = {one.name for one in (*BUILT_IN, BESIDE) if isinstance(one, kind)}
    taken |= {Observable: SUMMARY_NAMES, Variable: FIELDS, Parameter: NUMBERS}.get(kind, frozenset())
    if thing.name in taken or (thing.name in mine and _files(mine[thing.name]) != _files(thing)):
        raise InvalidProblem(f"{kind.__name__} {thing.name}: must have another name, this one is taken")
    if isinstance(thing, EmtEvent):
        if any(thing.mark in one.mark for one in BUILT_IN):
            raise InvalidProblem(f"EmtEvent {thing.name}: must have another name, {thing.mark} is ambiguous")
        # Only for one that was there before: so none waits for itself through others.
        names = [one.name for one in events()]
        before = names[: names.index(thing.name)] if thing.name in names else names
        if thing.after is not None and thing.after not in before:
            must = f"must wait for another one of {', '.join(before)}"
            raise InvalidProblem(f"EmtEvent {thing.name}: after = {describe(thing.after)}: {must}")
        if not {*thing.starts} <= {*before}:
            must = f"must be names among {', '.join(before)}"
            raise InvalidProblem(f"EmtEvent {thing.name}: starts = {describe(thing.starts)}: {must}")
    if thing.name not in mine and len(mine) == MOST:
        raise InvalidProblem(f"{kind.__name__} {thing.name}: must be one of {MOST} at most, these are there")


def _functions(thing: Any) -> list[FunctionType]:
    return [value for value in vars(thing).values() if isinstance(value, FunctionType)]


def _files(thing: Any) -> set[str]:
    return {str(Path(function.__code__.co_filename).resolve()) for function in _functions(thing)}


def own_code() -> dict[str, str]:
    """Return a digest of each module of registered functions and of those that it imports; variables, parameters."""
    modules = {name: digest for one in _every_function() for name, digest in sources(one.__module__).items()}
    mine = {name: digest for name, digest in sorted(modules.items()) if name.partition(".")[0] not in PACKAGES}
    plain: list[Any] = [*registered(Variable), *registered(Parameter)]
    return mine | {f"{type(one).__name__} {one.name}": repr(one) for one in plain}


def _every_function() -> Iterator[FunctionType]:
    for kind in KINDS:
        for thing in registered(kind):
            yield from _functions(thing)
