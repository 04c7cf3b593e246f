"""Sums of a smooth kernel over all pairs of N points on a line in O(N p), by Chebyshev interpolation of degree p."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.polynomial import chebyshev

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    Kernel = Callable[[NDArray[np.float64]], NDArray[np.float64]]

# Degrees tried. A degree is sufficient if the last TAIL_TERMS coefficients are this small relative to the largest one.
DEGREES = (16, 32, 64, 128)
SUFFICIENT = 1e-14
TAIL_TERMS = 3
# Points per block: their polynomials fit into the cache.
CACHE_BLOCK = 8192


@dataclass(frozen=True)
class Interpolant:
    """Interval that contains all points, and the degree of interpolation that a kernel needs on it."""

    centre: float
    half: float
    degree: int

    def sum_pairs(self, kernel: Kernel, x: NDArray[np.float64], w: NDArray[np.float64]) -> NDArray[np.float64]:
        """Compute sum_k w_k kernel(x_k - x_i) for each i, from points x (Q,) and weights (Q,).

        The kernel is interpolated in both variables. The moments of w T_j(x) give equivalent weights at the nodes; the
        sum, a function of x_i, is interpolated from its values at the nodes.
        """
        s = (x - self.centre) / self.half
        nodes = chebyshev.chebpts1(self.degree + 1)
        values = chebyshev.chebvander(nodes, self.degree)
        scale = np.full(self.degree + 1, 2.0 / (self.degree + 1))
        scale[0] /= 2
        node_weights = values @ (scale * self._moments(s, w))
        at_nodes = (
            kernel((self.half * (nodes[None, :] - nodes[:, None])).ravel()).reshape(len(nodes), -1) @ node_weights
        )
        return np.asarray(chebyshev.chebval(s, scale * (at_nodes @ values)))

    def _moments(self, s: NDArray[np.float64], w: NDArray[np.float64]) -> NDArray[np.float64]:
        """Compute sum_k w_k T_j(s_k) for each degree j."""
        found = np.zeros(self.degree + 1)
        for begin in range(0, len(s), CACHE_BLOCK):
            part = slice(begin, begin + CACHE_BLOCK)
            before, now, twice = w[part].copy(), w[part] * s[part], 2 * s[part]
            found[:2] += before.sum(), now.sum()
            for j in range(2, self.degree + 1):
                before, now = now, twice * now - before
                found[j] += now.sum()
        return found


def interpolant(kernels: tuple[Kernel, ...], x: NDArray[np.float64]) -> Interpolant | None:
    """Choose the degree that resolves kernels to rounding at points x (Q,); None if no degree of DEGREES does.

    A kernel that is a polynomial of degree p in x_k - x_i to accuracy e is a polynomial of degree p in each of the two
    points. Interpolation in both points then has an error of at most (1 + 2 log p)^2 e.
    """
    low, high = float(x.min()), float(x.max())
    if low == high:
        return None
    for degree in DEGREES:
        if all(_resolves(kernel, high - low, degree) for kernel in kernels):
            return Interpolant((low + high) / 2, (high - low) / 2, degree)
    return None


def _resolves(kernel: Kernel, length: float, degree: int) -> bool:
    """Return whether the last coefficients of a kernel on [-length, length], even and odd ones, are at rounding."""
    coefficients: Any = chebyshev.chebinterpolate(lambda s: kernel(length * s), degree)
    size = np.abs(coefficients)
    return bool(size[-TAIL_TERMS:].max() <= SUFFICIENT * size.max())
