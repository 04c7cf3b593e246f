"""How loops are compiled to machine code, and when anew: if the code that they can reach has changed, and only then."""

from __future__ import annotations

import inspect
import json
import sys
import textwrap
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from threading import RLock, local
from typing import Any, TypeVar, cast

import numba
from numba import types
from numba.core.caching import CacheImpl, _CacheLocator
from numba.core.ccallback import CFunc
from numba.core.sigutils import normalize_signature

from dincl.compiled.announcement import ANNOUNCEMENT
from dincl.compiled.cache import checked
from dincl.compiled.parts import PartCompiler
from dincl.provenance import closure, libraries
from dincl.provenance.source import digest_of, read_source, source

Function = TypeVar("Function", bound=Callable[..., Any])
# Of each file, what it was when it was first looked at: the functions that are compiled in this process.
_DIGESTS: dict[Path, str] = {}
# By module.
_STAMPS: dict[str, str] = {}
_DECLARING = RLock()
# What each thread hears of its compiled code; and the hook that was there before any thread listened, once for each.
_HEARD, _LISTENING = local(), RLock()
_HOOKS: list[Callable[[Any], object]] = []


def kernel(function: Function, *, references: bool = True) -> Function:
    """Compile on first use, free of the interpreter lock; division by zero gives inf as in NumPy.

    No fastmath and no parallel: the order of operations is part of the result. The machine code is kept on the disk,
    where numba keeps it. It is used again as long as no module of ``closure(function)`` says something else, and the
    libraries have the same versions; a docstring or a remark is nothing to it. A damaged file is made again.

    Parameters
    ----------
    function
        At top level of a file.
    references
        Whether to count the references to arrays: not needed by a kernel that makes none.
    """
    options: dict[str, Any] = {"cache": True, "nogil": True, "error_model": "numpy", "_nrt": references}
    with _by_closure():
        compiled: Any = numba.njit(**options)(function)
    checked(compiled._cache)
    return cast("Function", _once(compiled))


def inner(function: Function) -> Function:
    """Compile a part of kernels that makes no arrays; called from Python, its text is run."""
    return _part(function, references=False)


def maker(function: Function) -> Function:
    """Compile a part of kernels that makes arrays; called from Python, its text is run."""
    return _part(function, references=True)


def _part(function: Function, *, references: bool) -> Function:
    options: dict[str, Any] = {"no_cpython_wrapper": True, "no_cfunc_wrapper": True, "_nrt": references}
    compiled: Any = _once(numba.njit(pipeline_class=PartCompiler, error_model="numpy", **options)(function))
    # There is no machine code that Python could call: it runs the text, and finds nothing that numba has compiled.
    compiled._compile_for_args, compiled._insert = lambda *_: function, lambda *_: None
    return cast("Function", compiled)


def c_function(signature: Any, function: Callable[..., Any]) -> Any:
    """Compile a function at top level of a file that is called by its ``address``; kept on the disk as a kernel is.

    It makes no arrays. What it raises goes no farther than to ``heard``: by then it has returned any number.
    """
    options: dict[str, Any] = {"error_model": "numpy", "_nrt": False}
    compiled: Any = CFunc(function, normalize_signature(signature), locals={}, options=options)
    with _by_closure():
        compiled.enable_caching()
    checked(compiled._cache)
    with ANNOUNCEMENT.of(function):
        compiled.compile()
    return compiled


@contextmanager
def heard() -> Iterator[list[BaseException]]:
    """The first error that functions of ``c_function`` raise meanwhile in this thread; the list is empty without one.

    Numba hands it to ``sys.unraisablehook``, which prints it.
    """
    errors: list[BaseException] = []
    before, _HEARD.errors = getattr(_HEARD, "errors", None), errors
    with _LISTENING:
        _HOOKS.append(sys.unraisablehook)
        sys.unraisablehook = _hear
    try:
        yield errors
    finally:
        _HEARD.errors = before
        with _LISTENING:
            earliest = _HOOKS[0]
            _HOOKS.pop()
            if not _HOOKS:
                sys.unraisablehook = earliest


def _hear(raised: Any) -> None:
    """Keep what compiled code of a thread that listens has raised; anything else is not for us."""
    errors = getattr(_HEARD, "errors", None)
    if errors is None or not str(raised.object).startswith("<numba."):
        (_HOOKS[0] if _HOOKS else sys.__unraisablehook__)(raised)
    elif not errors:
        errors.append(raised.exc_value)


def _once(compiled: Any) -> Any:
    """Compile it but once if kernels call it with constants: numba has a type for each of them."""
    template = compiled.get_call_template

    def general(arguments: Any, names: Any) -> Any:
        named = {name: types.unliteral(kind) for name, kind in names.items()}
        return template(tuple(map(types.unliteral, arguments)), named)

    compiled.get_call_template = general
    return compiled


@contextmanager
def _by_closure() -> Iterator[None]:
    """What is declared meanwhile is kept under its closure; threads come one at a time."""
    config: Any = numba.config
    with _DECLARING:
        before = config.CACHE_LOCATOR_CLASSES
        config.CACHE_LOCATOR_CLASSES = f"{__name__}.{ByClosure.__name__}"
        try:
            yield
        finally:
            config.CACHE_LOCATOR_CLASSES = before


class ByClosure(_CacheLocator):
    """Machine code in the folder of numba, under the closure of the function in place of the text of its file."""

    def __init__(self, function: Callable[..., Any], place: Any) -> None:
        self._function, self._place = function, place
        self._py_file = place._py_file

    @classmethod
    def from_function(cls, py_func: Callable[..., Any], py_file: str) -> ByClosure | None:
        """Take the first place that numba would."""
        classes: list[Any] = CacheImpl._locator_classes
        found = (standard.from_function(py_func, py_file) for standard in classes)
        return next((cls(py_func, place) for place in found if place is not None), None)

    def get_cache_path(self) -> str:
        """The folder."""
        return str(self._place.get_cache_path())

    def get_source_stamp(self) -> str:
        """What the machine code is made of."""
        return _stamp(self._function.__module__, self._function)

    def get_disambiguator(self) -> str:
        """Tell functions of one name in one file apart by their text: lines shift with every remark.

        And by what they reach: numba cannot read what was kept for types that have another name by now.
        """
        text = textwrap.dedent(inspect.getsource(self._function))
        return digest_of((source(text).digest + self.get_source_stamp()).encode())


def _stamp(module: str, function: Callable[..., Any]) -> str:
    """The code that the functions of a module can reach, and the versions of the libraries."""
    if module not in _STAMPS:
        reached = closure(function)
        code = {name: _DIGESTS.setdefault(path, read_source(path).digest) for name, path in reached.modules.items()}
        _STAMPS[module] = json.dumps([code, libraries(reached)])
    return _STAMPS[module]
