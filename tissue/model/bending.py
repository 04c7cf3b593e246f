"""The bending energy, which keeps a cell straight (3.12).

    W = alpha (cos gamma + 1),  gamma the angle between u = A - X and v = B - X

The other form that is printed, alpha (cos pi - cos(gamma - pi)), is alpha (cos gamma - 1): smaller by 2 alpha, with the
same forces.
"""

from __future__ import annotations

from typing import Any


def energy(cosine: Any, alpha: Any) -> Any:
    """Compute W of cells with these cosines, for numbers, arrays and symbols."""
    return alpha * (cosine + 1)


def force(unit: Any, other: Any, length: Any, cosine: Any, alpha: Any) -> Any:
    """-dW/du = -alpha (v/|v| - cos gamma u/|u|) / |u|, from both unit vectors (2, n) and |u|."""
    return -alpha * (other - cosine * unit) / length
