"""Introduction: what it says of the method, the model of cells and the mean-field limit."""

from __future__ import annotations

import math
from itertools import product

import numpy as np

import dincl
from tissue.statistics.comparisons import Difference, runs_needed
from verification.claims import Comparison, Evidence, Tables, Verdict, at_least, at_most, equal, proved
from verification.thesis.chapter1.sets import Floats
from verification.thesis.chapter4.claims.s4_6_conditional import by_kind
from verification.thesis.chapter4.frequencies import (
    CONDITIONAL,
    DECIDES,
    RATIOS,
    alike,
    more,
    most_runs,
    needed,
    ratio_of,
    runs_for_margin,
)
from verification.thesis.chapter4.ratio_claims import ALIKE, CLAIM_LEVEL
from verification.thesis.chapter4.studies import PRESETS
from verification.thesis.chapter5.claims.s1_introduction import mass_rates
from verification.thesis.text.quoted import claim

ROUNDING = 1e-12
# Seconds of damped Arrow-Hurwicz and of PBD, as sections 3.2 and 3.4 of chapter 3 print them.
RUNTIMES = ((27.0, 0.08), (28.0, 0.08))
PROTRUSIONS, OTHERS = "[BP]", ("[A]", "[B]", "[S]")


@claim(
    "c0.faster",
    "How much faster the new method simulates tissues, beside the runtimes of chapter 3.",
    "introduction, Part II",
    chosen="the runtimes are those that chapter 3 prints",
)
def _faster() -> Evidence:
    ratios = [slow / fast for slow, fast in RUNTIMES]
    return Evidence(
        f"The runtimes that chapter 3 prints, 27 s (28 s) and 0.08 s, have the ratios "
        f"{' and '.join(f'{ratio:.1f}' for ratio in ratios)}.",
        printed=(at_least("least ratio of the printed runtimes", min(ratios), 300.0),),
    )


def pbd_error(dt: float) -> float:
    """The error of PBD at t = 2, when one of two discs pushes the other and slides around it."""
    scene = dincl.scenes.two_disks()
    exact = np.full((2, 2), np.nan) if scene.exact is None else scene.exact(2.0)
    return float(np.abs(dincl.solve(scene, dincl.PBD(dt=dt), t=2.0).final - exact).max())


@claim(
    "c0.converges",
    "Position based dynamics comes to the exact solution as the steps get shorter.",
    "introduction, Part I",
    Verdict.NOT_REFUTED,
    tried_on="two discs, one of which pushes the other and slides around it",
)
def _converges() -> Evidence:
    errors = [pbd_error(dt) for dt in (0.04, 0.01, 0.0025)]
    order = math.log(errors[0] / errors[2], 16)
    return Evidence(
        f"Two discs whose motion is known, at t = 2: errors of PBD {errors[0]:.1e}, {errors[1]:.1e}, {errors[2]:.1e} "
        f"for dt = 0.04, 0.01, 0.0025, of order {order:.2f}.",
        printed=(
            at_most("error, dt/16 over dt", errors[2] / errors[0], 0.2),
            at_most("error at dt = 0.0025", errors[2], 1e-2),
        ),
    )


def pbd_by_hand(x: Floats, h: float, steps: int) -> tuple[Floats, int]:
    """Steps of -x, with one operation for each overlap of discs of radius 1/2, i by i, then j < i; and their number."""
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
    "What a step of position based dynamics takes.",
    "introduction, Part I",
    Verdict.NOT_REFUTED,
    tried_on="four discs, 200 steps",
)
def _simple() -> Evidence:
    scene = dincl.scenes.four_disks()
    found = dincl.solve(scene, dincl.PBD(dt=0.01), t=2.0)
    x, operations = pbd_by_hand(scene.x0, 0.01, 200)
    off = float(np.abs(found.final - x).max())
    return Evidence(
        f"Four discs, 200 steps: a loop that has no parameter but h and makes one operation for each of {operations} "
        f"overlaps gives the states of the solver to {off:.0e}; that counts {found.stats.constraint_projections} "
        f"operations and {found.stats.solver_calls} calls of a solver for multipliers.",
        printed=(
            at_most("difference of the states", off, 0.0, ROUNDING),
            equal("operations of the solver less overlaps", found.stats.constraint_projections - operations, 0),
            equal("calls of a solver for multipliers", found.stats.solver_calls, 0),
        ),
    )


