"""Discs of chapter 2 that are pushed into each other, and the projections that separate them."""

from __future__ import annotations

import numpy as np

from verification.thesis.chapter1.sets import Floats, apart

RADIUS = 0.5
# What is left of numbers of size 1 after a few hundred operations.
ROUNDING = 1e-12


def separated(x: Floats) -> Floats:
    """Return both discs moved apart by half of their overlap: the formulas of Example 2.5."""
    return apart(x, 2 * RADIUS)


def points_of_step(x: Floats, force: Floats, dt: float) -> list[Floats]:
    """Return p_0 ... p_M of one step of PBD (2.11): pairs (i, j < i) in the order of Algorithm 1."""
    points = [x + dt * force]
    for i in range(len(x)):
        for j in range(i):
            p = points[-1].copy()
            p[[j, i]] = separated(p[[j, i]])
            points.append(p)
    return points


def row(count: int) -> Floats:
    """Return centres of discs that touch each other in a row."""
    return np.column_stack((2 * RADIUS * np.arange(float(count)), np.zeros(count)))
