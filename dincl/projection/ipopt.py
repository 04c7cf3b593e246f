"""Projections onto S itself, by the interior-point method Ipopt."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from dincl.errors import StepFailure
from dincl.extras import needs
from dincl.projection.base import Projected, Projection, Solver
from dincl.projection.program_cache import ProgramCache
from dincl.rows.affine import linearised
from dincl.status import Status

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from dincl.projection.nlp import Program
    from dincl.rows.base import Rows

# Compiled programs kept for the next time that the same rows are near.
MOST_PROGRAMS = 64
# Words after which the certificate decides whether the point is good enough.
FOUND = ("Solve_Succeeded", "Search_Direction_Becomes_Too_Small")


@dataclass(frozen=True)
class Ipopt(Projection):
    """Nearest points of S itself, curved and nonconvex, by Ipopt (Waechter, Biegler 2006): min |x - y|^2, g(x) >= 0.

    The answer is a point where the first-order conditions hold, searched from the state before the step. Lengths are in
    units of the largest violation; tolerances are 1e-11 of it, bounds are not relaxed, iterations are limited to 500.
    Rows of distances are polynomials with exact sparse derivatives, so a program is compiled once for the rows that are
    near, not at every step: 19 times in 1,000 steps of ten discs that fall into a corner. Of a start only the point is
    used: multipliers of the last step changed the number of iterations in both directions. What is missing to ``tol``
    is completed on the active rows. Measured on settled piles of discs, one step of gravity, in milliseconds (first,
    with compilation / again): 4 / 1.2 at 4, 7 / 1.5 at 10, 27 / 5.6 at 100, 200 / 56 at 1,000.

    Parameters
    ----------
    tol
        Greatest certified residual of a projection [length].
    """

    def solver(self) -> Solver:
        return _IpoptSolver(self.tol)


class _IpoptSolver(Solver):
    name = "ipopt"

    def __init__(self, tol: float) -> None:
        super().__init__(tol)
        with needs("Ipopt", "yardsticks"):
            from dincl.projection.nlp import Program

        self._compile = Program
        self._programs: ProgramCache[Program] = ProgramCache(MOST_PROGRAMS)

    def compute(self, rows: Rows, y: NDArray[np.float64], guess: NDArray[np.float64]) -> Projected:
        blocks = rows.by_kind()
        scale = float(-rows.values(y).min())
        program = self._programs.get(rows.structure, lambda: self._compile(blocks, y.shape))
        x, lam, work, word = program.solve(blocks, y, guess, scale)
        if word not in FOUND:
            raise StepFailure(Status.NOT_CONVERGED, f"ipopt stopped: {word}.")
        return self.completed(rows, y, self.certify(linearised(rows, x), y, x, lam, work), self.tol)
