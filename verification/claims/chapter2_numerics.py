"""Chapter 2, section 4: what the thesis says about its experiments, and Figure 2."""

from __future__ import annotations

import pandas as pd

from verification.claim import Claim, Kind, Tables, Verdict, corrected_if, holds_if
from verification.methods import CATCH_UP, LINEARISED_CLARABEL, PBD, REFERENCE_TOL

# An order is one if its interval lies within this distance of 1.
ORDER_BAND = 0.1
# "A small margin" is read as at most this factor.
SMALL_MARGIN = 2.0
# Discs that end farther than this, a radius, from where they belong have been thrown away [length].
THROWN = 0.5
# A disc that moved less than this in a quarter of a unit of time is at rest [length].
AT_REST = 1e-6


def _order(scene: str, tables: Tables) -> Verdict:
    rows = tables["orders"]
    mine = rows[(rows["scene"] == scene) & (rows["method"] == PBD.name)]
    one = bool(((mine["low"] > 1 - ORDER_BAND) & (mine["high"] < 1 + ORDER_BAND)).all())
    return holds_if(one, "order of PBD " + "; ".join(f"t = {row.t:g}: {row.order}" for row in mine.itertuples()))


def _four(tables: Tables) -> Verdict:
    return _order("four_disks", tables)


def _ten(tables: Tables) -> Verdict:
    return _order("ten_disks_corner", tables)


def _pbd_errors(tables: Tables, scene: str) -> pd.DataFrame:
    rows = tables["convergence"]
    return rows[(rows["scene"] == scene) & (rows["method"] == PBD.name)].pivot(index="dt", columns="t", values="error")


def _decreases(tables: Tables) -> Verdict:
    errors = _pbd_errors(tables, "four_disks")
    ratio = errors[2.0] / errors[1.0]
    return holds_if(
        bool((ratio < 1).all()),
        f"the error of PBD at t = 2 is {ratio.min():.2f} to {ratio.max():.2f} of that at t = 1, over {len(ratio)} "
        "step sizes",
    )


def _tolerance(tables: Tables) -> Verdict:
    rows = tables["convergence"]
    mine = rows[(rows["method"] == CATCH_UP.name) & (rows["scene"] == "four_disks")]
    smallest = float(mine["error"].min())
    return corrected_if(
        smallest < REFERENCE_TOL,
        smallest > 100 * REFERENCE_TOL,
        f"the smallest time-stepping error of catch-up with four discs is {smallest:.1e} (dt = "
        f"{mine['dt'].min():.2g}), {smallest / REFERENCE_TOL:.0e} times the tolerance: it must read “much smaller "
        "than the errors”",
    )


def _coincides(tables: Tables) -> Verdict:
    rows, runs = tables["references"], tables["convergence"]
    allowed = rows["catch_up_error"] + rows["linearised_error"] + REFERENCE_TOL
    worst = rows["linearised"].idxmax()
    mine = runs[(runs["scene"] == "four_disks") & (runs["t"] == 1.0)].pivot(
        index="dt", columns="method", values="error"
    )
    finest = mine[[CATCH_UP.name, LINEARISED_CLARABEL.name]].dropna().sort_index().iloc[0]
    return holds_if(
        bool((rows["linearised"] <= allowed).all()),
        f"extrapolated, the two are at most {rows['linearised'][worst]:.1e} apart, within the sum of their stated "
        f"errors ({allowed[worst]:.1e}); at one and the same step they differ: at dt = {finest.name:.2g} the errors of "
        f"four discs at t = 1 are {finest.iloc[0]:.1e} and {finest.iloc[1]:.1e}",
    )


def _margin(tables: Tables) -> Verdict:
    rows = tables["penalty_best"].dropna(subset="strength")
    largest, mean = rows["largest"] / rows["pbd_largest"], rows["mean"] / rows["pbd_mean"]
    spring = rows["exponent"] == 2
    better = bool((largest > 1).all() and (mean[spring] > 1).all())
    small = bool(largest.max() <= SMALL_MARGIN and (mean > 1).all())
    note = "" if small else " (not by a small margin everywhere, and not in every mean)"
    return corrected_if(
        better and small,
        better,
        f"largest overlap in time, penalty over PBD{note}: "
        f"{largest[spring].min():.2f} to {largest[spring].max():.2f} for springs and {largest[~spring].min():.2f} to "
        f"{largest[~spring].max():.2f} for the force as printed; of the means in time {mean[spring].min():.2f} to "
        f"{mean[spring].max():.2f} and {mean[~spring].min():.2f} to {mean[~spring].max():.2f}",
    )


