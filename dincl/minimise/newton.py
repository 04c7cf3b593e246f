"""Free minima by Newton's method with conjugate gradients, from gradients alone: a Problem does not tell its energy."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from dincl.checks import bounded
from dincl.errors import StepFailure
from dincl.status import Status

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    Slope = Callable[[NDArray[np.float64]], NDArray[np.float64]]

MOST_STEPS = 100
# Changes of the length of a step; 2^60 spans all lengths that matter.
MOST_LENGTHS = 60
# A step may leave this part of the slope along it.
FLAT = 0.9
# Newton's equations are solved to this part of their right side, or to the slope itself where that is smaller.
FORCING = 0.1
# Difference quotients balance rounding and curvature.
QUOTIENT = math.sqrt(np.finfo(np.float64).eps)


def free_minimum(slope: Slope, x: NDArray[np.float64], tol: float) -> tuple[NDArray[np.float64], int]:
    """A point near x (n,) where max |slope| <= tol, for slope = grad f, and the steps to it; each goes downhill in f.

    StepFailure where f falls for ever or the steps do not end.
    """
    gradient = slope(x)
    for k in range(MOST_STEPS):
        if float(np.abs(gradient).max()) <= tol:
            return x, k
        x, gradient = _along(slope, x, gradient, _direction(slope, x, gradient))
    raise StepFailure(Status.NOT_CONVERGED, f"The Lagrangian was not minimised in {MOST_STEPS} Newton steps.")


def _direction(slope: Slope, x: NDArray[np.float64], gradient: NDArray[np.float64]) -> NDArray[np.float64]:
    """-H^{-1} gradient, or what conjugate gradients have of it when they meet a direction without curvature."""
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
    """x + t d with |slope . d| at most FLAT of what it is at x, and the slope there: t = 1, doubled, or bisected."""
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
