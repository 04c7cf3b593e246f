"""The experiments of chapter 2 of the thesis, section 4."""

from __future__ import annotations

from collections.abc import Sequence

import pandas as pd

from verification.page.report import Chapter, Context, Grid, Picture, Section, Text, number
from verification.thesis.chapter2 import convergence, exactness, extrapolation, infeasibility, large_steps, reference
from verification.thesis.chapter2 import figures as plots
from verification.thesis.chapter2.methods import CATCH_UP, METHODS, PBD
from verification.thesis.chapter2.runs import scene

SCENES = tuple(scene(name) for name in convergence.SCENES)
# Of each scene [time]; all of them are among the kept times of the reference.
SHOWN = {"four_disks": (0.0, 0.5, 1.0, 1.5, 2.0), "ten_disks_corner": (0.0, 1.0, 1.5, 2.0, 3.0)}
STARTS = {
    "four_disks": "X' = -X outside of contact: four discs of radius 1/2 are drawn to one point (Figure 4).",
    "ten_disks_corner": "X' = (0, -1) outside of contact: ten discs of radius 1/2 fall into a corner (Figure 5).",
}
# Columns of the tables on the page, with their headings.
REFERENCE = {
    "scene": "Scene",
    "t": "t",
    "events": "Events so far",
    "error": "Stated error",
    "catch_up": "Distance to catch-up",
    "catch_up_error": "its stated error",
    "ratio": "its ratio",
    "daqp": "Ipopt against Daqp, same step",
    "linearised": "Catch-up against linearised",
    "linearised_error": "its stated error ",
}
EXACT = {
    "scene": "Scene",
    "t_end": "Run to t",
    "events": "Events",
    "true": "Largest error",
    "stated": "Largest stated error",
    "seconds": "Seconds",
}
ORDERS = {
    "t": "t",
    "method": "Method",
    "order": "Order [95 %]",
    "dt": "Finest dt",
    "error": "Error there",
    "infeasibility": "Infeasibility",
    "seconds": "Seconds",
    "failed": "Failed",
}
BEST = {
    "scene": "Scene",
    "dt": "dt",
    "kind": "Force",
    "strength": "Best strength",
    "largest": "Largest overlap",
    "mean": "Mean",
    "error": "Error",
    "pbd_largest": "PBD: largest",
    "pbd_mean": "PBD: mean",
    "pbd_error": "PBD: error",
    "width": "Width",
    "least_error": "Least error, any strength",
}


def run(context: Context) -> None:
    """Complete all studies of this chapter."""
    full, tables, where = context.full, context.tables, (context.folder, context.executor)
    tables["positions"] = reference.study(convergence.SCENES).complete(*where)
    tables["exactness"] = exactness.study().complete(*where)
    tables["catch_up"] = extrapolation.study(convergence.SCENES, full).complete(*where)
    references = {name: reference.reference(tables["positions"], name) for name in convergence.SCENES}
    context.keep("references", extrapolation.summary(references, tables["catch_up"], convergence.TIMES))
    tables["convergence"] = convergence.study(references, full).complete(*where)
    context.keep("orders", convergence.orders(tables["convergence"]))
    tables["penalty_scan"] = infeasibility.scan(references, full).complete(*where)
    context.keep("penalty_best", infeasibility.best_strengths(tables["penalty_scan"]))
    tables["infeasibility"] = infeasibility.curves(tables["penalty_scan"], full).complete(*where)
    tables["large_steps"] = large_steps.study().complete(*where)


def sections(context: Context) -> Sequence[Section]:
    """The two scenes, the reference, convergence, infeasibility, large steps."""
    return [
        _scenes(context),
        _reference(context),
        *(_convergence(context, name) for name in convergence.SCENES),
        _penalty(context),
        _large(context),
    ]


def _named(table: pd.DataFrame, headings: dict[str, str]) -> pd.DataFrame:
    """The columns of a table that a reader wants, with words for names."""
    words = {method.name: method.label for method in METHODS.values()} | {one.name: one.title for one in SCENES}
    return table[list(headings)].replace(words).rename(columns=headings)


def _scenes(context: Context) -> Section:
    pictures = []
    for one in SCENES:
        own = reference.reference(context.tables["positions"], one.name)
        path = context.draw(f"motion_{one.name}", plots.motion, one, SHOWN[one.name], own.at(SHOWN[one.name])[0])
        pictures.append(Picture(path, STARTS[one.name]))
    intro = Text(
        "The thesis does not give its starting positions; these are generic ones, without symmetry, so that discs "
        "really slide along each other. Positions are those of the reference."
    )
    return Section("Two scenes in time", [intro, *pictures])


