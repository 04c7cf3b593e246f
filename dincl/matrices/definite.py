"""Factors of symmetric positive definite or semidefinite matrices, dense or sparse, imported where one is needed."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]


class Factor(NamedTuple):
    """M^-1 B and F B for B (n, k), where F^T F = M^-1."""

    solve: Callable[[Floats], Floats]
    half: Callable[[Floats], Floats]


def factorised(matrix: Any) -> Factor:
    """Factorise a matrix M, an array or sparse; LinAlgError unless it is positive definite."""
    if isinstance(matrix, np.ndarray):
        from scipy.linalg import cho_solve, cholesky, solve_triangular

        low = cholesky(matrix, lower=True, check_finite=False)
        return Factor(
            lambda b: cho_solve((low, True), b, check_finite=False),
            lambda b: solve_triangular(low, b, lower=True, check_finite=False),
        )
    from scipy.sparse.linalg import splu, spsolve_triangular

    try:
        found = splu(matrix.tocsc(), permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
    except RuntimeError as error:
        raise np.linalg.LinAlgError(str(error)) from error
    pivots, place = found.U.diagonal(), np.argsort(found.perm_r)
    if not ((pivots > 0).all() and (found.perm_r == found.perm_c).all()):
        raise np.linalg.LinAlgError("a pivot is not positive")
    low, roots = found.L.tocsr(), np.sqrt(pivots)[:, None]
    return Factor(found.solve, lambda b: spsolve_triangular(low, b[place], unit_diagonal=True) / roots)


def pivoted_cholesky(matrix: Floats) -> tuple[Floats, NDArray[np.int64]]:
    """Return L (m, rank) and an order with M[order][:, order] = L L^T, up to rounding of the largest entry."""
    from scipy.linalg.lapack import dpstrf

    size = float(matrix.diagonal().max(initial=0.0))
    lower, order, rank, _ = dpstrf(matrix, tol=len(matrix) * np.finfo(float).eps * size, lower=1)
    return np.tril(lower)[:, :rank], order.astype(np.int64) - 1
