"""Parts of kernels: functions that are compiled into each kernel that calls them, and not by themselves as well."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar, cast

import numba
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import Compiler

from dincl.compiled.folders import require_folder

Function = TypeVar("Function", bound=Callable[..., Any])


def inner(function: Function) -> Function:
    """Compile a part of kernels that allocates no arrays; called from Python, its text is run."""
    return _part(function, allocates=False)


def maker(function: Function) -> Function:
    """Compile a part of kernels that allocates arrays; called from Python, its text is run."""
    return _part(function, allocates=True)


def _part(function: Function, *, allocates: bool) -> Function:
    require_folder(function)
    # Wrappers for Python and for C, which nobody calls, make first runs 1.17 times as long, that of eight tissues 1.27.
    # Counting references makes steps 1.3 to 1.7 times as long.
    options: dict[str, Any] = {"no_cpython_wrapper": True, "no_cfunc_wrapper": True, "_nrt": allocates}
    compiled: Any = numba.njit(pipeline_class=PartCompiler, error_model="numpy", **options)(function)
    # There is no machine code that Python could call: it runs the text, and finds nothing that numba has compiled.
    compiled._compile_for_args, compiled._insert = lambda *_: function, lambda *_: None
    return cast("Function", compiled)


class PartCompiler(Compiler):
    """The compiler of numba, but that the code is neither optimised nor emitted before it is linked into a kernel.

    Otherwise numba does both with a function and all that it calls, at each level of calls: first runs of tissues, PBD,
    catch-up and EventDriven take 63 s instead of 43 s, 1.45 times as long; that of EventDriven 2.3 times.
    """

    def define_pipelines(self) -> Any:
        library: Any = _Part
        self.state.library = library(self.state.targetctx.codegen(), self.state.func_id.func_qualname)
        return super().define_pipelines()  # type: ignore[no-untyped-call]


class _Part(JITCodeLibrary):
    """A library of code without an entry point of its own."""

    def get_pointer_to_function(self, name: str) -> int:
        """Return 0: this library has no entry point."""
        return 0

    @property
    def codegen(self) -> _Part:
        """The receiver of ``set_env``: nothing reads the environment of a part."""
        return self

    def set_env(self, name: str, environment: Any) -> None:
        """Do nothing."""

    def _optimize_final_module(self) -> None:
        """Leave optimisation to the kernels."""

    def _finalize_final_module(self) -> None:
        self._finalized = True
