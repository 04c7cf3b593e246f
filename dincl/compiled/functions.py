"""Functions compiled to machine code: kernels for Python, functions inlined into them, C functions for other kernels.

The machine code of kernels and C functions is cached on the disk (``dincl.compiled.cache``). A line in the log "dincl",
which goes to stderr by default, says what is compiled, and about how long that takes.
"""

from __future__ import annotations

import gc
import os
import secrets
from collections.abc import Callable, Iterator
from contextlib import contextmanager, nullcontext
from functools import cached_property
from itertools import count
from types import CodeType
from typing import Any, ClassVar, TypeVar, cast

import numba
from llvmlite.binding import Linkage
from numba.core import typed_passes, untyped_passes
from numba.core.bytecode import FunctionIdentity
from numba.core.ccallback import CFunc
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import Compiler, Flags
from numba.core.event import Listener, install_recorder, register
from numba.core.sigutils import normalize_signature
from numba.core.types import Function as BuiltIn
from numba.core.types import unliteral
from numba.core.typing.context import Context

from dincl.compiled.cache import code_cache, is_ours, say

Function = TypeVar("Function", bound=Callable[..., Any])


def _number_functions() -> None:
    """Let the numbers of functions begin anywhere.

    Numba tells functions of one name, as of closures, apart by a number that begins with one in each process. Two that
    two processes compiled and cached may have the same, and one that loads both would call one in place of the other.
    """
    cast("Any", FunctionIdentity)._unique_ids = count(secrets.randbits(60))


_number_functions()
os.register_at_fork(after_in_child=_number_functions)


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
    compiled: Any = numba.njit(pipeline_class=_Compiler, **options)(function)
    _compile_once(compiled, function)
    return cast("Function", compiled)


def c_function(described: Any, function: Callable[..., Any]) -> Any:
    """Return a function at top level of a file, compiled when its ``address`` is first asked for, see ``call``.

    Its machine code is cached as that of a kernel is.

    It must not allocate arrays. Where it raises, it returns an arbitrary number: see ``collect_errors``. A function of
    a user, outside of these packages, raises IndexError where it reads or writes beyond an array.
    """
    options: dict[str, Any] = {"error_model": "numpy", "_nrt": False, "boundscheck": not is_ours(function)}
    # numba.cfunc would compile before the cache is set.
    compiled: Any = _CFunction(
        function, normalize_signature(described), locals={}, options=options, pipeline_class=_Compiler
    )
    _compile_once(compiled, function)
    return compiled


def inner(function: Function) -> Function:
    """Compile a function inlined into kernels that allocates no arrays; called from Python, its text is run."""
    return _inlined(function, allocates=False)


def allocating(function: Function) -> Function:
    """Compile a function inlined into kernels that allocates arrays; called from Python, its text is run."""
    return _inlined(function, allocates=True)


def _compile_once(compiled: Any, function: Callable[..., Any]) -> None:
    """Cache the machine code of a function, which one process compiles, and does not look for garbage meanwhile.

    Garbage takes a sixth of the time of compiling.
    """
    code, compile_now = code_cache(function), compiled.compile
    if code is not None:
        compiled._cache = code

    def compile_once(*signature: Any) -> Any:
        collects = gc.isenabled()
        gc.disable()
        try:
            with code.compiling() if code else nullcontext():
                return compile_now(*signature)
        finally:
            if collects:
                gc.enable()

    compiled.compile = compile_once


def _inlined(function: Function, *, allocates: bool) -> Function:
    # Wrappers for Python and for C, which nobody calls, make first runs 1.17 times as long, that of eight tissues 1.27.
    # Counting references makes steps 1.3 to 1.7 times as long.
    options: dict[str, Any] = {"no_cpython_wrapper": True, "no_cfunc_wrapper": True, "_nrt": allocates}
    options["boundscheck"] = not is_ours(function)  # numba keeps this by function: callers do not pass it on
    compiled: Any = numba.njit(pipeline_class=_InlinedCompiler, error_model="numpy", **options)(function)
    # There is no machine code that Python could call: it runs the text, and finds nothing that numba has compiled.
    compiled._compile_for_args, compiled._insert = lambda *_: function, lambda *_: None
    # Numba would compile f(x, True) beside f(x, flag).
    template = compiled.get_call_template
    compiled.get_call_template = lambda arguments, named: template(
        [*map(unliteral, arguments)], {name: unliteral(kind) for name, kind in named.items()}
    )
    return cast("Function", compiled)


class _CFunction(CFunc):
    """A C function that is compiled on use: most programs need few of those that they import."""

    @cached_property
    def address(self) -> Any:
        with MESSAGES.naming(self.__wrapped__):
            self.compile()
        return super().address


class _Options(Flags):
    """The options of a compilation, compared by those that are set.

    Numba compares the values of all fifty, for each operation and each function that may stand for it: a fifth of the
    time of compiling.
    """

    def __hash__(self) -> int:
        return len(self._values)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _Options) and self._values == other._values


