"""Chapter 4, Tables 3 to 5: the times against the captions, the text and each other."""
# ruff: noqa: RUF001 - the formulas are quoted as they are printed

from __future__ import annotations

from collections import Counter

import numpy as np

from tissue.files.timing import timing
from tissue.study.plan import load_study
from tissue.study.ratios import wilson
from verification.claim import Claim, Correction, Effect, Tables
from verification.evidence import Comparison, Evidence, Kind, at_most, equal
from verification.thesis.chapter4.frequencies import most_runs, runs_for_bound

SEED = 5
DRAWS = 200_000
LEVEL = 0.999
NEVER = np.inf
# (T_A, T_B) of Table 3 and (T_A, T_B, T_P) of Table 4 [h], in the order of their rows.
TABLE_3 = ((6, 24), (15, 15), (24, 6))
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
# The ninth row, the partner of the tenth.
NINTH = (NEVER, 6, NEVER)
# The names of these rows, and those that their times give.
NAMES = ("ABP", "BAP", "BP☒", "☒P", "A☒B", "☒A", "A☒", "☒A", "☒", "☒B", "∅")
RENAMED = ("ABP", "BAP", "BP☒", "B☒P", "A☒B", "B☒A", "A☒", "☒A", "B☒", "☒B", "∅")
# The first and the last time of Table 4, and the delay of the symbol ☒, by the caption of Figure 15 [h].
FIRST, LAST, DELAY = 6, 18, 12
# Rows 4 to 10 of Table 4 have a delay: between two events, or before or after one that is early or late.
DELAYED = ((3, 1, 2), (4, 0, 1), (5, 1, 0))
EARLY_LATE = ((6, 7, 0), (8, 9, 1))


def _delays(_: Tables) -> Evidence:
    third = [abs(b - a) for a, b in TABLE_3]
    rows = (*TABLE_4[:8], NINTH, *TABLE_4[9:])
    fourth = [rows[k][late] - rows[k][early] for k, early, late in DELAYED]
    fourth += [rows[late][event] - rows[early][event] for early, late, event in EARLY_LATE]
    return Evidence(
        f"Between [A] and [B] of Table 3 lie {third[0]} h, {third[1]} h and {third[2]} h; the five delays of Table 4 "
        f"are {', '.join(f'{delay:g}' for delay in fourth)} h.",
        printed=(
            *(
                equal(f"delay {k + 1} of Table 3 [h]", t, wanted)
                for k, (t, wanted) in enumerate(zip(third, (18, 0, 18), strict=True))
            ),
            *(equal(f"delay {k + 1} of Table 4 [h]", t, 12) for k, t in enumerate(fourth)),
        ),
    )


def _table4(_: Tables) -> Evidence:
    right = (*TABLE_4[:8], NINTH, *TABLE_4[9:])
    twice, still = (sum(n - 1 for n in Counter(rows).values()) for rows in (TABLE_4, right))
    ran = {
        tuple(event.fixed if event.ever else NEVER for event in (p.emt.a, p.emt.b, p.emt.p))
        for p in load_study("figure15").scenarios.values()
    }
    return Evidence(
        f"{twice} of the 11 rows repeats another: the ninth has the times of the seventh, [A] alone at 6 h. With "
        f"T^B = 6 h it is the partner of the tenth, and {still} rows repeat.",
        printed=(at_most("rows with the times of another", twice, 0),),
        corrected=(
            at_most("rows with the times of another", still, 0),
            equal("rows that the study of Figure 15 has", len(ran & set(right)), len(right)),
        ),
    )


def name_of(row: tuple[float, ...]) -> str:
    """The events in their order, with ☒ for 12 h between two, before the first or after the last."""
    timed = sorted((t, event) for t, event in zip(row, "ABP", strict=True) if t < NEVER)
    if not timed:
        return "∅"
    name, before = "", FIRST
    for t, event in timed:
        name += "☒" * (t - before == DELAY) + event
        before = t
    return name + "☒" * (LAST - before == DELAY)


def _names(_: Tables) -> Evidence:
    rows = (*TABLE_4[:8], NINTH, *TABLE_4[9:])
    by_times = [name_of(row) for row in rows]
    wrong = {names: [n for n, right in zip(names, by_times, strict=True) if n != right] for names in (NAMES, RENAMED)}
    twice, still = (sum(n - 1 for n in Counter(names).values()) for names in (NAMES, RENAMED))
    return Evidence(
        f"{len(wrong[NAMES])} names, {', '.join(wrong[NAMES])}, are not what the times of their rows give by the rule "
        f"of the others, {', '.join(right for name, right in zip(NAMES, by_times, strict=True) if name != right)}; "
        f"{twice} name stands at two rows.",
        printed=(
            at_most("names that are not those of the times", len(wrong[NAMES]), 0),
            at_most("names that occur again", twice, 0),
        ),
        corrected=(
            at_most("names that are not those of the times", len(wrong[RENAMED]), 0),
            at_most("names that occur again", still, 0),
        ),
    )


def acting(percent: float) -> Comparison:
    """P[T_P and T_B finite] of Table 5 [%]."""
    whether, when, other, then = np.random.default_rng(SEED).random((4, DRAWS))
    p = timing(f"6 h to 24 h, {percent:g} %").times(whether, when)
    b = timing("6 h to 24 h, 70 %").times(other, then)
    share = float((np.isfinite(p) & np.isfinite(b)).mean())
    low, high = wilson(share, DRAWS, LEVEL)
    return Comparison(f"cells with [P] of U^{percent:g}% [%]", 100 * share, -np.inf, np.inf, (100 * low, 100 * high))


