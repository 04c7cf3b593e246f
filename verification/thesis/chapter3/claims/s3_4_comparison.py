"""Chapter 3, sections 2.3.2, 3 and 3.4: DAHA against PBD in growing tissues, from tables of the report."""
# ruff: noqa: RUF001 - the formulas are quoted as they are printed

from __future__ import annotations

import math

import pandas as pd
from scipy.special import stdtrit

from verification.claims import Comparison, Evidence, MissingRow, Tables, Verdict, at_least, at_most, equal
from verification.thesis.chapter3.daha import (
    COMPARED,
    DOUBLED_CASE,
    OWN,
    PBD_SUBSTEPS,
    PRINTED,
    TERMINATING,
    THEORY,
    TIMES,
)
from verification.thesis.chapter3.intervals import CONFIDENCE, over_seeds
from verification.thesis.text.quoted import claim

USUAL, SHARE, DISTANCE, SUBSTEPS = 7500, 0.25, 0.06, min(PBD_SUBSTEPS)
# "Roughly every fourth", "close to", "almost optimal": what is taken as such.
ROUGHLY, CLOSE, ALMOST = 0.1, 0.25, 1.5
# Time steps in 10 h, each with SUBSTEPS gradients of PBD.
STEPS = 100
# Half-width of the 95 % interval of a median of n, in quartile distances over sqrt(n).
NOTCH = 1.57


@claim(
    "c3.part-way",
    "DAHA stops on its way from the start to the minimum.",
    "section 2.3.2",
    needs=("tissue_judged_steps",),
    chosen="stops on its way: at least a tenth of the way is left",
)
def _part_way(tables: Tables) -> Evidence:
    row = row_of(tables["tissue_judged_steps"], where="DAHA")
    interval = float(row["low"]), float(row["high"])
    return Evidence(
        f"in steps of a growing tissue DAHA with Table 4 goes {100 * row['part']:.0f} % [{100 * row['low']:.0f}, "
        f"{100 * row['high']:.0f}] of the way down to the minimum; ‖∇W - Jᵀλ‖/‖z‖ is {row['steepest']:.4f} at most, so "
        "near 2ε/α = 0.02",
        printed=(at_most("part of the way to the minimum", row["part"], 1 - ROUGHLY, interval=interval),),
        runs_needed=needed(row["steps"], (interval[1] - interval[0]) / 2, 1 - row["part"]),
    )


def runs_for(share: float, error: float) -> int:
    """Runs whose 95 % interval of a share reaches ``error`` to both sides."""
    return math.ceil(share * (1 - share) * (1.96 / error) ** 2)


@claim(
    "c3.every-fourth",
    "A quarter of the simulations by DAHA fail.",
    "sections 3 and 3.4",
    Verdict.OPEN,
    needs=("tissue_daha_failures",),
    chosen="runs of 10 h, at most 100,000 iterations in a step; whether desired rest lengths may be negative",
)
def _failures(tables: Tables) -> Evidence:
    """The share is that of one of the two readings of the model: it is not known more closely than they differ."""
    table = tables["tissue_daha_failures"]
    one, other = (row_of(table, case=case, eps=OWN) for case in (PRINTED, TERMINATING))
    low, high = min(one["low"], other["low"]), max(one["high"], other["high"])
    middle = (one["share"] + other["share"]) / 2
    return Evidence(
        f"runs of 10 h that do not terminate: {one['failed']} of {one['runs']} with desired rest lengths d - R_soft as "
        f"printed, {other['failed']} of {other['runs']} where they are not below 0. One in four lies between: the text "
        "does not say enough to decide it",
        printed=(equal("share of runs that fail", middle, SHARE, ROUGHLY, interval=(low, high)),),
        runs_needed=runs_for(SHARE, ROUGHLY),
    )


def row_of(table: pd.DataFrame, **where: object) -> pd.Series:
    """The row with these values; MissingRow if there is none."""
    for name, value in where.items():
        table = table[table[name] == value]
    if table.empty:
        raise MissingRow(f"no row where {', '.join(f'{name} is {value}' for name, value in where.items())}")
    return table.iloc[0]


def needed(runs: float, half: float, gap: float) -> int:
    """Runs with which an interval that has the half-width ``half`` with ``runs`` of them shrinks to ``gap``."""
    return max(2, math.ceil(runs * (half / gap) ** 2)) if math.isfinite(half) else 2


@claim(
    "c3.iterations",
    "How many iterations DAHA needs in a step.",
    "section 3.1, Figure 11",
    needs=("tissue_daha_iterations",),
    chosen="close: within a quarter",
)
def _iterations(tables: Tables) -> Evidence:
    row = row_of(tables["tissue_daha_iterations"], case=PRINTED, eps=OWN)
    half = NOTCH * (row["high"] - row["low"]) / math.sqrt(row["terminated"])
    interval = (row["median"] - half) / USUAL, (row["median"] + half) / USUAL
    return Evidence(
        f"thesis preset, Table 4: {row['terminated']} steps take {row['median']:.0f} iterations in the median, half of "
        f"them {row['low']:.0f} to {row['high']:.0f}, {row['mean']:.0f} on average; every limit above "
        f"{100 * max(abs(end - 1) for end in interval):.0f} % of 7500 decides alike",
        printed=(
            equal("median of the iterations over 7500", row["median"] / USUAL, 1.0, CLOSE, interval),
            at_most("lower quartile of the iterations", row["low"], USUAL),
            at_least("upper quartile of the iterations", row["high"], USUAL),
        ),
        runs_needed=needed(row["terminated"], half / USUAL, CLOSE - abs(row["median"] / USUAL - 1)),
    )


