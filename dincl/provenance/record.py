"""The record of what a table was made by, and what differs between two records."""

from __future__ import annotations

import enum
import json
from collections.abc import Callable, Iterator, Mapping
from dataclasses import fields, is_dataclass
from functools import cache, partial
from importlib.metadata import PackageNotFoundError, packages_distributions, version
from importlib.util import find_spec
from pathlib import Path
from types import ModuleType
from typing import Any

from dincl.errors import InvalidProblem
from dincl.provenance.code import Closure, Start, closure, digest_of, read_source

MAKES_NO_NUMBERS = True
# The first line of a TOML file that holds words for readers.
WORDS_ONLY = "# MAKES_NO_NUMBERS"
# The parts of a record, and how a difference in each begins.
WORDS = {"code": "module {}", "data": "file {}", "libraries": "{}", "settings": "setting {}"}
VALUES_IN_WORDS = ("libraries", "settings")
LONGEST_SETTING = 1000
Function = Callable[..., Any]


def provenance(function: Start, /, *others: Start, **settings: Any) -> dict[str, str]:
    """Record what the results of a function, or of a module, depend on; results of equal provenance may be mixed.

    A ``functools.partial`` stands for its function, a callable dataclass for its class: the arguments of the one and
    the fields of the other are settings, unless settings are given.

    Parameters
    ----------
    function, others
        What makes the numbers; several if one finds others at run time.
    settings
        Numbers, texts, arrays, dataclasses, functions and containers of those.

    Returns
    -------
    dict[str, str]
        JSON of four mappings. "code": module -> digest of its text without docstrings and lines of comment, for all of
        ``closure``. "data": the same of the TOML files in the packages of these. "libraries": library -> version of
        those that they import, without Python. "settings": as given.

    Raises
    ------
    InvalidProblem
        If a function is not defined in a file, or a setting is nothing of the above.
    """
    plain, bound = zip(*map(_unwrapped, (function, *others)), strict=True)
    used = settings or bound[0]
    reached = closure(*plain, *_definitions([bound, settings]))
    parts: tuple[Mapping[str, Any], ...] = (
        {name: read_source(path).digest for name, path in reached.modules.items()},
        {name: digest_of(path.read_bytes()) for name, path in _data(reached.modules)},
        libraries(reached),
        {name: _short(_as_json(name, value)) for name, value in used.items()},
    )
    return {name: json.dumps(part, sort_keys=True) for name, part in zip(WORDS, parts, strict=True)}


def differences(old: Mapping[str, str], new: Mapping[str, str]) -> list[str]:
    """Write a line for each module, data file, library and setting in which two records differ."""
    if not all(part in old for part in WORDS):
        return ["the file does not record what it was made by"]
    lines: list[str] = []
    for part, words in WORDS.items():
        before, after = json.loads(old[part]), json.loads(new[part])
        for name in sorted({*before, *after}):
            if name not in before:
                lines.append(f"{words.format(name)} is new")
            elif name not in after:
                lines.append(f"{words.format(name)} is gone")
            elif before[name] != after[name]:
                change = f": {before[name]} -> {after[name]}" if part in VALUES_IN_WORDS else " has changed"
                lines.append(words.format(name) + change)
    return lines


def libraries(reached: Closure) -> dict[str, str]:
    """Return the versions of the libraries that a closure imports."""
    return {name: _version(name) for name in sorted(reached.libraries)}


@cache
def _version(library: str) -> str:
    """Return the version of the distribution that an import name belongs to."""
    try:
        return version(library)
    except PackageNotFoundError:
        names = _distributions().get(library, [])
    if names:
        return ", ".join(version(name) for name in sorted(set(names)))
    return "unknown" if find_spec(library) is not None else "not installed"


_distributions = cache(packages_distributions)


def _data(modules: Mapping[str, Path]) -> Iterator[tuple[str, Path]]:
    """List the TOML files of the packages: beside their modules, and in folders that are no packages themselves.

    A file whose first line is ``# MAKES_NO_NUMBERS`` holds words for readers, and is left out.
    """
    packages = {name: path.parent for name, path in modules.items() if path.stem == "__init__"}
    for name, folder in packages.items():
        inner = [path for path in folder.glob("*/") if path.is_dir() and not (path / "__init__.py").exists()]
        for place in (folder, *sorted(inner)):
            for path in sorted(place.glob("*.toml")):
                if path.read_text("utf-8").startswith(WORDS_ONLY):
                    continue
                yield f"{name}/{path.relative_to(folder).as_posix()}", path


def _unwrapped(function: Start) -> tuple[Start, dict[str, Any]]:
    """Return the function inside a partial, a method or a callable object, and what these bind."""
    bound: dict[str, Any] = {}
    while isinstance(function, partial):
        bound = {f"argument {k}": value for k, value in enumerate(function.args)} | function.keywords | bound
        function = function.func
    known = hasattr(function, "__qualname__") or isinstance(function, ModuleType)
    owner = getattr(function, "__self__", None if known else function)
    if is_dataclass(owner):
        bound |= {field.name: getattr(owner, field.name) for field in fields(owner)}
    elif owner is not None and not isinstance(owner, ModuleType):
        bound["self"] = owner
    return (function if known else type(function)), bound


def _definitions(value: Any) -> Iterator[Function]:
    """List the functions, and the classes of dataclasses, in a setting: they are code, too."""
    if isinstance(value, Mapping):
        value = list(value.values())
    elif isinstance(value, partial):
        value = [value.func, value.args, value.keywords]
    elif is_dataclass(value) and not isinstance(value, type):
        yield type(value)
        value = [getattr(value, field.name) for field in fields(value)]
    if isinstance(value, list | tuple | set | frozenset):
        for item in value:
            yield from _definitions(item)
    elif hasattr(value, "__qualname__"):
        yield value
    elif hasattr(value, "model_dump_json"):
        yield type(value)


def _as_json(name: str, value: Any) -> Any:
    """Convert a setting to what JSON can store; InvalidProblem if its text may differ from run to run."""
    convert = partial(_as_json, name)
    match value:
        case enum.Enum():
            return f"{type(value).__qualname__}.{value.name}"
        case None | bool() | int() | float() | str():
            return value
        case Mapping():
            return {str(key): convert(item) for key, item in value.items()}
        case list() | tuple() | range():
            return [convert(item) for item in value]
        case set() | frozenset():
            return sorted(map(convert, value), key=repr)
        case partial():
            return [convert(part) for part in (value.func, value.args, value.keywords)]
        case Path():
            return str(value)
    if is_dataclass(value) and not isinstance(value, type):
        return {type(value).__qualname__: {field.name: convert(getattr(value, field.name)) for field in fields(value)}}
    if hasattr(value, "__qualname__"):
        return f"{value.__module__}.{value.__qualname__}"
    if hasattr(value, "model_dump_json"):  # models of pydantic
        return {type(value).__qualname__: value.model_dump_json()}
    if hasattr(value, "tolist"):  # arrays and numbers of NumPy
        return value.tolist()
    allowed = "must be a number, text, array, dataclass, function or a container of those"
    raise InvalidProblem(f"setting {name} = {value!r}: {allowed}")


def _short(setting: Any) -> Any:
    """Replace a long setting by its beginning and a digest."""
    text = json.dumps(setting, sort_keys=True)
    return setting if len(text) <= LONGEST_SETTING else f"{text[:20]}... ({digest_of(text.encode())})"
