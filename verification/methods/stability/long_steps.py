"""Long steps: limits of the drift, of penalties, of the prox-regularity radius and of saddle-point methods.

The explicit prediction of a stiff drift has a limit of its own, which no projection lifts.
"""
# ruff: noqa: RUF001 - formulas for readers are written with Greek letters and minus signs

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

import dincl
from dincl.drifts import attraction, constant
from dincl.minimise import ArrowHurwicz, DampedArrowHurwicz, Minimiser, Stationary, Uzawa, minimise
from verification.instruments.outcome import judge
from verification.instruments.stability import Limit, StabilityRuns, judged_run
from verification.methods.stability.schemes import Maker, Map, geometric, some

Floats = NDArray[np.float64]
START: Floats = np.array([[-1.0, 0.2], [1.3, -0.1]])
REST: Floats = np.array([[-0.7, 0.0], [0.7, 0.0]])
FIRST, SECOND = ("PBD", "linearised with Daqp", "midpoint with Daqp"), "second-order PBD"


@dataclass(frozen=True)
class Springs:
    """F = -rate (x - REST): each of two discs is drawn to its own place; picklable."""

    rate: float

    def __call__(self, t: float, x: Floats) -> Floats:
        """The force."""
        return -self.rate * (x - REST)


def drawn(rate: float) -> dincl.Problem:
    """Return two discs that end 1.4 apart and touch only when they are thrown about."""
    return dincl.Problem(START, Springs(rate), [dincl.NonOverlap(0.5)])


def exact(rate: float, t: Floats, *, newton: bool) -> Floats:
    """Return REST + e^{-rate t} (x0 - REST), or with cos(sqrt(rate) t) for Newton's equation, shape (K, 2, 2)."""
    left: Floats = np.cos(np.sqrt(rate) * t) if newton else np.exp(-rate * t)
    return REST + left[:, None, None] * (START - REST)


def run_drift(scheme: Maker, dt: float, rate: float) -> dict[str, Any]:
    """Run until t = 3, or for 30 steps; output times lie on the steps."""
    steps = max(30, int(np.ceil(3.0 / dt)))
    t = np.round(np.array([0.5, 0.8, 1.0]) * steps) * dt
    right = exact(rate, t, newton=scheme is dincl.SecondOrderPBD)
    return judged_run(drawn(rate), scheme(dt=dt), t, right, reach=float(np.abs(START).max()))


DRIFT = Map(
    "drift",
    "the stiffness of the drift",
    StabilityRuns(
        None,
        {label: partial(run_drift, scheme) for label, scheme in some(*FIRST, SECOND).items()},
        x=("dt", geometric(1e-2, 10.0, 25), "step dt [time]"),
        y=("rate", geometric(0.1, 100.0, 19), "rate k [1/time]"),
        limits=[
            Limit("dt k = 2", lambda dt: 2 / dt, FIRST),
            Limit("dt √k = 2", lambda dt: 4 / dt**2, [SECOND]),
        ],
    ),
)


# The penalty method beyond its stability limit, and the force as printed, which has no limit and never rests.

OVERLAP = 0.1
SPRINGS, PRINTED = "springs", "force as printed"


def slit() -> dincl.Problem:
    """Return an interval in a slit that just fits, pressed to one side by the force 1: it cannot move."""
    walls = [dincl.HalfSpace(normal=(side,), offset=-0.5, radius=0.5) for side in (1.0, -1.0)]
    return dincl.Problem([[0.0]], constant(np.array([[1.0]])), walls)


def at_rest(problem: dincl.Problem) -> NDArray[np.float64]:
    """Return the start."""
    return problem.x0


def times(dt: float) -> NDArray[np.float64]:
    """Return the times of the last ten steps: chatter repeats after a few."""
    steps = max(60, math.ceil(2 / dt))
    return np.asarray(dt * np.arange(steps - 10, steps + 1), dtype=np.float64)


PENALTY = Map(
    "penalty",
    "the strength of a penalty",
    StabilityRuns(
        slit(),
        {SPRINGS: dincl.Penalty, PRINTED: partial(dincl.Penalty, exponent=1)},
        x=("dt", geometric(1e-3, 1.0, 37), "step dt [time]"),
        y=("strength", geometric(0.5, 1000.0, 37)),
        t=times,
        reference=at_rest,
        feasible=OVERLAP,
        limits=[
            Limit("dt · strength = 2", lambda dt: 2 / dt, [SPRINGS]),
            Limit("1/strength = 0.1", 1 / OVERLAP, [SPRINGS]),
            Limit("dt · strength = 0.1", lambda dt: OVERLAP / dt, [PRINTED]),
            Limit("strength = load", 1.0, [PRINTED]),
        ],
    ),
)


# Steps longer than the prox-regularity radius: the nearest point is on the other side.

STEPS = 20
SWEEPS, SEARCH = ("PBD", "PBD with 16 sweeps"), ("catch-up with Ipopt", "catch-up with Daqp")


def opening(c: float) -> tuple[dincl.Problem, float]:
    """Return a point pressed down above the gap of two obstacles of radius 1 at (+-c, 0), and its height h at rest.

    h = sqrt(1 - c^2) is the prox-regularity radius: (0, 0) is as far from (0, h) as from (0, -h).
    """
    height = math.sqrt(1 - c**2)
    obstacles = [dincl.OutsideBall(centre=(side * c, 0.0), distance=1.0) for side in (1, -1)]
    return dincl.Problem([[0.0, height]], constant(np.array([[0.0, -1.0]])), obstacles), height


def run_into_gap(scheme: Maker, c: float, part: float) -> dict[str, Any]:
    """Make steps of ``part`` times h; exactly, the point rests at (0, h)."""
    problem, height = opening(c)
    dt = part * height
    return judged_run(problem, scheme(dt=dt), dt * np.array([STEPS / 2, STEPS]), [[0.0, height]])


METHODS = some(
    *SWEEPS,
    *SEARCH,
    "linearised with Daqp",
    "midpoint with Daqp",
    "springs of 0.3/dt",
    "force as printed of 10",
)
RADIUS = Map(
    "radius",
    "the prox-regularity radius",
    StabilityRuns(
        None,
        {label: partial(run_into_gap, scheme) for label, scheme in METHODS.items()},
        x=("c", tuple(round(float(c), 12) for c in np.linspace(0.1, 0.98, 17)), "half distance c [length]"),
        y=("part", geometric(0.02, 4.0, 28), "step / η"),
        limits=[Limit("step = η", 1.0, SWEEPS), Limit("step = 2η", 2.0, SEARCH)],
    ),
)


# The Arrow-Hurwicz methods and Uzawa's: step sizes beyond which they do not come to rest.

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


def run_saddle(method: str, alpha: float, beta: float) -> dict[str, Any]:
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


SADDLE = Map(
    "saddle",
    "the two steps of saddle-point methods",
    StabilityRuns(
        None,
        {method: partial(run_saddle, method) for method in (PLAIN, DAMPED, UZAWA)},
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
