"""The damped Arrow-Hurwicz method."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from dincl.checks import number
from dincl.minimise.base import AHEAD, LIMIT, Iteration, Minimiser, check_choices
from dincl.minimise.stop import RelativeMove, Stop

if TYPE_CHECKING:
    from dincl.minimise.contacts import Point
    from dincl.problem import Problem


@dataclass(frozen=True)
class DampedArrowHurwicz(Minimiser):
    """z_{n+1} = (2 z_n - (1 - a) z_{n-1} - dtau^2 p_n) / (1 + a),  lambda_{n+1} = max(0, lambda_n - dtau beta g(z_n)),

    with a = c dtau/2 and p_n = alpha (grad W - J^T lambda_n) + gamma J^T (lambda_n g), all at z_n: Method 3.4, (3.25)
    with max in the place of min. It discretises z'' = -c z' - p, lambda' = -beta g  (3.23), (3.22).

    For c dtau = 2 it is z_{n+1} = z_n - dtau^2 p_n / 2; (3.26) omits the 1/2. Without constraints it converges for
    dtau^2 alpha |D^2 W| < 4, whatever c. At a constraint with multiplier lambda* and curvature h, where the gradient
    has length 1, the system in continuous time is stable just for c (alpha h + gamma lambda*) > alpha beta, and the
    iteration with c dtau = 2 for dtau beta alpha < alpha h + gamma lambda*  (and steps short enough). So a weight on a
    floor comes to rest only if it is heavy enough.

    Parameters
    ----------
    alpha, beta, gamma
        Weights of the descent, of the ascent in lambda, both > 0, and of the term that damps the constraints, >= 0.
    damping, dtau
        c > 0 [1 / units of dtau] and the step dtau > 0.
    stop
        ``RelativeMove(eps)`` is (3.24); ``Stationary(tol)`` asks for the minimum itself.
    limit
        Steps after which it gives up.
    squared
        As in ArrowHurwicz.
    """

    alpha: float
    beta: float
    gamma: float
    damping: float
    dtau: float
    stop: Stop
    limit: int = LIMIT
    squared: bool = False

    def __post_init__(self) -> None:
        for name in ("alpha", "beta", "damping", "dtau"):
            object.__setattr__(self, name, number(name, getattr(self, name), positive=True))
        object.__setattr__(self, "gamma", number("gamma", self.gamma, non_negative=True))
        check_choices(self.stop, self.limit, self.squared)

    @classmethod
    def published(cls, limit: int = LIMIT) -> DampedArrowHurwicz:
        """The parameters of Table 4 of chapter 3, distances squared."""
        return cls(1e-4, 0.25, 1e-3, 2.0, 1.0, RelativeMove(1e-6), limit, squared=True)

    def start(self, problem: Problem) -> Iteration:
        return _Damped(problem, self)


class _Damped(Iteration):
    def __init__(self, problem: Problem, method: DampedArrowHurwicz) -> None:
        super().__init__(problem, squared=method.squared, ahead=AHEAD)
        self._method = method
        self._before = self.x
        self.dtau = method.dtau

    def step(self, point: Point) -> None:
        """One iteration of (3.25) in z and lambda."""
        m = self._method
        drag = m.damping * m.dtau / 2
        weights = point.multipliers * (m.alpha - m.gamma * point.values)
        push = m.dtau**2 * (m.alpha * point.gradient - point.pull(weights))
        x = (2 * point.x - (1 - drag) * self._before - push) / (1 + drag)
        # The rows may change with x, so the multipliers that belong to the old ones come first.
        self.contacts.set(np.maximum(0.0, point.multipliers - m.dtau * m.beta * point.values))
        self.move(x)
        self._before = point.x
