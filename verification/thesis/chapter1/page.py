"""The geometry of the feasible set: chapter 1, section 4, and the consistency of PBD, chapter 2, section 3."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from verification.page.columns import headed, read_columns
from verification.page.context import Context
from verification.page.parts import Follows, Grid, Picture, Section, Text
from verification.page.prose import fill
from verification.page.report import Chapter, Finding
from verification.thesis.chapter1 import consistency, prox_regularity
from verification.thesis.chapter1 import figures as figures_geometry

COLUMNS = read_columns(Path(__file__).parent / "columns.toml")
PROSE = Path(__file__).parent / "prose"
SHOWN = "two contacts, oblique"
# Rows and arrangements of at most so many discs are searched again.
FEW = 4


def run(context: Context) -> None:
    """Complete the searches; the limits of PBD take a second and are recomputed."""
    form = context.form(prox_regularity.FULL)
    constants, around = prox_regularity.constants(form), prox_regularity.configurations(form)
    context.tables["prox_constants"] = context.rows_of(constants, constants.only(lambda key: key["count"] <= FEW))
    few = [name for name, x in prox_regularity.arrangements().items() if len(x) <= FEW]
    context.tables["prox_arrangements"] = context.rows_of(around, around.only(lambda key: key["arrangement"] in few))
    steps, settled = consistency.single_steps(), consistency.settling()
    context.keep("consistency_steps", steps)
    context.keep("consistency_settling", settled)
    context.keep("consistency", consistency.summary(steps, settled))


def sections(context: Context) -> Sequence[Section]:
    """Write about the constant of prox-regularity and about the consistency of one step of PBD."""
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
        COLUMNS["sections"]["constants"],
        [
            Text(said["proved"]),
            Picture(picture, said["picture"]),
            Grid(headed(table, COLUMNS["constants"]), said["table"], "prox_constants"),
            Grid(headed(around, COLUMNS["arrangements"]), said["arrangements"], "prox_arrangements"),
            Follows(said["follows"]),
        ],
    )


def _consistency(context: Context) -> Section:
    steps, settled = context.tables["consistency_steps"], context.tables["consistency_settling"]
    said = fill(
        PROSE / "consistency.html",
        excess=float(steps["excess"].max()),
        sweeps=consistency.SWEEPS,
        settling=consistency.SETTLING,
        settling_dt=consistency.SETTLING_DT,
        least_dt=float(steps["dt"].min()),
    )
    picture = context.draw("consistency", figures_geometry.consistency, steps, settled, SHOWN)
    orders = headed(context.tables["consistency"], COLUMNS["consistency"])
    parts = Text(said["limits"]), Picture(picture, said["picture"]), Grid(orders, said["table"], "consistency")
    return Section(COLUMNS["sections"]["consistency"], [*parts, Follows(said["follows"])])


def findings(context: Context) -> Sequence[Finding]:
    """Say by how much the printed constant is too small."""
    table = context.tables["prox_constants"]
    factors = (table["measured"] / table["printed_plane"]).iloc[1:]
    said = fill(
        PROSE / "learned.html",
        three=factors.iloc[0],
        most=factors.iloc[-1],
        count=table["count"].iloc[-1],
        over=table["gap"].max() - 1,
    )
    return [Finding(said["constant"], COLUMNS["sections"]["constants"])]


CHAPTER = Chapter(
    "geometry",
    "The geometry of the feasible set",
    "How far from convex is the feasible set of discs, and which inclusion does one step of PBD belong to?",
    run,
    sections,
    findings,
    place=7,
    tables=("prox_", "consistency"),
)
