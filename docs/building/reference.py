"""The reference: a page for each package with all that its ``__init__`` exports, written for autodoc."""

from __future__ import annotations

import importlib
import inspect
from collections import defaultdict
from functools import cache
from pathlib import Path
from types import ModuleType
from typing import Any

from dincl.files import write_text

PACKAGES = ("dincl", "meanfield", "tissue", "verification")


def write(folder: Path) -> None:
    """Write the page of each package into a folder."""
    folder.mkdir(parents=True, exist_ok=True)
    for package in PACKAGES:
        write_text(folder / f"{package}.rst", page(package))


def page(package: str) -> str:
    """The text of a page, a section for each room."""
    parts = [_title(package, "="), f".. automodule:: {package}\n   :no-members:\n"]
    for room, names in public(package).items():
        if room != package:
            parts += [_title(room, "-"), f".. automodule:: {room}\n   :no-members:\n   :no-index:\n"]
        parts += [_entry(name) for name in names]
    return "\n".join(parts)


@cache
def public(package: str) -> dict[str, list[str]]:
    """The full names of what a package and the modules that it exports export, by the rooms that have them."""
    module = importlib.import_module(package)
    exported = {name: getattr(module, name) for name in module.__all__}
    rooms = defaultdict(list)
    for name, item in exported.items():
        if inspect.ismodule(item):
            rooms[item.__name__] += [f"{item.__name__}.{one}" for one in _names(item) if one not in exported]
        else:
            rooms[_room(package, item)].append(f"{package}.{name}")
    return {room: sorted(names, key=str.lower) for room, names in sorted(rooms.items()) if names}


def _entry(name: str) -> str:
    """Directives for a name; one that is another name of something is said to be that."""
    item, home = _found(name), _home(name)
    if home != name:
        return f"{name}\n   Is :py:obj:`{home}`.\n"
    kind = "exception" if _is_error(item) else "class" if inspect.isclass(item) else "function"
    return f".. auto{kind if callable(item) else 'data'}:: {name}\n"


def _home(name: str) -> str:
    """The first of the names under which an object is public: that of its own package, and of its own room."""
    item = _found(name)
    where = getattr(item, "__module__", "").split(".")
    names = [one for one in _all() if _found(one) is item]
    return max(names, key=lambda one: sum(a == b for a, b in zip(one.split("."), where, strict=False)))


@cache
def _all() -> list[str]:
    return [name for package in PACKAGES for room in public(package).values() for name in room]


@cache
def _found(name: str) -> Any:
    owner, _, last = name.rpartition(".")
    return getattr(importlib.import_module(owner), last)


def _is_error(item: object) -> bool:
    return inspect.isclass(item) and issubclass(item, Exception)


def _room(package: str, item: object) -> str:
    """The folder of a package that has an object."""
    parts = getattr(item, "__module__", package).split(".")
    return ".".join(parts[:2]) if parts[0] == package and len(parts) > 2 else package


def _names(module: ModuleType) -> list[str]:
    """What a module exports: by its list, or all that is its own."""
    own = [name for name, item in vars(module).items() if getattr(item, "__module__", "") == module.__name__]
    return list(getattr(module, "__all__", [name for name in own if not name.startswith("_")]))


def _title(text: str, line: str) -> str:
    return f"{text}\n{line * len(text)}\n"
