"""Machine code on the disk, in a folder that a change of any code beneath a kernel changes.

Numba's own cache goes by the path of a file, and compiles a function again when its file has changed, not when a
function or a number has that it takes from another file. Here the folder of a module is named by the digest of its text
and of all that it imports, wherever they lie: clones, worktrees and installations share it.
"""

from __future__ import annotations

import ast
import fcntl
import logging
import os
import pickle
import shutil
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from functools import cache
from hashlib import sha256
from importlib.util import find_spec, resolve_name
from pathlib import Path
from types import CodeType, FunctionType, ModuleType
from typing import Any, cast

import llvmlite
import numba
import numpy as np
from llvmlite.binding import get_host_cpu_features
from numba.core.compiler import CompileResult
from numba.core.serialize import dumps

from dincl.compiled.structs import names_in

# The packages of this program, wherever they are installed.
PACKAGES = ("dincl", "meanfield", "tissue", "verification")
_INSTALLED, _STANDARD = {"site-packages", "dist-packages"}, Path(os.__file__).parent
_VERSIONS = f"{sys.version_info[:2]} {numba.__version__} {llvmlite.__version__} {np.__version__}"
UNUSED = 30 * 24 * 3600.0  # [s] after which the machine code of other code is removed
# [s]: what a function costs to compile, measured at 2.6 GHz, and from when on a user is told that he waits.
EACH, LONG = 0.12, 1.0
LOG = logging.getLogger("dincl")
# Machine code that a wheel brings, made by ``make dist`` for all processors of this name and its features; those of the
# names in FEATURES are the ones that x86-64-v3 has and older processors lack.
SHIPPED = Path(__file__).parent / "shipped"
PROCESSORS = ("x86-64-v3", "")
FEATURES = ("avx2", "bmi", "bmi2", "f16c", "fma", "lzcnt", "movbe")
_DIGEST = sha256().digest_size
# What machine code contains of a module: these, and tuples and arrays of them.
_CONSTANTS = (bool, int, float, complex, str, bytes, np.generic, type(None))


