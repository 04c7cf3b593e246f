"""Long rows of discs pressed onto a wall: sweeps carry a push from one neighbour to the next, so they need many."""
# ruff: noqa: RUF001 - formulas for readers are written with Greek letters and minus signs

from __future__ import annotations

import math
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

import dincl
from dincl.drifts import constant
from dincl.solvers.dual import dual_sweeps
from verification.thesis.chapter2.stability.case import Case, Found, happens, within
from verification.thesis.chapter2.stability.contestants import CONTESTANTS, TOL, named
from verification.thesis.chapter2.stability.outcome import ERROR, measured
from verification.thesis.chapter2.stability.plane import Axis, Line, Plane, geometric

Floats = NDArray[np.float64]
RADIUS = 0.5
GAP = 0.1
# Sweeps over which a contraction is measured, after the faster modes have died out: multiples of n^2.
SETTLING, MEASURING = 1.0, 0.25
# Overlap at which a row is called sorted out [diameters].
SORTED = 1e-3
MOST_SWEEPS = 100_000


def packed(n: int) -> Floats:
    """Return where the discs of a row end: 1/2, 3/2, ..., shape (n, 1)."""
    return np.arange(float(n))[:, None] + RADIUS


def pressed(n: int, gap: float = 0.0) -> dincl.Problem:
    """Return n intervals of diameter 1 with gaps, each pressed with the force 1 onto a wall at 0."""
    x = packed(n) + gap * np.arange(1, n + 1)[:, None]
    push = constant(np.full((n, 1), -1.0))
    return dincl.Problem(x, push, [dincl.NonOverlap(RADIUS), dincl.HalfSpace(normal=(1,), radius=RADIUS)])


def contraction(rows: int) -> float:
    """Return the factor by which a dual Gauss-Seidel sweep shortens the error, for ``rows`` contacts of a free row."""
    matrix, row = np.zeros((rows, rows + 1)), np.arange(rows)
    matrix[row, row], matrix[row, row + 1] = -1.0, 1.0
    indptr, indices = 2 * np.arange(rows + 1), np.column_stack((row, row + 1)).ravel()
    data = np.tile([-1.0, 1.0], rows)
    mode = np.sin(np.pi * (row + 1) / (rows + 1))
    right = np.full(rows, 2.0)  # the answer; so large that no multiplier reaches zero
    mu = right + mode
    u, least = matrix.T @ mu, matrix @ matrix.T @ right
    first = max(4, round(SETTLING * rows**2))
    errors, counts = [], (first, max(6, round(MEASURING * rows**2)))
    for sweeps in counts:
        dual_sweeps(u, indptr, indices, data, least, np.full(rows, 2.0), mu, sweeps, 0.0)
        errors.append(float(np.abs(mu - right).max()))
    return float((errors[1] / errors[0]) ** (1 / counts[1]))


def predicted_contraction(rows: int) -> float:
    """Return cos^2(pi / (rows + 1)): the spectral radius of I - (D + L)^{-1} A for A = tridiag(-1, 2, -1)  (Young)."""
    return math.cos(math.pi / (rows + 1)) ** 2


def _contraction(rows: int) -> Found:
    """The sweeps for a factor e, 1 / -log(rho), since rho itself is near 1."""
    expected, found = (-1 / math.log(rho) for rho in (predicted_contraction(rows), contraction(rows)))
    return within(expected, found, 1e-3, f"sweeps for a factor e, {rows} contacts")


def _two() -> Found:
    return within(predicted_contraction(2), contraction(2), 1e-6, "factor of a sweep, two contacts")


def _limit_of_sweeps() -> Found:
    """400 discs: 100,000 sweeps of 1 - 1.5e-5 leave 0.2 of the error."""
    n = 400
    left = math.cos(math.pi / (2 * n)) ** (2 * MOST_SWEEPS)
    scheme = dincl.LinearisedCatchUp(dt=1.0, projection=dincl.GaussSeidel(tol=TOL))
    path = dincl.solve(pressed(n), scheme, t=1.0, throw=False)
    reported = path.status is dincl.Status.NOT_CONVERGED
    words = f"{n} discs on a wall, {left:.2f} of the error left: {path.status.name}, {path.detail}"
    return happens(reported and left > TOL, words)


def sweeps_needed(n: int) -> int:
    """Count the sweeps of PBD until a row that overlaps by a tenth of a diameter overlaps by ``SORTED`` at most."""
    start = (0.9 * np.arange(n) + RADIUS)[:, None]
    problem = dincl.Problem(packed(n), constant(start - packed(n)), pressed(n).constraints)
    few, many = 0, 1
    while _overlap_after(problem, many) > SORTED:
        few, many = many, 2 * many
    while many - few > 1:
        middle = (few + many) // 2
        few, many = (few, middle) if _overlap_after(problem, middle) <= SORTED else (middle, many)
    return many


