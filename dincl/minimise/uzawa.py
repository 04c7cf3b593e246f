"""Uzawa's method: an exact minimum for given multipliers, then a step for the multipliers."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from dincl.checks import bounded, instance
from dincl.errors import StepFailure
from dincl.matrices import combined
from dincl.minimise.iterate import Iterate
from dincl.minimise.methods import LIMIT, Minimiser, Stationary
from dincl.status import Status

if TYPE_CHECKING:
    from dincl.minimise.iterate import Point
    from dincl.problem import Problem

Slope = Callable[[NDArray[np.float64]], NDArray[np.float64]]

# The inner problem is solved to this part of the tolerance.
INNER = 0.1
MOST_STEPS = 100
# Changes of the length of a step; 2^60 spans all lengths that matter.
MOST_LENGTHS = 60
# A step may leave this part of the slope along it.
FLAT = 0.9
# Newton's equations are solved to this part of their right side, or to the slope itself where that is smaller.
FORCING = 0.1
# Difference quotients balance rounding and curvature.
QUOTIENT = math.sqrt(np.finfo(np.float64).eps)


@dataclass(frozen=True)
class Uzawa(Minimiser):
    """z_{k+1} = argmin_z W(z) - lambda_k . g(z),  lambda_{k+1} = max(0, lambda_k - step g(z_{k+1})).

    Section 1.1 of the appendix, for inequalities: there B x = g, here B x - g >= 0, hence the other sign of lambda and
    max(0, .). For W = x^T A x / 2 - f . x with A positive definite it converges for 0 < step < 2 / |B A^{-1} B^T|.
    It needs a minimum of the Lagrangian for each lambda: not so for energies that are linear, and distances are not
    squared, since W - lambda |X_i - X_j|^2 is soon unbounded below.

    The inner problem is solved by Newton's method with conjugate gradients, downhill from z_k. Where the Lagrangian
    is not convex this is a local minimum, which may jump or vanish when lambda changes.

    Parameters
    ----------
    step
        Step size > 0 of the ascent.
    stop
        ``Stationary(tol)``; the inner problem is solved to a tenth of tol.
    limit
        The largest number of steps.
    """

    step: float
    stop: Stationary
    limit: int = LIMIT

    def __post_init__(self) -> None:
        instance("stop", self.stop, Stationary, "Stationary(tol)")
        self._check(positive=("step",), squared=False)

    def start(self, problem: Problem) -> Iterate:
        # Moves are long at first: rows are listed for where the point is, not for where it may go.
        return Iterate(problem, squared=False, ahead=0.0)

    def advance(self, iterate: Iterate, point: Point) -> None:
        blocks, weights = iterate.take(point.active), point.multipliers[point.active]

        def slope(flat: NDArray[np.float64]) -> NDArray[np.float64]:
            """Evaluate grad W - sum_k lambda_k grad g_k over the rows that have a multiplier."""
            x = flat.reshape(point.x.shape)
            return iterate.gradient(x).ravel() - combined(iterate.jacobian(blocks, x), weights)

        flat, steps = free_minimum(slope, point.x.ravel(), INNER * self.stop.tol)
        iterate.work.count_call("newton_cg", steps)
        iterate.move(flat.reshape(point.x.shape))
        gaps, _, _ = iterate.values(iterate.x)
        iterate.set_multipliers(np.maximum(0.0, iterate.multipliers - self.step * gaps))


def free_minimum(slope: Slope, x: NDArray[np.float64], tol: float) -> tuple[NDArray[np.float64], int]:
    """Find a point near x (n,) where max |slope| <= tol, for slope = grad f, going downhill in f; count the steps.

    Newton's method with conjugate gradients, from gradients alone: a Problem does not define its energy. StepFailure
    where f is unbounded below or the steps do not end.
    """
    gradient = slope(x)
    for k in range(MOST_STEPS):
        if float(np.abs(gradient).max()) <= tol:
            return x, k
        x, gradient = _along(slope, x, gradient, _direction(slope, x, gradient))
    raise StepFailure(Status.NOT_CONVERGED, f"The Lagrangian was not minimised in {MOST_STEPS} Newton steps.")


def _direction(slope: Slope, x: NDArray[np.float64], gradient: NDArray[np.float64]) -> NDArray[np.float64]:
    """Solve H step = -gradient by conjugate gradients, which end early at a direction without curvature."""
    size = float(np.linalg.norm(gradient))
    scale = QUOTIENT * (1 + float(np.linalg.norm(x)))
    step, rest, d = np.zeros_like(x), -gradient, -gradient
    for _ in range(2 * x.size):
        length = scale / float(np.linalg.norm(d))
        bent = (slope(x + length * d) - gradient) / length
        curvature = float(d @ bent)
        if curvature <= 0:
            return step if step.any() else d
        before = float(rest @ rest)
        step = step + before / curvature * d
        rest = rest - before / curvature * bent
        if float(np.linalg.norm(rest)) <= min(FORCING, size) * size:
            break
        d = rest + float(rest @ rest) / before * d
    return step


def _along(
    slope: Slope, x: NDArray[np.float64], gradient: NDArray[np.float64], d: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Double or bisect t until |slope . d| at x + t d is at most FLAT of its value at x; return x + t d and slope."""
    steep = -float(gradient @ d)
    short, t, far = 0.0, 1.0, math.inf
    for _ in range(MOST_LENGTHS):
        there = x + t * d
        if not bounded(there):
            break
        after = slope(there)
        along = float(after @ d)
        if abs(along) <= FLAT * steep:
            return there, after
        if along < 0:
            short, t = t, 2 * t if far == math.inf else (t + far) / 2
        else:
            far, t = t, (short + t) / 2
    raise StepFailure(Status.NOT_CONVERGED, "The Lagrangian has no minimum for the present multipliers.")
