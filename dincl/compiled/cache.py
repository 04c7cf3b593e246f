"""Numba's own cache of machine code, in a folder that a change of any code beneath a kernel changes.

Numba compiles a function again when its file has changed, not when a function or a number has that it takes from
another file. So the folder of a module is named by the digest of its text and of all that it imports.
"""

from __future__ import annotations

import ast
import os
import shutil
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import suppress
from functools import cache
from hashlib import sha256
from importlib.util import find_spec, resolve_name
from pathlib import Path
from threading import Lock
from typing import Any, cast

import llvmlite
import numba
import numpy as np
from numba.core.caching import FunctionCache

# The packages of this program, wherever they are installed.
PACKAGES = ("dincl", "meanfield", "tissue", "verification")
_INSTALLED, _STANDARD = {"site-packages", "dist-packages"}, Path(os.__file__).parent
_VERSIONS = f"{numba.__version__} {llvmlite.__version__} {np.__version__}"
UNUSED = 30 * 24 * 3600.0  # [s] after which the machine code of other code is removed
# Numba has one folder for all functions of a process; ours is set while it looks up that of one function.
_FOLDER, _CONFIG = Lock(), cast("Any", numba.config)


class CodeCache(FunctionCache):
    """Numba's cache, but a full disk or a damaged file costs another compilation and no run."""

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """Load the machine code for types of arguments; None if there is none, or no such."""
        try:
            found: Any = super().load_overload(sig, target_context)  # type: ignore[no-untyped-call]
        except Exception:  # noqa: BLE001  # unpickling an incomplete file may raise any
            with suppress(OSError):
                self.flush()  # type: ignore[no-untyped-call]
            return None
        # Two processes may give one name to the files of different types, of which the second replaces the first.
        return found if found is None or found.signature.args == tuple(getattr(sig, "args", sig)) else None

    def save_overload(self, sig: Any, data: Any) -> None:
        """Save machine code if the disk has room."""
        with suppress(OSError):
            super().save_overload(sig, data)  # type: ignore[no-untyped-call]


def set_cache(compiled: Any, function: Callable[..., Any]) -> None:
    """Cache the machine code of a function, unless it is in no file or no folder can be written to.

    The folder is in ``NUMBA_CACHE_DIR`` or ``~/.cache/dincl-testbed``.
    """
    path = Path(function.__code__.co_filename)
    if path.suffix != ".py" or not path.is_file():
        return
    with _FOLDER, suppress(OSError, RuntimeError):  # RuntimeError if a user has no home
        before = _CONFIG.CACHE_DIR
        home = Path(before or Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "dincl-testbed")
        _CONFIG.CACHE_DIR = str(_folder(home, _digest(function.__module__)))
        try:
            compiled._cache = CodeCache(function)  # type: ignore[no-untyped-call]
        finally:
            _CONFIG.CACHE_DIR = before


@cache
def _folder(home: Path, digest: str) -> Path:
    """Return the folder of a digest, marked as used now; a new one has others removed that were unused for a month."""
    folder = home / digest
    if not folder.exists():
        folder.mkdir(parents=True, exist_ok=True)
        for other in home.iterdir():
            with suppress(OSError):  # another process may remove it, too
                if time.time() - other.stat().st_mtime > UNUSED:
                    shutil.rmtree(other)
    os.utime(folder)
    return folder


def _digest(module: str) -> str:
    digests = [f"{name} {digest}" for name, digest in sources(module).items()]
    return sha256("\n".join([_VERSIONS, *digests]).encode()).hexdigest()[:16]


def sources(module: str) -> dict[str, str]:
    """Return a digest of the file of a module, and of each that it imports when it is loaded, at any depth, by name.

    Modules that are installed, other than these packages, are left out.
    """
    found: dict[str, str] = {}
    todo = [module]
    while todo:
        name = todo.pop()
        path = _file(name)
        if path is not None and name not in found:
            found[name], imports = _read(name, path, path.stat().st_mtime_ns)
            todo += imports
    return dict(sorted(found.items()))


@cache
def _read(name: str, path: Path, _changed: int) -> tuple[str, list[str]]:
    """Return the digest of a file, and the modules that it imports."""
    data = path.read_bytes()
    home = name if path.stem == "__init__" else name.rpartition(".")[0]
    imports = []
    for node in _imports(ast.parse(data)):
        if isinstance(node, ast.Import):
            imports += [alias.name for alias in node.names]
        else:
            outer = resolve_name("." * node.level + (node.module or ""), home) if node.level else str(node.module)
            inner = [f"{outer}.{alias.name}" for alias in node.names]
            imports += [name if _file(name) else outer for name in inner]
    return sha256(data).hexdigest()[:16], imports


def _imports(node: ast.AST) -> Iterator[ast.Import | ast.ImportFrom]:
    """List the imports that run when a module is loaded."""
    for child in ast.iter_child_nodes(node):
        for_types = isinstance(child, ast.If) and "TYPE_CHECKING" in ast.dump(child.test)
        if isinstance(child, ast.Import | ast.ImportFrom):
            yield child
        elif not (for_types or isinstance(child, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef)):
            yield from _imports(child)


def _file(name: str) -> Path | None:
    """Find the source file of a module that is one of ours or not installed; of a loaded one that it is loaded from."""
    if not _is_followed(name.partition(".")[0]):
        return None
    loaded = sys.modules.get(name)
    return _source(getattr(loaded, "__file__", None) if loaded else _origin(name))


@cache
def _origin(name: str) -> str | None:
    try:
        spec = find_spec(name)
    except (ImportError, ValueError):  # the name is no module
        return None
    return spec.origin if spec else None


@cache
def _source(file: str | None) -> Path | None:
    path = Path(file or "")
    return path if path.suffix == ".py" and path.is_file() else None


@cache
def _is_followed(top: str) -> bool:
    """Return whether a top-level module is one of ours or not installed."""
    if top in (*PACKAGES, "__main__"):
        return True
    try:
        spec = find_spec(top)
    except (ImportError, ValueError):  # a module without a specification, made by hand
        return top in sys.modules
    places = [] if spec is None else [Path(place) for place in spec.submodule_search_locations or [spec.origin or ""]]
    return any(
        place.is_absolute() and not (_INSTALLED & {*place.parts} or _STANDARD in place.parents) for place in places
    )
