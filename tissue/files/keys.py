"""Facts about the keys of parameter files, from their declarations; and messages about them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from contextlib import suppress
from difflib import SequenceMatcher
from functools import reduce
from typing import Any, NamedTuple, get_args

from pydantic import BaseModel, ValidationError

from dincl.checks import describe
from dincl.errors import InvalidProblem
from tissue.events.known import OF_THESIS, events
from tissue.files import quantities as q
from tissue.files.parameter_files import TYPE, general
from tissue.files.quantities import NEVER
from tissue.files.sections import OWN_KEYS, CellType, EmtGroup, Forces, Own, Types, show
from tissue.plugins import Force, Parameter, registered

# In place of a default: the key has to be given.
NOTHING: Any = ...
# A key in the same section counts as this much nearer than one in another.
SAME_SECTION = 0.25


class KeyFacts(NamedTuple):
    """All that is known of a key of parameter files."""

    name: str  # with its section, such as "tissue.cells"
    meaning: str
    symbol: str  # "" for none
    source: str
    unit: str  # in which values are kept, or of what kind they are
    allowed: str  # what a value may be, in words
    default: Any  # as in a file, NOTHING if the key has to be given
    options: tuple[Any, ...] = ()  # all values, where these are a few

    @property
    def section(self) -> str:
        """Where it stands in a file."""
        return self.name.partition(".")[0]

    @property
    def has_default(self) -> bool:
        """Whether a file without base may leave it out."""
        return self.default is not NOTHING

    @property
    def comment(self) -> str:
        """Symbol and meaning, as behind a value in a file."""
        return f"{self.symbol}: {self.meaning}" if self.symbol else self.meaning

    @property
    def is_choice(self) -> bool:
        """Whether a few values are all that is allowed; they stand for their unit, too."""
        return bool(self.options)


def sections(shape: type[BaseModel]) -> dict[str, Any]:
    """Return the model of each section, by its name."""
    return {name: field.annotation for name, field in shape.model_fields.items()}


def heading(section: type[BaseModel]) -> str:
    """Return the heading of a section, the first line of its docstring."""
    return (section.__doc__ or "").partition("]: ")[2].partition("\n")[0]


def all_keys(shape: type[BaseModel]) -> dict[str, KeyFacts]:
    """Return the keys of all sections by name, in the order of a file."""
    return {facts.name: facts for name, section in sections(shape).items() for facts in _keys_of(name, section)}


def _keys_of(name: str, section: type[BaseModel]) -> Iterator[KeyFacts]:
    """Give the keys of a section: its fields, and those that have the names of events or forces."""
    if section is Types:
        name, section = f"types.{TYPE}", CellType
    for key, field in ((key, field) for key, field in section.model_fields.items() if key != "own"):
        own = OWN_KEYS.get(key) if section is CellType else None
        default = NOTHING if field.is_required() else f"that of {own}.{key}" if own else field.default
        about: Any = field.description, field.title or "", field.json_schema_extra
        yield _facts(f"{name}.{key}", *about[:2], about[2]["source"], default, field.annotation, *field.metadata)
    for event in events() if issubclass(section, EmtGroup) else ():
        symbol = f"T^{event.mark}" if event.name in OF_THESIS else ""
        yield _facts(f"{name}.{event.name}", event.meaning, symbol, event.source, NEVER, *get_args(q.Begin))
    where, of_all = (f"{name}.own", "that of own.") if section is CellType else (name, "")
    for one in registered(Parameter) if section in (Own, CellType) else ():
        default = f"{of_all}{one.name}" if of_all else one.default
        yield KeyFacts(f"{where}.{one.name}", one.meaning, "", one.source, one.unit or "number", one.allowed, default)
    for force in registered(Force) if section is Forces else ():
        yield _facts(f"{name}.{force.name}", force.meaning, "", force.source, 0, *get_args(q.NonNegative))


def _facts(name: str, meaning: str, symbol: str, source: str, default: Any, kind: Any, *metadata: Any) -> KeyFacts:
    """Return what is known of a key of a type."""
    about = name, meaning, symbol, source
    found = next((one for one in metadata if isinstance(one, q.Allowed)), None)
    if found is not None:
        return KeyFacts(*about, found.unit, found.words, default)
    options = get_args(kind) or (True, False)
    words = " or ".join(str(one).lower() if isinstance(one, bool) else show(one) for one in options)
    return KeyFacts(*about, words, words, default, options)


# Messages


def refuse(source: str, lines: Iterable[str]) -> InvalidProblem:
    """Make the error that lists the lines; a single line stands behind the name of the source."""
    found = list(lines)
    if len(found) == 1:
        return InvalidProblem(f"{source}: {found[0]}")
    return InvalidProblem("\n  ".join([f"{source}: {len(found)} errors", *found]))


def problems(error: ValidationError, tables: Mapping[str, Any], shape: type[BaseModel]) -> list[str]:
    """Return a line for each bad, unknown or missing key of ``tables``, or for values that do not go together."""
    found: dict[tuple[str, ...], str] = {}
    for item in error.errors(include_url=False):
        path = tuple(str(part) for part in item["loc"] if not isinstance(part, int))  # a list is one value
        found.setdefault(path, _line(path, item, tables, shape))
    own = [line for path, line in found.items() if path[:1] == ("own",)]
    return own or list(found.values())  # what is not imported is unknown, too


def _line(path: tuple[str, ...], item: Any, tables: Mapping[str, Any], shape: type[BaseModel]) -> str:
    keys, name, value = all_keys(shape), ".".join(path), item["input"]
    with suppress(KeyError, TypeError):  # as it was given, before validators
        value = reduce(lambda table, part: table[part], path, tables)
    is_missing = item["type"] == "missing" and len(path) == len(item["loc"])
    facts, reason = keys.get(general(name)), str(item.get("ctx", {}).get("error", ""))
    if facts is not None:
        meaning = f" ({facts.meaning})" if facts.is_choice or is_missing else ""
        allowed = f"{facts.allowed}{meaning}" + (f"; {reason}" if reason else "")
    else:
        inside = [key.removeprefix(f"{general(name)}.") for key in keys if key.startswith(f"{general(name)}.")]
        names = f"the keys {', '.join(inside)}" if inside else "names of registered forces"
        allowed = f"a section [{name}] with {names}"
    if is_missing:
        return f"{name} is missing: without a base it must be given, {allowed}"
    if facts is not None or item["type"] == "model_type":
        return f"{name} = {describe(value)}: must be {allowed}"
    if reason:  # of a validator of a section, or of all
        return f"{name}.{reason}".removeprefix(".")
    return unknown(name, value, [*([] if "." in name else ["base", *sections(shape)]), *keys])


def unknown(key: str, value: Any, known: Iterable[str]) -> str:
    """Return the line for a key that is unknown."""
    return f"{key} = {describe(value)}: {no_key(key, known)}"


def no_key(key: str, known: Iterable[str]) -> str:
    """Say what is wrong with a name that is no key."""
    keys = list(known)
    if key.startswith("forces.") and not any(name.startswith("forces.") for name in keys):
        return "unknown key; no force is registered, as files in own.modules do"
    nearest = _nearest(general(key), keys)
    if key.startswith("types."):
        nearest = nearest.replace(f".{TYPE}.", f".{key.split('.')[1]}.")
    return f"unknown key; the nearest known one is {nearest}"


def _nearest(key: str, known: Iterable[str]) -> str:
    """Find the known key that looks most like this one: by its name, and rather in its section."""
    section, _, name = key.lower().rpartition(".")

    def likeness(candidate: str) -> float:
        there, _, called = candidate.lower().rpartition(".")
        return SequenceMatcher(None, name, called).ratio() + SAME_SECTION * (there == section != "")

    return max(known, key=likeness)
