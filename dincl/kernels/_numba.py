"""How every kernel is compiled, and the array types they share."""

from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
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


def forget_stale(folder: Path, *beside: Path) -> None:
    """Remove the cached kernels of a folder that are older than any source in it, or than the files ``beside`` it.

    The cache of numba looks at the file of a kernel only, not at those of the kernels it calls: after a change there it
    would go on with the old code.
    """
    newest = max(source.stat().st_mtime for source in (*folder.glob("*.py"), *beside))
    for index in folder.glob("__pycache__/*.nbi"):
        with suppress(OSError):  # another process was faster, or the folder is read-only
            if index.stat().st_mtime < newest:
                index.unlink()


forget_stale(Path(__file__).parent)
