"""Record of a table: the versions of this package and of its libraries, the settings, the date."""

from __future__ import annotations

import datetime
import enum
import inspect
import json
from collections.abc import Callable, Mapping
from dataclasses import fields, is_dataclass
from functools import cache, partial
from hashlib import sha256
from importlib.metadata import PackageNotFoundError, version
from itertools import zip_longest
from pathlib import Path
from types import CodeType, ModuleType
from typing import Any

import numpy as np

PACKAGE = "dincl-testbed"
# Libraries whose version may change a number.
LIBRARIES = (
    *("numpy", "scipy", "numba", "pandas", "casadi", "clarabel", "cvxpy-base", "daqp", "piqp"),
    *("mpmath", "python-flint", "POT", "sympy", "z3-solver"),
)
# Longest setting that is written as it is, and longest part of one in a message [characters].
LONGEST_SETTING, LONGEST_SHOWN = 1000, 80
# Numbers, texts, tuples and arrays of a module that a setting names where a function reads them.
CONSTANTS = (bool, int, float, complex, str, bytes, tuple, np.ndarray, np.generic)


def record(settings: Mapping[str, Any]) -> dict[str, str]:
    """Return what is written into a table: "package", "libraries" (JSON), "settings" (JSON) and "date".

    Settings may be any objects (``described``); of long ones the beginning and a digest are written.
    """
    texts = {name: _short(described(value)) for name, value in settings.items()}
    return {
        "package": version_of(PACKAGE),
        "libraries": json.dumps(libraries()),
        "settings": json.dumps(texts, sort_keys=True),
        "date": datetime.datetime.now(datetime.UTC).date().isoformat(),
    }


def differences(old: Mapping[str, str], new: Mapping[str, str]) -> list[str]:
    """Write a line for each setting in which two records differ, and for the version of this package.

    Rows may stand in one table if there is none. Versions of libraries are noted only: they change the last digits.
    """
    try:
        package, before = str(old["package"]), dict(json.loads(old["settings"]))
    except (LookupError, TypeError, ValueError):
        return ["the file does not record what it was made by"]
    lines = [] if package == new["package"] else [f"{PACKAGE}: {package} -> {new['package']}"]
    after = json.loads(new["settings"])
    for name in sorted({*before, *after}):
        if name not in before:
            lines.append(f"setting {name} is new")
        elif name not in after:
            lines.append(f"setting {name} is gone")
        elif before[name] != after[name]:
            lines.append(f"setting {name}: {' -> '.join(_parting(str(before[name]), str(after[name])))}")
    return lines


def _parting(old: str, new: str) -> tuple[str, str]:
    """Return two different texts, of long ones what stands around the first place where they differ."""
    if max(len(old), len(new)) <= LONGEST_SHOWN:
        return old, new
    parting = next(k for k, (before, after) in enumerate(zip_longest(old, new)) if before != after)
    first = max(0, parting - LONGEST_SHOWN // 2)
    shown = slice(first, first + LONGEST_SHOWN)
    return f"...{old[shown]}...", f"...{new[shown]}..."


def libraries() -> dict[str, str]:
    """Return the versions of the libraries that are here."""
    found = {name: version_of(name) for name in LIBRARIES}
    return {name: one for name, one in found.items() if one}


@cache
def version_of(name: str) -> str:
    """Return the version of a distribution, "" if there is none."""
    try:
        return version(name)
    except PackageNotFoundError:
        return ""


def bound_in(function: Callable[..., Any]) -> dict[str, Any]:
    """Return what a partial, a method or a callable dataclass binds, by name."""
    bound: dict[str, Any] = {}
    while isinstance(function, partial):
        bound = {f"argument {k}": value for k, value in enumerate(function.args)} | function.keywords | bound
        function = function.func
    owner = getattr(function, "__self__", None if hasattr(function, "__qualname__") else function)
    if is_dataclass(owner):
        bound |= {field.name: getattr(owner, field.name) for field in fields(owner)}
    return bound


def described(value: Any, above: tuple[Any, ...] = ()) -> Any:
    """Convert a setting to what JSON can store, the same in each process.

    Objects are named by their class and their attributes; ``above`` are those that hold the value, so that one that
    holds itself ends.
    """
    match value:
        case enum.Enum():
            return f"{type(value).__qualname__}.{value.name}"
        case None | bool() | int() | float() | str():
            return value
        case Path():
            return str(value)
        case complex() | bytes():
            return repr(value)
        case ModuleType():
            return value.__name__
    if any(one is value for one in above):
        return "itself"
    convert = partial(described, above=(*above, value))
    match value:
        case Mapping():
            return {str(key): convert(item) for key, item in value.items()}
        case list() | tuple() | range():
            return [convert(item) for item in value]
        case set() | frozenset():
            return sorted(map(convert, value), key=repr)
        case partial():
            return [convert(part) for part in (value.func, value.args, value.keywords)]
        case CodeType():  # without its place in the file
            parts = convert((value.co_code.hex(), value.co_names, value.co_varnames, value.co_consts))
            return digest_of(json.dumps(parts).encode())
        case type():
            codes = [convert(one.__code__) for one in vars(value).values() if hasattr(one, "__code__")]
            return f"{value.__module__}.{value.__qualname__} {digest_of(' '.join(codes).encode())}"
    if is_dataclass(value):
        mine = {field.name: convert(getattr(value, field.name)) for field in fields(value)}
        return {type(value).__qualname__: mine}
    if hasattr(value, "__qualname__") and hasattr(value, "__module__"):
        return _of_function(value, convert)
    if hasattr(value, "model_dump_json"):  # models of pydantic
        return {type(value).__qualname__: value.model_dump_json()}
    if hasattr(value, "tolist"):  # arrays and numbers of NumPy
        return convert(value.tolist())
    return [convert(type(value)), convert(getattr(value, "__dict__", {}))]


def _of_function(value: Any, convert: Callable[[Any], Any]) -> Any:
    """Name a function with a digest of its compiled code, and the values that it has from around.

    These are its defaults, the variables of functions around it, the object that a method belongs to, and constants of
    its module that it reads. The code of functions that it calls is left out.
    """
    name, plain = f"{value.__module__}.{value.__qualname__}", inspect.unwrap(getattr(value, "py_func", value))
    if not hasattr(plain, "__code__"):
        return name
    around = inspect.getclosurevars(plain)
    constants = {one: what for one, what in around.globals.items() if isinstance(what, CONSTANTS)}
    owner = getattr(plain, "__self__", None)
    parts = (plain.__defaults__, plain.__kwdefaults__, around.nonlocals, owner, constants)
    return [f"{name} {convert(plain.__code__)}", *(convert(part) for part in parts if part)]


def _short(setting: Any) -> Any:
    """Replace a long setting by its beginning and a digest."""
    text = json.dumps(setting, sort_keys=True)
    return setting if len(text) <= LONGEST_SETTING else f"{text[:20]}... ({digest_of(text.encode())})"


def digest_of(data: bytes) -> str:
    """Return a short name for bytes."""
    return sha256(data).hexdigest()[:16]
