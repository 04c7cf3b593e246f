"""What is wrong with a parameter file, in lines that name key, value and what is allowed."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from difflib import SequenceMatcher
from typing import Any

from pydantic import BaseModel, ValidationError

from dincl.checks import describe
from dincl.errors import InvalidProblem
from tissue.files.keys import all_keys, sections

# A key in the same section counts as this much nearer than one in another.
SAME_SECTION = 0.25


def known_keys(shape: type[BaseModel]) -> list[str]:
    """All keys, such as "tissue.cells"."""
    return [f"{section}.{name}" for section, fields in sections(shape).items() for name in fields.all_keys()]


def problems(error: ValidationError, shape: type[BaseModel], *, missing: bool) -> list[str]:
    """One line for each bad, unknown and, on request, missing key; none for what concerns the whole model."""
    items = (item for item in error.errors(include_url=False) if item["loc"])
    return [_line(item, shape) for item in items if missing or item["type"] != "missing"]


def unknown(key: str, value: Any, known: Iterable[str]) -> str:
    """The line for a key that is unknown."""
    return f"{key} = {describe(value)}: {no_key(key, known)}"


def no_key(key: str, known: Iterable[str]) -> str:
    """What is wrong with a name that is no key."""
    keys = list(known)
    if key.startswith("forces.") and not any(name.startswith("forces.") for name in keys):
        return "unknown key; no force is registered, as files in own.modules do"
    return f"unknown key; the nearest known one is {_nearest(key, keys)}"


def unknown_names(tables: Mapping[str, Any], shape: type[BaseModel]) -> list[str]:
    """A line for each key that is none in the sections where it may be the name of any event, or force."""
    open_ones = {name: fields for name, fields in sections(shape).items() if fields.model_config["extra"] == "allow"}
    given = {f"{section}.{key}": value for section in open_ones for key, value in _items(tables.get(section))}
    keys = known_keys(shape)
    return [unknown(key, value, keys) for key, value in given.items() if key not in keys]


def _items(table: Any) -> Iterable[tuple[str, Any]]:
    return table.items() if isinstance(table, Mapping) else ()


def refuse(source: str, lines: Iterable[str]) -> InvalidProblem:
    """The error that lists the lines; one alone stands behind the name of the source."""
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
            top = [] if "." in key else ["base", *sections(shape)]
            return unknown(key, item["input"], [*top, *known_keys(shape)])
        case "model_type":
            return f"{key} = {describe(item['input'])}: must be {_allowed(key, shape)}"
        case _:
            return f"{key} = {describe(item['input'])}: {item['ctx']['error']}{_choice(key, shape)}"


def _allowed(key: str, shape: type[BaseModel]) -> str:
    if "." not in key:
        keys = ", ".join(sections(shape)[key].all_keys())
        return f"a section [{key}] with {f'the keys {keys}' if keys else 'names of registered forces'}"
    facts = all_keys(shape)[key]
    return f"{facts.allowed} ({facts.meaning})"


def _choice(key: str, shape: type[BaseModel]) -> str:
    """What is chosen between a few values; for numbers and times the name of the key says enough."""
    facts = all_keys(shape).get(key)
    return f" ({facts.meaning})" if facts is not None and facts.is_choice else ""


def _nearest(key: str, known: Iterable[str]) -> str:
    """The known key that looks most like this one: by its name, and rather in the section given."""
    section, _, name = key.rpartition(".")

    def likeness(candidate: str) -> float:
        there, _, called = candidate.rpartition(".")
        return SequenceMatcher(None, name, called).ratio() + SAME_SECTION * (there == section != "")

    return max(known, key=likeness)
