"""Messages about parameter files, which name key, value and what is allowed."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from difflib import SequenceMatcher
from typing import Any

from pydantic import BaseModel, ValidationError

from dincl.checks import describe
from dincl.errors import InvalidProblem
from tissue.files.keys import all_keys, sections
from tissue.files.parameter_files import TYPE, general

# A key in the same section counts as this much nearer than one in another.
SAME_SECTION = 0.25
# Sections less alike than this are not suggested.
ALIKE = 0.5


def known_keys(shape: type[BaseModel]) -> list[str]:
    """List all keys, such as "tissue.cells"."""
    return [f"{section}.{name}" for section, fields in sections(shape).items() for name in fields.all_keys()]


def problems(error: ValidationError, shape: type[BaseModel], *, missing: bool) -> list[str]:
    """Return a line for each bad, unknown and, on request, missing key; none for what concerns the whole model."""
    items = (item for item in error.errors(include_url=False) if item["loc"])
    return [_line(item, shape) for item in items if missing or item["type"] != "missing"]


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


def known_only(tables: Mapping[str, Any], shape: type[BaseModel]) -> tuple[dict[str, Any], list[str]]:
    """Take unknown keys out of sections whose keys may name any event or force; also return a line for each."""
    keys, result = known_keys(shape), dict(tables)
    lines: list[str] = []

    def only(section: str, given: Any) -> Any:
        if not isinstance(given, Mapping):
            return given
        names = {name: f"{section}.{name}" for name in given}
        wrong = [name for name, key in names.items() if general(key) not in keys]
        lines.extend(unknown(names[name], given[name], keys) for name in wrong)
        return {name: value for name, value in given.items() if name not in wrong}

    for section, fields in sections(shape).items():
        given = tables.get(section)
        if section == "types" and isinstance(given, Mapping):
            result[section] = {name: only(f"types.{name}", one) for name, one in given.items()}
        elif fields.model_config["extra"] == "allow" and section in tables:
            result[section] = only(section, given)
    return result, lines


def refuse(source: str, lines: Iterable[str]) -> InvalidProblem:
    """Make the error that lists the lines; a single line stands behind the name of the source."""
    found = list(lines)
    if len(found) == 1:
        return InvalidProblem(f"{source}: {found[0]}")
    return InvalidProblem("\n  ".join([f"{source}: {len(found)} errors", *found]))


def _line(item: Any, shape: type[BaseModel]) -> str:
    key = ".".join(str(part) for part in item["loc"])
    match item["type"]:
        case "missing":
            return f"{key} is missing: without a base it must be given, {_allowed(key, shape)}"
        case "extra_forbidden":
            if "." not in key and isinstance(item["input"], Mapping):
                return f"{key} = {describe(item['input'])}: {_no_section(key, sections(shape))}"
            return unknown(key, item["input"], [*([] if "." in key else ["base"]), *known_keys(shape)])
        case "model_type":
            return f"{key} = {describe(item['input'])}: must be {_allowed(key, shape)}"
        case _:
            return f"{key} = {describe(item['input'])}: {item['ctx']['error']}{_choice(key, shape)}"


def _allowed(key: str, shape: type[BaseModel]) -> str:
    keys = all_keys(shape)
    if general(key) not in keys:
        own = sections(shape)[key].all_keys() if key in sections(shape) and key != "types" else ()
        table = f"{general(key)}."
        names = ", ".join(own or [name.removeprefix(table) for name in keys if name.startswith(table)])
        return f"a section [{key}] with {f'the keys {names}' if names else 'names of registered forces'}"
    facts = keys[general(key)]
    return f"{facts.allowed} ({facts.meaning})"


def _choice(key: str, shape: type[BaseModel]) -> str:
    """Return the meaning of a key with a few values; for numbers and times the name of the key says enough."""
    facts = all_keys(shape).get(general(key))
    return f" ({facts.meaning})" if facts is not None and facts.is_choice else ""


def _no_section(name: str, known: Iterable[str]) -> str:
    """Say what is wrong with the name of a table that is no section."""
    names = list(known)
    nearest = _nearest(name, names)
    if SequenceMatcher(None, name.lower(), nearest).ratio() < ALIKE:
        return f"unknown section; must be one of {', '.join(names)}"
    return f"unknown section; the nearest known one is {nearest}"


def _nearest(key: str, known: Iterable[str]) -> str:
    """Find the known key that looks most like this one in lower case: by its name, and rather in its section."""
    section, _, name = key.lower().rpartition(".")

    def likeness(candidate: str) -> float:
        there, _, called = candidate.lower().rpartition(".")
        return SequenceMatcher(None, name, called).ratio() + SAME_SECTION * (there == section != "")

    return max(known, key=likeness)
