r"""Constants of prox-regularity for N discs of radius R in R^d: printed, proved, and the exact one of a straight row.

What is proved, for discs of distance L = 2R in contact, n = -sum_k lambda_k grad g_k a normal at x, and y in S:

1. |s| = L and |s'| >= L give -s.(s' - s)/L <= |s' - s|^2 / (2L). With v = y - x and the weighted graph Laplacian
   Q(v) = sum_ij lambda_ij |v_i - v_j|^2 of the contacts that push, n . v <= Q(v) / (2L). So
   eta >= L |n| / max Q(v) over |v| = 1, and max Q <= max_ij (w_i + w_j) for the weights w_i = sum_j lambda_ij.
2. For a monotone field V, all contacts have e_ij . (V(X_i) - V(X_j)) >= 0, so that each sum of some of the terms
   lambda_ij e_ij . (V_i - V_j) is at most -n . V. Take V = P_i + P_j with P_i(z) = (nearest point to z of the ball
   of radius L around X_i) - X_i: the terms of all contacts of i are L lambda under P_i, and so for j. Its length is
   L at X_i and at X_j and at most 2L at the N - 2 others, so L (w_i + w_j) <= |n| L sqrt(4N - 6).

Together eta >= L / sqrt(4N - 6). A row of discs along a line attains 1 for its lambda when d >= 2: it can buckle along
any v across the line, and shortens by |v_i - v_{i+1}|^2 / (2L) at each contact. N = 2 attains both, N = 3 is exact by
hand, and for large N proof and row agree to first order: eta = R / sqrt(N).
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from dincl.checks import integer, number

if TYPE_CHECKING:
    from numpy.typing import NDArray

# Alternations until the ratio stands still to rounding; each solves one tridiagonal system.
MOST_ALTERNATIONS = 500
STANDS_STILL = 1e-14

# Of the row of discs whose buckling is computed: its arrays fit into memory.
LONGEST_ROW = 1_000_000


def printed_constant(count: int, radius: float, d: int) -> float:
    """R/(6N) (sin(2 pi/N)/3)^d as it is printed, 0 for N <= 2 [length].

    Source: Proposition 1.22. It proves nothing for N = 2, where the projection is unique up to sqrt(2) R.
    """
    n, size, dimension = (
        integer("count", count, least=1),
        number("radius", radius, positive=True),
        integer("d", d, least=1),
    )
    return 0.0 if n <= 2 else size / (6 * n) * (math.sin(2 * math.pi / n) / 3) ** dimension


def proved_constant(count: int, radius: float) -> float:
    """R sqrt(2/(2N - 3)), and R sqrt(8)/3 for N = 3: N discs of radius R are prox-regular with it, in every d [length].

    The proof is in the docstring of this module; it holds for unequal radii with 2R the least sum of two of them, but
    for N = 3. There, max Q for a chain with weights a, b and q^2 = a^2 - ab + b^2 is a + b + q, while |n|^2 >= 2 q^2,
    and a + b <= 2q: eta >= L sqrt(2)/3. Three discs in mutual contact have eta >= L/sqrt(2). One disc has eta = inf.
    """
    n, size = integer("count", count, least=1), number("radius", radius, positive=True)
    if n == 1:
        return math.inf
    return size * (math.sqrt(8) / 3 if n == 3 else math.sqrt(2 / (2 * n - 3)))


def chain_constant(count: int, radius: float) -> float:
    """The eta of a straight row of N >= 2 discs of radius R, all normals [length]: no eta of S is larger, for d >= 2.

    min over lambda >= 0 of L |n| / max Q by alternation: the buckling mode v of lambda, then the lambda best for v,
    D lambda = (|v_i - v_{i+1}|^2) with D = tridiag(-1, 2, -1), the Gram matrix of the row. What is found is attained,
    so it bounds eta from above even if it were not least; no random start has led any lower.
    """
    n, size = integer("count", count, least=2, most=LONGEST_ROW), number("radius", radius, positive=True)
    return 2 * size / _buckling(np.ones(n - 1))


def _buckling(weights: NDArray[np.float64]) -> float:
    """max Q / |n|, climbed from weights (N - 1,)."""
    from scipy.linalg import eigh_tridiagonal, solve_banded

    m = len(weights)
    gram = np.tile([[-1.0], [2.0], [-1.0]], m)
    best = 0.0
    for _ in range(MOST_ALTERNATIONS):
        padded = np.concatenate(([0.0], weights, [0.0]))
        force = float(np.sqrt((np.diff(padded) ** 2).sum()))
        top, mode = eigh_tridiagonal(padded[1:] + padded[:-1], -weights, select="i", select_range=(m, m))
        ratio = float(top[0]) / force
        if ratio <= best * (1 + STANDS_STILL):
            break
        best = ratio
        weights = solve_banded((1, 1), gram, np.diff(mode[:, 0]) ** 2)
    return best