class _Typing(Context):
    """The typing context of numba, which it is made from; it remembers the types of its own functions and operators.

    Numba tries all that may stand for an operator at each place where it is used: a tenth of the time of compiling.
    """

    _known: ClassVar[dict[Any, Any]] = {}

    def __init__(self, shared: Context) -> None:
        self.__dict__ = shared.__dict__

    def resolve_function_type(self, func: Any, args: Any, kws: Any) -> Any:
        """Return the signature of a function for types of arguments."""
        if kws or type(func) is not BuiltIn:
            return super().resolve_function_type(func, args, kws)  # type: ignore[no-untyped-call]
        found = self._known.get((func, args))
        if found is None:
            found = super().resolve_function_type(func, args, kws)  # type: ignore[no-untyped-call]
            self._known[func, args] = found
        return found


class _Compiler(Compiler):
    """The compiler of numba, with options that are compared fast."""

    def _compile_core(self) -> Any:
        self.state.flags = _Options(self.state.flags)  # type: ignore[no-untyped-call]
        self.state.typingctx = _Typing(self.state.typingctx)
        return super()._compile_core()  # type: ignore[no-untyped-call]


# What rewrites closures, ``with``, ``literally``, ``literal_unroll``, and functions that numba is told to inline.
_RARE = (
    untyped_passes.WithLifting,
    untyped_passes.InlineClosureLikes,
    untyped_passes.MakeFunctionToJitFunction,
    untyped_passes.InlineInlinables,
    untyped_passes.FindLiterallyCalls,
    untyped_passes.LiteralUnroll,
    untyped_passes.LiteralPropagationSubPipelinePass,
    typed_passes.InlineOverloads,
)
# What fuses expressions of arrays, and releases variables: functions without new arrays have neither.
_OF_ARRAYS = (typed_passes.NopythonRewrites, typed_passes.IRLegalization)


class _InlinedCompiler(_Compiler):
    """The compiler of numba, but that the code is neither optimised nor emitted before it is linked into a kernel.

    Otherwise numba does both with a function and all that it calls, at each level of calls: first runs of tissues, PBD,
    catch-up and EventDriven take 1.45 times as long; that of EventDriven 2.3 times. Functions of these packages are
    plain, and spare passes that would find nothing, a tenth of the time.
    """

    def define_pipelines(self) -> Any:
        function, library = self.state.func_id, cast("Any", _InlinedCode)
        self.state.library = library(self.state.targetctx.codegen(), function.func_qualname)
        pipelines: Any = super().define_pipelines()  # type: ignore[no-untyped-call]
        if is_ours(function.func) and not any(isinstance(part, CodeType) for part in function.code.co_consts):
            spared = _RARE if self.state.flags.nrt else (*_RARE, *_OF_ARRAYS)
            for one in pipelines:
                one.passes = [step for step in one.passes if step[0] not in spared]
        return pipelines


class _InlinedCode(JITCodeLibrary):
    """A library of code without an entry point of its own; the kernels optimise it.

    It is linked with all that it calls when a kernel asks for it, not with each function that calls it.
    """

    def get_pointer_to_function(self, name: str) -> int:
        """Return 0: this library has no entry point."""
        return 0

    @property
    def codegen(self) -> _InlinedCode:
        """The receiver of ``set_env``: nothing reads the environment of an inlined function."""
        return self

    def set_env(self, name: str, environment: Any) -> None:
        """Do nothing."""

    def finalize(self) -> None:
        """Let the functions be linked into others, as often as they are called."""
        for function in self._final_module.functions:
            if not function.is_declaration and function.linkage == Linkage.external:
                function.linkage = "linkonce_odr"
        self._finalized = True

    def _get_module_for_linking(self) -> Any:
        """Link this code with all that it calls: callers first, since LLVM drops what nobody has called so far."""
        if self._shared_module is None:
            called: list[Any] = []
            _list_called(self, called)
            for library in reversed(called[:-1]):
                inside = isinstance(library, _InlinedCode)
                self._final_module.link_in(
                    library._final_module if inside else library._get_module_for_linking(), preserve=True
                )
            self._shared_module = self._final_module
        return self._shared_module


def _list_called(library: Any, found: list[Any]) -> None:
    """List the code that this one calls, and then itself, if it is not listed."""
    for called in library._linking_libraries if isinstance(library, _InlinedCode) else ():
        if called not in found:
            _list_called(called, found)
    found.append(library)


class CompilerMessages(Listener):
    """A line in the log for each function that is compiled, but for those that it calls."""

    def __init__(self) -> None:
        self._compiling: list[Callable[..., Any]] = []
        self._named: Callable[..., Any] | None = None

    def on_start(self, event: Any) -> None:
        """Name the function that is compiled, unless this was done."""
        self._compiling.append(event.data["dispatcher"].py_func)
        first = self._compiling[0]
        if first is not self._named:
            say(first, "Compiling")
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
