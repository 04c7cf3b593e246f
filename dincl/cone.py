"""Distances to the cone that gradients span."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from dincl.csr import Csr


def distance_to_cone(u: NDArray[np.float64], gradients: Csr) -> float:
    """min |u - A^T lambda| over lambda >= 0, for u of shape (n,) and the rows of A; non-negative least squares."""
    if gradients.rows == 0:
        return float(np.sqrt(u @ u))
    from scipy.optimize import lsq_linear

    found = lsq_linear(gradients.scipy().T, u, bounds=(0.0, np.inf), tol=1e-14, lsmr_tol="auto")
    rest = u - gradients.transposed_times(found.x)
    return float(np.sqrt(rest @ rest))
