"""The dense dual active-set method of this package."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from dincl.errors import StepFailure
from dincl.projection.base import Projection
from dincl.projection.qp import QpAnswer, QpSolver
from dincl.status import Status

if TYPE_CHECKING:
    from numpy.typing import NDArray
    from scipy.sparse import csr_array

    from dincl.projection.base import Solver

# What the codes of ``dincl.solvers.active_set`` mean.
CONTRADICTING = "active rows keep a violated row from being met."
ROUNDING = "rounding keeps it from an answer."


@dataclass(frozen=True)
class ActiveSet(Projection):
    """Nearest points by the dual active-set method of Goldfarb and Idnani (1983), compiled.

    The catch-up schemes make whole runs of up to 200 particles in compiled code with it, so that it is the fastest for
    them: rows are assembled in place, the last active rows are the start, and the Cholesky factor of their Gram matrix
    is kept in the envelope of the contacts in the order of the cloud. The answer is refined until the active rows are
    met to rounding.

    Parameters
    ----------
    tol
        Greatest certified residual of a projection [length].
    """

    def solver(self) -> Solver:
        return _ActiveSetSolver(self.tol)


class _ActiveSetSolver(QpSolver):
    name = "active set"
    dense = True

    @property
    def compiled(self) -> Any:
        from dincl.steps.programs import active_set

        return active_set

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
