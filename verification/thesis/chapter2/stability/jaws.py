"""Sets that move: a linearised set that is empty though the set is not, and walls that leave no room at all."""
# ruff: noqa: RUF001 - formulas for readers are written with Greek letters and minus signs

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

import dincl
from dincl.drifts import constant
from verification.thesis.chapter2.stability.boundary import boundary
from verification.thesis.chapter2.stability.case import Case, Found, within
from verification.thesis.chapter2.stability.contestants import CONTESTANTS, named
from verification.thesis.chapter2.stability.outcome import measured
from verification.thesis.chapter2.stability.plane import Axis, Line, Plane, geometric

Floats = NDArray[np.float64]
# Height of the point when the jaws touch it, height of the ceiling, and how far a jaw travels. Their radius is 1.
LOW, CEILING, TRAVEL = 0.1, 1.0, 0.4
APART = math.sqrt(1 - LOW**2)
PRECISION = 1e-4
# Two walls that close on an interval of diameter 1 at the speed 1 each, from this distance.
OPEN = 2.0


@dataclass(frozen=True)
class Along:
    """t -> t velocity; picklable."""

    velocity: tuple[float, ...]

    def __call__(self, t: float) -> Floats:
        """The displacement."""
        return t * np.array(self.velocity)


def jaws(speed: float) -> dincl.Problem:
    """Return two discs of radius 1 at (+-a, 0), a = sqrt(1 - 0.01) - speed t, that squeeze a point up to a ceiling.

    The point is drawn downwards with the force 1, so it stays on both jaws: y = sqrt(1 - a^2), which is below the
    ceiling for all a > 0.
    """
    obstacles = [
        dincl.Moving(dincl.OutsideBall(centre=(side * APART, 0.0), distance=1.0), Along((-side * speed, 0.0)))
        for side in (1, -1)
    ]
    ceiling = dincl.HalfSpace(normal=(0, -1), offset=-CEILING)
    return dincl.Problem([[0.0, LOW]], constant(np.array([[0.0, -1.0]])), [*obstacles, ceiling])


def height(travel: float) -> float:
    """Return where the point is once each jaw has moved by ``travel``."""
    return math.sqrt(1 - (APART - travel) ** 2)


def linearised_height(travel: float) -> float:
    """Return the least height in S~ after a first step in which each jaw moves by ``travel``.

    At x = (0, y) the jaws have the rows rho - 1 + ((-+a z_1) + y (z_2 - y)) / rho >= 0, rho^2 = a^2 + y^2. Their sum
    is free of z_1: z_2 >= y + rho (1 - rho) / y, which exceeds every ceiling as y -> 0.
    """
    rho = math.hypot(APART - travel, LOW)
    return LOW + rho * (1 - rho) / LOW


def _not_empty(method: str, travel: float) -> bool:
    path = dincl.solve(jaws(1.0), CONTESTANTS[method].scheme(travel), t=travel, throw=False)
    if not path.status and path.status is not dincl.Status.INFEASIBLE:
        raise RuntimeError(f"{method} at {travel:g}: {path.status.name}, neither solved nor empty")
    return bool(path.status)


def longest_step() -> float:
    """Return the travel of a step at which S~ becomes empty."""
    return boundary(lambda travel: linearised_height(travel) <= CEILING, 0.01, 0.4, 1e-12)


def _empty(method: str) -> Found:
    found = boundary(partial(_not_empty, method), 0.01, 0.4, PRECISION)
    return within(longest_step(), found, 2 * PRECISION, f"travel of a jaw in a step, {CONTESTANTS[method].label}")


