"""How the kernels of the tissue are compiled."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar, cast

import numba

Function = TypeVar("Function", bound=Callable[..., Any])


def kernel(function: Function) -> Function:
    """Compile once per machine (cache), free of the interpreter lock; division by zero gives inf as in NumPy.

    The kernels take dozens of arrays and allocate none, so nobody counts references to arrays (``_nrt``): counting took
    as long as computing.
    """
    options: dict[str, Any] = {"cache": True, "nogil": True, "error_model": "numpy", "_nrt": False}
    return cast("Function", numba.njit(**options)(function))
