"""Crowding: a box that closes on a row of intervals until they fill it, and beyond."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

import dincl
from dincl.drifts import constant
from verification.thesis.chapter2.stability.contestants import CONTESTANTS, named
from verification.thesis.chapter2.stability.jaws import Along
from verification.thesis.chapter2.stability.outcome import measured
from verification.thesis.chapter2.stability.plane import Axis, Line, Plane, even, geometric

Floats = NDArray[np.float64]
COUNT, RADIUS = 8, 0.5
METHODS = (
    "pbd",
    "pbd_16",
    "catch_up_ipopt",
    "catch_up_daqp",
    "linearised_daqp",
    "linearised_gauss_seidel",
    "penalty_tied",
    "penalty_100",
)
# Part of the box that is filled at the start; the box closes in one unit of time.
FILLED = 0.4


def start() -> Floats:
    """Return unequal gaps, shape (8, 1)."""
    gaps = np.random.default_rng(8).dirichlet(np.ones(COUNT + 1))[:COUNT] * COUNT * (1 / FILLED - 1)
    return (np.cumsum(gaps) + np.arange(COUNT) + RADIUS)[:, None]


def box(fraction: float) -> dincl.Problem:
    """Return a box whose right wall moves until the intervals fill ``fraction`` of it at t = 1; no drift."""
    first = COUNT / FILLED
    right = dincl.Moving(
        dincl.HalfSpace(normal=(-1,), offset=-first, radius=RADIUS), Along((COUNT / fraction - first,))
    )
    walls = [dincl.HalfSpace(normal=(1,), radius=RADIUS), right]
    return dincl.Problem(start(), constant(np.zeros((COUNT, 1))), [dincl.NonOverlap(RADIUS), *walls])


def exact(fraction: float) -> Floats:
    """Return x_i = min(x_i(0), the place in a row packed against the wall); NaN where the intervals do not fit."""
    if fraction > 1:
        return np.full((COUNT, 1), np.nan)
    pushed = COUNT / fraction - RADIUS - np.arange(COUNT)[::-1, None]
    return np.asarray(np.minimum(start(), pushed))


def cell(method: str, dt: float, fraction: float) -> dict[str, Any]:
    """Judge a run at t = 1."""
    return measured(box(fraction), CONTESTANTS[method].scheme(dt), [1.0], exact(fraction))


PLANE = Plane(
    name="crowding",
    title="the crowding of a closing box",
    x=Axis("step dt", geometric(1e-2, 1.0, 11)),
    y=Axis("part of the box filled", even(0.45, 1.1, 14), logarithmic=False),
    methods=named(*METHODS),
    cell=cell,
    lines=(Line("all that fits", METHODS, height=1.0),),
)