def _strength(tables: Tables) -> Verdict:
    rows = tables["penalty_scan"]
    springs = rows[rows["exponent"] == 2]
    weak = springs.loc[springs.groupby(["scene", "dt"])["strength"].idxmin()]
    strong = springs.loc[springs.groupby(["scene", "dt"])["strength"].idxmax()]
    best = springs.groupby(["scene", "dt"])["largest"].min().min()
    flown = strong["error"].fillna(float("inf"))
    return holds_if(
        bool((weak["largest"] > 10 * best).all() and (flown > THROWN).all()),
        f"springs: at the smallest strength the overlap reaches {weak['largest'].min():.2f} or more, at the largest "
        f"the discs end {flown.min():.2g} or more from where they belong",
    )


def _large(tables: Tables) -> Verdict:
    rows = tables["large_steps"]
    pbd, penalty = rows[rows["method"] == PBD.name], rows[rows["method"] != PBD.name]
    done = pbd[pbd["status"] == "SUCCESS"]
    stopped = ", ".join(
        f"{row.scene} at dt = {row.dt:g} stops ({row.status})" for row in pbd[pbd["status"] != "SUCCESS"].itertuples()
    )
    threshold = penalty[~penalty["stable"]].groupby("method")["dt"].min()
    limits = ", ".join(f"{name.replace('_', ' ')} from dt = {dt:g}" for name, dt in threshold.items())
    return corrected_if(
        bool(done["stable"].all()) and not stopped,
        bool(done["stable"].all()),
        f"PBD at dt = {pbd['dt'].min():g} … {pbd['dt'].max():g}: the discs get at most {done['growth'].max():.2f} "
        f"times as far out as at the start{'; ' + stopped if stopped else ''}; unstable are {limits}",
    )


def _at_rest(tables: Tables) -> Verdict:
    rows = tables["positions"]
    rows = rows[rows["scene"] == "ten_disks_corner"].set_index(["t", "particle"])[["x", "y"]]
    moved = {t: ((rows.loc[t] - rows.loc[t - 0.25]) ** 2).sum(axis=1) ** 0.5 for t in (1.0, 2.0, 3.0)}
    resting = {t: int((values < AT_REST).sum()) for t, values in moved.items()}
    text = ", ".join(f"{count} at t = {t:g}" for t, count in resting.items())
    return Verdict(
        Kind.HOLDS if resting[1.0] < 5 < resting[3.0] else Kind.FAILS,
        f"discs at rest, of ten: {text} (the start is ours, the thesis does not give its own)",
    )


CLAIMS = (
    Claim(
        "c2.large-steps",
        "Figure 2",
        "Crucially, the use of large time steps does not make the simulations unstable.",
        _large,
        ("large_steps",),
    ),
    Claim(
        "c2.tolerance",
        "section 4.1",
        "We set tol to 10⁻¹¹ which was much larger than the errors introduced by the time-stepping.",
        _tolerance,
        ("convergence",),
    ),
    Claim(
        "c2.coincides",
        "section 4.1",
        "The computed solutions from [inner convex approximation] coincided with the solutions computed with "
        "Moreau's catch-up scheme.",
        _coincides,
        ("references", "convergence"),
    ),
    Claim(
        "c2.order-four",
        "Figure 4",
        "The PBD method converges to the reference solution with order 1.",
        _four,
        ("orders",),
    ),
    Claim(
        "c2.decreases",
        "section 4.2",
        "The global error decreases at the end of the simulation, e.g. at t = 2, compared to … t = 1.",
        _decreases,
        ("convergence",),
    ),
    Claim(
        "c2.order-ten",
        "Figure 5",
        "Also here, the PBD converges to the reference solution with order 1.",
        _ten,
        ("orders",),
    ),
    Claim(
        "c2.at-rest",
        "section 4.2",
        "At time t = 1 most disks are falling … at t = 3 most disks will be in a stationary position.",
        _at_rest,
        ("positions",),
    ),
    Claim(
        "c2.strength",
        "section 4.3",
        "For too large penalty parameters, simulations become unstable, but for too small …, the constraints will "
        "be violated too strongly.",
        _strength,
        ("penalty_scan",),
    ),
    Claim(
        "c2.margin",
        "Figure 6",
        "PBD is able to outperform the penalty method by a small margin, even for optimal choice of the penalty "
        "parameter.",
        _margin,
        ("penalty_best",),
    ),
)
