"""Completing an answer that is nearly right: the rows that are active are taken for equations and solved exactly."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from dincl.matrices import combined

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from dincl.rows.affine import AffineRows

# Weight of the step from the multipliers given, relative to the rows: makes redundant rows solvable.
DAMPING = 1e-7
# Each step shortens the error by DAMPING over the least eigenvalue of A A^T that is not zero.
STEPS = 6


def on_active_rows(
    linear: AffineRows, y: NDArray[np.float64], multipliers: NDArray[np.float64], active: NDArray[np.bool_]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Nearest point to y with A x = bound in the ``active`` rows, and its multipliers (m,), zero in the others.

    Solves A A^T lambda = bound - A y by the proximal point method from the multipliers given,

        lambda <- lambda + (A A^T + damping)^{-1} (bound - A (y + A^T lambda)),

    which for redundant rows ends at the nearest of the many solutions. The matrix is sparse and factorised once.
    """
    from scipy.sparse import eye_array
    from scipy.sparse.linalg import splu

    full = np.zeros_like(multipliers)
    if not active.any():
        return y, full
    rows = linear.take(active)
    matrix = rows.matrix
    gram = matrix @ matrix.T
    weight = DAMPING * float(gram.diagonal().max())
    if weight == 0:
        return y, full
    factor = splu((gram + weight * eye_array(gram.shape[0])).tocsc())
    lam = multipliers[active]
    missing = -rows.values(y)
    for _ in range(STEPS):
        lam = lam + factor.solve(missing - matrix @ (matrix.T @ lam))
    full[active] = np.maximum(lam, 0.0)
    return y + combined(linear.matrix, full).reshape(y.shape), full
