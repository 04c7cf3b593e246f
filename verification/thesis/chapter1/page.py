"""The geometry of the feasible set: chapter 1, section 4, and the consistency of PBD, chapter 2, section 3."""
# ruff: noqa: RUF001 - formulas as readers know them

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from verification.page.context import Context
from verification.page.parts import Follows, Grid, Picture, Section, Text
from verification.page.prose import fill
from verification.page.report import Chapter, Finding
from verification.thesis.chapter1 import consistency, prox_regularity
from verification.thesis.chapter1 import figures as figures_geometry

CONVEXITY = "How far from convex: the constant of prox-regularity"
PROSE = Path(__file__).parent / "prose"
SHOWN = "two contacts, oblique"
# Rows of at most so many discs are searched again, and so many arrangements.
FEW = 4
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
    form = context.form(prox_regularity.FULL)
    constants, around = prox_regularity.constants(form), prox_regularity.configurations(form)
    context.tables["prox_constants"] = context.rows_of(constants, constants.only(lambda key: key["count"] <= FEW))
    context.tables["prox_arrangements"] = context.rows_of(around, around.some(FEW))
    steps, settled = consistency.single_steps(), consistency.settling()
    context.keep("consistency_steps", steps)
    context.keep("consistency_settling", settled)
    context.keep("consistency", consistency.summary(steps, settled))


def sections(context: Context) -> Sequence[Section]:
    """The constant of prox-regularity; what one step of PBD is consistent with."""
    return [_constants(context), _consistency(context)]


def _constants(context: Context) -> Section:
    table, around = context.tables["prox_constants"], context.tables["prox_arrangements"]
    smaller = table["measured"] / table["printed_plane"]
    said = fill(
        PROSE / "constants.html",
        worst=table["gap"].max(),
        at_three=smaller.iloc[1],
        at_most=smaller.iloc[-1],
        most=table["count"].iloc[-1],
    )
    picture = context.draw("prox_constants", figures_geometry.constants, table)
    return Section(
        CONVEXITY,
        [
            Text(said["proved"]),
            Picture(picture, said["picture"]),
            Grid(table[list(CONSTANTS)].rename(columns=CONSTANTS), said["table"], "prox_constants"),
            Grid(around[list(ARRANGEMENTS)].rename(columns=ARRANGEMENTS), said["arrangements"], "prox_arrangements"),
            Follows(said["follows"]),
        ],
    )


def _consistency(context: Context) -> Section:
    steps, settled = context.tables["consistency_steps"], context.tables["consistency_settling"]
    said = fill(
        PROSE / "consistency.html",
        excess=float(steps["excess"].max()),
        settling_dt=consistency.SETTLING_DT,
        least_dt=float(steps["dt"].min()),
    )
    picture = context.draw("consistency", figures_geometry.consistency, steps, settled, SHOWN)
    orders = context.tables["consistency"][list(CONSISTENCY)].rename(columns=CONSISTENCY)
    parts = Text(said["limits"]), Picture(picture, said["picture"]), Grid(orders, said["table"], "consistency")
    return Section("Consistency of PBD", [*parts, Follows(said["follows"])])


def findings(context: Context) -> Sequence[Finding]:
    """By how much the printed constant is too small."""
    table = context.tables["prox_constants"]
    factors = (table["measured"] / table["printed_plane"]).iloc[1:]
    said = fill(
        PROSE / "learned.html",
        three=factors.iloc[0],
        most=factors.iloc[-1],
        count=table["count"].iloc[-1],
        over=table["gap"].max() - 1,
    )
    return [Finding(said["constant"], CONVEXITY)]


CHAPTER = Chapter(
    "geometry",
    "The geometry of the feasible set",
    "How far from convex is the feasible set of discs, and which inclusion does one step of PBD belong to?",
    run,
    sections,
    findings,
    place=5,
    tables=("prox_", "consistency"),
)