def _exists() -> Found:
    """Ipopt projects onto S itself, which is not empty."""
    travel = 1.5 * longest_step()
    path = dincl.solve(jaws(1.0), CONTESTANTS["catch_up_ipopt"].scheme(travel), t=travel, throw=False)
    found = float(path.final[0, 1])
    linearised = [name for name in ("linearised_daqp", "linearised_clarabel") if not _not_empty(name, travel)]
    words = f"height after a step of 1.5 times that length; at the same step {', '.join(linearised)} find S~ empty"
    checked = within(height(travel), found, 1e-6, words)
    return checked._replace(agrees=checked.agrees and len(linearised) == 2)


def closing() -> dincl.Problem:
    """Return a disc of diameter 1 between two walls, 2 apart, that close at the speed 1 each: no room after t = 1/2."""
    walls = [
        dincl.Moving(dincl.HalfSpace(normal=(side, 0), offset=-OPEN / 2, radius=0.5), Along((side, 0.0)))
        for side in (1.0, -1.0)
    ]
    return dincl.Problem([[0.2, 0.0]], constant(np.array([[0.3, 0.0]])), walls)


def _room(method: str, end: float) -> bool:
    return bool(dincl.solve(closing(), CONTESTANTS[method].scheme(0.01), t=end, throw=False).status)


def _closing(method: str) -> Found:
    found = boundary(partial(_room, method), 0.1, 1.0, PRECISION)
    return within((OPEN - 1) / 2, found, 2 * PRECISION, f"time at which the set is found empty, {method}")


def _unnoticed() -> Found:
    path = dincl.solve(closing(), dincl.PBD(dt=0.01), t=0.75)
    overlap = float(path.violation()[-1])
    words = f"PBD ends with {path.status.name}; the last wall is met, the other is missed by all that is missing"
    return within(0.5, overlap, 1e-9, words)


def cell(method: str, dt: float, speed: float) -> dict[str, Any]:
    """Run while the jaws move by TRAVEL each."""
    end = TRAVEL / speed
    exact = [[[0.0, height(part * TRAVEL)]] for part in (0.5, 1.0)]
    steps = math.ceil(end / dt * (1 - 1e-12))
    # States between two steps are interpolated; so look at whole steps, at the middle or before it.
    middle = max(1, steps // 2) / max(1, steps)
    exact[0] = [[0.0, height(middle * TRAVEL)]]
    times, wanted = ([middle * end, end], exact) if steps > 1 else ([end], exact[1:])
    return measured(jaws(speed), CONTESTANTS[method].scheme(dt), times, wanted)


def _empty_line(speed: Floats) -> Floats:
    return longest_step() / speed


PLANE = Plane(
    name="jaws",
    title="the speed of moving sets",
    x=Axis("step dt", geometric(4e-3, 0.4, 16)),
    y=Axis("speed of a jaw", geometric(0.2, 10.0, 11)),
    methods=named(
        "pbd",
        "catch_up_ipopt",
        "catch_up_daqp",
        "linearised_daqp",
        "linearised_clarabel",
        "midpoint_daqp",
        "penalty_tied",
        "penalty_printed",
    ),
    cell=cell,
    lines=(
        Line("S̃ empty in the first step", ("catch_up_daqp", "linearised_daqp", "linearised_clarabel"), _empty_line),
    ),
)
CASES = (
    *(
        Case(
            f"empty-{method}",
            f"An empty linearised set, {CONTESTANTS[method].label}",
            "y + ρ(1 − ρ)/y = ceiling, ρ² = a² + y²",
            partial(_empty, method),
        )
        for method in ("linearised_daqp", "linearised_clarabel", "linearised_gauss_seidel")
    ),
    Case("empty-but-not-s", "The same step, projected onto S itself", "y = √(1 − a²), Ipopt finds it", _exists),
    *(
        Case(
            f"closing-{method}",
            f"Walls that leave no room, {CONTESTANTS[method].label}",
            "the set is empty once the walls are a diameter apart",
            partial(_closing, method),
        )
        for method in ("catch_up_ipopt", "linearised_daqp")
    ),
    Case("closing-pbd", "Walls that leave no room, PBD", "not noticed: the last wall wins", _unnoticed),
)
