"""From quadratic programs to nearest points: what all QP back ends share."""

from __future__ import annotations

from abc import abstractmethod
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from dincl.errors import StepFailure
from dincl.matrices import combined, divided, row_squares
from dincl.projection.base import NEGLIGIBLE, Projected, Solver
from dincl.rows.affine import AffineRows, linearised
from dincl.status import Status

if TYPE_CHECKING:
    from numpy.typing import NDArray
    from scipy.sparse import csr_array

    from dincl.rows.base import Rows

# A set is called empty when it is proved to be farther away than this many times the largest violation.
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
        length = np.sqrt(row_squares(linear.matrix))
        length[length == 0] = 1.0
        unit, missing = divided(linear.matrix, length), -linear.values(y) / length
        found = self.solve(unit, missing, np.zeros(len(missing)), self.tol / max(1.0, float(length.max(initial=1.0))))
        if found is None:
            return self.certify(linear, y, y, np.zeros(len(missing)), 0)
        x = y + found.u.reshape(y.shape)
        return self.certify(linear, y, x, found.multipliers / length, found.iterations)

    def solve(
        self, matrix: csr_array, missing: NDArray[np.float64], multipliers: NDArray[np.float64], tol: float
    ) -> QpAnswer | None:
        """min 1/2 |u|^2 s.t. matrix u >= missing, to the residual ``tol``, for rows of length 1 or 0; None if u = 0."""
        if ((row_squares(matrix) == 0) & (missing > 0)).any():
            raise StepFailure(Status.INFEASIBLE, "A violated constraint has the gradient zero.")
        scale = float(missing.max(initial=0.0))
        if scale <= NEGLIGIBLE * tol:
            return None
        near = float(multipliers.max(initial=0.0)) <= FARTHEST * scale
        start = multipliers / scale if near else np.zeros(len(missing))
        found = self.qp(matrix, missing / scale, start, tol / scale)
        return QpAnswer(scale * found.u, scale * found.multipliers, found.iterations)

    @abstractmethod
    def qp(
        self, matrix: csr_array, least: NDArray[np.float64], multipliers: NDArray[np.float64], tol: float
    ) -> QpAnswer:
        """min 1/2 |u|^2 s.t. matrix u >= least, to the residual ``tol``, from the multipliers of a similar program.

        Rows of ``matrix`` (m, n) have length 1 (or 0), max ``least`` = 1; the solution obeys u = matrix^T multipliers.
        StepFailure(INFEASIBLE) when there is no such u, StepFailure(NOT_CONVERGED) when the back end gives up.
        """


class InteriorPointSolver(QpSolver):
    """A QP back end whose answer lies a little off the active rows and is completed when that is too far.

    Without it, one projection in six of the tests' clusters and piles would miss a residual of 1e-9, by a factor of up
    to 60: where rows are active without a multiplier, a duality gap eps leaves sqrt(eps) in the point.
    """

    def solve(
        self, matrix: csr_array, missing: NDArray[np.float64], multipliers: NDArray[np.float64], tol: float
    ) -> QpAnswer | None:
        found = super().solve(matrix, missing, multipliers, tol)
        if found is None:
            return None
        rows, origin = AffineRows(matrix, missing), np.zeros((matrix.shape[1], 1))
        certified = self.certify(rows, origin, found.u[:, None], found.multipliers, found.iterations)
        done = self.completed(rows, origin, certified, tol)
        return QpAnswer(done.point.ravel(), done.multipliers, done.iterations)


def refuse_if_empty(name: str, matrix: csr_array, least: NDArray[np.float64], weights: NDArray[np.float64]) -> None:
    """StepFailure(INFEASIBLE) if ``weights`` (m,) >= 0 prove it  (Farkas' lemma).

    Any u with A u >= least has |u| >= least.w / |A^T w|; of an empty set, multipliers grow towards such a w.
    """
    total = combined(matrix, weights)
    if float(least @ weights) > FARTHEST * float(np.sqrt(total @ total)):
        raise StepFailure(
            Status.INFEASIBLE, f"{name} proved all such points to be more than {FARTHEST:g} violations away."
        )
