"""Nearest points by formula, where there is one."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from dincl.constraints.moving import Moving
from dincl.errors import InvalidProblem, StepFailure
from dincl.matrices import row_squares, stacked
from dincl.projection.base import Projected, Projection, Solver
from dincl.rows.affine import linearised
from dincl.status import Status

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from dincl.problem import Problem
    from dincl.rows.affine import AffineRows
    from dincl.rows.base import Rows, RowsOfOneKind

# Certified residual allowed, in units of the largest length involved: a few roundings. Two directions are taken to be
# at right angles, or parallel, when they are to this precision.
ROUNDING = 1e-14


@dataclass(frozen=True)
class ClosedForm(Projection):
    """Nearest points by formula, exact to rounding, where constraints do not meet or meet at right angles.

    Served are: a ball or an obstacle for each particle; walls that are parallel or at right angles (half space, slab,
    box); one pair that must not overlap or is held together, and more pairs of other particles; ordered pairs. It takes
    no tolerance: the certified residual is at most 1e-14 of the largest length involved.
    """

    tol: float = field(default=ROUNDING, init=False)

    def check(self, problem: Problem) -> None:
        """InvalidProblem, naming the first constraint that leaves no formula."""
        rows: list[RowsOfOneKind] = []
        for constraint in problem.constraints:
            rows.append(constraint.pattern(problem.x0))
            if not _served(rows, len(problem.x0), problem.x0.size):
                name = type(constraint.constraint if isinstance(constraint, Moving) else constraint).__name__
                raise InvalidProblem(
                    f"projection = ClosedForm(): has no formula for {name} together with the constraints before it; "
                    "allowed are those that share no particle, and walls that are at right angles"
                )

    def solver(self) -> Solver:
        return _ClosedFormSolver(self.tol)


class _ClosedFormSolver(Solver):
    name = "closed form"

    def tolerance(self, rows: Rows, y: NDArray[np.float64]) -> float:
        """A few roundings of the largest coordinate or length."""
        return self.tol * max([float(np.abs(y).max()), *(block.longest_length() for block in rows.by_kind())])

    def compute(self, rows: Rows, y: NDArray[np.float64], guess: NDArray[np.float64]) -> Projected:
        """Spheres by their lines, then planes one after another."""
        x = y.copy()
        blocks = rows.by_kind()
        multipliers = np.concatenate([np.zeros(len(block)) if block.affine else block.project(x) for block in blocks])
        flat = np.repeat([block.affine for block in blocks], [len(block) for block in blocks])
        linear = linearised(rows, x)
        multipliers[flat] = _onto_planes(linear.take(flat), x)
        found = self.certify(linearised(rows, x), y, x, multipliers, 1)
        if found.violation > self.tolerance(rows, y):
            raise StepFailure(Status.NOT_CONVERGED, "Parallel walls leave no room between them.")
        return found


def _onto_planes(rows: AffineRows, x: NDArray[np.float64]) -> NDArray[np.float64]:
    """Project x onto the planes of violated rows, in place, and return the multipliers.

    Rows at right angles do not disturb each other; of parallel ones the most violated comes first and settles the rest.
    """
    z, matrix = x.reshape(-1), rows.matrix
    multipliers = np.zeros(len(rows.bound))
    squares = row_squares(matrix)
    missing = -rows.values(x)
    violated = np.flatnonzero(missing > 0)
    for k in violated[np.argsort(-missing[violated] / np.sqrt(squares[violated]), kind="stable")]:
        entries = slice(matrix.indptr[k], matrix.indptr[k + 1])
        places, row = matrix.indices[entries], matrix.data[entries]
        multipliers[k] = max(rows.bound[k] - row @ z[places], 0.0) / squares[k]
        z[places] += multipliers[k] * row
    return multipliers


def _served(blocks: Sequence[RowsOfOneKind], count: int, size: int) -> bool:
    """Whether no particle is in two curved rows, or in one and a wall, and walls are at right angles."""
    curved = [block for block in blocks if not block.affine]
    if not all(block.closed_form for block in curved):
        return False
    used = sum((block.rows_per_particle(count) for block in curved), np.zeros(count, dtype=np.int64))
    if len(curved) == len(blocks):
        return bool(used.max() <= 1)
    walls = stacked([block.jacobian(np.zeros(0)) for block in blocks if block.affine], size)
    walled = np.zeros(count, dtype=np.bool_)
    walled[walls.indices // (size // count)] = True
    gram = (walls @ walls.T).tocoo()
    cosine = np.abs(gram.data) / np.sqrt(gram.diagonal()[gram.row] * gram.diagonal()[gram.col])
    aligned = (cosine <= ROUNDING) | (cosine >= 1 - ROUNDING)
    return bool((used + walled).max() <= 1 and aligned.all())
