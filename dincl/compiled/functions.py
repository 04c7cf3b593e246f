"""Functions compiled to machine code: kernels for Python, functions inlined into them, C functions for other kernels.

The machine code of kernels and C functions is cached on the disk (``dincl.compiled.cache``). At a terminal a line names
what is compiled: a first run takes half a minute longer.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any, TypeVar, cast
from zlib import crc32

import numba
from numba.core.ccallback import CFunc
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import Compiler
from numba.core.event import Listener, install_recorder, register
from numba.core.sigutils import normalize_signature

from dincl.compiled.cache import PACKAGES, set_cache

Function = TypeVar("Function", bound=Callable[..., Any])


def kernel(function: Function, *, references: bool = True) -> Function:
    """Compile on first use, free of the interpreter lock; division by zero gives inf as in NumPy.

    No fastmath and no parallel: the order of operations is part of the result. The machine code is cached on the disk,
    and compiled again when its file changes or one that it imports.

    Parameters
    ----------
    function
        At top level of a file.
    references
        Whether to count the references to arrays: not needed by a kernel that allocates none.
    """
    # Counting references makes steps of tissues and of PBD 1.3 to 1.7 times as long.
    options: dict[str, Any] = {"nogil": True, "error_model": "numpy", "_nrt": references}
    compiled: Any = numba.njit(**options)(function)
    set_cache(compiled, function)
    return cast("Function", compiled)


def c_function(described: Any, function: Callable[..., Any]) -> Any:
    """Compile a function at top level of a file for calls by its ``address``, see ``call``; cached as a kernel is.

    It must not allocate arrays. Where it raises, it returns an arbitrary number: see ``collect_errors``. A function of
    a user, outside of these packages, raises IndexError where it reads or writes beyond an array.
    """
    options: dict[str, Any] = {"error_model": "numpy", "_nrt": False, "boundscheck": _of_user(function)}
    # numba.cfunc would compile before the cache is set.
    compiled: Any = CFunc(function, normalize_signature(described), locals={}, options=options)
    set_cache(compiled, function)
    with MESSAGES.naming(function):
        compiled.compile()
    return compiled


def inner(function: Function) -> Function:
    """Compile a function inlined into kernels that allocates no arrays; called from Python, its text is run."""
    return _inlined(function, allocates=False)


def allocating(function: Function) -> Function:
    """Compile a function inlined into kernels that allocates arrays; called from Python, its text is run."""
    return _inlined(function, allocates=True)


def _of_user(function: Callable[..., Any]) -> bool:
    """Return whether a function is in none of these packages: it is always compiled with checks, or always without."""
    return (function.__module__ or "").partition(".")[0] not in PACKAGES


def _named_apart(function: Callable[..., Any]) -> None:
    """Add to the name of a function that another one made a digest of what it was made of.

    Kernels in the cache call by name what is not inlined after all, and the names that numba makes differ between
    functions that it compiled in one process only. Of two kernels that were compiled in two processes, and both call a
    function made by ``loop_of``, one would run the loop of the other.
    """
    parts = [getattr(cell.cell_contents, "__qualname__", cell.cell_contents) for cell in function.__closure__ or ()]
    if parts:
        function.__qualname__ += f"_{crc32(repr(parts).encode()):x}"


def _inlined(function: Function, *, allocates: bool) -> Function:
    _named_apart(function)
    # Wrappers for Python and for C, which nobody calls, make first runs 1.17 times as long, that of eight tissues 1.27.
    # Counting references makes steps 1.3 to 1.7 times as long.
    options: dict[str, Any] = {"no_cpython_wrapper": True, "no_cfunc_wrapper": True, "_nrt": allocates}
    options["boundscheck"] = _of_user(function)  # numba keeps this by function: callers do not pass it on
    compiled: Any = numba.njit(pipeline_class=_InlinedCompiler, error_model="numpy", **options)(function)
    # There is no machine code that Python could call: it runs the text, and finds nothing that numba has compiled.
    compiled._compile_for_args, compiled._insert = lambda *_: function, lambda *_: None
    return cast("Function", compiled)


class _InlinedCompiler(Compiler):
    """The compiler of numba, but that the code is neither optimised nor emitted before it is linked into a kernel.

    Otherwise numba does both with a function and all that it calls, at each level of calls: first runs of tissues, PBD,
    catch-up and EventDriven take 63 s instead of 43 s, 1.45 times as long; that of EventDriven 2.3 times.
    """

    def define_pipelines(self) -> Any:
        library: Any = _InlinedCode
        self.state.library = library(self.state.targetctx.codegen(), self.state.func_id.func_qualname)
        return super().define_pipelines()  # type: ignore[no-untyped-call]


class _InlinedCode(JITCodeLibrary):
    """A library of code without an entry point of its own; the kernels optimise it."""

    def get_pointer_to_function(self, name: str) -> int:
        """Return 0: this library has no entry point."""
        return 0

    @property
    def codegen(self) -> _InlinedCode:
        """The receiver of ``set_env``: nothing reads the environment of an inlined function."""
        return self

    def set_env(self, name: str, environment: Any) -> None:
        """Do nothing."""

    def _optimize_final_module(self) -> None:
        """Do nothing."""

    def _finalize_final_module(self) -> None:
        self._finalized = True


class CompilerMessages(Listener):
    """A line at a terminal for each function that is compiled, but for those that it calls."""

    def __init__(self) -> None:
        self._compiling: list[Callable[..., Any]] = []
        self._named: Callable[..., Any] | None = None

    def on_start(self, event: Any) -> None:
        """Name the function that is compiled, unless this was done."""
        self._compiling.append(event.data["dispatcher"].py_func)
        first = self._compiling[0]
        if first is not self._named and sys.stderr.isatty():
            print(
                f"Compiling {first.__module__}.{first.__qualname__}; its machine code is cached.",
                file=sys.stderr,
                flush=True,
            )
        self._named = first

    def on_end(self, event: Any) -> None:
        """Go back to the function that calls this one."""
        self._compiling.pop()

    @contextmanager
    def naming(self, function: Callable[..., Any]) -> Iterator[None]:
        """Name this function for all that is compiled in the block: numba reports what it calls, but not itself."""
        self._compiling.append(function)
        try:
            yield
        finally:
            self._compiling.pop()


MESSAGES = CompilerMessages()
register("numba:compile", MESSAGES)


@contextmanager
def compiler_events() -> Iterator[list[Any]]:
    """Make a list that is empty after the block if nothing in it was compiled or loaded from the disk.

    Numba holds a lock for either, and calls of code that is there do not take it.
    """
    with install_recorder("numba:compiler_lock") as found:
        yield found.buffer
