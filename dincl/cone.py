"""Distances to the cone that gradients span."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from dincl.constraints.rows import AffineRows
from dincl.projection.daqp import Daqp
from dincl.projection.piqp import Piqp

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from dincl.csr import Csr

# Accuracy relative to |u|, and the number of unknowns up to which a dense active-set method is the faster one.
TOLERANCE = 1e-10
DENSE = 60


def distance_to_cone(u: NDArray[np.float64], gradients: Csr) -> float:
    """min |u - A^T lambda| over lambda >= 0, for u of shape (n,) and the rows of A; accurate to 1e-10 |u|.

    By Moreau's decomposition this is the length of the projection of u onto the polar cone {z : A z <= 0}.
    """
    size = float(np.sqrt(u @ u))
    if size == 0:
        return 0.0
    polar = AffineRows(gradients._replace(data=-gradients.data), np.zeros(gradients.rows))
    projection = Daqp if u.size <= DENSE else Piqp
    nearest = projection(TOLERANCE).solver().nearest(polar, u[:, None] / size, u[:, None] / size)
    return size * float(np.sqrt((nearest.point**2).sum()))
