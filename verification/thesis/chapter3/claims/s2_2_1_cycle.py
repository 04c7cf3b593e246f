"""Chapter 3, section 2.2.2: the rest lengths of a cell in the phases of its cycle."""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd

from verification.claims import Correction, Effect, Evidence, Tables, at_most, claim
from verification.claims.formal.algebra import library
from verification.claims.formal.stated import identity
from verification.thesis.chapter3 import page as made
from verification.thesis.chapter3.claims.s1_3_model import grown
from verification.thesis.chapter3.sampled import G2, MITOSIS, MODEL, R_SOFT, SEEDS, daha_runs_ending, of_mean

sp = library()

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
