"""Introduction: claims about the method, the model of cells and the mean-field limit."""

from __future__ import annotations

import math

import numpy as np

import dincl
from tissue.statistics.comparisons import Difference
from verification.claims import Evidence, Tables, at_least, at_most, claim, equal
from verification.thesis.chapter1.sets import ROUNDING, Floats
from verification.thesis.chapter4.frequencies import RATIOS, evidence, in_readings, more, ratio_of, share

# Seconds of damped Arrow-Hurwicz and of PBD, as sections 3.2 and 3.4 of chapter 3 print them.
RUNTIMES = ((27.0, 0.08), (28.0, 0.08))
PROTRUSIONS, OTHERS = "[BP]", ("[A]", "[B]", "[S]")


@claim(
    "c0.faster",
    ("Position based dynamics simulates tissues more than 300 times faster than the damped Arrow-Hurwicz method."),
    source="introduction, Part II",
    quote="Thanks to that, we can simulate over 300 times faster",
    rests_on=("c3.speedup",),
    chosen="the runtimes are those that chapter 3 prints",
    arithmetic=True,
)
def _faster() -> Evidence:
    return Evidence(
        printed=tuple(
            at_least(f"printed runtimes, {slow:g} s over {fast:g} s", slow / fast, 300.0) for slow, fast in RUNTIMES
        )
    )


def pbd_error(dt: float) -> float:
    """Return the error of PBD at t = 2, when one of two discs pushes the other and slides around it."""
    scene = dincl.scenes.two_disks()
    exact = np.full((2, 2), np.nan) if scene.exact is None else scene.exact(2.0)
    return float(np.abs(dincl.solve(scene, dincl.PBD(dt=dt), t=2.0).final - exact).max())


@claim(
    "c0.converges",
    "Position based dynamics converges to the exact solution as the steps get shorter.",
    source="introduction, Part I",
    quote="the PBD method converges in numerical tests to the exact solutions.",
    rests_on=("c2.order-exact",),
    tried_on="two discs, one of which pushes the other and slides around it",
)
def _converges() -> Evidence:
    coarse, fine = (pbd_error(dt) for dt in (0.04, 0.0025))
    return Evidence(
        printed=(
            at_most("two discs at t = 2: error of PBD, step 0.0025 over 16 times that step", fine / coarse, 0.2),
            at_most("error at step 0.0025 [length]", fine, 1e-2),
        )
    )


def pbd_by_hand(x: Floats, h: float, steps: int) -> tuple[Floats, int]:
    """Make steps of -x with one operation for each overlap of discs of radius 1/2, i by i, then j < i; count them."""
    x, operations, pairs = x.copy(), 0, [(i, j) for i in range(len(x)) for j in range(i)]
    for _ in range(steps):
        x -= h * x
        for i, j in pairs:
            arrow = x[i] - x[j]
            overlap = 1.0 - math.hypot(*arrow)
            if overlap > 0:
                push = overlap / 2 * arrow / (1.0 - overlap)
                x[i], x[j], operations = x[i] + push, x[j] - push, operations + 1
    return x, operations


@claim(
    "c0.simple",
    ("Position based dynamics makes one simple operation per overlap, and has no multipliers or numerical parameters."),
    source="introduction, Part I",
    quote=("one simple operation per overlap, but neither Lagrangian multipliers nor artificial numerical parameters."),
    rests_on=("c2.algorithm",),
    tried_on="four discs, 200 steps",
)
def _simple() -> Evidence:
    """A loop that has no parameter but the step."""
    scene = dincl.scenes.four_disks()
    found = dincl.solve(scene, dincl.PBD(dt=0.01), t=2.0)
    (x, operations), stats = pbd_by_hand(scene.x0, 0.01, 200), found.stats
    off = float(np.abs(found.final - x).max())
    return Evidence(
        printed=(
            at_most("largest distance of the solver from a loop with one operation per overlap", off, 0.0, ROUNDING),
            equal("operations of the solver less those of the loop", stats.constraint_projections - operations, 0),
            equal("calls of a solver for multipliers", stats.solver_calls, 0),
            at_least("operations of the loop", operations, 1),
        )
    )


@claim(
    "c0.protrusions",
    ("Cells with protrusions leave basally far more often than others, which are at risk of leaving apically."),
    source="introduction, Part II",
    quote=(
        "cells showing protrusive activities … are much more efficient at exiting basally than cells relying "
        "on passive forces"
    ),
    needs=(RATIOS,),
    rests_on=("c4.protrusions",),
    chosen="isolated cells with one event, with INM",
)
def _protrusions(tables: Tables) -> Evidence:
    """[BP] against the best other event, by basal extrusion; and the most of apical extrusion without [P]."""

    def compare(preset: str) -> Evidence:
        with_p = ratio_of(tables, preset, "figure10", PROTRUSIONS, "basal")
        most, risk = (
            max((ratio_of(tables, preset, "figure10", event, what) for event in OTHERS), key=lambda ratio: ratio.value)
            for what in ("basal", "apical")
        )
        return evidence(
            [
                more("basal extrusion with [P] minus the most without", Difference(with_p, most)),
                share("most apical extrusion without [P]", risk, 0.01),
            ]
        )

    return in_readings(compare)
