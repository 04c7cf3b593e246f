"""Sums of a smooth kernel over all pairs of points on a line in O(N p), by interpolation in Chebyshev points."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.polynomial import chebyshev

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    Kernel = Callable[[NDArray[np.float64]], NDArray[np.float64]]

# Degrees tried, and the size of the last coefficients, relative to the largest, at which an expansion is complete.
DEGREES = (16, 32, 64, 128)
COMPLETE = 1e-14
LAST = 3
# Points that are worked on together, so that their polynomials stay in the cache.
BLOCK = 8192


@dataclass(frozen=True)
class Interpolant:
    """The interval that holds all points, and the degree that a kernel needs on it."""

    centre: float
    half: float
    degree: int

    def summed(self, kernel: Kernel, x: NDArray[np.float64], w: NDArray[np.float64]) -> NDArray[np.float64]:
        """sum_k w_k kernel(x_k - x_i) for each i, from points x (Q,) and weights (Q,).

        The kernel is interpolated in both variables: sources at the nodes from the sums of w T_j(x), the sum as a
        function of x_i from its values at the nodes.
        """
        s = (x - self.centre) / self.half
        nodes = chebyshev.chebpts1(self.degree + 1)
        values = chebyshev.chebvander(nodes, self.degree)
        scale = np.full(self.degree + 1, 2.0 / (self.degree + 1))
        scale[0] /= 2
        sources = values @ (scale * self._moments(s, w))
        field = kernel((self.half * (nodes[None, :] - nodes[:, None])).ravel()).reshape(len(nodes), -1) @ sources
        return np.asarray(chebyshev.chebval(s, scale * (field @ values)))

    def _moments(self, s: NDArray[np.float64], w: NDArray[np.float64]) -> NDArray[np.float64]:
        """sum_k w_k T_j(s_k) for each degree j."""
        found = np.zeros(self.degree + 1)
        for begin in range(0, len(s), BLOCK):
            part = slice(begin, begin + BLOCK)
            before, now, twice = w[part].copy(), w[part] * s[part], 2 * s[part]
            found[:2] += before.sum(), now.sum()
            for j in range(2, self.degree + 1):
                before, now = now, twice * now - before
                found[j] += now.sum()
        return found


def line(kernels: tuple[Kernel, ...], x: NDArray[np.float64]) -> Interpolant | None:
    """The line through points x (Q,) on which kernels are resolved to rounding; None if they are not smooth enough.

    A kernel that is a polynomial of degree p to accuracy e on all differences is one in each of its two points, so
    that interpolation in both errs by (1 + 2 log p)^2 e at most.
    """
    low, high = float(x.min()), float(x.max())
    if low == high:
        return None
    for degree in DEGREES:
        if all(_complete(kernel, high - low, degree) for kernel in kernels):
            return Interpolant((low + high) / 2, (high - low) / 2, degree)
    return None


def _complete(kernel: Kernel, length: float, degree: int) -> bool:
    """Whether the last coefficients of a kernel on [-length, length] are at rounding, the even and the odd ones."""
    coefficients: Any = chebyshev.chebinterpolate(lambda s: kernel(length * s), degree)
    size = np.abs(coefficients)
    return bool(size[-LAST:].max() <= COMPLETE * size.max())
