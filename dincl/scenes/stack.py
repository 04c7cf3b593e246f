"""A row of intervals that is pressed against a wall."""

from __future__ import annotations

from typing import Any

import numpy as np

from dincl.constraints import HalfSpace, NonOverlap
from dincl.drifts import attraction
from dincl.scenes.exact import Exact
from dincl.scenes.scene import Scene

RADII = (0.5, 0.25, 0.375, 0.5, 0.25, 0.375)
START = (1.23, 5.08, 5.84, 8.05, 9.17, 15.1)


class _Stack(Exact):
    @property
    def _shape(self) -> tuple[int, int]:
        return (len(START), 1)

    def _at(self, t: Any) -> list[Any]:
        import mpmath

        packed = [mpmath.mpf(c) for c in _packed()]
        growth = mpmath.exp(t)
        free = [x - c - (growth - 1) * c for x, c in zip(START, packed, strict=True)]
        return [c + max(z, mpmath.mpf(0)) / growth for c, z in zip(packed, _isotonic(free), strict=True)]


def stack() -> Scene:
    r"""x_i' in -x_i - N_i, six intervals of radii r_i on a line that may not overlap, behind a wall at 0: x_0 >= r_0.

    Exact solution: let c be the packed row, c_0 = r_0, c_i = c_{i-1} + r_{i-1} + r_i, and K the convex cone
    0 <= z_0 <= z_1 <= ... Then x - c lies in K. For z = e^t (x - c), with N(K, .) the same along a ray,

        z' in -e^t c - N(K, z),   and, in the time s = e^t - 1,   dz/ds in -c - N(K, z).

    This is solved by z = P_K(p), p = z(0) - s c. Indeed p - z lies in N(K, z), with the multipliers
    lambda_k = sum_{i <= k} (p_i - z_i) between i = k and k + 1, summed over the cluster of touching intervals that
    holds k. There z_i is the mean of p, so lambda_k grows at the rate sum_{i <= k} (mean(c) - c_i), or z_i = 0 at the
    wall, lambda_k = -sum_{i > k} p_i and the rate is sum_{i > k} c_i. Both are positive, since c increases. So contacts
    stay once made, and -c - dz/ds = d(p - z)/ds, with these rates as multipliers, lies in N(K, z). Hence

        x(t) = c + e^{-t} P_K(x(0) - c - (e^t - 1) c).

    P_K is isotonic regression (pooling of adjacent violators) followed by max(., 0).

    Source: the stack mentioned in section 4.1 of chapter 2.
    """
    return Scene(
        np.array(START)[:, None],
        attraction(0),
        [NonOverlap(RADII), HalfSpace(normal=(1,), radius=RADII)],
        name="stack",
        title="A row of intervals pressed against a wall",
        times=(0.5, 1.0, 1.5),
        radius=RADII,
        exact=_Stack(),
    )


def _packed() -> list[float]:
    """c, exactly: the radii are multiples of 1/8."""
    reach = np.cumsum(2 * np.array(RADII)) - RADII
    return [float(c) for c in reach]


def _isotonic(values: list[Any]) -> list[Any]:
    """The nearest increasing sequence: adjacent blocks are pooled while their means decrease."""
    blocks: list[tuple[Any, int]] = []
    for value in values:
        mean, size = value, 1
        while blocks and blocks[-1][0] >= mean:
            left, count = blocks.pop()
            mean, size = (left * count + mean * size) / (count + size), count + size
        blocks.append((mean, size))
    return [mean for mean, size in blocks for _ in range(size)]
