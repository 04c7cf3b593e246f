"""Stiff drifts: the explicit prediction has a limit of its own, which no projection lifts."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

import dincl
from verification.thesis.chapter2.stability.boundary import boundary
from verification.thesis.chapter2.stability.case import Case, Found, within
from verification.thesis.chapter2.stability.contestants import CONTESTANTS, named
from verification.thesis.chapter2.stability.outcome import measured
from verification.thesis.chapter2.stability.plane import Axis, Line, Plane, geometric

Floats = NDArray[np.float64]
START: Floats = np.array([[-1.0, 0.2], [1.3, -0.1]])
REST: Floats = np.array([[-0.7, 0.0], [0.7, 0.0]])
STEPS = 1000
# Below the limit symplectic Euler swings by up to 1/sqrt(4 - dt^2 k) of the start, so a larger bound than FAR is taken.
BLOWN = 100.0
PRECISION = 1e-3


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


def bounded(method: str, rate: float) -> bool:
    """Whether steps of length 1 stay within BLOWN times the start."""
    path = dincl.solve(drawn(rate), CONTESTANTS[method].scheme(1.0), t=float(STEPS), throw=False)
    return float(np.abs(path.final).max()) <= BLOWN * float(np.abs(START).max())


def _limit(method: str, expected: float) -> Found:
    found = boundary(partial(bounded, method), expected / 2, 2 * expected, PRECISION)
    # Just above the limit the growth over the steps of a run is too small to be seen.
    return within(expected, found, 1e-2, f"dt rate, {CONTESTANTS[method].label}")


def exact(method: str, rate: float, t: Floats) -> Floats:
    """Return REST + e^{-rate t} (x0 - REST), or with cos(sqrt(rate) t) for Newton's equation, shape (K, 2, 2)."""
    left: Floats = np.cos(np.sqrt(rate) * t) if method == "second_order" else np.exp(-rate * t)
    return REST + left[:, None, None] * (START - REST)


def cell(method: str, dt: float, rate: float) -> dict[str, Any]:
    """Run until t = 3, or for 30 steps; output times lie on the steps."""
    steps = max(30, int(np.ceil(3.0 / dt)))
    t = np.round(np.array([0.5, 0.8, 1.0]) * steps) * dt
    return measured(drawn(rate), CONTESTANTS[method].scheme(dt), t, exact(method, rate, t), float(np.abs(START).max()))


def _first(rate: Floats) -> Floats:
    return 2 / rate


def _second(rate: Floats) -> Floats:
    return 2 / np.sqrt(rate)


PLANE = Plane(
    name="drift",
    title="the stiffness of the drift",
    x=Axis("step dt", geometric(1e-2, 10.0, 25)),
    y=Axis("rate k", geometric(0.1, 100.0, 19)),
    methods=named("pbd", "linearised_daqp", "midpoint_daqp", "second_order"),
    cell=cell,
    lines=(
        Line("dt k = 2", ("pbd", "linearised_daqp", "midpoint_daqp"), _first),
        Line("dt √k = 2", ("second_order",), _second),
    ),
)
CASES = (
    Case("drift-pbd", "A stiff drift, PBD", "explicit Euler: dt k = 2", partial(_limit, "pbd", 2.0)),
    Case(
        "drift-second",
        "A stiff drift, second-order PBD",
        "symplectic Euler: dt² k = 4",
        partial(_limit, "second_order", 4.0),
    ),
)
