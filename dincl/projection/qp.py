"""From quadratic programs to nearest points: what all QP back ends share."""

from __future__ import annotations

from abc import abstractmethod
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from dincl.errors import StepFailure
from dincl.matrices import combined, divided, multiplied, row_squares
from dincl.norms import length as norm
from dincl.projection.base import NEGLIGIBLE, Projected, Solver, row_lengths
from dincl.rows.affine import AffineRows, linearised
from dincl.status import Status

if TYPE_CHECKING:
    from numpy.typing import NDArray
    from scipy.sparse import csr_array

    from dincl.rows.base import Rows

# Iterations end when all points of a set are proved to be this many times the largest violation away.
FARTHEST = 1e8


class QpAnswer(NamedTuple):
    """Solution u (n,), multipliers (m,) >= 0 and iterations of a least-distance program."""

    u: NDArray[np.float64]
    multipliers: NDArray[np.float64]
    iterations: int


class QpSolver(Solver):
    """Projects onto polyhedra; ``dincl.steps.programs`` makes projections onto curved sets of them.

    A back end sees each program in the displacement u = (z - y) / s, with rows of unit length and the largest
    violation s, so that its tolerances are relative to the move and not to the coordinates.
    """

    whole = False

    def compute(self, rows: Rows, y: NDArray[np.float64], guess: NDArray[np.float64]) -> Projected:
        """The nearest point of the rows linearised at ``guess``."""
        linear = linearised(rows, guess)
        length, start = row_lengths(linear.matrix), np.zeros(len(linear))
        unit, missing = divided(linear.matrix, length), -linear.values(y) / length
        found = self.solve(unit, missing, start, self.tol / max(1.0, float(length.max(initial=1.0))))
        done = self.put_right(unit, missing, length, found, self.tol)
        return self.certify(linear, y, y + done.u.reshape(y.shape), done.multipliers / length, done.iterations)

    def solve(
        self, matrix: csr_array, missing: NDArray[np.float64], multipliers: NDArray[np.float64], tol: float
    ) -> QpAnswer:
        """min 1/2 |u|^2 s.t. matrix u >= missing, to the residual ``tol``, for rows of length 1 or 0.

        StepFailure(NOT_CONVERGED) if the back end gives up.
        """
        scale = float(missing.max(initial=0.0))
        if scale <= NEGLIGIBLE * tol:
            return QpAnswer(np.zeros(matrix.shape[1]), np.zeros(len(missing)), 0)
        if ((row_squares(matrix) == 0) & (missing > 0)).any():
            raise StepFailure(Status.NOT_CONVERGED, "A violated constraint has the gradient zero.")
        near = float(multipliers.max(initial=0.0)) <= FARTHEST * scale
        start = multipliers / scale if near else np.zeros(len(missing))
        found = self.qp(matrix, missing / scale, start, tol / scale)
        return QpAnswer(scale * found.u, scale * found.multipliers, found.iterations)

    def put_right(
        self,
        matrix: csr_array,
        missing: NDArray[np.float64],
        length: NDArray[np.float64],
        found: QpAnswer,
        tol: float,
    ) -> QpAnswer:
        """Complete an answer to the residual ``tol`` of rows of these lengths, if it misses it.

        It misses it where an interior point leaves a duality gap eps, and so sqrt(eps) in the point, where rows are
        longer than the largest violation, and where rows are shorter than 1, so that their multipliers are longer.
        """
        rows = AffineRows(multiplied(matrix, length), length * missing)
        origin, u = np.zeros((matrix.shape[1], 1)), found.u[:, None]
        certified = self.certify(rows, origin, u, found.multipliers / length, found.iterations)
        if certified.residual <= tol:
            return found
        done = self.completed(rows, origin, certified, tol)
        return QpAnswer(done.point.ravel(), done.multipliers * length, done.iterations)

    @abstractmethod
    def qp(
        self, matrix: csr_array, least: NDArray[np.float64], multipliers: NDArray[np.float64], tol: float
    ) -> QpAnswer:
        """min 1/2 |u|^2 s.t. matrix u >= least, to the residual ``tol``, from the multipliers of a similar program.

        Rows of ``matrix`` (m, n) have length 1 (or 0), max ``least`` = 1; the solution obeys u = matrix^T multipliers.
        StepFailure(NOT_CONVERGED) when the back end gives up, for whatever reason.
        """


def stop_if_suspected(matrix: csr_array, least: NDArray[np.float64], weights: NDArray[np.float64]) -> None:
    """StepFailure if ``weights`` (m,) >= 0 show that all u with A u >= least are far away: iterations would not end.

    Any such u has |u| >= least . weights / |A^T weights|; of an empty set, multipliers grow towards such weights.
    """
    if float(least @ weights) > FARTHEST * norm(combined(matrix, weights)):
        detail = f"All points that meet the constraints are more than {FARTHEST:g} violations away."
        raise StepFailure(Status.NOT_CONVERGED, detail)
