"""Prox-regularity of the set of discs that do not overlap: printed, proved and measured constants (chapter 1, 4)."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

import dincl
from dincl.geometry import (
    chain_constant,
    hypomonotonicity,
    normal_cone,
    printed_constant,
    proved_constant,
    prox_regularity,
)
from dincl.study import Key, Row, Study

Floats = NDArray[np.float64]
RADIUS = 0.5
COUNTS = (2, 3, 4, 5, 6, 8, 10, 15, 20)
# Distance of the pairs [length]: the ratio is off by about its square, and by the tolerance over that.
DISTANCE, TOL = 1e-3, 1e-12
CONTACT = 1e-9
SEED = 31


@dataclass(frozen=True)
class ProxForm:
    """Samples of each search, lengths of the straight rows, number of arrangements (None: all)."""

    samples: int
    counts: tuple[int, ...] = COUNTS
    arrangements: int | None = None


FULL = ProxForm(200)


def constants(form: ProxForm) -> Study:
    """Return, for each N, the constants for R = 1/2, and what the searches find around a straight row of N discs."""
    return _study("prox_constants", "Constants of prox-regularity", "count", form.counts, constants_of, form)


def configurations(form: ProxForm) -> Study:
    """Return, for each arrangement of touching discs, what the search finds around it, beside the straight row."""
    names = tuple(arrangements())[: form.arrangements]
    return _study("prox_arrangements", "Prox-regularity of arrangements", "arrangement", names, configuration_of, form)


def _study(
    name: str, title: str, key: str, values: Sequence[object], run: Callable[..., list[Row]], form: ProxForm
) -> Study:
    return Study(
        name=name,
        title=title,
        key=(key,),
        runs=tuple({key: value} for value in reversed(values)),
        run=partial(run, samples=form.samples),
    )


def constants_of(key: Key, samples: int) -> list[Row]:
    """Return one row for the straight row of key["count"] discs."""
    n = key["count"]
    problem = packed(row(n))
    eta, hypomonotone = measured(problem, samples)
    gamma = normal_cone(problem, 0.0, problem.x0, CONTACT).inverse_triangle()
    columns = {
        "printed_plane": printed_constant(n, RADIUS, 2),
        "printed_space": printed_constant(n, RADIUS, 3),
        "from_gamma": math.sqrt(2) * RADIUS * gamma,
        "proved": proved_constant(n, RADIUS),
        "row": chain_constant(n, RADIUS),
        "measured": eta,
        "hypomonotone": 1 / hypomonotone,
        "gap": eta / proved_constant(n, RADIUS),
    }
    return [dict(key) | columns]


def configuration_of(key: Key, samples: int) -> list[Row]:
    """Return one row for the discs of key["arrangement"]."""
    x = arrangements()[key["arrangement"]]
    problem = packed(x)
    cone = normal_cone(problem, 0.0, problem.x0, CONTACT)
    columns = {
        "count": len(x),
        "d": x.shape[1],
        "contacts": len(cone.names),
        "gamma": cone.inverse_triangle(),
        "measured": measured(problem, samples)[0],
        "row": chain_constant(len(x), RADIUS),
        "proved": proved_constant(len(x), RADIUS),
    }
    return [dict(key) | columns]


def measured(problem: dincl.Problem, samples: int) -> tuple[float, float]:
    """Return the eta and the constant of hypomonotonicity that searches around x0 find."""
    found = prox_regularity(
        problem, problem.x0, distance=DISTANCE, samples=samples, tol=TOL, rng=np.random.default_rng(SEED)
    )
    other = hypomonotonicity(
        problem, problem.x0, distance=DISTANCE, samples=samples, tol=TOL, rng=np.random.default_rng(SEED)
    )
    return found.eta, other.constant


def packed(x: Floats) -> dincl.Problem:
    """Return discs of radius 1/2 at x (N, d), without drift."""
    return dincl.Problem(x, lambda _t, state: 0 * state, [dincl.NonOverlap(RADIUS)])


def row(count: int, d: int = 2) -> Floats:
    """Return a straight row."""
    return np.asarray(np.arange(count, dtype=np.float64)[:, None] * np.eye(d)[0])


def arrangements() -> dict[str, Floats]:
    """Return touching discs by name."""
    return {
        "three in mutual contact": honeycomb(3),
        "bent row of three": np.array([[0.0, 0.0], [1.0, 0.0], [1.0 + math.cos(0.6), math.sin(0.6)]]),
        "rhombus": honeycomb(4),
        "star, 3 arms": star(3, 1),
        "cross": star(4, 1),
        "honeycomb of 7": honeycomb(7),
        "honeycomb of 10": honeycomb(10),
        "cross, arms of 2": star(4, 2),
        "star, 6 arms of 2": star(6, 2),
        "cross in space": _lifted(star(4, 1)),
        "honeycomb of 7 in space": _lifted(honeycomb(7)),
        "row of 5 in space": row(5, d=3),
    }


def star(arms: int, length: int) -> Floats:
    """Return a disc with straight arms of ``length`` discs."""
    angle = 2 * math.pi * np.arange(arms) / arms
    rays = np.column_stack((np.cos(angle), np.sin(angle)))
    return np.vstack((np.zeros((1, 2)), *(k * rays for k in range(1, length + 1))))


def honeycomb(count: int) -> Floats:
    """Return the ``count`` places of the triangular lattice nearest to one of them."""
    steps = np.arange(-3, 4)
    places = np.array([[i + j / 2, j * math.sqrt(0.75)] for i in steps for j in steps])
    order = np.argsort(np.round((places**2).sum(axis=1), 6), kind="stable")
    return places[order[:count]]


def _lifted(x: Floats) -> Floats:
    """Return the plane z = 0 of space."""
    return np.column_stack((x, np.zeros(len(x))))
