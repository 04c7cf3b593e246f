"""The Pacman set of Figure 7, a disc without its mouth: at the tip of the mouth it is not prox-regular.

It is {|x| <= 1} less an open sector, locally a union of two half planes, and so no Problem: constraints intersect. Its
nearest points are written down here, and the catch-up scheme with them.
"""
# ruff: noqa: RUF001 - formulas for readers are written with Greek letters and minus signs

from __future__ import annotations

import math

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from verification.thesis.chapter2.stability.case import Case, Found, happens

Floats = NDArray[np.float64]
TWIN = 1e-12
# Half the opening of the mouth of the figure, and of one that is so wide that the set is convex at its tip.
NARROW, WIDE = math.radians(35), math.radians(120)
END = 0.5


def inside(x: Floats, half: float) -> bool:
    """Whether x (2,) lies in the unit disc, outside of the open mouth |angle| < ``half``."""
    return float(x @ x) <= 1 and (abs(math.atan2(x[1], x[0])) >= half or not x.any())


def nearest(x: Floats, half: float) -> Floats:
    """Return P_S(x), shape (2,); of two nearest points, that on the lower jaw.

    A point outside of S is nearest to the arc at x / |x|, or to one of the jaws {r (cos, +-sin) : 0 <= r <= 1}.
    """
    if inside(x, half):
        return x
    found = [np.clip(x @ jaw, 0.0, 1.0) * jaw for jaw in _jaws(half)]
    around = x / np.linalg.norm(x)
    if abs(math.atan2(x[1], x[0])) >= half:
        found.append(around)
    return min(found, key=lambda z: float(np.linalg.norm(z - x)))


def _jaws(half: float) -> tuple[Floats, Floats]:
    return np.array([math.cos(half), -math.sin(half)]), np.array([math.cos(half), math.sin(half)])


def catch_up(start: Floats, dt: float, half: float) -> Floats:
    """Return x_{k+1} = P_S(x_k + dt (1, 0)) to ``END``: the drift points into the mouth; all states, (K, 2)."""
    states = [start]
    for _ in range(round(END / dt)):
        states.append(nearest(states[-1] + [dt, 0.0], half))
    return np.array(states)


def twins(dt: float, half: float) -> tuple[Floats, Floats]:
    """Return two catch-up runs that start ``TWIN`` apart, below and above the axis behind the tip, (K, 2) each."""
    below, above = (catch_up(np.array([-TWIN, side]), dt, half) for side in (-TWIN / 2, TWIN / 2))
    return below, above


def table(steps: tuple[float, ...]) -> pd.DataFrame:
    """Return all states of the twins for some steps, one row each."""
    rows = [
        {"dt": dt, "side": side, "k": k, "x": state[0], "y": state[1]}
        for dt in steps
        for side, states in zip(("below", "above"), twins(dt, NARROW), strict=True)
        for k, state in enumerate(states)
    ]
    return pd.DataFrame(rows)


def split(dt: float, half: float) -> float:
    """Return the distance of the twins at ``END``."""
    ends = [states[-1] for states in twins(dt, half)]
    return float(np.linalg.norm(ends[1] - ends[0]))


def _tie() -> Found:
    """Points on the axis of the mouth, ever nearer to S: two nearest points each."""
    distances = [10.0**-k for k in range(1, 13)]
    apart = []
    for rho in distances:
        both = [nearest(np.array([rho, side * 1e-4 * rho]), NARROW) for side in (-1, 1)]
        apart.append(float(np.linalg.norm(both[1] - both[0])) / (rho * math.sin(2 * NARROW)))
    worst = max(abs(ratio - 1) for ratio in apart)
    words = "1e-1 to 1e-12 from the tip: nearest points on both jaws, ρ sin 2α apart"
    return Found(1.0, apart[-1], worst < 1e-3, f"{words}, so no η > 0 serves; deviation {worst:.0e}")


def _split() -> Found:
    steps = (1e-1, 1e-2, 1e-3, 1e-4)
    expected = END * math.sin(2 * NARROW)
    apart = [split(dt, NARROW) for dt in steps]
    worst = max(abs(value / expected - 1) for value in apart)
    words = f"at t = {END:g}, for dt = {', '.join(f'{dt:g}' for dt in steps)}: {', '.join(f'{a:.4f}' for a in apart)}"
    return Found(expected, apart[-1], worst < 1e-3, words)


def _convex() -> Found:
    apart = [split(dt, WIDE) for dt in (1e-1, 1e-2, 1e-3)]
    words = "a mouth of 240 degrees leaves a set that is convex at the tip: the two runs stay together"
    return happens(max(apart) <= 2 * TWIN, words)


CASES = (
    Case(
        "pacman-tie", "Pacman: nearest points near the tip", "two of them for every ρ > 0: distance over ρ sin 2α", _tie
    ),
    Case("pacman-split", "Pacman: catch-up of two starts 1e-12 apart", "t sin 2α apart, however small dt", _split),
    Case("pacman-convex", "Pacman: a mouth beyond 180 degrees", "convex: no split", _convex),
)
