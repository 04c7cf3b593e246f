"""Stiff drifts: the explicit prediction has a limit of its own, which no projection lifts."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

import dincl
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


def run(scheme: Maker, dt: float, rate: float) -> dict[str, Any]:
    """Run until t = 3, or for 30 steps; output times lie on the steps."""
    steps = max(30, int(np.ceil(3.0 / dt)))
    t = np.round(np.array([0.5, 0.8, 1.0]) * steps) * dt
    right = exact(rate, t, newton=scheme is dincl.SecondOrderPBD)
    return judged_run(drawn(rate), scheme(dt=dt), t, right, reach=float(np.abs(START).max()))


MAP = Map(
    "drift",
    "the stiffness of the drift",
    StabilityRuns(
        None,
        {label: partial(run, scheme) for label, scheme in some(*FIRST, SECOND).items()},
        x=("dt", geometric(1e-2, 10.0, 25), "step dt [time]"),
        y=("rate", geometric(0.1, 100.0, 19), "rate k [1/time]"),
        limits=[
            Limit("dt k = 2", lambda dt: 2 / dt, FIRST),
            Limit("dt √k = 2", lambda dt: 4 / dt**2, [SECOND]),
        ],
    ),
)
