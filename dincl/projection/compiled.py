"""The back ends of this package: an active set, with which whole runs are compiled, and conjugate gradients."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from dincl.errors import StepFailure
from dincl.matrices import combined
from dincl.projection.certificate import Projection
from dincl.projection.quadratic import QpAnswer, QpSolver, stop_if_suspected
from dincl.status import Status

if TYPE_CHECKING:
    from numpy.typing import NDArray
    from scipy.sparse import csr_array

    from dincl.projection.certificate import Solver

# What the codes of ``dincl.solvers.active_set`` mean.
CONTRADICTING = "active rows keep a violated row from being met."
ROUNDING = "rounding keeps it from an answer."
# Iterations of conjugate gradients for one quadratic program, in rounds; after each round the residual is formed anew.
ROUNDS = 50
ITERATIONS_A_ROUND = 2000
# Part of the tolerance that the iterations may use; the certificate, from the coordinates, adds their rounding.
SHARE = 0.5
# When a round stops too early, the next one aims at this part of its residual.
TIGHTER = 0.25


@dataclass(frozen=True)
class ActiveSet(Projection):
    """Nearest points by the dual active-set method of Goldfarb and Idnani (1983), compiled.

    The catch-up schemes make whole runs in compiled code with it, so that it is the fastest for them up to about a
    thousand particles: rows are assembled in place, the last active rows are the start, and the Cholesky factor of
    their Gram matrix is kept in the envelope of the contacts in the order of the cloud. The answer is refined until the
    active rows are met to rounding.

    Parameters
    ----------
    tol
        Greatest certified residual of a projection [length].
    """

    def solver(self) -> Solver:
        return _ActiveSetSolver(self.tol)


class _ActiveSetSolver(QpSolver):
    name = "active set"

    def qp(
        self, matrix: csr_array, least: NDArray[np.float64], multipliers: NDArray[np.float64], tol: float
    ) -> QpAnswer:
        """Solve with the rows in the order of their first coordinates, in which the envelope is narrow."""
        from dincl.rows.table import ROW, row_table
        from dincl.solvers.active_set import OK, UNMET, least_distance, solve
        from dincl.solvers.envelope_factor import envelope_factor

        m, n = matrix.shape[0], matrix.shape[1]
        rows = row_table(np.zeros(m, dtype=ROW), matrix.indptr, matrix.indices, np.zeros(0))
        first = np.minimum(matrix.indptr[:-1], max(len(matrix.indices) - 1, 0))
        order = np.argsort(matrix.indices[first], kind="stable") if len(matrix.indices) else np.arange(m)
        program = least_distance(matrix.data, least, multipliers.copy(), n)
        code = solve(rows, order, program, envelope_factor(min(m, n) + 1, n))
        if code != OK:
            detail = CONTRADICTING if code == UNMET else ROUNDING
            raise StepFailure(Status.NOT_CONVERGED, f"{self.name}: {detail}")
        return QpAnswer(program.z, program.multiplier, int(program.answer[0]))


@dataclass(frozen=True)
class ProjectedCG(Projection):
    """Nearest points by conjugate gradients on the multipliers >= 0 (MPRGP: Dostal, Schoeberl 2005).

    Per iteration the cost is linear in the rows; the iterations needed grow with the root of the condition of A A^T.
    Starts from the multipliers of the last solve, also when some rows came or went, so that it is best where steps are
    short and many. Measured per projection in a run of a pile of 1,000 discs, tol = 1e-6: 60 iterations, 2 ms, for
    steps of 0.003; 1,100 iterations, 100 ms, for steps of 0.1, a fifth of a radius.

    Parameters
    ----------
    tol
        Greatest certified residual of a projection [length].
    """

    def solver(self) -> Solver:
        return _ProjectedCGSolver(self.tol)


class _ProjectedCGSolver(QpSolver):
    name = "projected cg"

    def qp(
        self, matrix: csr_array, least: NDArray[np.float64], multipliers: NDArray[np.float64], tol: float
    ) -> QpAnswer:
        from dincl.solvers.dual import bounded_conjugate_gradients

        mu = multipliers.copy()
        allowed = SHARE * tol
        iterations, rest = 0, allowed
        for _ in range(ROUNDS):
            before = mu.copy()
            done, claimed = bounded_conjugate_gradients(
                matrix.indptr, matrix.indices, matrix.data, matrix.shape[1], least, mu, ITERATIONS_A_ROUND, rest
            )
            iterations += done
            u = combined(matrix, mu)
            residual = float(np.abs(np.minimum(mu, matrix @ u - least)).max())
            if residual <= allowed:
                return QpAnswer(u, mu, iterations)
            stop_if_suspected(matrix, least, np.maximum(mu - before, 0.0))
            if claimed <= rest:
                # Rounding has added up in the slope that is only updated.
                rest *= TIGHTER
        raise StepFailure(Status.NOT_CONVERGED, f"projected cg missed its tolerance in {iterations} iterations.")
