"""The experiments of chapter 2 of the thesis, section 4, and orders on sets that move."""

from __future__ import annotations

from collections.abc import Sequence

import pandas as pd

from verification.methods import large_steps, orders, references, strengths
from verification.methods.methods import CATCH_UP, PBD
from verification.site.context import Context
from verification.site.parts import Follows, Grid, HowMeasured, Picture, Section, Text, number
from verification.site.prose import interval
from verification.site.report import Chapter, Finding

CROWD = "Ten discs falling into a corner"
ORDERS, MOVING = "With which order do methods converge?", "Do methods keep their orders on sets that move?"


def run(context: Context) -> None:
    """Complete all studies of this chapter."""
    for complete in (refer, converge, overlap, stride):
        complete(context)


def refer(context: Context) -> None:
    """Compute the reference solutions, and the limits of both convergent methods."""
    context.rows("references")


def converge(context: Context) -> None:
    """Compare the methods with exact solutions, and estimate their orders."""
    context.keep("order_fits", orders.fits(context.rows("orders")))


def overlap(context: Context) -> None:
    """Look for the best strengths of penalty methods."""
    context.keep("penalty_best", strengths.best_strengths(context.rows("penalty_scan")))
    context.rows("infeasibility")


def stride(context: Context) -> None:
    """Try large steps."""
    context.rows("large_steps")


def sections(context: Context) -> Sequence[Section]:
    """Write about the two scenes with their reference, orders, overlap and large steps."""
    return [_reference(context), _orders(context), _moving(context), _penalty(context), _large(context)]


def _reference(context: Context) -> Section:
    rows = context.tables["references"]
    shown = rows[(rows["particle"] == 0) & (rows["t"] % 1 == 0) & (rows["t"] > 0)]
    within = shown["catch_up"] <= shown["error"] + shown["catch_up_error"]
    return Section(
        "Two scenes in time, and how exact is their reference?",
        [
            Picture(
                context.draw("scenes", references.draw, rows),
                "Discs of radius 1/2: four are drawn to one point, ten fall into a corner. The thesis does not give "
                "its starts; these have no symmetry, so that discs slide along each other.",
            ),
            Grid(
                context.headed("references", shown),
                "Stated errors of the reference, and its distance to the limits of two other methods.",
                "references",
            ),
            Follows(
                f"{within.sum()} of {len(shown)} distances to catch-up are within the stated errors of both: every "
                "larger error below is an error of a method."
            ),
            HowMeasured(
                [
                    Text(
                        "The reference is the event-driven solution. Between events it is integrated with order 8, and "
                        "events are found on the dense output. It is computed twice, with tolerances that differ by a "
                        "factor of 100; the stated error is twice the largest distance of both runs nearby."
                    ),
                    Text(
                        "Moreau's catch-up scheme and linearised catch-up, run with three steps each, are extrapolated "
                        "where successive differences halve (ratio near 2). Twice the last difference is stated, the "
                        "largest of those at a time and at its neighbours."
                    ),
                ]
            ),
        ],
    )


def _orders(context: Context) -> Section:
    rows, fits = context.tables["orders"], context.tables["order_fits"]
    moving = {make().title for make in orders.MOVING}
    parts = []
    for make in orders.EXPERIMENTS:
        scene = make()
        panels = [(scene.title, error) for error in (*(f"t = {t:g}" for t in scene.times), "overlap")]
        path = context.draw(f"orders_{scene.name}", orders.draw, rows, panels)
        parts.append(Picture(path, f"{scene.title}: errors at some times, and the largest overlap, against the step."))
    mine = fits[~fits["problem"].isin(moving)]
    return Section(ORDERS, [*parts, _fits(mine)])


def _moving(context: Context) -> Section:
    moving = [make().title for make in orders.MOVING]
    fits = context.tables["order_fits"]
    path = context.draw("orders_moving", orders.draw, context.tables["orders"], [(name, "largest") for name in moving])
    said = (
        "PBD keeps its order one, midpoint catch-up its order two. Catch-up is exact where no disc slides, and then "
        "has no order to be read."
    )
    mine = fits[fits["problem"].isin(moving)]
    caption = "Largest error over time against the step, where sets turn, close and grow."
    return Section(MOVING, [Picture(path, caption), Follows(said), _fits(mine)])


