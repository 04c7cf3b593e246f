"""A crowd of discs drawn to one point: with few sweeps it collapses, with large steps centres coincide."""
# ruff: noqa: RUF001 - formulas for readers are written with Greek letters and minus signs

from __future__ import annotations

import math
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

import dincl
from dincl import FixedStep
from dincl.drifts import attraction
from verification.thesis.chapter2.stability.case import Case, Found, happens
from verification.thesis.chapter2.stability.contestants import CONTESTANTS, named
from verification.thesis.chapter2.stability.outcome import row
from verification.thesis.chapter2.stability.plane import Axis, Line, Plane, geometric

Floats = NDArray[np.float64]
RADIUS = 0.5
# Spacing and jitter of the start: no two discs touch.
SPACING, JITTER = 1.2, 0.09
# Runs last so long [time], and at least so many steps.
END, LEAST = 4.0, 20
# Relative error of the radius of gyration that counts as converged: packings differ by a few per cent.
ALIKE = 0.06
FEW, MANY = 200, 1000
# Most of the way is done by then: e^-3 of the spread is left [time].
SETTLED = 3.0


def crowd(n: int) -> dincl.Problem:
    """Return F = -x, n discs of diameter 1 on a jittered lattice around the origin."""
    side = math.ceil(math.sqrt(n))
    place = np.indices((side, side)).reshape(2, -1).T[:n].astype(np.float64)
    jitter = np.random.default_rng(n).uniform(-JITTER, JITTER, (n, 2))
    return dincl.Problem(SPACING * (place - place.mean(axis=0)) + jitter, attraction(0), [dincl.NonOverlap(RADIUS)])


def gyration(x: Floats) -> float:
    """Return the root mean square distance from the centre of mass."""
    return float(np.sqrt(((x - x.mean(axis=0)) ** 2).sum(axis=1).mean()))


def densest(n: int) -> float:
    """Return the least radius of gyration of a heap: n points of a triangular lattice of width 1 around a centre.

    The heap may be centred on a point of the lattice, on the middle of a bond, or on that of a triangle.
    """
    side = math.ceil(math.sqrt(n)) + 2
    i, j = np.mgrid[-side : side + 1, -side : side + 1]
    lattice = np.column_stack(((i + j / 2).ravel(), (math.sqrt(3) / 2 * j).ravel()))
    sizes = []
    for centre in ((0.0, 0.0), (0.5, 0.0), (0.5, math.sqrt(3) / 6)):
        nearest = np.argsort(((lattice - centre) ** 2).sum(axis=1), kind="stable")[:n]
        sizes.append(gyration(lattice[nearest]))
    return min(sizes)


def radius(n: int) -> float:
    """Return the radius of n densely packed discs of diameter 1, as a round heap [diameters]."""
    return math.sqrt(n * math.sqrt(12) / (4 * math.pi))


def seen(problem: dincl.Problem, scheme: FixedStep) -> dict[str, Any]:
    """Judge a run by overlap and by the radius of gyration, since equilibria are many."""
    end = scheme.dt * max(LEAST, math.ceil(END / scheme.dt))
    path = dincl.solve(problem, scheme, t=end, throw=False)
    true = densest(len(problem.x0))
    growth = float(np.abs(path.final).max() / np.abs(problem.x0).max())
    error = abs(gyration(path.final) / true - 1) if growth < np.inf else np.nan
    return row(path.status, path.detail, error, float(path.violation()[-1]), growth, ALIKE)


def by_sweeps(method: str, dt: float, sweeps: float) -> dict[str, Any]:
    """Return a crowd of FEW."""
    return seen(crowd(FEW), dincl.PBD(dt=dt, sweeps=round(sweeps)))


def by_number(method: str, dt: float, n: float) -> dict[str, Any]:
    """Return a crowd of n."""
    return seen(crowd(round(n)), CONTESTANTS[method].scheme(dt))


