"""What curved rows of every kind have in common: the nearest point of a single one."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from dincl.errors import StepFailure
from dincl.rows.affine import linearised
from dincl.rows.base import RowsOfOneKind
from dincl.rows.sweeper import Sweeper
from dincl.status import Status

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from dincl.work import Work

# A row is projected until a step moves less than this, relative to the first or to x; never more than LIMIT.
NEWTON_TOLERANCE = 1e-13
NEWTON_LIMIT = 50


class CurvedRows(RowsOfOneKind):
    """Rows that are not affine: a kind of them needs no formula for its projections."""

    def sweeper(self, d: int) -> Sweeper:
        return CurvedSweeper(self)


class CurvedSweeper(Sweeper):
    """Nearest point of {g_k >= 0} for one row k after another, by relinearising at the point reached.

    The fixed point x = y + multiplier grad g_k(x) with g_k(x) = 0 is the nearest point of a violated set; the
    footnote to Method 2.2 stops after the first of these Gauss-Newton steps, which is exact for affine rows only.
    """

    def __init__(self, rows: CurvedRows) -> None:
        self._rows = [rows.take(np.arange(len(rows)) == k) for k in range(len(rows))]
        self.idle = not self._rows

    def sweep(self, t: float, x: NDArray[np.float64], work: Work) -> None:
        for row in self._rows:
            if row.values(x)[0] < 0:
                x[:] = _nearest(row, x.copy())
                work.constraint_projections += 1


def _nearest(row: RowsOfOneKind, y: NDArray[np.float64]) -> NDArray[np.float64]:
    x, first = y, 0.0
    for _ in range(NEWTON_LIMIT):
        linear = linearised(row, x)
        gradient = linear.matrix.dense()
        norm2 = float((gradient * gradient).sum())
        if norm2 == 0:
            name = row.label(0, y.shape[1])
            raise StepFailure(Status.CONSTRAINT_FAILED, f"A violated constraint has gradient zero: {name}.")
        lack = max(float(linear.bound[0] - gradient[0] @ y.ravel()), 0.0)
        nearer = y + (lack / norm2 * gradient).reshape(y.shape)
        moved = float(np.abs(nearer - x).max())
        first = first or moved
        x = nearer
        if moved <= NEWTON_TOLERANCE * max(first, float(np.abs(x).max())):
            return x
    name = row.label(0, y.shape[1])
    raise StepFailure(Status.NOT_CONVERGED, f"The projection onto {name} took more than {NEWTON_LIMIT} steps.")
