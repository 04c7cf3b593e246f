"""Chapter 2, section 4.1: the reference solutions."""
# ruff: noqa: RUF001 - the formulas are quoted as they are printed

from __future__ import annotations

import numpy as np

import dincl
from verification.claims import Evidence, Tables, Verdict, at_least, at_most, proved
from verification.formal.reals import implication, solver_library
from verification.thesis.chapter2.methods import CATCH_UP, CHECK_TOL, LINEARISED_CLARABEL, REFERENCE_TOL
from verification.thesis.text.quoted import claim

# "Much smaller" and "much larger" are read as at least this factor.
MUCH = 100.0
# The four discs: a step from which the error of smaller ones follows, and the most steps that anyone would make.
FOUR_DT, MOST_STEPS = 0.02, 1e6


@claim(
    "c2.stack",
    "The heights of discs that fall onto each other can be written down.",
    "section 4.1",
    Verdict.PROVED,
    chosen="discs above each other that fall with speed 1",
)
def _stack() -> Evidence:
    """Disc i (height a, from y) above disc i - 1 (height b, from z), R the radius, k = (2i - 1) R; l, m: multipliers.

    l acts from below on disc i, m from above on it: the force of disc i + 1, which is 0 while disc i falls.
    """
    z3 = solver_library()
    return proved(
        implication(
            "heights max(y_i − t, (2i + 1)R) of discs that start apart never overlap, touch once both have landed, and "
            "l = 1 + m ≥ 0 holds a landed disc",
            lambda s, y, z, t, a, b, R, k, rate, low, m: (
                [
                    R > 0,
                    k > 0,
                    y - z >= s * 2 * R,
                    m >= 0,
                    rate == z3.If(y - t > k + 2 * R, -1, 0),
                    a == z3.If(y - t > k + 2 * R, y - t, k + 2 * R),
                    b == z3.If(z - t > k, z - t, k),
                    low == 1 + m,
                ],
                [a - b >= 2 * R, z3.Implies(rate == 0, z3.And(a - b == 2 * R, -1 + low - m == rate, low >= 0))],
            ),
            "discs that overlap at first",
            0.5,
        )
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
    "section 4.1",
    Verdict.CORRECTED,
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
    "section 4.1",
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
