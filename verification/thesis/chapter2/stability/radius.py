"""Steps longer than the prox-regularity radius: the nearest point is not unique, or is on the other side."""
# ruff: noqa: RUF001 - formulas for readers are written with Greek letters and minus signs

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

import dincl
from dincl.drifts import constant
from verification.thesis.chapter2.stability.boundary import boundary
from verification.thesis.chapter2.stability.case import Case, Found, happens, within
from verification.thesis.chapter2.stability.contestants import CONTESTANTS, named
from verification.thesis.chapter2.stability.outcome import measured
from verification.thesis.chapter2.stability.plane import Axis, Line, Plane, even, geometric

Floats = NDArray[np.float64]
# Two starts differ by this much: small, but far above rounding.
TWIN = 1e-12
LENGTH = 1.0
PRECISION = 1e-4
STEPS = 20
# So many that a step is as good as a projection.
MANY_SWEEPS = 256


def spread(scheme: dincl.Scheme, step: float) -> float:
    """Return the distance after one step of two points that start ``TWIN`` apart on a disc and are pushed into it."""
    half = TWIN / 2
    ends = []
    for side in (-half, half):
        start = [[math.sqrt(LENGTH**2 - side**2), side]]
        push = constant(np.array([[-step, 0.0]]))
        problem = dincl.Problem(start, push, [dincl.OutsideBall(centre=(0, 0), distance=LENGTH)])
        ends.append(dincl.solve(problem, scheme, t=1.0).final)
    return float(np.linalg.norm(ends[1] - ends[0]))


def pair_spread(scheme: dincl.Scheme, step: float) -> float:
    """Return this distance for two touching discs of radius 1/2; a step in R^4 moves each by step / sqrt(2)."""
    each, ends = step / math.sqrt(2), []
    for side in (-TWIN / 2, TWIN / 2):
        turn = side / math.sqrt(2)  # each of the two is moved across, in opposite directions
        start = np.array([[-LENGTH / 2, -turn], [LENGTH / 2, turn]])
        push = constant(np.array([[each, 0.0], [-each, 0.0]]))
        path = dincl.solve(dincl.Problem(start, push, [dincl.NonOverlap(LENGTH / 2)]), scheme, t=1.0)
        ends.append(path.final)
    return float(np.linalg.norm(ends[1] - ends[0]))


def _amplified(radius: float, measure: Callable[[dincl.Scheme, float], float], what: str) -> Found:
    """P_S has the Lipschitz constant eta / (eta - s) at the distance s < eta from S, and no constant at eta."""
    schemes = (dincl.CatchUp(dt=1.0, projection=dincl.ClosedForm()), dincl.PBD(dt=1.0))
    parts, worst = (0.5, 0.9, 0.99, 0.999), 0.0
    for scheme in schemes:
        for part in parts:
            worst = max(worst, abs(measure(scheme, part * radius) / TWIN * (1 - part) - 1))
    split = min(measure(scheme, radius * (1 + 1e-15)) for scheme in schemes)
    agrees = worst < 1e-3 and split > LENGTH
    words = f"{what}: steps s of {parts} η, to {worst:.0e}; a step of η takes them {split:.2f} apart"
    return Found(1.0, 1 + worst, agrees, words)


def _disc() -> Found:
    return _amplified(LENGTH, spread, "two starts 1e-12 apart on a disc, η = its radius")


def _pair() -> Found:
    return _amplified(LENGTH / math.sqrt(2), pair_spread, "two discs of radius R, η = √2 R")


def opening(c: float) -> tuple[dincl.Problem, float]:
    """Return a point pressed down above the gap of two obstacles of radius 1 at (+-c, 0), and its height h at rest.

    h = sqrt(1 - c^2) is the prox-regularity radius: (0, 0) is as far from (0, h) as from (0, -h).
    """
    height = math.sqrt(LENGTH**2 - c**2)
    obstacles = [dincl.OutsideBall(centre=(side * c, 0.0), distance=LENGTH) for side in (1, -1)]
    return dincl.Problem([[0.0, height]], constant(np.array([[0.0, -1.0]])), obstacles), height


def stays(c: float, make: Callable[[float], dincl.Scheme], dt: float) -> bool:
    """Whether the point is above the gap after one step."""
    problem, height = opening(c)
    path = dincl.solve(problem, make(dt), t=dt, throw=False)
    return bool(path.status) and float(path.final[0, 1]) > height / 2


def _passes(c: float, make: Callable[[float], dincl.Scheme], over: float, words: str) -> Found:
    """The step, over h, at which the point stops staying above."""
    height = opening(c)[1]
    found = boundary(lambda part: stays(c, make, part * height), 0.5 * over, 2 * over, PRECISION)
    return within(over, found, 3 * PRECISION, f"{words}, c = {c:g}")


def _many_sweeps(dt: float) -> dincl.Scheme:
    return dincl.PBD(dt=dt, sweeps=MANY_SWEEPS)


def _local(name: str) -> Found:
    """Solvers that search from the state before the step stay on their side until the prediction is feasible."""
    return _passes(0.6, CONTESTANTS[name].scheme, 2.0, f"{CONTESTANTS[name].label}: step / h")


def _sweeps() -> Found:
    return _passes(0.6, _many_sweeps, 1.0, f"PBD, {MANY_SWEEPS} sweeps: step / h")


def _linearised() -> Found:
    """S~ at the corner is the tangent wedge, which the point cannot leave."""
    steps = (0.5, 1.0, 2.0, 10.0, 1e3)
    held = [stays(0.6, CONTESTANTS["linearised_daqp"].scheme, s) for s in steps]
    return happens(all(held), f"it stays above for steps up to {steps[-1]:g} times η")


def cell(method: str, part: float, c: float) -> dict[str, Any]:
    """Make steps of ``part`` times h; exactly, the point rests at (0, h)."""
    problem, height = opening(c)
    dt = part * height
    return measured(problem, CONTESTANTS[method].scheme(dt), dt * np.array([STEPS / 2, STEPS]), [[0.0, height]])


def _one(c: Floats) -> Floats:
    return np.ones_like(c)


def _two(c: Floats) -> Floats:
    return 2 * np.ones_like(c)


PLANE = Plane(
    name="radius",
    title="the prox-regularity radius",
    x=Axis("step / η", geometric(0.02, 4.0, 28)),
    y=Axis("half distance c", even(0.1, 0.98, 17), logarithmic=False),
    methods=named(
        "pbd",
        "pbd_16",
        "catch_up_ipopt",
        "catch_up_daqp",
        "linearised_daqp",
        "midpoint_daqp",
        "penalty_tied",
        "penalty_printed",
    ),
    cell=cell,
    lines=(
        Line("step = η", ("pbd", "pbd_16"), _one),
        Line("step = 2η", ("catch_up_ipopt", "catch_up_daqp"), _two),
    ),
)
CASES = (
    Case(
        "radius-disc", "A step of η into a round obstacle", "distance of two starts over δ η/(η − s); split at η", _disc
    ),
    Case("radius-pair", "A step of η into another disc", "the same with η = √2 R for two discs", _pair),
    Case(
        "gap-sweeps", "Through the gap of two discs, PBD", "each projection keeps the side until step = η = h", _sweeps
    ),
    *(
        Case(
            f"gap-{name}",
            f"Through the gap of two discs, {CONTESTANTS[name].label}",
            "a local minimum above: it passes only at step = 2h, not at h",
            partial(_local, name),
        )
        for name in ("catch_up_ipopt", "catch_up_daqp")
    ),
    Case("gap-linearised", "Through the gap of two discs, linearised", "never: S̃ is the wedge above", _linearised),
)