def _collapse() -> Found:
    """A thousand discs, one sweep."""
    rows = []
    for dt, sweeps in ((1e-3, 1), (1e-2, 1), (1e-1, 1), (1e-1, 16), (1e-2, 16)):
        path = dincl.solve(crowd(MANY), dincl.PBD(dt=dt, sweeps=sweeps), t=SETTLED)
        rows.append((dt, sweeps, gyration(path.final) / densest(MANY), float(path.violation()[-1])))
    listed = "; ".join(f"dt = {dt:g}, {sweeps}: {size:.2f}, {overlap:.2f}" for dt, sweeps, size, overlap in rows)
    # Across a radius of the heap R discs lie behind each other, and dt R^2/2 is what their drift adds up to in a step.
    load = radius(MANY) ** 2 / 2
    collapsed, cured = rows[1][2], rows[-1][2]
    return happens(
        collapsed < 0.75 and rows[2][2] < 0.4 and cured > 1 - ALIKE and rows[0][3] > 1e-3 * load / 2,
        f"radius of gyration over that of the densest heap, and largest overlap, for dt, sweeps: {listed} (a single "
        f"sweep needs dt well below 2/R² = {1 / load:.3f}, R = {radius(MANY):.0f} discs)",
    )


def _coincide(method: str) -> Found:
    problem = dincl.scenes.four_disks()
    outcomes = {}
    for dt in (1 - 1e-3, 1.0, 1 + 1e-3):
        path = dincl.solve(problem, CONTESTANTS[method].scheme(dt), t=20 * dt, throw=False)
        outcomes[dt] = path.status
    refused = dincl.Status.COINCIDENT_CENTRES
    words = ", ".join(f"dt = {dt:g}: {status.name}" for dt, status in outcomes.items())
    return happens([dt for dt, status in outcomes.items() if status is refused] == [1.0], words)


def _coincide_linearised() -> Found:
    """The rows are linearised where the discs were, and there they have directions."""
    problem = dincl.scenes.four_disks()
    path = dincl.solve(problem, CONTESTANTS["linearised_daqp"].scheme(1.0), t=20.0, throw=False)
    overlap = float(path.violation()[-1])
    words = f"{path.status.name}, overlap {overlap:.0e}, while the prediction is a single point"
    return happens(bool(path.status) and overlap < 1e-8, words)


def limit_line(n: Floats) -> Floats:
    """Return dt R^2 / 2 = 0.1 for a heap of n discs: one sweep."""
    return 0.1 * 2 / (n * math.sqrt(12) / (4 * math.pi))


def _sweeps_line(sweeps: Floats) -> Floats:
    return sweeps * limit_line(np.array(float(FEW)))


SWEEPS = Plane(
    name="sweeps",
    title="the number of sweeps",
    x=Axis("step dt", (*geometric(2e-3, 0.8, 14), 1.0, 1.3, 1.7, 2.2)),
    y=Axis("sweeps", (1, 2, 4, 8, 16, 32, 64)),
    methods=named("pbd"),
    cell=by_sweeps,
    lines=(Line("dt R²/2 = 0.1 · sweeps", ("pbd",), _sweeps_line),),
)
NUMBERS = Plane(
    name="crowd",
    title="the number of attracted discs",
    x=Axis("step dt", (*geometric(2e-3, 0.8, 14), 1.0, 1.3, 1.7, 2.2)),
    y=Axis("discs n", (4, 8, 16, 32, 64, 128, 256, 512)),
    methods=named("pbd", "pbd_16", "penalty_tied", "penalty_100", "penalty_printed"),
    cell=by_number,
    lines=(Line("dt R²/2 = 0.1", ("pbd",), limit_line),),
)
CASES = (
    Case(
        "collapse",
        "A thousand attracted discs, one sweep",
        "one sweep does not carry the load dt R²/2: the heap collapses",
        _collapse,
    ),
    *(
        Case(
            f"coincide-{method}",
            f"Centres driven to coincide, {CONTESTANTS[method].label}",
            "F = −x, dt = 1: refused just there, not at dt = 1 ± 0.001",
            partial(_coincide, method),
        )
        for method in ("pbd", "second_order", "penalty_tied")
    ),
    Case(
        "coincide-linearised",
        "Centres driven to coincide, linearised",
        "rows have directions where the discs were: it goes on, without overlap",
        _coincide_linearised,
    ),
)
