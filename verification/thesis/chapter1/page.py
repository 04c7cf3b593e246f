"""The geometry of the feasible set: chapter 1, section 4, and the consistency of PBD, chapter 2, section 3."""
# ruff: noqa: RUF001 - formulas as readers know them

from __future__ import annotations

from collections.abc import Sequence

from verification.page.report import Chapter, Context, Grid, Picture, Section, Text, number
from verification.thesis.chapter1 import figures as figures_geometry
from verification.thesis.chapter1 import prox_regularity
from verification.thesis.chapter2 import consistency

SHOWN = "two contacts, oblique"
CONSTANTS = {
    "count": "N",
    "printed_plane": "Printed, d = 2",
    "printed_space": "Printed, d = 3",
    "from_gamma": "√2 R γ of a row",
    "proved": "Proved",
    "measured": "Measured",
    "row": "Straight row",
    "hypomonotone": "1 / hypomonotone",
    "gap": "Measured / proved",
}
ARRANGEMENTS = {
    "arrangement": "Discs",
    "count": "N",
    "d": "d",
    "contacts": "Contacts",
    "gamma": "γ",
    "measured": "Measured around it",
    "row": "Straight row of N",
    "proved": "Proved for N",
}
CONSISTENCY = {
    "configuration": "Configuration",
    "contacts": "Contacts",
    "inclusion_order": "Order, to F - N",
    "sweep_order": "Order, to one sweep",
    "tangent": "To P_T F",
    "many": f"the same, {consistency.SWEEPS} sweeps",
    "outside": "Outside of T",
    "settled": f"To P_T F, step {consistency.SETTLING}",
    "reaction": "|V - F| / |F|",
}


def run(context: Context) -> None:
    """Complete the searches; the limits of PBD take a second and are made anew."""
    where = context.folder, context.executor
    context.tables["prox_constants"] = prox_regularity.constants(context.full).complete(*where)
    context.tables["prox_arrangements"] = prox_regularity.configurations(context.full).complete(*where)
    steps, settled = consistency.single_steps(), consistency.settling()
    context.keep("consistency_steps", steps)
    context.keep("consistency_settling", settled)
    context.keep("consistency", consistency.summary(steps, settled))


def sections(context: Context) -> Sequence[Section]:
    """The constant of prox-regularity; what one step of PBD is consistent with."""
    return [_constants(context), _consistency(context)]


def _constants(context: Context) -> Section:
    table, around = context.tables["prox_constants"], context.tables["prox_arrangements"]
    worst = table["gap"].max()
    intro = Text(
        "S of N discs of radius R is η-prox-regular with η ≥ R √(2/(2N - 3)) in every dimension: with L = 2R, "
        "n = -Σ λ∇g and |n| = 1, n · (y - x) ≤ Σ λ<sub>ij</sub> |v<sub>i</sub> - v<sub>j</sub>|² / (2L) for v = y - x, "
        "so 1/η is at most the largest eigenvalue of the Laplacian of the contacts with the weights λ/L; and the two "
        "discs of a contact carry λ of at most √(4N - 6) together (by a monotone test field). For d ≥ 2 no η is "
        "larger than that of a straight row of N discs, which can buckle. N = 2 (η = √2 R) and N = 3 (η = √8/3 R) are "
        "exact; for large N both bounds are R/√N. What is measured is the least |y - x|² / (2 n · (y - x)) of all "
        "pairs that a search finds (random pairs, largest curvature, climbing): an upper bound of η, attained by the "
        f"pair. Measured and proved differ by a factor of {number(worst)} at most. The printed constant is smaller by "
        f"{number(table['measured'].iloc[1] / table['printed_plane'].iloc[1])} at N = 3 and by "
        f"{number(table['measured'].iloc[-1] / table['printed_plane'].iloc[-1])} at N = {table['count'].iloc[-1]} "
        "(d = 2), and is 0 at N = 2."
    )
    picture = context.draw("prox_constants", figures_geometry.constants, table)
    return Section(
        "How far from convex: the constant of prox-regularity",
        [
            intro,
            Picture(picture, "Constants of prox-regularity for N discs of radius 1/2 (Proposition 1.22)."),
            Grid(table[list(CONSTANTS)].rename(columns=CONSTANTS), "Constants, R = 1/2.", "prox_constants"),
            Grid(
                around[list(ARRANGEMENTS)].rename(columns=ARRANGEMENTS),
                "Other arrangements: none that was tried has a smaller η than the straight row of as many discs.",
                "prox_arrangements",
            ),
        ],
    )


def _consistency(context: Context) -> Section:
    steps, settled = context.tables["consistency_steps"], context.tables["consistency_settling"]
    intro = Text(
        "V is the velocity of one step of PBD from a point with active contacts. As dt → 0 it tends to the result of "
        "one sweep of projections onto the half-spaces {v : ∇g<sub>k</sub> · v ≥ 0}, in the order of PBD: an element "
        "of F - N, as Lemma 2.8 says, but not the velocity P<sub>T</sub> F of the solution when contacts are neither "
        "alone nor orthogonal; it need not even lie in the tangent cone T. More sweeps bring it into T, not always to "
        "P<sub>T</sub> F. What makes PBD converge is the sequence: at a fixed small dt the velocity of the k-th step "
        "settles to P<sub>T</sub> F, the reactions that are missing at first being carried by small overlaps. The "
        "largest σ(V - F, w) - σ(-N ∩ B, w) over random w, with a ball of radius 2 |F| instead of (2^M + 1) |F|, is "
        f"{number(float(steps['excess'].max()))}: never positive, as the lemma needs it."
    )
    picture = context.draw("consistency", figures_geometry.consistency, steps, settled, SHOWN)
    return Section(
        "Consistency of PBD",
        [
            intro,
            Picture(
                picture,
                f"Left: one step against dt. Right: the k-th step, dt = {consistency.SETTLING_DT:g}; P_T F is that of "
                "the start, and contacts of discs turn away from it in proportion to k dt.",
            ),
            Grid(
                context.tables["consistency"][list(CONSISTENCY)].rename(columns=CONSISTENCY),
                f"Orders with 95 % intervals; distances at dt = {number(float(steps['dt'].min()))}.",
                "consistency",
            ),
        ],
    )


CHAPTER = Chapter("The geometry of the feasible set", run, sections, place=4, tables=("prox_", "consistency"))