def _seven(_: Tables) -> Evidence:
    found = [acting(percent) for percent in (90, 50, 10)]

    def against(*wanted: float) -> tuple[Comparison, ...]:
        rounded = ((each, each_wanted) for each, each_wanted in zip(found, wanted, strict=True))
        return tuple(equal(each.what, each.value, w, 0.5, each.interval) for each, w in rounded)

    return Evidence(
        f"In {DRAWS} draws [B] and [P] both happen in {', '.join(f'{each.value:.1f}' for each in found)} % of the "
        "cells of the three rows; the caption has 90 % · 70 % = 63 %, so the last row is 10 % · 70 % = 7 %.",
        printed=against(63, 35, 6),
        corrected=against(63, 35, 7),
        seed=SEED,
        runs_needed=most_runs(
            runs_for_bound(each.value / 100, end / 100) for each in against(63, 35, 7) for end in (each.low, each.high)
        ),
    )


def _data_points(_: Tables) -> Evidence:
    study = load_study("table5_35")
    (parameters,) = study.scenarios.values()
    points = study.replicates * parameters.emt.cells
    return Evidence(
        f"{study.replicates} runs of {parameters.emt.cells} EMT cells are {points:.0e} cells, a tenth of 5 × 10⁶.",
        printed=(equal("cells of a row of Table 5", points, 5e6, 5e5),),
        corrected=(equal("cells of a row of Table 5", points, 5e5, 5e4),),
    )


def _figure_20(_: Tables) -> Evidence:
    (parameters,) = load_study("table5_35").scenarios.values()
    timed = {event for event in "ABSP" if getattr(parameters.emt, event.lower()).ever}
    return Evidence(
        f"Table 5 has times of {', '.join(sorted(timed))}, and T^S = ∞ in all rows: no cell starts [S] in any time "
        "interval. The text of section 4.5.3 speaks of [A], [B] and [P].",
        printed=(equal("events of the caption with times, of A, B, S", len(timed & set("ABS")), 3),),
        corrected=(equal("events of the text with times, of A, B, P", len(timed & set("ABP")), 3),),
    )


CLAIMS = (
    Claim(
        "c4.delays",
        "Tables 3 and 4, Figure 15",
        "for [A☒B] there is an 18 h delay between [A] and [B] … The ⊗ symbol denotes 12 h delay",
        _delays,
        statement="The delays of Table 3 are 18 h, those of Table 4 are 12 h.",
        chosen="the ninth row of Table 4 as corrected in c4.table-4",
    ),
    Claim(
        "c4.table-4",
        "Table 4",
        "☒: T^P = ∞, T^A = 6 h, T^B = ∞, T^S = ∞.",
        _table4,
        statement="The times of the ninth program of Table 4, the one between [☒A] and [☒B].",
        recorded=Kind.CORRECTED,
        correction=Correction(
            "the ninth row is [B☒]: T^A = ∞, T^B = 6 h",
            Effect.NUMBER,
            "Figure 15 and section 4.4.1, which discuss [B☒]",
        ),
    ),
    Claim(
        "c4.table-4-names",
        "Table 4, Figure 15",
        "☒P: T^P = 18 h, T^A = ∞, T^B = 6 h … ☒A: T^P = ∞, T^A = 18 h, T^B = 6 h",
        _names,
        statement="The names of the programs of Table 4 tell their times, with ☒ for 12 h before or after an event.",
        recorded=Kind.CORRECTED,
        correction=Correction(
            "B☒P, B☒A, and B☒ for the ninth row, in 4.4.1, too",
            Effect.NOTATION,
            "which bars of Figure 15 are of which times: as printed ☒A is two programs",
        ),
        chosen="the times of the ninth row as corrected in c4.table-4",
    ),
    Claim(
        "c4.seven-per-cent",
        "Table 5",
        "'6% [P]': U^{10%}(6 h, 24 h)",
        _seven,
        statement="The share of cells in which protrusions take effect, in the three rows.",
        recorded=Kind.CORRECTED,
        correction=Correction("7 % = 10 % · 70 %", Effect.NUMBER, "the names in Figures 17 to 19"),
    ),
    Claim(
        "c4.data-points",
        "section 4.5",
        "50000 simulation runs with 10 EMT cells each, yielding 5×10⁶ data points",
        _data_points,
        statement="The number of EMT cells that the heterogeneous runs observe.",
        recorded=Kind.CORRECTED,
        correction=Correction("5 × 10⁵ data points", Effect.NUMBER, "the accuracy of Figures 17 to 22"),
    ),
    Claim(
        "c4.figure-20",
        "Figure 20",
        "Extrusion ratios for cells which start of [A], [B] and [S] within a particular time interval.",
        _figure_20,
        statement="The events whose times Figure 20 shows.",
        recorded=Kind.CORRECTED,
        correction=Correction(
            "[A], [B] and [P], also in 'the timing of [B] and [P] are irrelevant'",
            Effect.NUMBER,
            "what the third panel of Figure 20 is of; section 4.5.3 says [P], the times of [S] were never drawn",
        ),
    ),
)