def _reference(context: Context) -> Section:
    table = context.tables["references"]
    runs = context.tables["catch_up"]
    steps = sorted(runs[runs["method"] == CATCH_UP.name]["dt"].unique(), reverse=True)
    text = Text(
        "The event-driven solution: between contacts made and lost the motion is smooth and integrated with order 8, "
        "and events are found on its dense output. It is computed twice, with tolerances that differ by a factor of "
        f"100 and no step in common, to tol = {number(reference.TOL)}; stated is twice the largest distance of the two "
        "runs at this time and halfway to its neighbours."
    )
    checks = Text(
        "Independent of it: Moreau's catch-up scheme with the projection by Ipopt (tolerance 10⁻¹¹) at dt = "
        f"{', '.join(f'{dt:.3g}' for dt in steps)}. Where successive differences halve (ratio near 2) the three runs "
        "are extrapolated, elsewhere the finest one is taken; stated is twice the last difference, the largest of "
        "those at this time and at the kept times beside it (a quarter apart). The same scheme with another "
        "projection (Daqp), and linearised catch-up, extrapolated, check that one in turn."
    )
    return Section(
        "The reference", [text, checks, Grid(_named(table, REFERENCE), "Reference solutions.", "references")]
    )


def _convergence(context: Context, name: str) -> Section:
    table, orders = context.tables["convergence"], context.tables["orders"]
    mine = orders[orders["scene"] == name]
    pbd = mine[mine["method"] == PBD.name]
    orders_of = ", ".join(f"{row.order} at t = {row.t:g}" for row in pbd.itertuples())
    overlaps = ", ".join(f"{row.infeasibility_order} at t = {row.t:g}" for row in pbd.itertuples())
    error = context.draw(f"error_{name}", plots.against_step, table, name, "error")
    infeasible = context.draw(f"infeasibility_{name}", plots.against_step, table, name, "infeasibility")
    return Section(
        f"Convergence: {scene(name).title.lower()}",
        [
            Text(f"Order of PBD, with its 95 % interval: {orders_of}. Order of its infeasibility: {overlaps}."),
            Picture(
                error,
                "Error against the step. Crosses on the upper edge: runs that failed. Markers on the lower edge: "
                "errors below 10⁻⁸.",
            ),
            Picture(
                infeasible,
                "Largest overlap at that time against the step; markers on the lower edge: none above 10⁻⁶. Catch-up "
                "has none but rounding. A penalty that is too strong for its step has none either once it has "
                "thrown the discs apart (see its error), and the force as printed chatters in and out of contact.",
            ),
            Grid(_named(mine, ORDERS), "Orders, with 95 % intervals, and the finest run of each method.", "orders"),
            Grid(
                _named(mine, {"t": "t", "method": "Method", "verdict": "In words"}), "In words", "orders", folded=True
            ),
        ],
    )


def _penalty(context: Context) -> Section:
    best = context.tables["penalty_best"]
    kinds = best.assign(kind=best["exponent"].map({1: "as printed", 2: "springs"}))
    text = Text(
        f"The strength is scanned over {len(infeasibility.SPRINGS)} values at each step; the best is the one with the "
        "smallest largest overlap in time, among runs whose error is at most "
        f"{number(infeasibility.COMPARABLE)} times that of PBD (discs that were thrown apart do not overlap). The "
        "force as printed has constant size; springs grow with the overlap (section 1.1.3 prints the one and "
        "describes the other). Width is the factor between the strengths that stay within "
        f"{number(infeasibility.WIDTH)} times the best overlap."
    )
    curves = context.tables["infeasibility"]
    drawn = curves[curves["dt"].isin(infeasibility.SHORT)]
    in_time = context.draw("infeasibility_in_time", plots.infeasibility_in_time, drawn, SCENES)
    scan = context.draw("penalty_strengths", plots.strengths, context.tables["penalty_scan"], SCENES)
    return Section(
        "Infeasibility: PBD against the penalty method with its best strength",
        [
            text,
            Picture(
                in_time,
                "Largest overlap after every step (Figure 6): PBD solid, the penalty method with its best strength "
                "dashed.",
            ),
            Picture(
                scan, "How the penalty method depends on its strength; the levels of PBD, which has none, beside it."
            ),
            Grid(_named(kinds, BEST), "Best strengths.", "penalty_best"),
        ],
    )


def _large(context: Context) -> Section:
    figure = context.draw("large_steps", plots.large_steps, context.tables["large_steps"], large_steps.FAR, SCENES)
    text = Text(
        f"Runs to t = {large_steps.END:g}. At dt = 1 explicit Euler predicts all four discs into the one point that "
        "draws them, so their centres coincide and no pair of them has a direction: all methods shown here, which "
        "look at that prediction, stop there with that status. Linearised catch-up looks at the discs before the step "
        "and goes on."
    )
    return Section(
        "Large steps",
        [text, Picture(figure, "How far out a disc gets, over that of the start. Crosses: runs that stopped.")],
    )


CHAPTER = Chapter(
    "Numerical experiments with first-order PBD",
    run,
    sections,
    place=1,
    tables=("positions", "catch_up", "references", "convergence", "orders", "penalty_", "infeasibility", "large_steps"),
)
