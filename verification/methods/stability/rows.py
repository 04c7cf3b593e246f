"""Rows of discs pressed onto a wall: sweeps carry a push from one neighbour to the next, so long rows need many."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

import dincl
from dincl.drifts import constant
from verification.instruments.stability import Limit, StabilityRuns
from verification.methods.stability.schemes import Map, geometric, some

Floats = NDArray[np.float64]
RADIUS = 0.5
GAP = 0.1
ERROR = 0.02


def packed(n: int) -> Floats:
    """Return where the discs of a row end: 1/2, 3/2, ..., shape (n, 1)."""
    return np.arange(float(n))[:, None] + RADIUS


def pressed(n: float, gap: float = 0.0) -> dincl.Problem:
    """Return n intervals of diameter 1 with gaps, each pressed with the force 1 onto a wall at 0."""
    count = round(n)
    x = packed(count) + gap * np.arange(1, count + 1)[:, None]
    push = constant(np.full((count, 1), -1.0))
    return dincl.Problem(x, push, [dincl.NonOverlap(RADIUS), dincl.HalfSpace(normal=(1,), radius=RADIUS)])


def apart(n: float) -> dincl.Problem:
    """Return a row with gaps."""
    return pressed(n, GAP)


def closed(problem: dincl.Problem) -> Floats:
    """Return where the discs come to rest."""
    return packed(len(problem.x0))


def times(dt: float, n: float) -> Floats:
    """Return times at the end of a run long enough for all gaps to close."""
    return np.linspace(0.9, 1.0, 3) * max(GAP * n + 2.0, 10 * dt)


def sunk(n: int) -> float:
    """Return how deep the last disc of the row sinks in the equilibrium of PBD with one sweep, over dt |F|.

    At rest the moves of a step add up to zero: pair k (of discs k - 1 and k) moves each of its discs by (n - k) dt |F|,
    the wall moves disc 0 by n dt |F|. A pair is closed when it is treated; what later rows do to it stays: pair k + 1
    pushes disc k back by (n - k - 1) dt |F|, and the wall pushes disc 0. The sum of these overlaps is

        n + sum_{k = 1}^{n - 1} (n - k - 1) = n + (n - 1)(n - 2) / 2   for n >= 2.
    """
    return n + (n - 1) * (n - 2) / 2 if n > 1 else 0.0


def longest_row(dt: float) -> float:
    """Return the n with dt sunk(n) = ERROR, the positive root of n^2 - n + 2 = 2 ERROR / dt; NaN if there is none."""
    square = 8 * ERROR / dt - 7
    return (1 + math.sqrt(square)) / 2 if square >= 0 else math.nan


MAP = Map(
    "row",
    "the length of a row",
    StabilityRuns(
        apart,
        some(
            "PBD",
            "PBD with 4 sweeps",
            "PBD with 16 sweeps",
            "XPBD with 16 sweeps",
            "second-order PBD",
            "catch-up with Daqp",
            "springs of 0.3/dt",
            "force as printed of 10",
        ),
        x=("dt", geometric(1 / 256, 1.0, 17), "step dt [time]"),
        y=("n", (2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64, 96), "discs n"),
        t=times,
        reference=closed,
        accurate=ERROR,
        limits=[Limit("PBD, one sweep: error 0.02", longest_row, ["PBD"])],
    ),
)
