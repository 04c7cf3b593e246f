r"""Rows as quadratic polynomials of a scaled displacement: what a nonlinear program gets to see.

With x = y + s w, the rows

    sign (|X_i - X_j|^2 - L^2) / (2 L s) = c + m . w + q |w_i - w_j|^2   and   (a . x - b) / s = c + m . w

are >= 0 just where g is. Unlike g they are smooth where centres coincide. At contact the gradient of the first is
that of g; elsewhere it is |X_i - X_j| / L times as long, and so its multipliers are L / |X_i - X_j| times those of g.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray
    from scipy.sparse import csr_array


class Polynomial(NamedTuple):
    """Constants c (m,), linear part m as m rows, weights q (m,), and the particles i, j (m,) of the squares.

    Without ``i`` there is no square, and q is zero; without ``j`` it is |w_i|^2.
    """

    constant: NDArray[np.float64]
    linear: csr_array
    weight: NDArray[np.float64]
    i: NDArray[np.int64] | None = None
    j: NDArray[np.int64] | None = None
