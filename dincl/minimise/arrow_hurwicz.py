"""The Arrow-Hurwicz method, which is the nonlinear Uzawa method of the appendix."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from dincl.checks import number
from dincl.minimise.base import AHEAD, LIMIT, Iteration, Minimiser, check_choices

if TYPE_CHECKING:
    from dincl.minimise.iteration_rows import Point
    from dincl.minimise.stop import Stop
    from dincl.problem import Problem


@dataclass(frozen=True)
class ArrowHurwicz(Minimiser):
    """z_{n+1} = z_n - alpha (grad W(z_n) - J(z_n)^T lambda_n),  lambda_{n+1} = max(0, lambda_n - beta g(z_{n+1})).

    Method 3.3 with the signs that the optimality conditions ask for: as printed, the multiplier of a violated row stays
    zero. With equality constraints it is the nonlinear Uzawa method of section 1.2 of the appendix.

    Near a minimum where the Hessian of the Lagrangian is H, it converges when all pairs (h, j) of eigenvalues of H and
    J^T J with a common eigenvector obey alpha h > 0 and alpha (2 h + beta j) < 4. It does not where h = 0, as for a
    weight on a floor, which swings for ever, nor where H is not positive in the directions of the constraints, as
    happens for discs when their distances are squared.

    Parameters
    ----------
    alpha, beta
        Step sizes > 0 of the descent in z and the ascent in lambda.
    stop
        ``Stationary(tol)`` or ``RelativeMove(eps)``.
    limit
        Steps after which it gives up.
    squared
        Take distances as |X_i - X_j|^2 - L^2 [length^2], as chapter 3 does, in place of |X_i - X_j| - L; the units of
        beta and lambda change accordingly. Other rows stay as they are.
    """

    alpha: float
    beta: float
    stop: Stop
    limit: int = LIMIT
    squared: bool = False

    def __post_init__(self) -> None:
        for name in ("alpha", "beta"):
            object.__setattr__(self, name, number(name, getattr(self, name), positive=True))
        check_choices(self.stop, self.limit, self.squared)

    def start(self, problem: Problem) -> Iteration:
        return _ArrowHurwicz(problem, self)


class _ArrowHurwicz(Iteration):
    def __init__(self, problem: Problem, method: ArrowHurwicz) -> None:
        super().__init__(problem, squared=method.squared, ahead=AHEAD)
        self._method = method

    def step(self, point: Point) -> None:
        method, rows = self._method, self.rows
        self.move(point.x - method.alpha * (point.gradient - point.pull(point.multipliers)))
        rows.set(np.maximum(0.0, rows.multipliers - method.beta * rows.values(self.x)))
