"""Functions compiled to machine code that is kept on the disk: kernels for Python, C functions for other kernels."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar, cast

import numba
from numba.core.ccallback import CFunc
from numba.core.sigutils import normalize_signature

from dincl.compiled.announcement import ANNOUNCEMENT
from dincl.compiled.calls import signature
from dincl.compiled.folders import require_folder
from dincl.compiled.kept import KeptCode

Function = TypeVar("Function", bound=Callable[..., Any])


def kernel(function: Function, *, references: bool = True) -> Function:
    """Compile on first use, free of the interpreter lock; division by zero gives inf as in NumPy.

    No fastmath and no parallel: the order of operations is part of the result. The machine code is kept on the disk,
    where numba keeps it, and used until the code of a folder with kernels changes (``dincl.compiled.folders``) or the
    version of a library. A damaged file is replaced.

    Parameters
    ----------
    function
        At top level of a file.
    references
        Whether to count the references to arrays: not needed by a kernel that allocates none.
    """
    require_folder(function)
    # Counting references makes steps of tissues and of PBD 1.3 to 1.7 times as long.
    options: dict[str, Any] = {"nogil": True, "error_model": "numpy", "_nrt": references}
    compiled: Any = numba.njit(**options)(function)
    keep_code(compiled, function)
    return cast("Function", compiled)


def c_function(described: Any, function: Callable[..., Any]) -> Any:
    """Compile a function at top level of a file for calls by its ``address``, see ``call``; kept as a kernel is.

    It allocates no arrays. Only ``heard`` tells what it raises: it then returns an arbitrary number.
    """
    require_folder(function)
    options: dict[str, Any] = {"error_model": "numpy", "_nrt": False}
    # numba.cfunc would compile before it is told where machine code is kept.
    compiled: Any = CFunc(function, normalize_signature(described), locals={}, options=options)
    keep_code(compiled, function)
    with ANNOUNCEMENT.of(function):
        compiled.compile()
    return compiled


def keep_code(compiled: Any, function: Callable[..., Any]) -> None:
    """Keep the machine code on the disk, unless the function was typed and is in no file of Python."""
    path = Path(function.__code__.co_filename)
    if path.suffix == ".py" and path.is_file():
        compiled._cache = KeptCode(function)


def compile_reordered(function: Callable[..., Any]) -> Any:
    """Compile a generated loop, on first use; sums may be reordered, which changes their last bits only."""
    return numba.njit(nogil=True, error_model="numpy", fastmath={"reassoc", "contract", "nsz", "arcp"})(function)


def compile_now(returned: Any, *arguments: Any) -> Callable[[Function], Function]:
    """Make a decorator that compiles at once, with the operations as written, whichever loop calls the function."""
    made: Callable[[Function], Function] = numba.njit(signature(returned, *arguments), error_model="numpy")
    return made
