"""Chapter 4, section 4.3: Tables 3 to 5 against captions, text and runs; freed springs draw the nucleus back."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

import numpy as np

from tissue.files.parameters import preset as named
from tissue.files.quantities import timing
from tissue.frames.observables import ab_positions
from tissue.runs.simulate import simulate_many
from tissue.state.cells import Floats
from verification.claims import Comparison, Correction, Effect, Evidence, at_least, at_most, claim, equal
from verification.thesis.chapter4.frequencies import in_readings, most_runs, runs_by_width
from verification.thesis.chapter4.ratios import wilson

SEED = 5
DRAWS = 200_000
LEVEL = 0.999
NEVER = np.inf
# (T_A, T_B) of Table 3 and (T_A, T_B, T_P) of Table 4 [h], in the order of their rows.
TABLE_4 = (
    (6, 12, 18),
    (12, 6, 18),
    (NEVER, 6, 6),
    (NEVER, 6, 18),
    (6, 18, NEVER),
    (18, 6, NEVER),
    (6, NEVER, NEVER),
    (18, NEVER, NEVER),
    (6, NEVER, NEVER),
    (NEVER, 18, NEVER),
    (NEVER, NEVER, NEVER),
)
# The rows of Table 5, as printed (lines 2907 to 2909); and the runs and cells of section 4.5.
TABLE_5 = tuple(
    {"P": f"6 h to 24 h, {p} %", "A": "6 h to 24 h, 70 %", "B": "6 h to 24 h, 70 %", "S": "never"} for p in (90, 50, 10)
)
STATED_RUNS, STATED_CELLS = 50_000, 10
# The ninth row, the partner of the tenth.
NINTH = (NEVER, 6, NEVER)


@claim(
    "c4.table-4",
    "The ninth program of Table 4, the one between [☒A] and [☒B], has [A] alone at 6 h.",
    source="Table 4",
    quote="☒: T^P = ∞, T^A = 6 h, T^B = ∞, T^S = ∞.",
    correction=Correction(
        "the ninth row is [B☒]: T^A = ∞, T^B = 6 h",
        Effect.NUMBER,
        "Figure 15 and section 4.4.1, which discuss [B☒]",
        why="as printed the row is the seventh once more, and no program is the early one of the pair with [☒B]",
        place=2871,
    ),
)
def _table4() -> Evidence:
    right = (*TABLE_4[:8], NINTH, *TABLE_4[9:])
    twice, still = (sum(n - 1 for n in Counter(rows).values()) for rows in (TABLE_4, right))
    return Evidence(
        printed=(at_most("rows of 11 with the times of another, [A] alone at 6 h", twice, 0),),
        corrected=(at_most("rows of 11 with the times of another, T^B = 6 h in the ninth", still, 0),),
    )


def acting(percent: float) -> Comparison:
    """P[T_P and T_B finite] of Table 5 [%]."""
    whether, when, other, then = np.random.default_rng(SEED).random((4, DRAWS))
    p = timing(f"6 h to 24 h, {percent:g} %").times(whether, when)
    b = timing("6 h to 24 h, 70 %").times(other, then)
    share = float((np.isfinite(p) & np.isfinite(b)).mean())
    low, high = wilson(share, DRAWS, LEVEL)
    return Comparison(
        f"cells in which [B] and [P] happen, [P] of U^{percent:g}%, {DRAWS} draws [%]",
        100 * share,
        -np.inf,
        np.inf,
        (100 * float(low), 100 * float(high)),
    )


@claim(
    "c4.seven-per-cent",
    "Protrusions take effect in 63 %, 35 % and 6 % of the cells of the three rows.",
    source="Table 5",
    quote="'6% [P]': U^{10%}(6 h, 24 h)",
    correction=Correction(
        "7 % = 10 % · 70 %",
        Effect.NUMBER,
        "the names in Figures 17 to 19",
        why="[P] acts only with [B], which 70 % of the cells have: 90 % and 50 % become 63 % and 35 %, 10 % become 7 %",
        place=2909,
    ),
)
def _seven() -> Evidence:
    found = [acting(percent) for percent in (90, 50, 10)]

    def against(*wanted: float) -> tuple[Comparison, ...]:
        rounded = ((each, each_wanted) for each, each_wanted in zip(found, wanted, strict=True))
        return tuple(equal(each.what, each.value, w, 0.5, each.interval) for each, w in rounded)

    return Evidence(
        printed=against(63, 35, 6),
        corrected=against(63, 35, 7),
        seed=SEED,
        runs_needed=most_runs(
            runs_by_width(DRAWS, each.value - end, each.interval)
            for each in against(63, 35, 7)
            for end in (each.low, each.high)
            if each.interval is not None
        ),
    )


@claim(
    "c4.data-points",
    "The heterogeneous runs observe five million EMT cells.",
    source="section 4.5",
    quote="50000 simulation runs with 10 EMT cells each, yielding 5×10⁶ data points",
    correction=Correction(
        "5 × 10⁵ data points",
        Effect.NUMBER,
        (
            "the accuracy of Figures 17 to 22; that millions of transitions were simulated (abstract, introduction): "
            "the three rows of Table 5 make 1.5 million"
        ),
        why="50000 runs of 10 cells are 500 000 cells",
        place=2913,
    ),
)
def _data_points() -> Evidence:
    points, what = STATED_RUNS * STATED_CELLS, f"{STATED_RUNS} runs of {STATED_CELLS} EMT cells [cells]"
    return Evidence(printed=(equal(what, points, 5e6),), corrected=(equal(what, points, 5e5),))


@claim(
    "c4.figure-20",
    "Figure 20 shows the times of [A], [B] and [S].",
    source="Figure 20",
    quote="Extrusion ratios for cells which start of [A], [B] and [S] within a particular time interval.",
    correction=Correction(
        "[A], [B] and [P], also in 'the timing of [B] and [P] are irrelevant'",
        Effect.NUMBER,
        "what the third panel of Figure 20 is of; section 4.5.3 says [P], the times of [S] were never drawn",
        why="Table 5 has T^S = ∞ for all cells, so none starts [S] in any interval; section 4.5.3 has [A], [B] and [P]",
        place=2955,
    ),
)
def _figure_20() -> Evidence:
    timed = {event for row in TABLE_5 for event, time in row.items() if timing(time).ever}
    return Evidence(
        printed=(equal("events of the caption with times in Table 5, of A, B, S", len(timed & set("ABS")), 3),),
        corrected=(equal("events of section 4.5.3 with times in Table 5, of A, B, P", len(timed & set("ABP")), 3),),
    )


# Runs with one cell each; how long after [B] they end [h].
SEEDS, AFTER = range(60, 120), 3


def positions(preset: str, seeds: Sequence[int], b: str) -> Floats:
    """Return y_AB of isolated EMT cells at 24 h and after some hours, for [A] at 6 h and [B] at ``b``: (2, seeds)."""
    emt = {"emt.cells": 1, "emt.a": "6 h", "emt.b": b}
    parameters = named(preset).changed(emt | {"numerics.t_end": f"{24 + AFTER} h", "numerics.keep": f"{AFTER} h"})
    runs = simulate_many(parameters, seeds)
    return np.array([[ab_positions(run.frames[k])[run.frames[k].cells.emt >= 0][0] for run in runs] for k in (-2, -1)])


@claim(
    "c4.pulled-back",
    "Some cells that left apically after [A] return into the tissue when [B] frees their basal spring.",
    source="Figure 14",
    quote=(
        "In [A⊗B], the amount of apical extrusion increases rapidly in the beginning … at the onset of [B] some cells "
        "are pulled back into the tissue."
    ),
    chosen=f"[A] at 6 h, [B] at 24 h; back: y^AB ≤ 1 within {AFTER} h; the same seeds with [B] and without",
)
def _pulled_back() -> Evidence:
    def compare(preset: str) -> Evidence:
        at, later = positions(preset, SEEDS, "24 h")
        above = [seed for seed, y in zip(SEEDS, at, strict=True) if y > 1]
        _, control = positions(preset, above, "never")
        back = int((later[at > 1] <= 1).sum()) - int((control <= 1).sum())
        return Evidence(
            printed=(
                at_least("isolated cells above the tissue at 24 h", len(above), 1),
                at_least("of these, return with [B] minus return without [B]", back, 1),
            )
        )

    return in_readings(compare)
