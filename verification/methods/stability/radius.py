"""Steps longer than the prox-regularity radius: the nearest point is on the other side."""

from __future__ import annotations

import math
from functools import partial
from typing import Any

import numpy as np

import dincl
from dincl.drifts import constant
from verification.instruments.stability import Limit, StabilityRuns, judged_run
from verification.methods.stability.schemes import Maker, Map, geometric, some

STEPS = 20
SWEEPS, SEARCH = ("PBD", "PBD with 16 sweeps"), ("catch-up with Ipopt", "catch-up with Daqp")


def opening(c: float) -> tuple[dincl.Problem, float]:
    """Return a point pressed down above the gap of two obstacles of radius 1 at (+-c, 0), and its height h at rest.

    h = sqrt(1 - c^2) is the prox-regularity radius: (0, 0) is as far from (0, h) as from (0, -h).
    """
    height = math.sqrt(1 - c**2)
    obstacles = [dincl.OutsideBall(centre=(side * c, 0.0), distance=1.0) for side in (1, -1)]
    return dincl.Problem([[0.0, height]], constant(np.array([[0.0, -1.0]])), obstacles), height


def run(scheme: Maker, c: float, part: float) -> dict[str, Any]:
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
MAP = Map(
    "radius",
    "the prox-regularity radius",
    StabilityRuns(
        None,
        {label: partial(run, scheme) for label, scheme in METHODS.items()},
        x=("c", tuple(round(float(c), 12) for c in np.linspace(0.1, 0.98, 17)), "half distance c [length]"),
        y=("part", geometric(0.02, 4.0, 28), "step / η"),
        limits=[Limit("step = η", 1.0, SWEEPS), Limit("step = 2η", 2.0, SEARCH)],
    ),
)
