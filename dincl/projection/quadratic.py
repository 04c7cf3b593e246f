r"""Distance and affine rows as quadratic polynomials of a scaled displacement: what a nonlinear program gets to see.

With x = y + s w, the rows

    sign (|X_i - X_j|^2 - L^2) / (2 L s) = c + m . w + q |w_i - w_j|^2   and   (a . x - b) / s = c + m . w

are >= 0 just where g is. Unlike g they are smooth where centres coincide. At contact the gradient of the first is
that of g; elsewhere it is |X_i - X_j| / L times as long, and so its multipliers are L / |X_i - X_j| times those of g.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from dincl.constraints.rows import AffineRows, DistanceRows
from dincl.norms import norms

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from dincl.constraints.rows import RowsOfOneKind
    from dincl.csr import Csr


class Quadratic(NamedTuple):
    """Constants c (m,), linear part m as m rows, and weights q (m,), which are zero for affine rows."""

    constant: NDArray[np.float64]
    linear: Csr
    weight: NDArray[np.float64]


def quadratic(rows: AffineRows | DistanceRows, y: NDArray[np.float64], scale: float) -> Quadratic:
    """The polynomials of one block around y (N, d), for displacements in units of ``scale``."""
    if isinstance(rows, AffineRows):
        return Quadratic(rows.values(y) / scale, rows.matrix, np.zeros(len(rows.bound)))
    arrows = rows.arrows(y)
    distance = norms(arrows)
    constant = rows.sign * (distance - rows.length) * (distance + rows.length) / (2 * rows.length * scale)
    linear = rows.entries(rows.sign * arrows / rows.length[:, None], y.size)
    return Quadratic(constant, linear, rows.sign * scale / (2 * rows.length))


def steepness(rows: RowsOfOneKind, x: NDArray[np.float64]) -> NDArray[np.float64]:
    """Length of the gradient of the polynomial over that of g at x, shape (m,); 1 where g itself is used."""
    if not isinstance(rows, DistanceRows):
        return np.ones(len(rows.values(x)))
    return norms(rows.arrows(x)) / rows.length
