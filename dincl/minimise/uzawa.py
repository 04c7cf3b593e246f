"""Uzawa's method: an exact minimum for given multipliers, then a step for the multipliers."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from dincl.checks import describe, number
from dincl.errors import InvalidProblem
from dincl.matrices import combined
from dincl.minimise.base import LIMIT, Iteration, Minimiser, check_choices
from dincl.minimise.newton import free_minimum
from dincl.minimise.stop import Stationary

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from dincl.minimise.iteration_rows import Point
    from dincl.problem import Problem

# The inner problem is solved to this part of the tolerance.
INNER = 0.1
BACK_END = "newton_cg"


@dataclass(frozen=True)
class Uzawa(Minimiser):
    """z_{k+1} = argmin_z W(z) - lambda_k . g(z),  lambda_{k+1} = max(0, lambda_k - step g(z_{k+1})).

    Section 1.1 of the appendix, for inequalities: there B x = g, here B x - g >= 0, hence the other sign of lambda and
    max(0, .). For W = x^T A x / 2 - f . x with A positive definite it converges for 0 < step < 2 / |B A^{-1} B^T|.
    It needs a minimum of the Lagrangian for each lambda: not so for energies that are linear, and distances are not
    squared, since W - lambda |X_i - X_j|^2 is soon unbounded below.

    The inner problem is solved by Newton's method with conjugate gradients, going down from z_k. Where the Lagrangian
    is not convex this is a local minimum, which may jump or vanish when lambda changes.

    Parameters
    ----------
    step
        Step size > 0 of the ascent.
    stop
        ``Stationary(tol)``; the inner problem is solved to a tenth of tol.
    limit
        Steps after which it gives up.
    """

    step: float
    stop: Stationary
    limit: int = LIMIT

    def __post_init__(self) -> None:
        object.__setattr__(self, "step", number("step", self.step, positive=True))
        if not isinstance(self.stop, Stationary):
            raise InvalidProblem(f"stop = {describe(self.stop)}: must be Stationary(tol)")
        check_choices(self.stop, self.limit, squared=False)

    def start(self, problem: Problem) -> Iteration:
        return _Uzawa(problem, self)


class _Uzawa(Iteration):
    def __init__(self, problem: Problem, method: Uzawa) -> None:
        # Moves are long at first: rows are listed for where the point is, not for where it may go.
        super().__init__(problem, ahead=0.0)
        self._method = method

    def step(self, point: Point) -> None:
        rows = self.rows
        self.move(self._inner(point))
        rows.set(np.maximum(0.0, rows.multipliers - self._method.step * rows.gaps(self.x)))

    def _inner(self, point: Point) -> NDArray[np.float64]:
        """Where grad W = sum_k lambda_k grad g_k, over the rows that have a multiplier."""
        blocks, weights = self.rows.take(point.active), point.multipliers[point.active]

        def slope(flat: NDArray[np.float64]) -> NDArray[np.float64]:
            x = flat.reshape(point.x.shape)
            pull = combined(self.rows.gradients(blocks, x), weights)
            return self.gradient(x).ravel() - pull

        flat, steps = free_minimum(slope, point.x.ravel(), INNER * self._method.stop.tol)
        self.work.count_call(BACK_END, steps)
        return flat.reshape(point.x.shape)
