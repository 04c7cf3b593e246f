"""Chapter 2, section 4.1: the reference solutions."""
# ruff: noqa: RUF001 - the formulas are quoted as they are printed

from __future__ import annotations

import numpy as np

import dincl
from verification.claims import Correction, Effect, Tables, claim
from verification.evidence import Evidence, Kind, at_least, at_most
from verification.thesis.chapter1.sets import Floats
from verification.thesis.chapter2.discs import RADIUS
from verification.thesis.chapter2.methods import CATCH_UP, CHECK_TOL, LINEARISED_CLARABEL, REFERENCE_TOL

# "Much smaller" and "much larger" are read as at least this factor.
MUCH = 100.0
# The four discs: a step from which the error of smaller ones follows, and the most steps that anyone would make.
FOUR_DT, MOST_STEPS = 0.02, 1e6
# A stack of falling discs: heights at the start, end and step [length, time].
HEIGHTS, STACKED_BY, STACK_DT = np.array([1.3, 2.9, 4.0, 5.7]), 2.3, 0.02


def stacked(heights: Floats, t: float) -> Floats:
    """Discs above each other that fall with speed 1 onto a floor: each falls until it meets its place."""
    return np.asarray(np.maximum(heights - t, RADIUS * (2 * np.arange(len(heights)) + 1)))


@claim(
    "c2.stack",
    "The heights of discs that fall onto each other can be written down.",
    source="section 4.1",
    quote="one can compute explicitly simple situations such as a stack of disks",
    chosen="discs above each other that fall with speed 1",
)
def _stack() -> Evidence:
    start = np.column_stack((np.zeros(len(HEIGHTS)), HEIGHTS))
    floor = dincl.HalfSpace(normal=(0, 1), radius=RADIUS)
    problem = dincl.Problem(start, lambda _t, x: np.tile([0.0, -1.0], (len(x), 1)), [dincl.NonOverlap(RADIUS), floor])
    scheme = dincl.CatchUp(dt=STACK_DT, projection=dincl.Daqp(tol=1e-10))
    times = np.array([STACKED_BY / 2, STACKED_BY])
    path = dincl.solve(problem, scheme, t=times)
    exact = np.array([stacked(HEIGHTS, t) for t in times])
    off = float(np.abs(path.x[:, :, 1] - exact).max())
    landed = int((exact[-1] > HEIGHTS - STACKED_BY).sum())
    return Evidence(
        f"{len(HEIGHTS)} discs that fall onto each other: heights max(y_i − t, (2i + 1)R), i = 0, 1, … Moreau's scheme "
        f"agrees to {off:.0e} at two times, when {landed} discs have landed.",
        (at_most("largest distance", off, 1e-8), at_least("landed discs", landed, 2)),
    )


def step_error(dt: float) -> float:
    """About the error of Moreau's scheme with four discs at t = 1: its distance from the run with half the step."""
    ends = [
        dincl.solve(dincl.scenes.four_disks(), dincl.CatchUp(dt=h, projection=dincl.Daqp(tol=CHECK_TOL)), t=1.0).final
        for h in (dt, dt / 2)
    ]
    return float(np.abs(ends[0] - ends[1]).max())


@claim(
    "c2.tolerance",
    "How the tolerance of the projections compares with the errors of the time steps.",
    source="section 4.1",
    quote="We set tol to 10⁻¹¹ which was much larger than the errors introduced by the time-stepping.",
    recorded=Kind.CORRECTED,
    correction=Correction(
        "… which was much smaller than the errors introduced by the time-stepping",
        Effect.NUMBER,
        "the accuracy of the reference solutions: as printed, the tolerance would spoil them",
        why=(
            "a reference is as good as the larger of both errors; for the time steps to count, the tolerance has "
            "to be the smaller one"
        ),
        place=1480,
    ),
    chosen="the start; at most a million steps, for theirs are not given",
)
def _tolerance() -> Evidence:
    error = step_error(FOUR_DT)
    best = error / (FOUR_DT * MOST_STEPS)
    ratio = best / REFERENCE_TOL
    return Evidence(
        f"Four discs, t = 1: the error of a time step dt = {FOUR_DT:g} is {error:.1e}. It falls as dt, so even a "
        f"million steps would leave {best:.0e}, {ratio:.0e} times the tolerance.",
        printed=(at_most("error of a million steps over tolerance", ratio, 1 / MUCH),),
        corrected=(at_least("error of a million steps over tolerance", ratio, MUCH),),
    )


@claim(
    "c2.coincides",
    "Both convergent methods give the same reference solutions, within their errors.",
    source="section 4.1",
    quote=(
        "The computed solutions from [inner convex approximation] coincided with the solutions computed with "
        "Moreau's catch-up scheme."
    ),
    needs=("references", "convergence"),
    chosen="the starts; the limits of small steps are compared",
)
def _coincides(tables: Tables) -> Evidence:
    rows, runs = tables["references"], tables["convergence"]
    allowed = rows["catch_up_error"] + rows["linearised_error"] + REFERENCE_TOL
    share = rows["linearised"] / allowed
    worst = rows["linearised"].idxmax()
    mine = runs[(runs["scene"] == "four_disks") & (runs["t"] == 1.0)].pivot(
        index="dt", columns="method", values="error"
    )
    finest = mine[[CATCH_UP.name, LINEARISED_CLARABEL.name]].dropna().sort_index().iloc[0]
    return Evidence(
        f"Extrapolated to dt = 0, the two are at most {rows['linearised'][worst]:.1e} apart, within the sum of their "
        f"stated errors ({allowed[worst]:.1e}). With one and the same step they differ: at dt = {finest.name:.2g} the "
        f"errors of four discs at t = 1 are {finest.iloc[0]:.1e} and {finest.iloc[1]:.1e}.",
        (at_most("largest distance over the stated errors", float(share.max()), 1.0),),
    )