class CodeCache:
    """The machine code of one function, a file for each of its signatures; a damaged file or a full disk costs no run.

    The name of a file has the digest of the types, of the processor, and of the code of the function and those it calls
    with the numbers that they take from their modules: a module may compute them when it is loaded.
    """

    def __init__(self, function: Callable[..., Any], folder: Path) -> None:
        self.cache_path = str(folder)
        self._function = function
        self._name = f"{function.__qualname__}-{function.__code__.co_firstlineno}".replace("<locals>.", "")
        self._locked: int | None = None

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """Load the machine code for types of arguments; None if there is none: then nobody else compiles it until the
        end of the block ``compiling``.
        """
        target_context.refresh()
        name = self._file(sig, target_context.codegen().magic_tuple())
        path = Path(self.cache_path, name)
        found = _load(path, sig, target_context)
        if found is None and _runs_shipped():
            triple = target_context.codegen().magic_tuple()[0]
            shipped = SHIPPED / path.parent.name / self._file(sig, (triple, *PROCESSORS))
            found = _load(shipped, sig, target_context)
        if found is None and self._lock(path):
            found = _load(path, sig, target_context)  # another process may have compiled it meanwhile
        return found

    def save_overload(self, sig: Any, data: Any) -> None:
        """Save machine code if the disk has room."""
        if data.library.has_dynamic_globals:  # it contains addresses of this process
            return
        path = Path(self.cache_path, self._file(sig, data.codegen.magic_tuple()))
        content = dumps(data._reduce())
        part = path.with_suffix(f".{os.getpid()}")
        with suppress(OSError):
            try:
                part.write_bytes(_check(path, content) + content)
                part.replace(path)
            finally:
                part.unlink(missing_ok=True)

    def flush(self) -> None:
        """Remove the machine code of this function."""
        for path in Path(self.cache_path).glob(f"{self._name}-*.code"):
            path.unlink(missing_ok=True)

    @contextmanager
    def compiling(self) -> Iterator[None]:
        """Let others compile when this block, in which machine code is looked for and made, has ended in any way."""
        try:
            yield
        finally:
            # Taken at once: another thread that waited for the same machine code may end here meanwhile.
            locked, self._locked = self._locked, None
            if locked is not None:
                with suppress(OSError):
                    fcntl.flock(locked, fcntl.LOCK_UN)  # a process that was forked meanwhile has the file open
                os.close(locked)

    def _lock(self, path: Path) -> bool:
        """Wait until no other process compiles this; the system frees the lock of a process that ends."""
        with suppress(OSError):  # a folder that cannot be written to, or a file system without locks
            self._locked = os.open(path.with_suffix(".lock"), os.O_CREAT | os.O_RDWR)
            try:
                fcntl.flock(self._locked, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError:
                say(self._function, "Another process is compiling")
                fcntl.flock(self._locked, fcntl.LOCK_EX)
            return True
        return False

    def _file(self, sig: Any, processor: tuple[str, str, str]) -> str:
        types = getattr(sig, "args", sig)
        text = repr(([str(kind) for kind in types], processor))
        if not is_ours(self._function):  # which alone may read names that are added, and whose errors name its file
            text += repr([self._function.__code__.co_filename, [name for kind in types for name in names_in(kind)]])
        key = sha256(text.encode() + reach(self._function)[0]).hexdigest()[:24]
        return f"{self._name}-{key}.code"


@cache
def _runs_shipped() -> bool:
    """Return whether this processor runs the machine code that comes with a wheel, if any does."""
    return SHIPPED.is_dir() and all(get_host_cpu_features().get(name) for name in FEATURES)


def _check(path: Path, content: bytes) -> bytes:
    return sha256(path.name.encode() + content).digest()


def _load(path: Path, sig: Any, target_context: Any) -> Any:
    """Load machine code from a file; None if it is missing, damaged, of another function, or of other types."""
    try:
        data = path.read_bytes()
        if data[:_DIGEST] != _check(path, data[_DIGEST:]):
            return None
        rebuild: Any = CompileResult._rebuild
        found: Any = rebuild(target_context, *pickle.loads(data[_DIGEST:]))
    except Exception:  # noqa: BLE001  # unpickling what refers to code that is gone may raise any
        return None
    # Types of one name may differ.
    return found if found.signature.args == tuple(getattr(sig, "args", sig)) else None


def is_ours(function: Callable[..., Any]) -> bool:
    """Return whether a function is in one of these packages, not one of a user."""
    return (function.__module__ or "").partition(".")[0] in PACKAGES


def say(function: Callable[..., Any], doing: str) -> None:
    """Log, with the time that is left, that a function is compiled, if that takes long."""
    seconds = EACH * reach(function)[1]
    if seconds >= LONG:
        name = f"{function.__module__}.{function.__qualname__}"
        LOG.warning("%s %s, about %.0f s, once: its machine code is cached.", doing, name, seconds)


def reach(function: Callable[..., Any]) -> tuple[bytes, int]:
    """Return a digest of a function and those it calls, and how many functions these are.

    Their code tells apart functions of one name that another function makes, the constants that they take from modules
    and closures those of modules that compute them.
    """
    found, seen = sha256(), set()
    todo: list[Any] = [function]
    while todo:
        value = todo.pop()
        value = getattr(value, "py_func", value)  # of a function that numba compiles
        if isinstance(value, FunctionType) and _is_followed(value.__module__):
            if value not in seen:
                seen.add(value)
                found.update(_text(value.__code__))
                todo += [*_members(value.__globals__, _names(value.__code__)), *_cells(value)]
                todo += value.__defaults__ or ()
        elif isinstance(value, tuple):
            todo += value
        elif isinstance(value, np.ndarray):
            found.update(f"{value.dtype} {value.shape} ".encode() + value.tobytes())
        elif isinstance(value, _CONSTANTS):
            found.update(f"{type(value)} {value!r} ".encode())
    return found.digest(), len(seen)


@cache
def _text(code: CodeType) -> bytes:
    """Return the name of a function, its code, and the numbers and names in it."""
    constants = [value for value in code.co_consts if isinstance(value, _CONSTANTS)]
    return repr((code.co_qualname, code.co_names, constants)).encode() + code.co_code


@cache
def _names(code: CodeType) -> tuple[str, ...]:
    """Return the names of globals and attributes in the code of a function, and in functions that it defines."""
    inside = [_names(part) for part in code.co_consts if isinstance(part, CodeType)]
    return sum(inside, code.co_names)


def _members(space: dict[str, Any], names: tuple[str, ...]) -> Iterator[Any]:
    """List what has one of these names in a module, and in those of its modules that have one.

    Modules may import each other.
    """
    spaces = [space]
    for inside in spaces:
        for value in (inside[name] for name in names if name in inside):
            if not isinstance(value, ModuleType):
                yield value
            elif _is_followed(value.__name__) and not any(vars(value) is one for one in spaces):
                spaces.append(vars(value))


def _cells(function: FunctionType) -> Iterator[Any]:
    """List what a function takes from the function in which it was defined."""
    for cell in function.__closure__ or ():
        with suppress(ValueError):  # not set yet
            yield cell.cell_contents


def code_cache(function: Callable[..., Any]) -> CodeCache | None:
    """Return the machine code of a function on the disk; None if it is in no file or there is no home.

    The folder is in ``NUMBA_CACHE_DIR`` or ``~/.cache/dincl-testbed``. One that cannot be written to is read.
    """
    path = Path(function.__code__.co_filename)
    if path.suffix != ".py" or not path.is_file():
        return None
    with suppress(RuntimeError):  # a user without a home
        home = Path(
            cast("Any", numba.config).CACHE_DIR
            or Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "dincl-testbed"
        )
        return CodeCache(function, _folder(home, _digest(function.__module__)))
    return None


@cache
def _folder(home: Path, digest: str) -> Path:
    """Return the folder of a digest, marked as used now; a new one has others removed that were unused for a month."""
    folder = home / digest
    with suppress(OSError):  # a folder that cannot be written to
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
    if not _is_followed(name):
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
def _is_followed(module: str | None) -> bool:
    """Return whether a module is one of ours or not installed."""
    top = (module or "").partition(".")[0]
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