def _fits(fits: pd.DataFrame) -> Grid:
    shown = fits[list(orders.HEADINGS)].rename(columns=orders.HEADINGS)
    return Grid(shown, "Orders with the range of the local orders, and the finest run of each method.", "order_fits")


def _penalty(context: Context) -> Section:
    best, scanned = context.tables["penalty_best"], context.tables["penalty_scan"]
    springs = best[best["exponent"] == 2]
    times = springs["largest"] / springs["pbd_largest"]
    return Section(
        "Do discs overlap less with PBD than with the best penalty method?",
        [
            Picture(
                context.draw("infeasibility_in_time", strengths.draw_curves, context.tables["infeasibility"]),
                "Largest overlap after every step (as Figure 6 of chapter 2 of the thesis): PBD, and the penalty "
                "method with its best strength.",
            ),
            Picture(
                context.draw("penalty_strengths", strengths.draw_scan, scanned),
                "How the penalty method depends on its strength, and beside it the levels of PBD, which has none.",
            ),
            Grid(context.headed("penalty_scan", best), "Best strengths.", "penalty_best"),
            Follows(
                f"With the best of all strengths springs still overlap {number(times.min())} to {number(times.max())} "
                "times as much as PBD, which has no strength to choose."
            ),
            Text(
                f"Each step was tried with {len(strengths.SPRINGS)} strengths. The best one has the smallest largest "
                f"overlap in time, among runs whose error is at most {strengths.COMPARABLE:g} times the error of PBD "
                "(discs that were thrown apart do not overlap). The force as printed has constant size; springs grow "
                "with the overlap (section 1.1.3 of the thesis prints the former and describes the latter). Width is "
                f"the factor between the strengths that stay within {strengths.WIDTH:g} times the best overlap."
            ),
        ],
    )


def _large(context: Context) -> Section:
    return Section(
        "Which methods stand large steps?",
        [
            Picture(
                context.draw("large_steps", large_steps.draw, context.tables["large_steps"]),
                "Largest distance of a disc from the origin, over that at the start. Crosses: runs that stopped.",
            ),
            Follows(
                "Keep the step below the one that carries several discs into one point, or linearise at the state "
                "before the step."
            ),
            Text(
                f"Runs to $t = {large_steps.END:g}$. At $dt = 1$ explicit Euler predicts all four discs into the one "
                "point that draws them. Their centres coincide there, and no pair has a direction: every method that "
                "starts from this prediction stops with that status. Linearised catch-up starts from the discs before "
                "the step and goes on."
            ),
        ],
    )


def findings(context: Context) -> Sequence[Finding]:
    """Say which order PBD has, and how its error compares with catch-up at the finest step of both."""
    fits, rows = context.tables["order_fits"], context.tables["orders"]
    at_times = fits["error"].str.startswith("t = ")
    pbd = fits[at_times & (fits["method"] == PBD.label)]
    crowd = rows[rows["problem"] == CROWD].set_index("setting")
    # Not at the last time, where catch-up has come to rest.
    times = [name for name in crowd if name.startswith("t = ") and crowd[name].notna().any()][:-1]
    one, other = (crowd.loc[crowd["method"] == method.label, times] for method in (PBD, CATCH_UP))
    ratios = (one / other).dropna().sort_index().iloc[0]
    said = (
        f"First-order PBD converges with order one, {interval((pbd['low'].min(), pbd['high'].max()))} over the ranges "
        f"of all times; but where ten discs fall on each other its error is {number(ratios.min())} to "
        f"{number(ratios.max())} times the error of catch-up at the same step."
    )
    return [Finding(said, ORDERS)]


CHAPTER = Chapter(
    "experiments",
    "Numerical experiments with first-order PBD",
    "Do first-order PBD and catch-up converge on discs, with which order, also where sets move, and how much do discs "
    "overlap on the way?",
    run,
    sections,
    findings,
    tables=("references", "order", "penalty_", "infeasibility", "large_steps"),
)
