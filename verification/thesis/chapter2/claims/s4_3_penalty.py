"""Chapter 2, section 4.3: PBD against the penalty method with its best strength."""

from __future__ import annotations

from verification.claims import Evidence, Tables, at_least, claim
from verification.methods.tables import PENALTY_BEST, PENALTY_SCAN

# Discs that end farther than this, a radius, from where they belong have been thrown away [length].
THROWN = 0.5
# An overlap that is more than rounding or the accuracy of a projection [length].
VISIBLE = 1e-4
# Best strengths that differ by this factor need to be looked for: no single value serves.
DIFFERENT = 1.5
# "Too strongly" is read as this many times the least that some strength reaches.
TOO_STRONGLY = 10.0


@claim(
    "c2.strength",
    "Too large penalty parameters make simulations unstable, too small ones let discs overlap too much.",
    source="section 4.3",
    quote=(
        "For too large penalty parameters, simulations become unstable, but for too small …, the constraints will be "
        "violated too strongly."
    ),
    needs=(PENALTY_SCAN,),
    rests_on=("c2.printed-penalty",),
    chosen="the starts, the steps, and the force as corrected in c2.printed-penalty",
)
def _strength(tables: Tables) -> Evidence:
    rows = tables["penalty_scan"]
    springs = rows[rows["exponent"] == 2]
    groups = springs.groupby(["scene", "dt"])
    weak, strong = springs.loc[groups["strength"].idxmin()], springs.loc[groups["strength"].idxmax()]
    best = groups["largest"].min().min()
    flown = strong["error"].fillna(float("inf")).min()
    return Evidence(
        printed=(
            at_least("overlap at the least strength over that at the best", weak["largest"].min() / best, TOO_STRONGLY),
            at_least("error at the largest strength, least over scenes and steps [length]", flown, THROWN),
        )
    )


@claim(
    "c2.a-priori",
    "The best penalty parameter differs between scenes and steps.",
    source="section 4.3",
    quote="In general, it is difficult to find the optimal penalty parameter a priori, i.e. before the simulation.",
    needs=(PENALTY_BEST,),
    rests_on=("c2.printed-penalty",),
    chosen="the starts and steps, and the force as corrected in c2.printed-penalty",
)
def _a_priori(tables: Tables) -> Evidence:
    rows = tables["penalty_best"].dropna(subset="strength")
    strengths = rows[rows["exponent"] == 2]["strength"]
    name = f"largest over least best strength of {len(strengths)} scenes and steps"
    return Evidence(printed=(at_least(name, strengths.max() / strengths.min(), DIFFERENT),))


@claim(
    "c2.margin",
    "PBD overlaps somewhat less than the penalty method with its best parameter.",
    source="Figure 6; section 4.3",
    also=("c2.both-overlap",),
    quote=(
        "PBD is able to outperform the penalty method by a small margin, even for optimal choice of the penalty "
        "parameter."
    ),
    needs=(PENALTY_BEST,),
    chosen="the starts and steps; best is the strength with the least largest overlap; how small a margin is small is "
    "left open",
)
def _margin(tables: Tables) -> Evidence:
    rows = tables["penalty_best"].dropna(subset="strength")
    ratio = rows["largest"] / rows["pbd_largest"]
    name = f"largest overlap in time, penalty over PBD (up to {ratio.max():.1f}), least over scenes and steps"
    return Evidence(
        printed=(
            at_least(name, float(ratio.min()), 1.0),
            at_least("overlap with PBD, least over scenes and steps [length]", rows["pbd_largest"].min(), VISIBLE),
            at_least("overlap with the best penalty method, least [length]", rows["largest"].min(), VISIBLE),
        )
    )
