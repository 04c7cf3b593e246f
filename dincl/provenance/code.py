"""The code that functions reach along import statements, and digests of its text.

A digest leaves out docstrings, lines of comment, blank lines and statements for type checkers, so that rewording
changes no digest.
"""

from __future__ import annotations

import ast
import os
import re
import sys
from collections.abc import Callable, Iterator
from functools import cache
from hashlib import sha256
from importlib.machinery import EXTENSION_SUFFIXES
from importlib.util import decode_source, find_spec, resolve_name
from pathlib import Path
from types import ModuleType
from typing import Any, NamedTuple

from dincl.errors import InvalidProblem

MAKES_NO_NUMBERS = True
# A module with this line draws or reports: no number depends on it, nor on what it imports.
END = re.compile(r"^MAKES_NO_NUMBERS = True$", re.MULTILINE)
# The packages of this program, wherever they are installed.
PACKAGES = ("dincl", "meanfield", "tissue", "verification")
INSTALLED, STANDARD = {"site-packages", "dist-packages"}, Path(os.__file__).parent
FILE_ENDINGS = (".py", *EXTENSION_SUFFIXES)
FINDERS = ("import_module", "__import__")
MAIN = "__main__"
Start = Callable[..., Any] | ModuleType


class Source(NamedTuple):
    """Digest and imports of a source file.

    ``imports``, at any depth, are (dots, module, name) for ``from module import name`` and (0, module, "") for ``import
    module``. It is ``dynamic`` if it imports modules by computed names, and ``makes_numbers`` unless it has the line
    ``MAKES_NO_NUMBERS = True``.
    """

    digest: str
    imports: frozenset[tuple[int, str, str]] = frozenset()
    dynamic: bool = False
    makes_numbers: bool = True


class Closure(NamedTuple):
    """The modules that a start reaches, with their files, and the libraries that these import."""

    modules: dict[str, Path]
    libraries: frozenset[str]


def digest_of(data: bytes) -> str:
    """Return a short name for bytes."""
    return sha256(data).hexdigest()[:16]


def read_source(path: Path) -> Source:
    """Read a source file, again only if its time or size has changed; of a compiled one, digest the bytes."""
    found = path.stat()
    return _read(path, found.st_mtime_ns, found.st_size)


@cache
def _read(path: Path, _mtime: int, _size: int) -> Source:
    data = path.read_bytes()
    return source(decode_source(data)) if path.suffix == ".py" else Source(digest_of(data))


def source(text: str) -> Source:
    """Digest a source text, and find its imports."""
    tree = ast.parse(text)
    statements = list(_statements(tree))
    imports, dynamic = set(), False
    for node in statements:
        if isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
            # ``import a.b`` also binds a, whose names can be used.
            imports |= {(0, name, "") for name in names} | {(0, name.partition(".")[0], "") for name in names}
        elif isinstance(node, ast.ImportFrom):
            imports |= {(node.level, node.module or "", alias.name) for alias in node.names}
    for node in ast.walk(tree) if any(name in text for name in FINDERS) else ():
        if isinstance(node, ast.Call) and getattr(node.func, "attr", getattr(node.func, "id", "")) in FINDERS:
            match node.args:
                case [ast.Constant(value=str(name)), *_]:
                    plain = name.lstrip(".")
                    imports.add((len(name) - len(plain), plain, ""))
                case _:
                    dynamic = True
    return Source(digest_of(_code_of(text, tree, statements)), frozenset(imports), dynamic, not END.search(text))


def _statements(node: ast.AST) -> Iterator[ast.AST]:
    """List all statements below a node that run, at any depth."""
    for part in ("body", "handlers", "cases", "orelse", "finalbody"):
        if part == "body" and _for_types(node):
            continue
        for child in getattr(node, part, ()):
            yield child
            yield from _statements(child)


def _for_types(node: ast.AST) -> bool:
    """Return whether a node is ``if TYPE_CHECKING:``."""
    return isinstance(node, ast.If) and getattr(node.test, "attr", getattr(node.test, "id", "")) == "TYPE_CHECKING"


def _code_of(text: str, tree: ast.Module, statements: list[ast.AST]) -> bytes:
    """Cut docstrings, lines of comment, blank lines and the bodies of ``if TYPE_CHECKING:`` out of a text."""
    documented = (ast.Module, ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)
    left_out: list[ast.stmt] = []
    for node in (tree, *statements):
        if isinstance(node, documented) and ast.get_docstring(node, clean=False) is not None:
            left_out.append(node.body[0])
        elif isinstance(node, ast.If) and _for_types(node):
            left_out += node.body
    lines, cut = text.encode().split(b"\n"), set[int]()
    # The last first, so that cutting one leaves the others in place.
    for node in sorted(left_out, key=lambda node: (node.lineno, node.col_offset), reverse=True):
        first, last = node.lineno - 1, (node.end_lineno or node.lineno) - 1
        before, after = lines[first][: node.col_offset], lines[last][node.end_col_offset :]
        lines[first : last + 1] = [before + after, *[b""] * (last - first)]
        cut.update(range(first, last + 1))
    rest, in_strings = b"\n".join(lines), set[int]()
    if any(mark in rest for mark in (b'"""', b"'''", b"\\\n")):
        # Lines on which a string of several lines goes on: nothing in them is a comment.
        strings = (node for node in ast.walk(tree) if isinstance(node, ast.Constant | ast.JoinedStr))
        in_strings = {k for node in strings for k in range(node.lineno, node.end_lineno or 0)} - cut
    return b"\n".join(
        line for k, line in enumerate(lines) if k in in_strings or (line.strip() and not line.lstrip().startswith(b"#"))
    )


