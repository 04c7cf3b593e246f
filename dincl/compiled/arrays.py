"""The types of arrays that the kernels share."""

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Offsets = NDArray[np.int64]
Indices = NDArray[np.int32]
Flags = NDArray[np.bool_]
Axes = tuple[int, ...]


def axes_of(x: Floats) -> Axes:
    """Give d zeros for positions (n, d): numba knows the length of a tuple when compiling and unrolls loops over it."""
    return (0,) * int(x.shape[1])
