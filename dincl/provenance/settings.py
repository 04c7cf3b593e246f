"""Settings as text, and the functions among them."""

from __future__ import annotations

import enum
from collections.abc import Callable, Iterator, Mapping
from dataclasses import fields, is_dataclass
from functools import partial
from pathlib import Path
from types import ModuleType
from typing import Any

from dincl.errors import InvalidProblem

MAKES_NO_NUMBERS = True
Function = Callable[..., Any]


def unwrapped(function: Function | ModuleType) -> tuple[Function | ModuleType, dict[str, Any]]:
    """The function inside a partial, a method or a callable object, and what these bind."""
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


def definitions(value: Any) -> Iterator[Function]:
    """The functions, and the classes of dataclasses, in a setting: they are code, too."""
    if isinstance(value, Mapping):
        for item in value.values():
            yield from definitions(item)
    elif isinstance(value, list | tuple | set | frozenset):
        for item in value:
            yield from definitions(item)
    elif isinstance(value, partial):
        yield from definitions((value.func, value.args, value.keywords))
    elif is_dataclass(value) and not isinstance(value, type):
        yield type(value)
        yield from definitions([getattr(value, field.name) for field in fields(value)])
    elif hasattr(value, "__qualname__"):
        yield value
    elif hasattr(value, "model_dump_json"):
        yield type(value)


def plain_setting(name: str, value: Any) -> Any:
    """A setting as JSON has it; InvalidProblem if it is of a kind whose text may differ from run to run."""
    match value:
        case enum.Enum():
            return f"{type(value).__qualname__}.{value.name}"
        case None | bool() | int() | float() | str():
            return value
        case Mapping():
            return {str(key): plain_setting(name, item) for key, item in value.items()}
        case list() | tuple() | range():
            return [plain_setting(name, item) for item in value]
        case set() | frozenset():
            return sorted((plain_setting(name, item) for item in value), key=repr)
        case partial():
            return [plain_setting(name, part) for part in (value.func, value.args, value.keywords)]
        case Path():
            return str(value)
    if is_dataclass(value) and not isinstance(value, type):
        found = {field.name: plain_setting(name, getattr(value, field.name)) for field in fields(value)}
        return {type(value).__qualname__: found}
    if hasattr(value, "__qualname__"):
        return f"{value.__module__}.{value.__qualname__}"
    if hasattr(value, "model_dump_json"):  # models of pydantic
        return {type(value).__qualname__: value.model_dump_json()}
    if hasattr(value, "tolist"):  # arrays and numbers of NumPy
        return value.tolist()
    allowed = "must be a number, text, array, dataclass, function or a container of those"
    raise InvalidProblem(f"setting {name} = {value!r}: {allowed}")
