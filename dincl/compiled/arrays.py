"""The types of arrays that the kernels share, and empty structs of them."""

from typing import Annotated, Any, get_args, get_origin, get_type_hints

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Table = Annotated[NDArray[np.float64], 2]  # of two axes
Offsets = NDArray[np.int64]
Indices = NDArray[np.int32]
Flags = NDArray[np.bool_]
Axes = tuple[int, ...]


def empty(kind: Any) -> Any:
    """Make the named tuple of this class with empty arrays and zeros, of the types that its annotations name.

    An annotation has its axes, or the type of its entries, as ``Annotated[NDArray[...], axes or dtype]``.
    """
    found: dict[str, Any] = {}
    for name, hint in get_type_hints(kind, include_extras=True).items():
        annotated, more = get_args(hint) if get_origin(hint) is Annotated else (hint, 1)
        if annotated in (int, float):
            found[name] = annotated()
        elif hasattr(annotated, "_fields"):
            found[name] = empty(annotated)
        elif isinstance(more, np.dtype):
            found[name] = np.zeros(0, more)
        else:
            found[name] = np.zeros((0,) * more, entry_type(annotated))
    return kind(**found)


def entry_type(array: Any) -> Any:
    """Return the type of the entries of ``NDArray[type]``, which NumPy writes with a dtype around it before 2.5."""
    last = get_args(array)[-1]
    return get_args(last)[0] if get_args(last) else last


def axes_of(x: Floats) -> Axes:
    """Give d zeros for positions (n, d): numba knows the length of a tuple when compiling and unrolls loops over it."""
    return (0,) * int(x.shape[1])