def _overlap_after(problem: dincl.Problem, sweeps: int) -> float:
    path = dincl.solve(problem, dincl.PBD(dt=1.0, sweeps=sweeps), t=1.0)
    return float(path.violation()[-1])


def _sweeps_grow() -> Found:
    counts = {n: sweeps_needed(n) for n in (8, 16, 32, 64)}
    slope = math.log(counts[64] / counts[16]) / math.log(4)
    listed = ", ".join(f"{count} for {n}" for n, count in counts.items())
    return Found(2.0, slope, abs(slope - 2) < 0.15, f"sweeps to an overlap of {SORTED:g}: {listed}")


def equilibrium(n: int, dt: float, sweeps: int = 1) -> Floats:
    """Return where PBD leaves the row, shape (n,): how much closer to the wall than it should be, from a run of PBD."""
    end = dt * (40 * n + 4 * n**2)
    path = dincl.solve(pressed(n), dincl.PBD(dt=dt, sweeps=sweeps), t=end)
    left: Floats = (packed(n) - path.final)[:, 0]
    return left


def sunk(n: int) -> float:
    """Measure how deep the last disc of the row sinks in the equilibrium of PBD with one sweep, over dt |F|.

    At rest the moves of a step add up to zero: pair k (of discs k - 1 and k) moves each of its discs by (n - k) dt |F|,
    the wall moves disc 0 by n dt |F|. A pair is closed when it is treated; what later rows do to it stays: pair k + 1
    pushes disc k back by (n - k - 1) dt |F|, and the wall pushes disc 0. The sum of these overlaps is

        n + sum_{k = 1}^{n - 1} (n - k - 1) = n + (n - 1)(n - 2) / 2   for n >= 2.
    """
    return n + (n - 1) * (n - 2) / 2 if n > 1 else 0.0


def _equilibrium() -> Found:
    worst, shown = 0.0, []
    for n in (2, 3, 5, 8, 16):
        for dt in (1e-4, 1e-3, 2e-3):
            worst = max(worst, abs(equilibrium(n, dt)[-1] / (dt * sunk(n)) - 1))
        shown.append(f"{n}: {sunk(n):g}")
    words = f"depth of the last disc / (dt |F|), n: depth {', '.join(shown)}; O(dt), and O(n²) at one step"
    return Found(0.0, worst, worst < 1e-3, f"{words}; largest deviation {worst:.0e}")


def cell(method: str, dt: float, n: float) -> dict[str, Any]:
    """Return a row with gaps, long enough in time for all to close."""
    count = round(n)
    end = max(GAP * count + 2.0, 10 * dt)
    times = np.linspace(0.9, 1.0, 3) * end
    return measured(pressed(count, GAP), CONTESTANTS[method].scheme(dt), times, packed(count))


def _pbd_line(n: Floats) -> Floats:
    return ERROR / (n + (n - 1) * (n - 2) / 2)


PLANE = Plane(
    name="row",
    title="the length of a row",
    x=Axis("step dt", geometric(1 / 256, 1.0, 17)),
    y=Axis("discs n", (2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64, 96)),
    methods=named(
        "pbd",
        "pbd_4",
        "pbd_16",
        "xpbd_16",
        "second_order",
        "catch_up_daqp",
        "linearised_gauss_seidel",
        "penalty_tied",
        "penalty_printed",
    ),
    cell=cell,
    lines=(Line("PBD, one sweep: error 0.02", ("pbd",), _pbd_line),),
)
CASES = (
    Case("sweep-contraction-2", "Dual sweeps, two contacts", "factor of a sweep cos²(π/(m + 1)) = 1/4", _two),
    *(
        Case(
            f"sweep-contraction-{rows}",
            f"Dual sweeps, {rows} contacts in a row",
            "−1/log cos²(π/(m + 1)) ≈ (m + 1)²/π² sweeps for a factor e",
            partial(_contraction, rows),
        )
        for rows in (10, 50, 200)
    ),
    Case(
        "sweep-limit",
        "Dual sweeps, 400 discs on a wall",
        "cos²(π/(2n)) to the power of 100,000 sweeps leaves more than the tolerance: reported, not hidden",
        _limit_of_sweeps,
    ),
    Case("pbd-sweeps", "Sweeps of PBD to sort out a row", "as n²: the exponent", _sweeps_grow),
    Case(
        "pbd-equilibrium",
        "Equilibrium of PBD in a row",
        "dt |F| (n + (n − 1)(n − 2)/2) too deep: relative deviation",
        _equilibrium,
    ),
)
