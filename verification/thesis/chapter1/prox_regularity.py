"""Prox-regularity of the set of discs that do not overlap: printed, proved and measured constants (chapter 1, 4)."""
# ruff: noqa: RUF001 - formulas for readers are written with Greek letters and minus signs

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pandas as pd
from numpy.typing import NDArray

import dincl
from dincl.geometry import normal_cone
from dincl.study import Key, Row, Study
from verification.site.sheet import GREY, sheet
from verification.thesis.chapter1.prox_constants import RADIUS, printed_constant, proved_constant, row_constant
from verification.thesis.chapter1.prox_search import hypomonotonicity, prox_constant

Floats = NDArray[np.float64]
NAME, ARRANGED, TITLE = "prox_constants", "prox_arrangements", "How far from convex is the set of discs?"
COUNTS = (20, 15, 10, 8, 6, 5, 4, 3, 2)
SAMPLES, CONTACT, SEED = 200, 1e-9, 31
# The smallest form has rows and arrangements of at most so many discs.
FEW = 3
HEADINGS = {
    "count": "N",
    "printed_plane": "Printed, d = 2",
    "printed_space": "Printed, d = 3",
    "from_gamma": "√2 R γ of a row",
    "proved": "Proved",
    "measured": "Upper bound, by search",
    "row": "Straight row",
    "hypomonotone": "1 / hypomonotone, by search",
    "gap": "Upper bound / proved",
}
ARRANGED_HEADINGS = {
    "arrangement": "Discs",
    "count": "N",
    "d": "d",
    "contacts": "Contacts",
    "gamma": "γ",
    "measured": "Upper bound, by search",
    "row": "Straight row of N",
    "proved": "Proved for N",
}
# Column, label, colour, marker, line.
CURVES = (
    ("measured", "measured, an upper bound", "#d55e00", "o", "none"),
    ("row", "straight row, an upper bound", "#0072b2", "", "-"),
    ("proved", "proved, a lower bound", "#009e73", "", "-"),
    ("from_gamma", "of a row, from the inverse triangle inequality", GREY, "", "-"),
    ("printed_plane", "printed, d = 2", "#cc79a7", "", "--"),
    ("printed_space", "printed, d = 3", "#cc79a7", "", ":"),
)


def study(smallest: bool = False) -> Study:
    """Return, for each N, the constants for R = 1/2, and what the searches find around a straight row of N discs."""
    runs = tuple({"count": n} for n in COUNTS if not smallest or n <= FEW)
    return Study(NAME, "Constants of prox-regularity", ("count",), runs, _of_row, {"samples": SAMPLES}, HEADINGS)


def _of_row(key: Key) -> list[Row]:
    n = key["count"]
    problem, proved = packed(row(n)), proved_constant(n)
    eta = prox_constant(problem, SAMPLES, SEED)
    columns = {
        "printed_plane": printed_constant(n, 2),
        "printed_space": printed_constant(n, 3),
        "from_gamma": math.sqrt(2) * RADIUS * normal_cone(problem, 0.0, problem.x0, CONTACT).inverse_triangle(),
        "proved": proved,
        "row": row_constant(n),
        "measured": eta,
        "hypomonotone": 1 / hypomonotonicity(problem, SAMPLES, SEED),
        "gap": eta / proved,
    }
    return [dict(key) | columns]


def arrangements_study(smallest: bool = False) -> Study:
    """Return, for each arrangement of touching discs, what the search finds around it, beside the straight row."""
    names = [name for name, x in arrangements().items() if not smallest or len(x) <= FEW]
    runs = tuple({"arrangement": name} for name in reversed(names))
    made = {"samples": SAMPLES}
    return Study(
        ARRANGED, "Prox-regularity of arrangements", ("arrangement",), runs, _of_arrangement, made, ARRANGED_HEADINGS
    )


def _of_arrangement(key: Key) -> list[Row]:
    x = arrangements()[key["arrangement"]]
    problem = packed(x)
    cone = normal_cone(problem, 0.0, problem.x0, CONTACT)
    columns = {
        "count": len(x),
        "d": x.shape[1],
        "contacts": len(cone.names),
        "gamma": cone.inverse_triangle(),
        "measured": prox_constant(problem, SAMPLES, SEED),
        "row": row_constant(len(x)),
        "proved": proved_constant(len(x)),
    }
    return [dict(key) | columns]


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


def figure(table: pd.DataFrame, path: Path) -> Path:
    """Draw all constants of prox-regularity against the number of discs."""
    with sheet(path, 3.6) as drawn:
        panel = drawn.subplots()
        for column, label, colour, marker, line in CURVES:
            known = table[table[column] > 0]
            panel.loglog(known["count"], known[column], color=colour, marker=marker, linestyle=line, label=label)
        panel.set(xlabel="number N of discs of radius 1/2", ylabel="constant of prox-regularity [length]")
        ticks = table["count"].to_list()
        panel.set_xticks(ticks, [str(tick) for tick in ticks])
        panel.minorticks_off()
        drawn.legend(loc="outside right center")
    return path
