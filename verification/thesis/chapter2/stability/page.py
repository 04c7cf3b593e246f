"""Where methods fail."""
# ruff: noqa: RUF001 - formulas for readers are written with Greek letters and minus signs

from __future__ import annotations

from collections.abc import Sequence

import pandas as pd

from verification.page.report import Chapter, Context, Grid, Picture, Section, Text, number
from verification.thesis.chapter2.stability import catalogue, decades, pacman
from verification.thesis.chapter2.stability import figures as figures_stability
from verification.thesis.chapter2.stability.contestants import CONTESTANTS
from verification.thesis.chapter2.stability.outcome import ERROR, FAR, OVERLAP, Outcome
from verification.thesis.chapter2.stability.plane import Plane

HEADINGS = {
    "title": "Case",
    "theory": "To be expected",
    "expected": "Predicted",
    "found": "Found",
    "agrees": "Agrees",
}
# Steps of the picture of the Pacman set [time].
SHOWN = (0.1, 0.02)


def run(context: Context) -> None:
    """Complete all cases, all maps and the decades."""
    full, tables, where = context.full, context.tables, (context.folder, context.executor)
    for plane in catalogue.PLANES:
        tables[_name(plane)] = plane.study(full).complete(*where)
    tables["stability_decades"] = decades.study(full).complete(*where)
    found = catalogue.cases().complete(*where).set_index("case")
    words = [{"case": case.id, "title": case.title, "theory": case.theory} for case in catalogue.CASES]
    context.keep("stability_verdicts", pd.DataFrame(words).join(found, on="case"))
    context.keep("stability_outcomes", pd.concat([_counted(context, plane) for plane in catalogue.PLANES]))
    context.keep("stability_pacman", pacman.table(SHOWN))


def sections(context: Context) -> Sequence[Section]:
    """The cases, the maps, six decades of dt, the Pacman set."""
    return [_cases(context), *(_map(context, plane) for plane in catalogue.PLANES), _decades(context), _pacman(context)]


def _name(plane: Plane) -> str:
    return f"stability_{plane.name}"


def _counted(context: Context, plane: Plane) -> pd.DataFrame:
    """How many cells of a map came out how, one row for each method."""
    table = context.tables[_name(plane)]
    counts = table.groupby(["method", "outcome"]).size().unstack(fill_value=0)
    counts = counts.reindex(index=list(plane.methods), columns=[one.value for one in Outcome], fill_value=0)
    named = counts.rename(index=plane.methods).rename_axis(columns=None).reset_index(names="method")
    return named.assign(map=plane.name)[["map", *named.columns]].astype({"method": str})


def _cases(context: Context) -> Section:
    table = context.tables["stability_verdicts"]
    agreeing = int(table["agrees"].sum())
    text = Text(
        f"{len(table)} failures that theory predicts, each looked for by the program: {agreeing} were found where they "
        "were expected. Limits are found by bisection, without use of the formula beside them."
    )
    words = table[["title", "words"]].rename(columns={"title": "Case", "words": "Particulars"})
    return Section(
        "Failures that theory predicts",
        [
            text,
            Grid(table[list(HEADINGS)].rename(columns=HEADINGS), "Predicted and found.", "stability_verdicts"),
            Grid(words, "Particulars", "stability_verdicts", folded=True),
        ],
    )


def _map(context: Context, plane: Plane) -> Section:
    table = context.tables[_name(plane)]
    picture = context.draw(_name(plane), figures_stability.plane, table, plane)
    counts = context.tables["stability_outcomes"]
    mine = counts[counts["map"] == plane.name].drop(columns="map").rename(columns={"method": "Method"})
    rule = (
        f"Unstable: a coordinate grows by more than {FAR:g} times, or leaves the finite numbers. Infeasible: overlap "
        f"above {number(OVERLAP)} diameters. Converged: error at most {number(ERROR)} diameters (for the crowds 6 % of "
        "the radius of gyration). Refused: an empty set, coincident centres."
    )
    return Section(
        f"Map: {plane.title}",
        [Text(plane.text), Picture(picture, rule), Grid(mine, "Cells", "stability_outcomes", folded=True)],
    )


def _decades(context: Context) -> Section:
    table = context.tables["stability_decades"]
    pictures = context.draw("stability_decades", figures_stability.decades, table)
    held = table.groupby("method")["bounded"].all()
    steady = ", ".join(CONTESTANTS[name].label for name in decades.METHODS if held[name])
    text = Text(
        f"Six discs fall onto a floor between walls (a bounded drift), for {decades.END:g} unit of time or "
        f"{decades.STEPS} steps. No coordinate grows, at any dt from 10⁻⁴ to 100, with: {steady}. Stable does not mean "
        "right: one sweep of PBD leaves overlaps that grow with dt, up to most of a diameter. With F = −x the explicit "
        "prediction itself is unstable beyond dt = 2, and centres coincide at dt = 1."
    )
    caption = "Growth, cut off at 1000, and largest overlap, cut off at 10⁻⁸; crosses: runs that stopped."
    return Section("Six decades of dt", [text, Picture(pictures, caption)])


def _pacman(context: Context) -> Section:
    table = context.tables["stability_pacman"]
    picture = context.draw("stability_pacman", figures_stability.pacman, table, pacman.NARROW)
    text = Text(
        "At the tip of its mouth the Pacman-like set of Figure 7 is a union of half planes, not an intersection, so it "
        "is no Problem here; its nearest points are written down by hand. The drift points into the mouth. "
        "At the tip the proximal normal cone is {0}: the inclusion has no solution that stays, and the catch-up scheme "
        "picks a jaw by the last bit of its start."
    )
    return Section("The Pacman set", [text, Picture(picture, "Two catch-up runs, started 10⁻¹² apart at the tip.")])


CHAPTER = Chapter("Where methods fail", run, sections, place=3, tables=("stability_",))