def scenarios() -> int:
    """Orders of the four events in time, each of which may not happen or happen with others."""
    found = set()
    for a, b, s, p in product((1, 2, 3, 4, math.inf), repeat=4):
        times = (a, b, s, max(p, b))
        ranks = sorted({t for t in times if t < math.inf})
        found.add(tuple(ranks.index(t) if t < math.inf else None for t in times))
    return len(found)


@claim(
    "c0.scenarios",
    "How many scenarios the four event times make.",
    "introduction, Part II",
    chosen="the parameters are the four times of chapter 4, section 2.2; scenarios differ by the order of events, "
    "not by their times; groups of two cells",
)
def _scenarios() -> Evidence:
    one = scenarios()
    two = one * (one + 1) // 2
    return Evidence(
        f"The four times, each also ∞, with [P] not before [B], have {one} orders; two cells with times of their own "
        f"have {two} scenarios. With and without INM, which is no time, there are {2 * one} for a cell.",
        printed=(at_least("scenarios of two cells", two, 2000),),
    )


@claim(
    "c0.protrusions",
    "Cells with protrusions leave basally more often; those without may leave apically.",
    "introduction, Part II",
    needs=(RATIOS,),
    chosen="isolated cells with one event, with INM, by the model as printed, with corrected energies and as published",
)
def _protrusions(tables: Tables) -> Evidence:
    """[BP] against the best other event, by basal extrusion; and the most of apical extrusion without [P]."""
    comparisons: list[Comparison] = []
    told, runs = [], 0
    for preset, suffix in PRESETS.items():
        study = f"figure10{suffix}"
        with_p = ratio_of(tables, study, PROTRUSIONS, "basal")
        others = [ratio_of(tables, study, event, "basal") for event in OTHERS]
        risk = [ratio_of(tables, study, event, "apical") for event in OTHERS]
        most = max(others, key=lambda ratio: ratio.value)
        more, worst = Difference(with_p, most), max(risk, key=lambda ratio: ratio.value)
        interval = more.interval(CLAIM_LEVEL)
        runs = max(runs, runs_needed(with_p.value, most.value, level=CLAIM_LEVEL) or 0)
        comparisons += [
            at_least(f"[P] less the best other, {preset}", with_p.value - most.value, 0.0, interval=interval),
            at_least(f"apical without [P], {preset}", worst.value, 0.01, interval=worst.interval(CLAIM_LEVEL)),
        ]
        told.append(
            f"{preset}: basal with [P] {with_p.value:.2f}, without at most {most.value:.2f}, apical {worst.value:.2f}"
        )
    return Evidence(f"Isolated cells, ratios; {'; '.join(told)}.", printed=tuple(comparisons), runs_needed=runs)


@claim(
    "c0.timing",
    "Of no event the time matters for basal extrusion.",
    "introduction, Part II",
    Verdict.CORRECTED,
    needs=(CONDITIONAL,),
    chosen=f"cells without [P] of the group '35 % [P]'; relevant: more than {ALIKE:.0%}; each limit below the least "
    "difference of the evidence decides alike",
)
def _timing(tables: Tables) -> Evidence:
    """Basal extrusion with [A] at 6 h to 9 h minus that at 21 h to 24 h, for cells with INM and without."""
    found = by_kind(tables, "t_a_h")
    least = min(each[DECIDES].interval(CLAIM_LEVEL)[0] for each in found)
    values = " and ".join(f"{100 * each[DECIDES].value:+.0f}" for each in found)
    return Evidence(
        f"Cells with [A] at 6 h to 9 h leave basally more often than those with [A] at 21 h to 24 h, by {values} "
        f"points, with and without INM: by {100 * least:.0f} at least.",
        printed=(alike("early minus late [A]", *found, margin=ALIKE),),
        corrected=(more("early minus late [A]", *found),),
        runs_needed=most_runs((needed(*found), *(runs_for_margin(each[DECIDES], ALIKE) for each in found))),
    )


@claim(
    "c0.mean-field-mass",
    "When the inertia that constrained particles add to the macroscopic component changes.",
    "introduction, Part III",
    Verdict.PROVED,
)
def _mean_field_mass() -> Evidence:
    return proved(mass_rates())
