"""The Arrow-Hurwicz methods and Uzawa's: step sizes beyond which they do not come to rest."""
# ruff: noqa: RUF001 - formulas for readers are written with Greek letters and minus signs

from __future__ import annotations

import math
from functools import partial
from typing import Any

import dincl
from dincl.drifts import attraction
from dincl.minimise import ArrowHurwicz, DampedArrowHurwicz, Minimiser, Stationary, Uzawa, minimise
from verification.instruments.outcome import judge
from verification.instruments.stability import Limit, StabilityRuns
from verification.methods.stability.schemes import Map, geometric

TOL = 1e-8
LIMIT = 1000
PLAIN, DAMPED, UZAWA = "Arrow-Hurwicz", "damped Arrow-Hurwicz with c dτ = 2", "Uzawa with step β"


def spring() -> dincl.Problem:
    """Return min x^2/2 for x >= 1, from 1.5: x = 1 with the multiplier 1; Hessian h = 1, |J|^2 = 1."""
    return dincl.Problem([[1.5]], attraction(0), [dincl.HalfSpace(normal=(1,), offset=1.0)])


def minimiser(method: str, alpha: float, beta: float, gamma: float = 0.0, limit: int = LIMIT) -> Minimiser:
    """Return the method with these steps; the damped one with dtau = 1 and c dtau = 2."""
    stop = Stationary(TOL)
    if method == PLAIN:
        return ArrowHurwicz(alpha=alpha, beta=beta, stop=stop, limit=limit)
    if method == UZAWA:
        return Uzawa(step=beta, stop=stop, limit=limit)
    return DampedArrowHurwicz(alpha=alpha, beta=beta, gamma=gamma, damping=2.0, dtau=1.0, stop=stop, limit=limit)


def run(method: str, alpha: float, beta: float) -> dict[str, Any]:
    """Find the minimum of ``spring``, 1."""
    limit = LIMIT // 5 if method == UZAWA else LIMIT  # each of its steps is a minimisation
    found = minimise(spring(), minimiser(method, alpha, beta, limit=limit), throw=False)
    error = abs(float(found.x[0, 0]) - 1)
    outcome = judge(found.status, error, found.violation, error, accurate=0.02, feasible=0.1)
    numbers = {"error": error, "overlap": found.violation, "growth": error}
    return {"outcome": outcome.value, "status": found.status.name, "detail": found.detail} | numbers


def damped_limit(alpha: float) -> float:
    """Return beta at the eigenvalue -1 of [[1 - a / 2, a / 2], [-b, 1]], where the pair is stable at all, b < 1."""
    beta = 2 - 8 / alpha
    return beta if 0 < beta < 1 else math.nan


MAP = Map(
    "saddle",
    "the two steps of saddle-point methods",
    StabilityRuns(
        None,
        {method: partial(run, method) for method in (PLAIN, DAMPED, UZAWA)},
        x=("alpha", geometric(0.03, 10.0, 16), "α"),
        y=("beta", geometric(0.03, 30.0, 17), "β"),
        limits=[
            Limit("α (2 + β) = 4", lambda alpha: 4 / alpha - 2, [PLAIN]),
            Limit("β dτ = 1", 1.0, [DAMPED]),
            Limit("α (1 - β/2) = 4", damped_limit, [DAMPED]),
            Limit("β = 2", 2.0, [UZAWA]),
        ],
    ),
)
