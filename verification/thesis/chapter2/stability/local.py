"""Solvers that find a local minimum only, or reach their limit."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

import dincl
from dincl.drifts import constant
from verification.thesis.chapter2.stability.case import Case, Found, happens, within
from verification.thesis.chapter2.stability.contestants import TOL

Floats = NDArray[np.float64]
RADIUS = 0.5
DISCS, STARTS, DEEP = 7, 10, 0.3
# The valley of Rosenbrock's function: g >= 0 is a thin crooked strip.
STEEP, WIDE = 1e4, 1e-3


def projected(start: Floats, y: Floats, constraints: list[dincl.Constraint], scheme: type[dincl.CatchUp]) -> Floats:
    """Return P_S(y), searched from ``start``, by Ipopt: one catch-up step."""
    problem = dincl.Problem(start, constant(y - start), constraints)
    return dincl.solve(problem, scheme(dt=1.0, projection=dincl.Ipopt(tol=TOL)), t=1.0).final


def _swapped() -> Found:
    """Two intervals predicted past each other by 0.1: it is shorter to let them pass, but Ipopt puts them back."""
    passed = 0.1
    y = np.array([[0.5 + passed / 2], [0.5 - passed / 2]])
    found = projected(np.array([[0.0], [1.0]]), y, [dincl.NonOverlap(RADIUS)], dincl.CatchUp)
    nearest = (1 - passed) / math.sqrt(2)
    words = f"distance (1 + 0.1)/√2, in the old order; the nearest point, in the new order, is {nearest:.4f} away"
    return within((1 + passed) / math.sqrt(2), float(np.linalg.norm(found - y)), 1e-6, words)


def _many() -> Found:
    """Seven discs nearly on one point, searched from ten numberings of a ring."""
    rng = np.random.default_rng(0)
    y = DEEP * rng.normal(size=(DISCS, 2))
    angle = 2 * np.pi * np.arange(DISCS) / DISCS
    ring = 3 * np.column_stack((np.cos(angle), np.sin(angle)))
    away = []
    for _ in range(STARTS):
        found = projected(ring[rng.permutation(DISCS)], y, [dincl.NonOverlap(RADIUS)], dincl.CatchUp)
        away.append(float(np.linalg.norm(found - y)))
    different = len(np.unique(np.round(away, 6)))
    words = f"{different} points that meet the first-order conditions, {min(away):.3f} ... {max(away):.3f} away"
    return happens(different > 1, words)


def _strip(x: Floats) -> Floats:
    a, b = x[0]
    return np.array([WIDE - STEEP * (b - a * a) ** 2 - (1 - a) ** 2])


def _slope(x: Floats) -> Floats:
    a, b = x[0]
    return np.array([[4 * STEEP * a * (b - a * a) + 2 * (1 - a), -2 * STEEP * (b - a * a)]])


def crooked() -> dincl.Problem:
    """Return a point in a thin crooked strip, pushed far out of it."""
    push = constant(np.array([[-3.0, 2.0]]))
    return dincl.Problem([[1.0, 1.0]], push, [dincl.Smooth(_strip, _slope)])


def _limits() -> Found:
    """Every solver that iterates, on a set that is too crooked for it."""
    schemes = {
        "Ipopt": dincl.CatchUp(dt=1.0, projection=dincl.Ipopt(tol=TOL)),
        "Daqp": dincl.CatchUp(dt=1.0, projection=dincl.Daqp(tol=TOL)),
        "Piqp": dincl.CatchUp(dt=1.0, projection=dincl.Piqp(tol=TOL)),
        "Clarabel": dincl.CatchUp(dt=1.0, projection=dincl.Clarabel(tol=TOL)),
        "PBD": dincl.PBD(dt=1.0),
    }
    ended = {name: dincl.solve(crooked(), scheme, t=1.0, throw=False) for name, scheme in schemes.items()}
    reported = [name for name, path in ended.items() if path.status is dincl.Status.NOT_CONVERGED]
    words = "; ".join(f"{name}: {path.detail.split(' This was')[0]}" for name, path in ended.items())
    return happens(len(reported) == len(schemes), words)


CASES = (
    Case("local-swapped", "Ipopt in a local minimum: two intervals that passed each other", "(1 + δ)/√2", _swapped),
    Case("local-many", "Ipopt in a local minimum: seven discs on one point", "many minima, by the start", _many),
    Case("limits", "Solvers at their limit: a thin crooked set", "each one reports it", _limits),
)
