"""Nearest points by formula, where there is one."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from dincl.checks import LARGEST
from dincl.constraints.moving import Moving
from dincl.constraints.nonoverlap import NonOverlap
from dincl.constraints.rows import AffineRows, DistanceRows
from dincl.csr import stack
from dincl.errors import InvalidProblem, StepFailure
from dincl.projection.base import Projected, Projection, Solver, blocks_of
from dincl.status import Status

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from dincl.constraints.base import Constraint
    from dincl.constraints.rows import Rows, RowsOfOneKind
    from dincl.problem import Problem

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
        rows: list[RowsOfOneKind] = []
        for constraint in problem.constraints:
            rows.append(_all_rows(constraint, problem.x0))
            if not _served(rows, len(problem.x0), problem.x0.size):
                raise InvalidProblem(
                    f"projection = ClosedForm(): has no formula for {_name(constraint)} together with the constraints "
                    "before it; allowed are those that share no particle, and walls that are at right angles"
                )

    def solver(self) -> Solver:
        return _ClosedFormSolver(self.tol)


class _ClosedFormSolver(Solver):
    name = "closed form"

    def tolerance(self, rows: Rows, y: NDArray[np.float64]) -> float:
        """A few roundings of the largest coordinate or length."""
        lengths = [block.length.max(initial=0.0) for block in blocks_of(rows) if isinstance(block, DistanceRows)]
        return self.tol * float(max([np.abs(y).max(), *lengths]))

    def compute(self, rows: Rows, y: NDArray[np.float64], guess: NDArray[np.float64]) -> Projected:
        """Spheres by their lines, then planes one after another."""
        x = y.copy()
        multipliers = np.concatenate([_onto_spheres(block, x) for block in blocks_of(rows)])
        flat = np.concatenate(
            [np.full(len(block.values(y)), isinstance(block, AffineRows)) for block in blocks_of(rows)]
        )
        linear = rows.linearised(x)
        multipliers[flat] = _onto_planes(linear.take(flat), x)
        found = self.certify(rows.linearised(x), y, x, multipliers, 1)
        if found.violation > self.tolerance(rows, y):
            raise StepFailure(Status.INFEASIBLE, "Parallel walls leave no room between them.")
        return found


def _onto_spheres(rows: RowsOfOneKind, x: NDArray[np.float64]) -> NDArray[np.float64]:
    """Move the particles of each violated distance along their line, in place; the multipliers, zero for walls."""
    if not isinstance(rows, DistanceRows):
        return np.zeros(len(rows.values(x)))
    movers = 1 if rows.j is None else 2
    multipliers = np.maximum(-rows.values(x), 0.0) / movers
    violated = rows.take(multipliers > 0)
    pushes = violated.jacobian(x).transposed_times(multipliers[multipliers > 0])
    x += pushes.reshape(x.shape)
    return multipliers


def _onto_planes(rows: AffineRows, x: NDArray[np.float64]) -> NDArray[np.float64]:
    """Project x onto the planes of violated rows, in place, and return the multipliers.

    Rows at right angles do not disturb each other; of parallel ones the most violated comes first and settles the rest.
    """
    z, matrix = x.reshape(-1), rows.matrix
    multipliers = np.zeros(len(rows.bound))
    squares = matrix.norms_squared()
    missing = -rows.values(x)
    violated = np.flatnonzero(missing > 0)
    for k in violated[np.argsort(-missing[violated] / np.sqrt(squares[violated]), kind="stable")]:
        entries = slice(matrix.indptr[k], matrix.indptr[k + 1])
        places, row = matrix.indices[entries], matrix.data[entries]
        multipliers[k] = max(rows.bound[k] - row @ z[places], 0.0) / squares[k]
        z[places] += multipliers[k] * row
    return multipliers


def _all_rows(constraint: Constraint, x0: NDArray[np.float64]) -> RowsOfOneKind:
    """All rows of a constraint; of many discs three are enough to see that there is no formula."""
    if isinstance(constraint, Moving):
        return _all_rows(constraint.constraint, x0 - constraint.displacement(0.0, x0.shape[1]))
    if isinstance(constraint, NonOverlap):
        others = np.arange(1, min(len(x0), 3))
        return DistanceRows(others, np.zeros_like(others), np.ones(len(others)), 1.0)
    return constraint.select(x0, LARGEST)


def _name(constraint: Constraint) -> str:
    return _name(constraint.constraint) if isinstance(constraint, Moving) else type(constraint).__name__


def _served(blocks: Sequence[RowsOfOneKind], count: int, size: int) -> bool:
    """Whether no particle is in two rows of distances, or in one and a wall, and walls are at right angles."""
    used = np.zeros(count, dtype=np.int64)
    flat = []
    for block in blocks:
        if isinstance(block, DistanceRows):
            np.add.at(used, block.i, 1)
            np.add.at(used, block.i[:0] if block.j is None else block.j, 1)
        elif isinstance(block, AffineRows):
            flat.append(block.matrix)
        else:
            return False
    if not flat:
        return bool(used.max() <= 1)
    matrix = stack(flat, size)
    walled = np.zeros(count, dtype=np.bool_)
    walled[matrix.indices // (size // count)] = True
    gram = (matrix.scipy() @ matrix.scipy().T).tocoo()
    cosine = np.abs(gram.data) / np.sqrt(gram.diagonal()[gram.row] * gram.diagonal()[gram.col])
    aligned = (cosine <= ROUNDING) | (cosine >= 1 - ROUNDING)
    return bool((used + walled).max() <= 1 and aligned.all())