@claim(
    "c3.optimal",
    "The damping that is derived makes PBD nearly as close to DAHA as any.",
    "section 3.1",
    needs=("tissue_daha_fits",),
    chosen="the step of DAHA is that of (3.26), from which 0.1333 is derived (c3.update); almost: within a factor "
    "1.5; desired rest lengths as corrected in c3.gradients",
)
def _optimal(tables: Tables) -> Evidence:
    fits = tables["tissue_daha_fits"]
    own, doubled = (row_of(fits, case=case, t=max(TIMES), substeps=SUBSTEPS) for case in (TERMINATING, DOUBLED_CASE))
    low, best, high = (float(doubled[name]) for name in ("mu_low", "mu", "mu_high"))
    return Evidence(
        f"nuclei at 10 h are nearest to those of DAHA with the step of (3.26), as printed, at μ = {best:.3f} "
        f"[{low:.3f}, {high:.3f}] h; with that of (3.25) and Table 4, α/2, at {own['mu']:.3f} [{own['mu_low']:.3f}, "
        f"{own['mu_high']:.3f}] h, {own['mu'] / best:.1f} times as much. Every factor above "
        f"{max(high / THEORY, THEORY / low):.2f} decides alike",
        printed=(Comparison("best μ over 0.1333 h", best / THEORY, 1 / ALMOST, ALMOST, (low / THEORY, high / THEORY)),),
        runs_needed=needed(doubled["runs"], (high - low) / 2, abs(ALMOST * THEORY - best)),
    )


@claim(
    "c3.gradients",
    "DAHA evaluates the gradient some 300 times as often as PBD.",
    "section 3.4",
    Verdict.CORRECTED,
    needs=("tissue_daha",),
)
def _work(tables: Tables) -> Evidence:
    table = tables["tissue_daha"]
    usual = table[(table["kind"] == "run") & (table["eps"] == OWN)]
    by_letter, runs = usual[usual["case"] == PRINTED], usual[usual["case"] == TERMINATING]
    letter_ended = int(by_letter["terminated"].eq(True).sum())
    ended = runs.loc[runs["terminated"].eq(True), "iterations"]
    work = over_seeds(ended / (STEPS * SUBSTEPS))
    half, told = (work.high - work.low) / 2, USUAL / SUBSTEPS
    return Evidence(
        f"10 h of tissue take DAHA {work.mean:.0f} [{work.low:.0f}, {work.high:.0f}] times as many gradients as PBD "
        f"with 20 substeps; 7500/20 = {told:.0f}. That is with desired rest lengths ≥ 0; with d - R_soft as printed "
        f"{letter_ended} of {len(by_letter)} runs end",
        printed=(at_least("runs of DAHA that end, rest lengths as printed", letter_ended, 1),),
        corrected=(
            at_least("gradients of DAHA over those of PBD", work.mean, 300.0, interval=(work.low, work.high)),
            equal("the same over 7500/20", work.mean / told, 1.0, CLOSE, (work.low / told, work.high / told)),
        ),
        runs_needed=needed(len(ended), half, work.mean - 300.0),
    )


def _beyond(row: pd.Series, value: float) -> float:
    """How far a value is from the mean of n runs, over the half-width in which 95 % of single runs lie."""
    runs = int(row["runs"])
    quantile = float(stdtrit(runs - 1, 0.5 + CONFIDENCE / 2))
    deviation = (row["high"] - row["low"]) / 2 / quantile * math.sqrt(runs)
    return float(abs(value - row["relative"]) / (quantile * deviation * math.sqrt(1 + 1 / runs)))


@claim(
    "c3.six-per-cent",
    "How far apart the nuclei of one simulation by both methods are.",
    "section 3.4",
    needs=("tissue_daha_distances",),
    chosen="the step of DAHA is that of (3.26), desired rest lengths as corrected in c3.gradients; one run is compared "
    "with the spread of single runs",
)
def _distance(tables: Tables) -> Evidence:
    table = tables["tissue_daha_distances"]
    at = {"kind": "pbd", "t": max(TIMES), "mu": COMPARED, "substeps": SUBSTEPS}
    doubled, own = (row_of(table, case=case, **at) for case in (DOUBLED_CASE, TERMINATING))
    told = [
        f"{100 * row['relative']:.1f} % [{100 * row['low']:.1f}, {100 * row['high']:.1f}]" for row in (doubled, own)
    ]
    return Evidence(
        f"nuclei of DAHA and PBD at 10 h, μ = 0.14: with the step of (3.26) {told[0]} apart on average, at least "
        f"{100 * doubled['least']:.1f} %; 6 % is {_beyond(doubled, DISTANCE):.2f} of the way out of what 95 % of "
        f"single runs show. With (3.25) and Table 4 {told[1]}: {_beyond(own, DISTANCE):.1f} of that way",
        printed=(at_most("6 %, over the reach of single runs", _beyond(doubled, DISTANCE), 1.0),),
        runs_needed=needed(
            doubled["runs"], (doubled["high"] - doubled["low"]) / 2, abs(doubled["relative"] - DISTANCE)
        ),
    )
