"""Chapter 2, section 4.3: PBD against the penalty method with its best strength."""

from __future__ import annotations

from verification.claims import Evidence, Tables, at_least
from verification.thesis.text.quoted import claim

# Discs that end farther than this, a radius, from where they belong have been thrown away [length].
THROWN = 0.5
# An overlap that is more than rounding or the accuracy of a projection [length].
VISIBLE = 1e-4
# Best strengths that differ by this factor need to be looked for: no single value serves.
DIFFERENT = 1.5
# "Too strongly" is read as this many times the least that some strength reaches.
TOO_STRONGLY = 10.0


@claim(
    "c2.both-overlap",
    "Neither of the two methods keeps discs from overlapping.",
    "section 4.3",
    needs=("penalty_best",),
    chosen="the starts and steps",
)
def _both(tables: Tables) -> Evidence:
    rows = tables["penalty_best"].dropna(subset="strength")
    pbd, penalty = rows["pbd_largest"], rows["largest"]
    return Evidence(
        f"Largest overlaps in time: {pbd.min():.4f} to {pbd.max():.3f} with PBD, {penalty.min():.4f} to "
        f"{penalty.max():.3f} with the penalty method at its best strength.",
        (at_least("overlap, PBD", float(pbd.min()), VISIBLE), at_least("overlap, penalty", penalty.min(), VISIBLE)),
    )


@claim(
    "c2.strength",
    "The penalty method needs a strength that is neither too small nor too large.",
    "section 4.3",
    needs=("penalty_scan",),
    chosen="the starts, the steps, and the force as corrected in c2.printed-penalty",
)
def _strength(tables: Tables) -> Evidence:
    rows = tables["penalty_scan"]
    springs = rows[rows["exponent"] == 2]
    weak = springs.loc[springs.groupby(["scene", "dt"])["strength"].idxmin()]
    strong = springs.loc[springs.groupby(["scene", "dt"])["strength"].idxmax()]
    best = springs.groupby(["scene", "dt"])["largest"].min().min()
    flown = strong["error"].fillna(float("inf"))
    return Evidence(
        f"Springs: at the smallest strength the overlap reaches {weak['largest'].min():.2f} or more, at the best "
        f"strength {best:.3f}; at the largest the discs end {flown.min():.2g} or more from where they belong.",
        (
            at_least("weakest over best overlap", weak["largest"].min() / best, TOO_STRONGLY),
            at_least("error at the largest strength", flown.min(), THROWN),
        ),
    )


@claim(
    "c2.a-priori",
    "Which strength is best depends on the scene and the step.",
    "section 4.3",
    needs=("penalty_best",),
    chosen="the starts and steps, and the force as corrected in c2.printed-penalty",
)
def _a_priori(tables: Tables) -> Evidence:
    """How far the best strength of springs differs between scenes and steps."""
    rows = tables["penalty_best"].dropna(subset="strength")
    strengths = rows[rows["exponent"] == 2]["strength"]
    return Evidence(
        f"Springs: the best strength is {strengths.min():.3g} to {strengths.max():.3g} over {len(strengths)} scenes "
        "and steps.",
        (at_least("largest over smallest best strength", strengths.max() / strengths.min(), DIFFERENT),),
    )


@claim(
    "c2.margin",
    "The largest overlap in a run of PBD is somewhat smaller than that of the best penalty method.",
    "Figure 6",
    needs=("penalty_best",),
    chosen="the starts and steps; best is the strength with the least largest overlap; what is small is left open",
)
def _margin(tables: Tables) -> Evidence:
    rows = tables["penalty_best"].dropna(subset="strength")
    largest, mean = rows["largest"] / rows["pbd_largest"], rows["mean"] / rows["pbd_mean"]
    spring = rows["exponent"] == 2
    return Evidence(
        f"Largest overlap in time, penalty over PBD: {largest[spring].min():.2f} to {largest[spring].max():.2f} for "
        f"springs, {largest[~spring].min():.2f} to {largest[~spring].max():.2f} for the force as printed. Of the means "
        f"in time {mean[spring].min():.2f} to {mean[spring].max():.2f} and {mean[~spring].min():.2f} to "
        f"{mean[~spring].max():.2f}. The margin is small for whoever calls a factor of {largest.max():.1f} small.",
        (at_least("least ratio of the largest overlaps", float(largest.min()), 1.0),),
    )
