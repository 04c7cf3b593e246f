"""Distances in compiled code.

Coordinates lie flat, particle by particle: ``i`` is the first coordinate of X_i in ``x``, ``j`` that of the other end
in ``other``. ``axes`` has the length d; as a tuple its length is known to the compiler, which unrolls the loops.
"""

from typing import Any

import numpy as np

from dincl.compiled import inner
from dincl.compiled.arrays import Floats


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
