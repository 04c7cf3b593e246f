"""Parts of kernels: functions that are compiled into each kernel that calls them, and not by themselves as well."""

from __future__ import annotations

from typing import Any

from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import Compiler


class PartCompiler(Compiler):
    """The compiler of numba, but that the code is neither optimised nor emitted before it is linked into a kernel.

    Otherwise numba does both with a function and all that it calls, at each level of calls. Without, all kernels of
    dincl take two thirds of the time, and their parts may be small.
    """

    def define_pipelines(self) -> Any:
        library: Any = _Part
        self.state.library = library(self.state.targetctx.codegen(), self.state.func_id.func_qualname)
        return super().define_pipelines()  # type: ignore[no-untyped-call]


class _Part(JITCodeLibrary):
    """Code that is nowhere by itself."""

    def get_pointer_to_function(self, name: str) -> int:
        """Zero, which stands for none."""
        return 0

    @property
    def codegen(self) -> _Part:
        """What is told the environment of the function: that of a part is never asked for."""
        return self

    def set_env(self, name: str, environment: Any) -> None:
        """Nothing."""

    def _optimize_final_module(self) -> None:
        """Left to the kernels."""

    def _finalize_final_module(self) -> None:
        self._finalized = True
