"""Contacts that depend on each other: which of them hold a state, and a direction that opens all of them.

All of this is in double numbers and decides nothing: it only says what a candidate and its certificate are made of.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from collections.abc import Sequence

Floats = NDArray[np.float64]
# Singular values below this part of the largest count as zero.
RANK = 1e-9


def dependent(gradients: Floats) -> bool:
    """Return whether the rows of a matrix (m, n) are linearly dependent, up to rounding."""
    if not len(gradients):
        return False
    values = np.linalg.svd(gradients, compute_uv=False)
    return len(gradients) > gradients.shape[1] or bool(values[-1] <= RANK * values[0])


def holding(gradients: Floats, velocity: Floats) -> Sequence[int]:
    """Return independent rows that hold a state against a velocity (n,): those with p_k > 0 in min |v + J^T p|."""
    from scipy.optimize import nnls

    forces = nnls(gradients.T, -velocity)[0]
    return [int(k) for k in np.flatnonzero(forces > RANK * forces.max(initial=0.0))]


def opening(gradients: Floats) -> Floats | None:
    """Return a short direction z (n,) with J z >= 1; None if there is none."""
    from scipy.optimize import linprog

    m, n = gradients.shape
    # min s with J z >= 1, -s <= z_c <= s.
    bound = np.ones((n, 1))
    rows: Any = np.vstack(
        (np.hstack((-gradients, np.zeros((m, 1)))), np.hstack((np.eye(n), -bound)), np.hstack((-np.eye(n), -bound)))
    )
    right = np.concatenate((-np.ones(m), np.zeros(2 * n)))
    cost = np.append(np.zeros(n), 1.0)
    found = linprog(cost, A_ub=rows, b_ub=right, bounds=[(None, None)] * n + [(0, None)])
    return found.x[:n] if found.status == 0 else None