def closure(*starts: Start) -> Closure:
    """Find the modules that functions or modules reach through import statements, at any depth, also in functions.

    Followed are the packages of this program and any other module that is not installed. ``from a import b`` reaches
    the module a.b if there is one, and a otherwise. Of the packages around a module, such as ``a``, the own text
    belongs to the closure, not what it imports for others. ``if TYPE_CHECKING:`` is passed over. A name that is
    computed in ``import_module(name)`` stands for every module beneath that package. A module with ``MAKES_NO_NUMBERS =
    True`` at top level is left out, unless it is a start.

    Raises
    ------
    InvalidProblem
        If a start is not defined in a file.
    """
    modules: dict[str, Path] = {}
    libraries: set[str] = set()
    begin = {_name_of(start): start for start in starts}
    libraries |= {top for top in (name.partition(".")[0] for name in begin) if not _is_followed(top)}
    todo = [(name, _file_of(start)) for name, start in begin.items() if _is_followed(name.partition(".")[0])]
    followed: set[str] = set()
    while todo:
        name, path = todo.pop()
        if name in followed or not (name in begin or read_source(path).makes_numbers):
            continue
        followed.add(name)
        modules[name] = path
        around = name
        while around := around.rpartition(".")[0]:
            package = _find(around)
            if package is not None:
                modules.setdefault(around, package)
        imported, others = _imported(name, path)
        todo += imported
        libraries |= others
    return Closure(dict(sorted(modules.items())), frozenset(libraries - sys.stdlib_module_names))


# By module, file and digest of its text: a report computes hundreds of closures.
_IMPORTED: dict[tuple[str, Path, str], tuple[list[tuple[str, Path]], set[str]]] = {}


def _imported(name: str, path: Path) -> tuple[list[tuple[str, Path]], set[str]]:
    """Find the modules and libraries that a module imports; once in a process, unless some of them do not exist."""
    found = read_source(path)
    key = name, path, found.digest
    if key in _IMPORTED:
        return _IMPORTED[key]
    home = name if path.stem == "__init__" else name.rpartition(".")[0]
    modules = list(_beneath(home, path.parent)) if found.dynamic else []
    libraries: set[str] = set()
    missing = False
    for level, outer, inner in found.imports:
        module = resolve_name("." * level + outer, home) if level else outer
        top = module.partition(".")[0]
        if not _is_followed(top):
            libraries.add(top)
            continue
        names = [f"{module}.{inner}"] * (inner not in ("", "*")) + [module]
        one = next(((name, file) for name in names if (file := _find(name)) is not None), None)
        if one is None:
            missing = True
            continue
        modules.append(one)
        if inner == "*" and one[1].stem == "__init__":
            modules += _beneath(module, one[1].parent)
    if not missing:
        _IMPORTED[key] = modules, libraries
    return modules, libraries


def _beneath(package: str, folder: Path) -> Iterator[tuple[str, Path]]:
    """List all modules of a package."""
    for path in folder.rglob("*.py") if package else ():
        parts = path.relative_to(folder).with_suffix("").parts
        yield ".".join((package, *(parts[:-1] if parts[-1] == "__init__" else parts))), path


def _is_followed(top: str) -> bool:
    """Return whether the imports of a top-level module are followed: unless it is installed."""
    file, folders = _located(top)
    places = [file] if file else folders
    return top in (*PACKAGES, MAIN) or any(
        not (INSTALLED & {*path.parts} or STANDARD in path.parents) for path in places
    )


def _find(name: str) -> Path | None:
    """Find the file of a module without importing anything."""
    top, *rest = name.split(".")
    file, folders = _located(top)
    if not rest:
        return file
    places = (folder.joinpath(*rest) for folder in folders)
    files = ((place / "__init__.py", *(place.with_name(place.name + end) for end in FILE_ENDINGS)) for place in places)
    return next((path for paths in files for path in paths if path.is_file()), None)


def _located(top: str) -> tuple[Path | None, list[Path]]:
    """Find the file of a top-level module, and the folders that a package extends over."""
    module = sys.modules.get(top)
    if module is not None and getattr(module, "__file__", None):
        return Path(str(module.__file__)), [Path(folder) for folder in getattr(module, "__path__", ())]
    try:
        spec = find_spec(top)
    except ValueError:  # a module without a specification, made by hand
        spec = None
    if spec is None:
        return None, []
    file = Path(spec.origin) if spec.has_location and spec.origin else None
    return file, [Path(folder) for folder in spec.submodule_search_locations or ()]


def _name_of(start: Start) -> str:
    """Return the module of a start by the name under which others import it."""
    name = start.__name__ if isinstance(start, ModuleType) else start.__module__ or "builtins"
    spec = getattr(sys.modules.get(name), "__spec__", None)
    return str(spec.name) if name == MAIN and spec is not None else name


def _file_of(start: Start) -> Path:
    module = start if isinstance(start, ModuleType) else sys.modules.get(start.__module__)
    file = getattr(module, "__file__", None)
    if file is None or not Path(file).exists():
        raise InvalidProblem(f"{start!r}: must be defined in a file, so that its code can be told from other code")
    return Path(file)
