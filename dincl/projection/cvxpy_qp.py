"""Quadratic programs written as they are meant, in CVXPY: the judge of the other back ends."""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from dincl.errors import StepFailure
from dincl.extras import needs
from dincl.matrices import from_rows
from dincl.projection.base import Projection
from dincl.projection.program_cache import ProgramCache
from dincl.projection.qp import QpAnswer, QpSolver
from dincl.status import Status

if TYPE_CHECKING:
    from numpy.typing import NDArray
    from scipy.sparse import csr_array

    from dincl.projection.base import Solver

# Settings of Clarabel, for the same reasons as in clarabel.py; lengths are in units of the largest violation.
SETTINGS = {
    "tol_feas": 1e-12,
    "tol_gap_abs": 1e-12,
    "tol_gap_rel": 1e-12,
    "static_regularization_constant": 1e-10,
    "max_threads": 1,
}
# Canonicalised programs kept for the next time that rows tie the same coordinates.
MOST_PROGRAMS = 16


@dataclass(frozen=True)
class CvxpyQP(Projection):
    """Nearest points by CVXPY with Clarabel inside: min |u|^2 subject to A u >= least, canonicalised once, re-solved.

    The judge of the others, not for hot loops. Clarabel has the settings of ``Clarabel``. Measured on settled piles of
    discs, one step of gravity, in milliseconds (first / again): 9 / 0.8 at 4, 6 / 0.8 at 10, 19 / 1.8 at 100,
    670 / 24 at 1,000; the first solve for rows that tie other coordinates canonicalises.

    Parameters
    ----------
    tol
        Greatest certified residual of a projection [length].
    """

    def solver(self) -> Solver:
        return _CvxpySolver(self.tol)


class _CvxpySolver(QpSolver):
    name = "cvxpy"

    def __init__(self, tol: float) -> None:
        super().__init__(tol)
        with needs("CvxpyQP", "yardsticks"):
            import cvxpy

        self._cvxpy: Any = cvxpy
        self._programs: ProgramCache[_Program] = ProgramCache(MOST_PROGRAMS)

    def qp(
        self, matrix: csr_array, least: NDArray[np.float64], multipliers: NDArray[np.float64], tol: float
    ) -> QpAnswer:
        """The program with these numbers; multipliers and ``tol`` are not passed on."""
        key = (matrix.indptr.tobytes(), matrix.indices.tobytes())
        return self._programs.get(key, lambda: _Program(self._cvxpy, matrix)).solve(matrix, least)


class _Program:
    """One program in which the entries of A and ``least`` are parameters (a DPP program, so it is canonicalised once).

    A u is written as a sum over entries, a_kl u_l: the pattern is data, and no dense matrix of parameters is needed.
    """

    def __init__(self, cvxpy: Any, matrix: csr_array) -> None:
        entries = len(matrix.data)
        summing = from_rows(matrix.indptr, np.arange(entries), np.ones(entries), entries)
        self._cvxpy = cvxpy
        self._u = cvxpy.Variable(matrix.shape[1])
        self._data = cvxpy.Parameter(entries)
        self._least = cvxpy.Parameter(matrix.shape[0])
        self._rows = summing @ cvxpy.multiply(self._data, self._u[matrix.indices]) >= self._least
        self._problem = cvxpy.Problem(cvxpy.Minimize(cvxpy.sum_squares(self._u) / 2), [self._rows])

    def solve(self, matrix: csr_array, least: NDArray[np.float64]) -> QpAnswer:
        """Solve with these numbers."""
        self._data.value, self._least.value = matrix.data, least
        try:
            with warnings.catch_warnings():
                # CVXPY warns of an answer that Clarabel calls almost solved; here the certificate decides.
                warnings.simplefilter("ignore", UserWarning)
                self._problem.solve(solver=self._cvxpy.CLARABEL, **SETTINGS)
        except self._cvxpy.error.SolverError as error:
            raise StepFailure(Status.NOT_CONVERGED, f"cvxpy stopped: {error}.") from error
        word = self._problem.status
        if word not in ("optimal", "optimal_inaccurate"):
            raise StepFailure(Status.NOT_CONVERGED, f"cvxpy stopped: {word}.")
        iterations = int(self._problem.solver_stats.num_iters)
        return QpAnswer(self._u.value, np.maximum(self._rows.dual_value, 0.0), iterations)
