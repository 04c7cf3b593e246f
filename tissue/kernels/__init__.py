"""The kernels of the tissue: numba, on the arrays of ``Cells``; ``tests/twins/tissue.py`` has substeps in Python."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

from dincl import compiled as compiling

Function = TypeVar("Function", bound=Callable[..., Any])


def kernel(function: Function) -> Function:
    """Compile a kernel of the tissue; see ``dincl.compiled``.

    The kernels take dozens of arrays and allocate none, so nobody counts references to arrays: counting took as long as
    computing.
    """
    return compiling.kernel(function, references=False)
