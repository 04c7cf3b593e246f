"""The Arrow-Hurwicz methods and Uzawa's: step sizes beyond which they do not come to rest."""
# ruff: noqa: RUF001 - formulas for readers are written with Greek letters and minus signs

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

import dincl
from dincl.drifts import attraction, constant
from dincl.minimise import ArrowHurwicz, DampedArrowHurwicz, Minimiser, Stationary, Uzawa, minimise
from verification.thesis.chapter2.stability.boundary import boundary
from verification.thesis.chapter2.stability.case import Case, Found, happens, within
from verification.thesis.chapter2.stability.outcome import row
from verification.thesis.chapter2.stability.plane import Axis, Line, Plane, geometric

Floats = NDArray[np.float64]
TOL = 1e-8
LIMIT = 1000
# A case asks for a residual of SETTLED, a tenth of that of the start, in MOST steps: a factor of 1 - 1/800 a step.
SETTLED, MOST = 0.05, 2000
PRECISION, ALLOWED = 1e-3, 1e-2
METHODS = {
    "arrow_hurwicz": "Arrow-Hurwicz",
    "damped": "damped Arrow-Hurwicz with c dτ = 2",
    "uzawa": "Uzawa with step β",
}


def spring() -> dincl.Problem:
    """Return min x^2/2 for x >= 1, from 1.5: x = 1 with the multiplier 1; Hessian h = 1, |J|^2 = 1."""
    return dincl.Problem([[1.5]], attraction(0), [dincl.HalfSpace(normal=(1,), offset=1.0)])


def weight() -> dincl.Problem:
    """Return min x for x >= 1, from 1.5: the same minimum with h = 0."""
    push = constant(np.array([[-1.0]]))
    return dincl.Problem([[1.5]], push, [dincl.HalfSpace(normal=(1,), offset=1.0)])


def minimiser(method: str, alpha: float, beta: float, gamma: float = 0.0, limit: int = LIMIT) -> Minimiser:
    """Return the method with these steps; the damped one with dtau = 1 and c dtau = 2."""
    if method == "arrow_hurwicz":
        return ArrowHurwicz(alpha=alpha, beta=beta, stop=Stationary(TOL), limit=limit)
    if method == "uzawa":
        return Uzawa(step=beta, stop=Stationary(TOL), limit=limit)
    return DampedArrowHurwicz(
        alpha=alpha, beta=beta, gamma=gamma, damping=2.0, dtau=1.0, stop=Stationary(TOL), limit=limit
    )


def converges(method: str, alpha: float, beta: float) -> bool:
    """Whether it gets near the minimum of ``spring``."""
    limit = MOST // 4 if method == "uzawa" else MOST  # each of its steps is a minimisation
    found = minimise(spring(), minimiser(method, alpha, beta, limit=limit), throw=False)
    return found.residual <= SETTLED


def _alpha() -> Found:
    """alpha (2 h + beta j) = 4 at beta = 1: the eigenvalue -1 of [[1 - a, a], [-b (1 - a), 1 - a b]]."""
    found = boundary(lambda alpha: converges("arrow_hurwicz", alpha, 1.0), 0.3, 1.9, PRECISION)
    return within(4 / 3, found, ALLOWED, "α at β = 1, Arrow-Hurwicz")


def _beta() -> Found:
    found = boundary(lambda beta: converges("arrow_hurwicz", 0.5, beta), 1.0, 50.0, PRECISION)
    return within(6.0, found, ALLOWED, "β at α = 0.5, Arrow-Hurwicz")


def _damped() -> Found:
    """The modulus 1 of a complex pair of [[1 - a h / 2, a / 2], [-b, 1]]: its determinant 1 - a (h - b) / 2."""
    found = boundary(lambda beta: converges("damped", 1.0, beta), 0.2, 5.0, PRECISION)
    return within(1.0, found, ALLOWED, "dτ β at α = 1, damped, γ = 0: β dτ < h")


def _uzawa() -> Found:
    found = boundary(lambda step: converges("uzawa", 1.0, step), 0.3, 9.0, PRECISION)
    return within(2.0, found, ALLOWED, "step of Uzawa, 2 / |B A⁻¹ Bᵀ|")


def _weight() -> Found:
    """h = 0: the determinant is 1, and the pair swings for ever, whatever the steps; gamma damps it."""
    choices = [(alpha, beta) for alpha in (0.01, 0.1) for beta in (0.1, 1.0)]
    swings = [minimise(weight(), minimiser("arrow_hurwicz", *steps), throw=False).status for steps in choices]
    damped = minimise(weight(), minimiser("damped", 0.1, 0.1, gamma=0.1), throw=False)
    reported = sum(status is dincl.Status.NOT_CONVERGED for status in swings)
    words = f"a weight on a floor: {reported} of {len(swings)} choices reach {LIMIT} steps; damped with γ: "
    agrees = reported == len(swings) and bool(damped.status)
    return happens(agrees, f"{words}{damped.status.name} in {damped.iterations}")


def cell(method: str, alpha: float, beta: float) -> dict[str, Any]:
    """Return the minimum of ``spring``, 1."""
    limit = LIMIT // 5 if method == "uzawa" else LIMIT  # each of its steps is a minimisation
    found = minimise(spring(), minimiser(method, alpha, beta, limit=limit), throw=False)
    error = abs(float(found.x[0, 0]) - 1)
    return row(found.status, found.detail, error, found.violation, error)


def _simple(beta: Floats) -> Floats:
    return 4 / (2 + beta)


def _damped_step(beta: Floats) -> Floats:
    """The eigenvalue -1 of the matrix at ``_damped``; where the pair is stable at all."""
    return np.where(beta < 1, 4 / (1 - np.minimum(beta, 1) / 2), np.nan)


PLANE = Plane(
    name="saddle",
    title="the two steps of saddle-point methods",
    x=Axis("α", geometric(0.03, 10.0, 16)),
    y=Axis("β", geometric(0.03, 30.0, 17)),
    methods=METHODS,
    cell=cell,
    lines=(
        Line("α (2 + β) = 4", ("arrow_hurwicz",), _simple),
        Line("β dτ = 1", ("damped",), height=1.0),
        Line("α (1 - β/2) = 4", ("damped",), _damped_step),
        Line("β = 2", ("uzawa",), height=2.0),
    ),
)
CASES = (
    Case("saddle-alpha", "Arrow-Hurwicz beyond its descent step", "α (2h + β|J|²) = 4: α = 4/3", _alpha),
    Case("saddle-beta", "Arrow-Hurwicz beyond its ascent step", "α (2h + β|J|²) = 4: β = 6", _beta),
    Case("saddle-damped", "Damped Arrow-Hurwicz beyond its ascent step", "dτ β = h for c dτ = 2, γ = 0", _damped),
    Case("saddle-uzawa", "Uzawa beyond its step", "2/|B A⁻¹ Bᵀ| = 2", _uzawa),
    Case("saddle-weight", "Arrow-Hurwicz without curvature", "never at rest for h = 0; the damped form is", _weight),
)
