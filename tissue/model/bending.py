"""The bending energy, which keeps a cell straight (3.12).

    W = alpha (cos gamma + 1),  gamma the angle between u = A - X and v = B - X

The other form that is printed, alpha (cos pi - cos(gamma - pi)), is alpha (cos gamma - 1): smaller by 2 alpha, with the
same forces.
"""

from __future__ import annotations

from typing import Any

from dincl.compiled import inner
from dincl.compiled.lanes import fma

Plane = tuple[Any, Any]


def energy(cosine: Any, alpha: Any) -> Any:
    """W of cells with these cosines, for numbers, arrays and symbols."""
    return alpha * (cosine + 1)


def force(unit: Any, other: Any, length: Any, cosine: Any, alpha: Any) -> Any:
    """-dW/du = -alpha (v/|v| - cos gamma u/|u|) / |u|, from both unit vectors (2, n) and |u|."""
    return -alpha * (other - cosine * unit) / length


@inner
def turned(u: Plane, v: Plane, by_u: Any, by_v: Any, bending: Any) -> tuple[Any, Any, Any]:
    """p, q and r of the displacements p u + r v of A and q v + r u of B, from 1/|u| and 1/|v|.

    -dW/dA = alpha (c u / |u|^2 - v / (|u| |v|)), likewise for B; ``bending`` is alpha times the time step over mu.
    """
    bend = bending * by_u * by_v
    turn = bend * fma(u[0], v[0], u[1] * v[1])
    return turn * by_u * by_u, turn * by_v * by_v, 0.0 - bend
