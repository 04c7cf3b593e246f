"""How every kernel is compiled, and the array types they share."""

from collections.abc import Callable
from typing import Any, TypeVar, cast

import numba
import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Offsets = NDArray[np.int64]
Indices = NDArray[np.int32]
Axes = tuple[int, ...]
Function = TypeVar("Function", bound=Callable[..., Any])


def kernel(function: Function) -> Function:
    """Compile once per machine (cache), free of the interpreter lock; division by zero gives inf as in NumPy.

    No fastmath and no parallel: the order of operations is part of the result.
    """
    return cast("Function", numba.njit(cache=True, nogil=True, error_model="numpy")(function))


def axes_of(x: Floats) -> Axes:
    """Give d zeros for positions (n, d): numba knows the length of a tuple when compiling and unrolls loops over it."""
    return (0,) * int(x.shape[1])
