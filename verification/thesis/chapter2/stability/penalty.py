"""The penalty method beyond its stability limit, and the force as printed, which has no limit and never rests."""

from __future__ import annotations

import math
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

import dincl
from dincl.drifts import attraction, constant
from verification.thesis.chapter2.stability.boundary import boundary
from verification.thesis.chapter2.stability.case import Case, Found, within
from verification.thesis.chapter2.stability.outcome import OVERLAP, measured
from verification.thesis.chapter2.stability.plane import Axis, Line, Plane, geometric
from verification.thesis.chapter2.stability.rows import pressed

Floats = NDArray[np.float64]
RADIUS = 0.5
DT = 1e-3
# A run is at rest if it moves, in its last step, by less than this part of dt |F|.
RESTING = 1e-2
# At the distance e from the limit a step changes the error by the factor 1 -+ 2 e: PRECISION STEPS is 6.
STEPS = 1500
PRECISION = 4e-3
# A load and a strength without a common measure, so that chatter does not become periodic.
IRRATIONAL = math.sqrt(2)


def limit(problem: dincl.Problem) -> float:
    """Return 2 / lambda_max(J J^T) of the closed rows, which bounds dt strength in z' = -strength J^T J z."""
    matrix = problem.rows_within(0.0, problem.x0, RADIUS / 10).jacobian(problem.x0).toarray()
    return 2 / float(np.linalg.eigvalsh(matrix @ matrix.T)[-1])


def pair() -> dincl.Problem:
    """Return two discs that are pressed together along the diagonal."""
    push = np.array([[0.6, 0.8], [-0.6, -0.8]])
    return dincl.Problem([[0.0, 0.0], [0.6, 0.8]], constant(push), [dincl.NonOverlap(RADIUS)])


def hexagon() -> dincl.Problem:
    """Return seven discs, densely packed and drawn to the middle one; a little off, so that every mode is excited."""
    angle = np.arange(6) * np.pi / 3
    ring = np.column_stack((np.cos(angle), np.sin(angle)))
    x = 1.002 * np.vstack(([[0.0, 0.0]], ring)) + 5e-4 * np.random.default_rng(3).uniform(-1, 1, (7, 2))
    return dincl.Problem(x, attraction(0), [dincl.NonOverlap(RADIUS)])


def rests(problem: dincl.Problem, strength: float, dt: float = DT) -> bool:
    """Whether springs of this strength come to rest."""
    end = STEPS * dt
    path = dincl.solve(problem, dincl.Penalty(dt=dt, strength=strength), t=[end - dt, end], throw=False)
    load = float(np.abs(problem.drift(0.0, problem.x0)).max())
    return bool(path.status) and float(np.abs(path.x[-1] - path.x[-2]).max()) <= RESTING * dt * load


def find_limit(problem: dincl.Problem, expected: float, allowed: float, words: str) -> Found:
    """Find the dt strength at which the springs stop coming to rest, by bisection between half and twice the limit."""
    found = DT * boundary(partial(rests, problem), expected / DT / 2, 2 * expected / DT, PRECISION)
    return within(expected, found, allowed, words)


def _wall() -> Found:
    return find_limit(pressed(1), 2.0, 2 * PRECISION, "one disc on a wall")


def _pair() -> Found:
    return find_limit(pair(), 1.0, 2 * PRECISION, "two discs pressed together")


def row_limit(n: int) -> float:
    """Return 2 / (2 + 2 cos(2 pi / (2 n + 1))): n discs on a wall, J J^T = tridiag(-1, 2, -1), but 1 at the wall."""
    return 1 / (1 + math.cos(2 * math.pi / (2 * n + 1)))


def _row(n: int) -> Found:
    return find_limit(pressed(n), row_limit(n), 2 * PRECISION, f"{n} discs in a row on a wall")


def _hexagon() -> Found:
    # The load adds terms of size load / strength = O(dt), and the ring has slack in its first steps.
    return find_limit(hexagon(), limit(hexagon()), 1e-2, "seven discs, twelve contacts")


def chatter(dt: float, strength: float) -> float:
    """Measure how far a disc that the force 1 presses onto a wall moves to and fro, under the force as printed."""
    path = dincl.solve(pressed(1), dincl.Penalty(dt=dt, strength=strength, exponent=1), t=dt * np.arange(1000, 2001))
    return float(np.ptp(path.x))


def _printed() -> Found:
    strengths = (IRRATIONAL, 10 * IRRATIONAL, 100 * IRRATIONAL)
    ratios = [chatter(dt, s) / (dt * s) for dt in (1e-1, 1e-2, 1e-3, 1e-4) for s in strengths]
    agrees = max(ratios) <= 1 + 1e-9 and min(ratios) > 0.95
    return Found(
        1.0,
        min(ratios),
        agrees,
        f"range / (dt strength) is {min(ratios):.3f} ... {max(ratios):.3f} for dt from 1e-4 to 0.1, strengths from "
        f"{strengths[0]:.1f} to {strengths[-1]:.0f}: it never rests, however small the step, and never blows up",
    )


def cell(method: str, dt: float, strength: float) -> dict[str, Any]:
    """Return an interval in a slit that just fits, pressed to one side by the force 1: it cannot move."""
    walls = [dincl.HalfSpace(normal=(side,), offset=-RADIUS, radius=RADIUS) for side in (1.0, -1.0)]
    problem = dincl.Problem([[0.0]], constant(np.array([[1.0]])), walls)
    scheme = dincl.Penalty(dt=dt, strength=strength, exponent=2 if method == "penalty_springs" else 1)
    steps = max(60, math.ceil(2 / dt))
    return measured(problem, scheme, dt * np.arange(steps - 10, steps + 1), problem.x0)


def _stable(strength: Floats) -> Floats:
    return 2 / strength


def _chatters(strength: Floats) -> Floats:
    return OVERLAP / strength


PLANE = Plane(
    name="penalty",
    title="the strength of a penalty",
    x=Axis("step dt", geometric(1e-3, 1.0, 37)),
    y=Axis("strength", geometric(0.5, 1000.0, 37)),
    methods={"penalty_springs": "springs", "penalty_push": "force as printed"},
    cell=cell,
    lines=(
        Line("dt · strength = 2", ("penalty_springs",), _stable),
        Line("1/strength = 0.1", ("penalty_springs",), height=1 / OVERLAP),
        Line("dt · strength = 0.1", ("penalty_push",), _chatters),
        Line("strength = load", ("penalty_push",), height=1.0),
    ),
)
CASES = (
    Case("penalty-wall", "Springs, one disc on a wall", "unstable beyond dt k |J Jᵀ| = 2: dt k = 2", _wall),
    Case("penalty-pair", "Springs, two discs", "|J Jᵀ| = 2: dt k = 1", _pair),
    *(
        Case(
            f"penalty-row-{n}",
            f"Springs, a row of {n} on a wall",
            "λ_max(J Jᵀ) = 2 + 2 cos(2π/(2n + 1)) → 4",
            partial(_row, n),
        )
        for n in (2, 4, 8)
    ),
    Case("penalty-dense", "Springs, seven discs packed densely", "dt k = 2/λ_max(J Jᵀ), numerically", _hexagon),
    Case(
        "penalty-printed",
        "The force as printed",
        "constant in size, so a disc chatters at every dt: its range over dt k",
        _printed,
    ),
)
