"""Chapter 3, sections 2.2.1 to 2.2.5: the phases of a cell, its rest lengths, and its division."""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd

from tissue.files.parameters import preset
from tissue.runs.simulate import simulate
from verification.claims import Correction, Effect, Evidence, Tables, at_least, at_most, claim
from verification.claims.formal.algebra import library
from verification.claims.formal.stated import identity
from verification.thesis.chapter3 import tables as made
from verification.thesis.chapter3.claims.s1_3_model import grown
from verification.thesis.chapter3.printed import G2, MITOSIS, R_SOFT
from verification.thesis.chapter3.sampled import MODEL, SEEDS, daha_runs_ending, of_mean, runs_for

sp = library()

# p^div of Table 1; cells after 48 h over those at the start.
ADDED, TOO_FAST, MODERATE = 0.2, 4.0, 2.5
# Rest lengths follow the extension if they are off by less than this part of what they are off in the last hour.
FOLLOWING = 0.5


t, k = sp.symbols("t k", positive=True)
start, wanted = sp.symbols("eta0 eta1")


def off(sign: int) -> Any:
    """Return what eta* + (eta(0) - eta*) exp(-sign k t) leaves of eta' = -k (eta - eta*), and of the start."""
    eta = wanted + (start - wanted) * sp.exp(-sign * k * t)
    return [eta.diff(t) + k * (eta - wanted), eta.subs(t, 0) - start]


_adaptation = identity(
    "c3.adaptation",
    "(3.2), (3.3), (3.6)",
    "dη^ax/dt = −k^ax (η^ax − η^ax*), dη^aa/dt = −k^aa η^aa, where k denotes the speed of adaptation",
    "Rest lengths approach the desired ones exponentially at the rates k.",
    right=off(1),
    wrong=off(-1),
    chosen="desired lengths stand still within a step",
)


def off_length(table: pd.DataFrame) -> pd.Series:
    """Return |‖X − A‖ − R^soft − η^ax| of each cell [R_soft]."""
    x, y = (table[f"nucleus_{axis}_um"] - table[f"apical_{axis}_um"] for axis in "xy")
    off: pd.Series = (np.hypot(x, y) - R_SOFT - table["apical_rest_um"]).abs() / R_SOFT
    return off


def following(seed: int) -> float:
    """Return the mean of ``off_length`` in G1 and S over the mean in the last hour of the cycle, from 2 h on."""
    table = grown(seed)
    table = table[table["time_h"] > 2.0]
    passive = table["age_h"] < table["cycle_h"] - G2 - MITOSIS
    off = off_length(table)
    return float(off[passive].mean() / off[~passive].mean())


@claim(
    "c3.passive-springs",
    (
        "In G1 and S the rest lengths follow the extension of the springs, with desired lengths of ‖X − A‖ − R^soft "
        "and ‖X − B‖ − R^soft."
    ),
    source="section 2.2.2",
    quote=(
        "During the G1 and the S phase, the cytoskeleton of the cell will adapt to the current extension: η^ax* := ‖X "
        "− A‖ − R^soft"
    ),
    correction=Correction(
        "η^ax* := max(0, ‖X − A‖ − R^soft), η^bx* := max(0, ‖X − B‖ − R^soft)",
        Effect.MODEL,
        (
            "all comparisons with DAHA in sections 3.1, 3.4 and 4: with the printed energies and rest lengths no run "
            "of 10 h by DAHA ends, and there is nothing to compare"
        ),
        why=(
            "a nucleus nearer than R^soft to an end of its cell gets a negative rest length, and a spring that "
            "stiffens like 1/d; the published program has max(0, ·) (time_step_springs! in src/core/simulate.jl of "
            "sEMTor.jl). With the squared denominators of c3.dimensions runs end by the printed rule as well"
        ),
        place=1725,
    ),
    needs=(made.SHARES,),
    rests_on=(*MODEL, "c3.adaptation", "c3.daha-multiplier"),
    chosen="DAHA with Table 4, at most 100,000 iterations in a step, denominators as printed: the rule is complete if "
    "half of the runs of 10 h end; rest lengths follow if they are off by less than half as much as in the last hour",
)
def _passive(tables: Tables) -> Evidence:
    ratios = [following(seed) for seed in SEEDS]
    what = "|‖X − A‖ − R^soft − η^ax| in G1 and S over the same in the last hour"
    return Evidence(
        printed=(of_mean(what, ratios, at_most, FOLLOWING), daha_runs_ending(tables, "as printed")),
        corrected=(of_mean(what, ratios, at_most, FOLLOWING), daha_runs_ending(tables, "desired rest lengths ≥ 0")),
        seed=SEEDS[0],
    )


# A straight cell of height h, its nucleus at y above B: W^ax + W^bx >= 0 is 0 at y = h - R, and so are both forces.
y = sp.symbols("y", positive=True)


def cells_after(share: float, seed: int) -> float:
    """Return the cells after 48 h over those at the start, if such a share of divisions adds one."""
    changes = {"tissue.two_daughters": share, "numerics.t_end": "48 h", "numerics.keep": "48 h"}
    run = simulate(preset("thesis").changed(changes), seed)
    return len(run.final.cells.x) / len(run.frames[0].cells.x)


@claim(
    "c3.slice",
    "With cycles of 10 to 21 hours a slice of tissue grows too fast if each division adds a cell to it.",
    source="section 2.2.5",
    quote=(
        "since we only model a 2D slice of a three-dimensional tissue, the growth of the tissue would be too fast if "
        "cells divide at a realistic rate"
    ),
    rests_on=MODEL,
    chosen="60 cells at the start; in vivo the tissue at most doubles its height in 48 h. Too fast: more than 4 times "
    "the cells in that time, and not more than 2.5 times with p^div = 20 %",
)
def _slice() -> Evidence:
    some, every = ([cells_after(share, seed) for seed in SEEDS[:3]] for share in (ADDED, 1.0))
    what = "cells after 48 h over those at the start"
    return Evidence(
        printed=(
            of_mean(f"{what}, if every division adds one", every, at_least, TOO_FAST),
            of_mean(f"{what}, if 20 % of divisions add one", some, at_most, MODERATE),
        ),
        seed=SEEDS[0],
        runs_needed=max(
            runs_for(some, MODERATE - float(np.mean(some))), runs_for(every, float(np.mean(every)) - TOO_FAST)
        ),
    )
