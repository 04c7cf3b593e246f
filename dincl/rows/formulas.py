"""Formulas of rows in compiled code: distances, and formulas of users.

Coordinates lie flat, particle by particle: ``i`` is the first coordinate of X_i in ``x``, ``j`` that of the other end
in ``other``. ``axes`` has the length d; as a tuple its length is known to the compiler, which unrolls the loops.
"""

from collections.abc import Callable
from typing import Any

import numpy as np

from dincl.compiled import c_function, inner, kernel
from dincl.compiled.arrays import Floats
from dincl.compiled.calls import DRIFT
from dincl.drifts.functions import call_drift


@inner
def square_distance(x: Floats, i: int, other: Floats, j: int, axes: Any) -> float:
    """Compute |X_i - X_j|^2."""
    square = 0.0
    for k in range(len(axes)):
        arrow = x[i + k] - other[j + k]
        square += arrow * arrow
    return square


@inner
def to_image(arrow: float, period: float) -> float:
    """Return a component of the arrow to the nearest image, for a period of its axis; 0: it does not repeat."""
    return float(arrow - period * np.rint(arrow / period)) if period > 0.0 else arrow


def row_formula(function: Callable[..., int]) -> Any:
    """Compile the formula of a kind of row, at top level of a file.

    ``function(t, x, out, entries, d, parameter)`` takes the coordinates of the particles of one row, one particle after
    the other, ``entries`` in all in dimension d, and the parameters of the row. It writes dg/dx into out[0] ...
    out[entries - 1] and g into out[entries], and returns 0, or 1 where g has no derivative.
    """
    return c_function(DRIFT, function)


@kernel
def evaluate_formula(address: int, x: Floats, parameter: Floats, d: int, out: Floats) -> int:
    """Write dg/dx and g of rows with coordinates x (m, e) into ``out`` (m, e + 1); return a row that failed, or -1."""
    for r in range(x.shape[0]):
        if call_drift(address, 0.0, x[r], out[r], x.shape[1], d, parameter[r]) != 0:
            return r
    return -1
