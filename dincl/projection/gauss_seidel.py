"""Projected Gauss-Seidel sweeps over the multipliers (Hildreth's method), until they are at rest."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from dincl.errors import StepFailure
from dincl.matrices import combined, row_squares
from dincl.projection.base import Projection
from dincl.projection.qp import QpAnswer, QpSolver, stop_if_suspected
from dincl.status import Status

if TYPE_CHECKING:
    from numpy.typing import NDArray
    from scipy.sparse import csr_array

    from dincl.projection.base import Solver

# Sweeps for one quadratic program, in rounds; after each round the certificate is looked at.
ROUNDS = 200
SWEEPS_A_ROUND = 500


@dataclass(frozen=True)
class GaussSeidel(Projection):
    """Nearest points by sweeps over the rows, each of which projects exactly onto one row and remembers its push.

    Per sweep the cost is linear in the rows; the sweeps needed grow with the depth of a pile, and 100,000 for one
    program are the limit. Starts from the multipliers of the last solve. Measured on settled piles of discs, one step
    of gravity, tol = 1e-11, in milliseconds (from nothing / from a step that differs by 1 %): 0.05 / 0.05 at 4,
    0.10 / 0.09 at 10, 21 / 16 at 100, 780 / 460 at 1,000.

    Parameters
    ----------
    tol
        Greatest certified residual of a projection [length].
    """

    def solver(self) -> Solver:
        return _GaussSeidelSolver(self.tol)


class _GaussSeidelSolver(QpSolver):
    name = "gauss-seidel"

    def __init__(self, tol: float) -> None:
        super().__init__(tol)
        from dincl.solvers.dual import dual_sweeps

        self._sweeps = dual_sweeps

    def qp(
        self, matrix: csr_array, least: NDArray[np.float64], multipliers: NDArray[np.float64], tol: float
    ) -> QpAnswer:
        """By sweeps over the multipliers: min 1/2 |u|^2 s.t. matrix u >= least, see QpSolver."""
        mu = multipliers.copy()
        norm2 = row_squares(matrix)
        norm2[norm2 == 0] = 1.0
        sweeps, rest = 0, tol
        for _ in range(ROUNDS):
            before = mu.copy()
            # The products are formed anew in each round, so that rounding does not pile up in u.
            u = combined(matrix, mu)
            done, moved = self._sweeps(
                u, matrix.indptr, matrix.indices, matrix.data, least, norm2, mu, SWEEPS_A_ROUND, rest
            )
            sweeps += done
            u = combined(matrix, mu)
            if np.abs(np.minimum(mu, matrix @ u - least)).max() <= tol:
                return QpAnswer(u, mu, sweeps)
            stop_if_suspected(matrix, least, np.maximum(mu - before, 0.0))
            # A sweep moves less than what is still missing: the slower it goes, the more it has to be tightened.
            rest = min(rest, moved) / 4
        raise StepFailure(Status.NOT_CONVERGED, f"gauss-seidel did not come to rest in {sweeps} sweeps.")
