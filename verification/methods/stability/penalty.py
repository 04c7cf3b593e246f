"""The penalty method beyond its stability limit, and the force as printed, which has no limit and never rests."""

from __future__ import annotations

import math
from functools import partial

import numpy as np
from numpy.typing import NDArray

import dincl
from dincl.drifts import constant
from verification.instruments.stability import Limit, StabilityRuns
from verification.methods.stability.schemes import Map, geometric

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


MAP = Map(
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
