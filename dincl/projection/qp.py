"""From quadratic programs to nearest points: what all QP back ends share."""

from __future__ import annotations

from abc import abstractmethod
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from dincl.errors import StepFailure
from dincl.matrices import combined, divided, row_squares
from dincl.projection.base import Projected, Solver
from dincl.rows.affine import linearised
from dincl.status import Status

if TYPE_CHECKING:
    from numpy.typing import NDArray
    from scipy.sparse import csr_array

    from dincl.rows.affine import AffineRows
    from dincl.rows.base import Rows

# Quadratic programs solved for one projection onto a curved set; each shortens the error by about the largest
# multiplier over the distance it acts on.
MOST_RELINEARISATIONS = 60
# A set is called empty when it is proved to be farther away than this many times the largest violation.
FARTHEST = 1e8


class QpAnswer(NamedTuple):
    """Solution u (n,), multipliers (m,) >= 0 and iterations of a least-distance program."""

    u: NDArray[np.float64]
    multipliers: NDArray[np.float64]
    iterations: int


class QpSolver(Solver):
    """Projects onto polyhedra by one quadratic program, and onto curved sets by a sequence of them.

    For curved rows, x <- P_{S~(x)}(y) is repeated, always for the same y: S~ is the inner convex approximation at the
    point reached. A fixed point satisfies the first-order conditions of the nearest point of S itself. This is
    sequential quadratic programming without the curvature of g: it converges while multipliers are shorter than the
    distances they act on, so for steps that are not too long; ``Ipopt`` has no such limit.

    A back end sees each program in the displacement u = (z - y) / s, with rows of unit length and the largest
    violation s, so that its tolerances are relative to the move and not to the coordinates.
    """

    def __init__(self, tol: float) -> None:
        super().__init__(tol)
        self._matrix: csr_array | None = None
        self._multipliers = np.zeros(0)

    def compute(self, rows: Rows, y: NDArray[np.float64], guess: NDArray[np.float64]) -> Projected:
        """x <- P_{S~(x)}(y) until the certificate holds; for affine rows once."""
        linear = linearised(rows, guess)
        affine, iterations = linear is rows, 0
        for _ in range(MOST_RELINEARISATIONS):
            x, multipliers, work = self._onto(linear, y)
            iterations += work
            here = linear if affine else linearised(rows, x)
            found = self.certify(here, y, x, multipliers, iterations)
            if affine or found.residual <= self.tol:
                break
            linear = here
        return found

    def _onto(self, linear: AffineRows, y: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64], int]:
        """Nearest point to y of one polyhedron, its multipliers, iterations; y itself when it lies inside."""
        matrix = linear.matrix
        length = np.sqrt(row_squares(matrix))
        missing = -linear.values(y)
        if ((length == 0) & (missing > 0)).any():
            raise StepFailure(Status.INFEASIBLE, "A violated constraint has the gradient zero.")
        length[length == 0] = 1.0
        missing /= length
        scale = float(missing.max(initial=0.0))
        if scale == 0:
            return y, np.zeros(len(missing)), 0
        unit = divided(matrix, length)
        tol = self.tol / (scale * max(1.0, float(length.max())))
        answer = self.qp(unit, missing / scale, self._recalled(unit, scale) / scale, tol)
        self._matrix, self._multipliers = unit, answer.multipliers * scale
        return y + scale * answer.u.reshape(y.shape), self._multipliers / length, answer.iterations

    def _recalled(self, matrix: csr_array, scale: float) -> NDArray[np.float64]:
        """The last multipliers if they belong to rows that tie the same coordinates, else zeros: a start, no more."""
        last = self._matrix
        same = last is not None and last.shape == matrix.shape and np.array_equal(last.indices, matrix.indices)
        near = same and self._multipliers.max(initial=0.0) <= FARTHEST * scale
        return self._multipliers if near else np.zeros(matrix.shape[0])

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

    def _onto(self, linear: AffineRows, y: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64], int]:
        found = self.completed(linear, y, self.certify(linear, y, *super()._onto(linear, y)))
        return found.point, found.multipliers, found.iterations


def refuse_if_empty(name: str, matrix: csr_array, least: NDArray[np.float64], weights: NDArray[np.float64]) -> None:
    """StepFailure(INFEASIBLE) if ``weights`` (m,) >= 0 prove it  (Farkas' lemma).

    Any u with A u >= least has |u| >= least.w / |A^T w|; of an empty set, multipliers grow towards such a w.
    """
    total = combined(matrix, weights)
    if float(least @ weights) > FARTHEST * float(np.sqrt(total @ total)):
        raise StepFailure(
            Status.INFEASIBLE, f"{name} proved all such points to be more than {FARTHEST:g} violations away."
        )
