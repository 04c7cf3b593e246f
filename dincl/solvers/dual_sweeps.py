"""Gauss-Seidel sweeps on the multipliers of a least-distance program (Hildreth)."""

import numpy as np

from dincl.compiled import kernel
from dincl.compiled.arrays import Floats, Offsets


@kernel
def dual_sweeps(
    z: Floats,
    indptr: Offsets,
    indices: Offsets,
    data: Floats,
    bound: Floats,
    norm2: Floats,
    multipliers: Floats,
    max_sweeps: int,
    tol: float,
) -> tuple[int, float]:
    """Minimise 1/2 |z - y|^2 subject to a_k.z >= b_k by projected Gauss-Seidel on the multipliers (Hildreth).

    Row after row: delta = max(-lambda_k, (b_k - a_k.z) / |a_k|^2), lambda_k += delta, z += delta a_k.

    Parameters
    ----------
    z : (n,)
        y + A^T multipliers at the start, the nearest point at the end; changed in place.
    indptr, indices, data : (m + 1,), (k,), (k,)
        The rows a_k in compressed sparse row form.
    bound, norm2 : (m,), (m,)
        The right-hand sides b_k and the squares |a_k|^2 > 0.
    multipliers : (m,)
        The multipliers lambda >= 0, changed in place.
    max_sweeps : int
        Sweeps allowed.
    tol : float
        Stop once no row of a whole sweep moved z by more than this.

    Returns
    -------
    sweeps : int
        Sweeps done.
    residual : float
        Longest move |delta_k| |a_k| in the last sweep; inf if none was done.
    """
    residual = np.inf
    for sweep in range(max_sweeps):
        residual = 0.0
        for row in range(bound.size):
            missing = bound[row]
            for p in range(indptr[row], indptr[row + 1]):
                missing -= data[p] * z[indices[p]]
            delta = max(-multipliers[row], missing / norm2[row])
            if delta == 0.0:
                continue
            multipliers[row] += delta
            for p in range(indptr[row], indptr[row + 1]):
                z[indices[p]] += delta * data[p]
            residual = max(residual, abs(delta) * np.sqrt(norm2[row]))
        if residual <= tol:
            return sweep + 1, residual
    return max_sweeps, residual
