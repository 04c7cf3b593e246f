"""From a function along the import statements to all modules that it can reach."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterable, Iterator
from importlib.machinery import EXTENSION_SUFFIXES
from importlib.util import find_spec, resolve_name
from pathlib import Path
from types import ModuleType
from typing import Any, NamedTuple

from dincl.errors import InvalidProblem
from dincl.provenance.source import Import, read_source

MAKES_NO_NUMBERS = True
# The packages of this program, wherever they are installed.
HOUSE = ("dincl", "meanfield", "tissue", "verification")
INSTALLED = {"site-packages", "dist-packages"}
STANDARD = Path(os.__file__).parent
ENDINGS = (".py", *EXTENSION_SUFFIXES)
MAIN = "__main__"
Start = Callable[..., Any] | ModuleType


class Closure(NamedTuple):
    """All modules that a start can reach, with their files, and the libraries that these import."""

    modules: dict[str, Path]
    libraries: frozenset[str]


def closure(*starts: Start) -> Closure:
    """The modules that functions or modules can reach through import statements, at any depth, also in functions.

    Followed are the packages of this program and any other module that is not installed. Of the packages on the way to
    a module, such as ``a`` in ``from a.b import c``, the own text belongs to the closure, not what it imports for
    others. ``if TYPE_CHECKING:`` is passed over. A name that is computed in ``import_module(name)`` stands for every
    module beneath that package. A module with ``MAKES_NO_NUMBERS = True`` at top level is left out.

    Raises
    ------
    InvalidProblem
        If a start is not defined in a file.
    """
    walk = _Walk()
    for start in starts:
        name = _name_of(start)
        top = name.partition(".")[0]
        if walk.is_ours(top):
            walk.follow(name, _file_of(start))
        elif top not in sys.stdlib_module_names:
            walk.libraries.add(top)
    return Closure(dict(sorted(walk.modules.items())), frozenset(walk.libraries))


class _Imported(NamedTuple):
    """The modules and libraries that a module imports."""

    modules: tuple[tuple[str, Path], ...]
    libraries: frozenset[str]


# By module, file and digest of its text: a report asks what hundreds of functions can reach.
_IMPORTED: dict[tuple[str, Path, str], _Imported] = {}


class _Walk:
    """A walk along import statements."""

    def __init__(self) -> None:
        self.modules: dict[str, Path] = {}
        self.libraries: set[str] = set()
        self._followed: set[str] = set()
        self._tops: dict[str, tuple[Path | None, list[Path]]] = {}
        self._files: dict[str, Path | None] = {}

    def is_ours(self, top: str) -> bool:
        """Whether the modules of a package are followed."""
        file, folders = self._top(top)
        places = [file] if file else folders
        return top in (*HOUSE, MAIN) or any(
            not (INSTALLED & {*path.parts} or STANDARD in path.parents) for path in places
        )

    def follow(self, name: str, path: Path) -> None:
        """Take a module, and what it imports."""
        start, todo = name, [(name, path)]
        while todo:
            name, path = todo.pop()
            if name in self._followed:
                continue
            found = read_source(path)
            if not (found.makes_numbers or name == start):
                continue
            self._followed.add(name)
            self.modules[name] = path
            self._pass(name)
            home = name if path.stem == "__init__" else name.rpartition(".")[0]
            meant = self._imported((name, path, found.digest), found.imports, home)
            todo += meant.modules
            self.libraries |= meant.libraries
            if found.dynamic:
                todo += self._beneath(home, path.parent)

    def _pass(self, name: str) -> None:
        """Take the packages on the way to a module."""
        while "." in name:
            name = name.rpartition(".")[0]
            path = self._find(name)
            if path is not None:
                self.modules.setdefault(name, path)

    def _imported(self, key: tuple[str, Path, str], imports: Iterable[Import], home: str) -> _Imported:
        """What a module with this text imports; looked for once in a process, unless some of it is not there."""
        if key not in _IMPORTED:
            modules: list[tuple[str, Path]] = []
            libraries: set[str] = set()
            missing = False
            for item in imports:
                module = resolve_name("." * item.level + item.module, home) if item.level else item.module
                top = module.partition(".")[0]
                if self.is_ours(top):
                    found = list(self._meant(item, module))
                    missing |= not found
                    modules += found
                else:
                    libraries |= {top} - sys.stdlib_module_names
            made = _Imported(tuple(modules), frozenset(libraries))
            if missing:
                return made
            _IMPORTED[key] = made
        return _IMPORTED[key]

    def _meant(self, item: Import, module: str) -> Iterator[tuple[str, Path]]:
        """The modules of this program that an import names."""
        inner = self._find(f"{module}.{item.name}") if item.name not in ("", "*") else None
        if inner is not None:
            yield f"{module}.{item.name}", inner
        outer = self._find(module)
        if outer is not None and (inner is None or item.name in read_source(outer).binds):
            yield module, outer
            if item.name == "*" and outer.stem == "__init__":
                yield from self._beneath(module, outer.parent)

    def _beneath(self, package: str, folder: Path) -> Iterator[tuple[str, Path]]:
        """All modules of a package."""
        for path in folder.rglob("*.py") if package else ():
            parts = path.relative_to(folder).with_suffix("").parts
            inner = parts[:-1] if parts[-1] == "__init__" else parts
            yield ".".join((package, *inner)), path

    def _find(self, name: str) -> Path | None:
        """The file of a module, without importing anything; it is looked for once."""
        if name not in self._files:
            self._files[name] = self._found(*name.split("."))
        return self._files[name]

    def _found(self, top: str, *rest: str) -> Path | None:
        file, folders = self._top(top)
        if not rest:
            return file
        for folder in folders:
            place = folder.joinpath(*rest)
            for path in (place / "__init__.py", *(place.with_name(place.name + ending) for ending in ENDINGS)):
                if path.is_file():
                    return path
        return None

    def _top(self, top: str) -> tuple[Path | None, list[Path]]:
        """The file of a top-level module, and the folders of its parts."""
        if top not in self._tops:
            self._tops[top] = _located(top)
        return self._tops[top]


def _located(top: str) -> tuple[Path | None, list[Path]]:
    module = sys.modules.get(top)
    if module is not None and getattr(module, "__file__", None):
        return Path(str(module.__file__)), [Path(folder) for folder in getattr(module, "__path__", ())]
    try:
        spec = find_spec(top)
    except ValueError:  # a module that was made by hand
        spec = None
    if spec is None:
        return None, []
    file = Path(spec.origin) if spec.has_location and spec.origin else None
    return file, [Path(folder) for folder in spec.submodule_search_locations or ()]


def _name_of(start: Start) -> str:
    """The module of a start by the name under which others import it."""
    name = start.__name__ if isinstance(start, ModuleType) else start.__module__ or "builtins"
    spec = getattr(sys.modules.get(name), "__spec__", None)
    return str(spec.name) if name == MAIN and spec is not None else name


def _file_of(start: Start) -> Path:
    module = start if isinstance(start, ModuleType) else sys.modules.get(start.__module__)
    file = getattr(module, "__file__", None)
    if file is None or not Path(file).exists():
        raise InvalidProblem(f"{start!r}: must be defined in a file, so that its code can be told from other code")
    return Path(file)
