"""The third dimension: how sheets grow, whether isolated cells go where they go in slices, and what is left open."""

from __future__ import annotations

from collections.abc import Sequence

import pandas as pd

from verification.site.context import Context
from verification.site.parts import Follows, Grid, Picture, Section, Text
from verification.site.report import Chapter, Finding
from verification.thesis.chapter3.substeps import accuracy, orders
from verification.tissues.space import choices, figures, growth, isolated, sheet

ISOLATED = "Do the answers for isolated cells survive?"


def grow(context: Context) -> None:
    """Take over the study of growing sheets."""
    context.keep("space_heights", growth.means(context.rows("space_growth")))


def run(context: Context) -> None:
    """Take over all studies."""
    context.keep("space_sheet_means", sheet.means(context.rows("space_sheet")))
    grow(context)
    ratios = isolated.with_slices(context.rows("space_isolated"))
    context.keep("space_isolated_ratios", ratios)
    context.keep("space_compared", isolated.compared(ratios))
    chosen = context.rows("space_choices")
    context.keep("space_choices_means", choices.means(chosen))
    context.keep("space_choices_ratios", choices.ratios(chosen))
    made = accuracy(context.rows("space_substeps"), "tissue")
    context.keep("space_accuracy", made)
    context.keep("space_orders", orders(made, "tissue"))


def sections(context: Context) -> Sequence[Section]:
    """Return the fitted sheet, growth, isolated cells, choices left open, substeps."""
    return [_fitted(context), _growth(context), _isolated(context), _choices(context), _substeps(context)]


def _fitted(context: Context) -> Section:
    table = context.tables["space_sheet_means"]
    return Section(
        "Which sheet is an epithelium?",
        [
            Text(
                "The preset “sheet” is one: for two days it keeps a height and a projected area for each cell that are "
                "published for pseudostratified epithelia, and its apical layer is flat. Its file cites the two "
                "sources. The area is set by the density, and stays since as many cells leave as are born; the "
                "height is set by the largest rest length. Published for the mouse is an apical outline of 9.93 µm. "
                "A slice that is made a sheet is no epithelium, since it cannot spread: after a day a cell has a "
                "tenth of that area, a hundred soft balls lie above each other, and some apical layers are folded. "
                "The sections below use such sheets, free or periodic: they say how the model of the thesis behaves in "
                "space, not how an embryo does."
            ),
            Grid(
                context.headed("space_sheet", table[table["t"].isin((0.0, 6.0, 24.0, 48.0))]),
                "Means over the runs, without heights and cells outside of folded ones. Nuclei above each other: those "
                "that a normal crosses, each as wide as nuclei are apart. Soft balls of 5 µm overlap: there are more.",
                "space_sheet_means",
            ),
            Follows("Begin with the preset “sheet”, and say what it was fitted to."),
        ],
    )


def _growth(context: Context) -> Section:
    table = context.tables["space_heights"]
    last = table[table["t"] == growth.END]
    return Section(
        "Does a sheet grow as its slice does?",
        [
            Text(
                "A sheet grows higher than its slice. The thesis models a slice and keeps both daughters in one "
                "division of five, since in a tissue not all daughters end up in one slice; in a sheet all daughters "
                "stay. The number of cells in the section $z = 0$ gives the share of second daughters that a slice "
                "would need: about half of them for a large free sheet, all of them in a sheet that cannot spread."
            ),
            Text(_folded(last)),
            Picture(
                context.draw("space_growth", figures.draw_growth, table),
                "Height of the apical layer over that of the start, published preset, means with Student's 95 % "
                "intervals of the runs whose apical layer is not folded; a line ends where it is in all of them. In "
                "“weak repulsion” alpha_xx is a fifth: a nucleus of a sheet begins among 35 soft balls, one of a slice "
                "among 7 soft discs.",
            ),
            Grid(
                context.headed("space_growth", last),
                "After 48 h. Extents are lengths of paths in a slice, roots of areas in a sheet. Heights, apical "
                "extents and roughness are of the runs that are not folded. Roughness is the root mean square of the "
                "height of an apical point less the mean of its neighbours'. Daughters that stay: p of $(1 + p)^g$ = "
                "cells of the section over those at the start, g generations; values above 1 are scatter of this "
                "count.",
                "space_heights",
            ),
            Follows(
                "Room sets the height: a sheet without an edge, which cannot spread, grows highest. Fit the constants "
                "to a sheet before you compare its height with an embryo; the constants of a slice do not carry over."
            ),
        ],
    )


def _folded(last: pd.DataFrame) -> str:
    """Say which tissues are folded at the end."""
    folded = [
        f"{row.layer} of {row.cells:,} cells, {100 * row.both:.0f} % ({row.folded:.0f} of {row.runs})"
        for row in last[last["folded"] > 0].itertuples()
    ]
    if not folded:
        return "The apical layer is folded in none of these runs."
    return (
        f"After {growth.END:g} h the apical layer is folded in runs of these tissues, by the share of divisions that "
        f"keep both daughters: {'; '.join(folded)}. A folded layer crosses itself, runs backwards, is far longer than "
        "the tissue, or leaves many control cells outside. Its height means nothing, and is left out from then on."
    )


def _isolated(context: Context) -> Section:
    ratios, compared = context.tables["space_isolated_ratios"], context.tables["space_compared"]
    return Section(
        ISOLATED,
        [
            Text(
                "All findings of chapter 4 hold in the slice. In a growing sheet most of them hold, at its edge and "
                "away from it, and none is reversed; the others need more cells. In a periodic sheet, which cannot "
                "spread, the effect of the order of [A] and [B] is reversed. In sheets of 784 cells of the published "
                "model 36 isolated cells, evenly spread, undergo EMT with the events of Figures 10, 12, 14 and 15. "
                "Growing sheets have a free edge and keep all daughters; periodic ones keep both in 20 % of the "
                "divisions."
            ),
            Picture(
                context.draw("space_isolated", figures.draw_isolated, ratios),
                "EMT cells that have left the tissue at 54 h on each side, by events and tissue; bars are 95 % "
                "intervals. Open marks are the cells of growing sheets that begin more than 3 cells from the edge. "
                "Intervals are by the number of cells over the design effect, since cells of one sheet may depend on "
                "each other.",
            ),
            Grid(
                context.headed("space_isolated", compared),
                "Difference of two ratios with Newcombe's 95 % interval, and whether the first one is larger, at 99 %.",
                "space_compared",
            ),
            Grid(
                context.headed("space_isolated", ratios),
                "Ratios of EMT cells that have left at 54 h.",
                "space_isolated_ratios",
                folded=True,
            ),
            Follows(
                "Room decides whether a finding for isolated cells survives the third dimension. Single ratios differ "
                "between the edge and the middle of a sheet: state the boundary and where the cells are."
            ),
        ],
    )


def _choices(context: Context) -> Section:
    means, ratios = context.tables["space_choices_means"], context.tables["space_choices_ratios"]
    return Section(
        "What depends on choices that the thesis leaves open?",
        [
            Text(
                "The boundary of a sheet matters most: without an edge the tissue cannot spread, becomes higher, and "
                "most cells that lose their adhesion leave it. The rest length of the junction of new neighbours "
                "hardly matters. In a sheet (C2) holds for all neighbours of a triangulation, so a free basal layer "
                "draws together, less if neighbours may be further apart. Larger sheets stay lower, and more of their "
                "EMT cells leave basally, since fewer are near the edge."
            ),
            Grid(
                context.headed("space_choices", means),
                "Sheets of 196 cells (more where stated) at 54 h, published preset, both daughters of 20 % of the "
                "divisions stay; each row changes one choice. Means with Student's 95 % intervals.",
                "space_choices_means",
            ),
            Grid(
                context.headed("space_choices", ratios),
                "Ratios of EMT cells that have left at 54 h; inner ones begin more than 3 cells from the edge.",
                "space_choices_ratios",
                folded=True,
            ),
            Follows("Take ratios of EMT cells in large sheets, away from the edge."),
        ],
    )


def _substeps(context: Context) -> Section:
    made, found = context.tables["space_accuracy"], context.tables["space_orders"]
    return Section(
        "How many substeps does a growing sheet need?",
        [
            Text(
                "Heights of a sheet are within 1 % with the substeps of the published preset, as those of a slice are "
                "with a quarter of them. Nuclei of a sheet are not predicted cell by cell for long: their error falls "
                "slowly with the substeps, and that of the reference is as large."
            ),
            Picture(
                context.draw("space_substeps", figures.draw_substeps, made),
                "Error of the nuclei, median over the seeds, for each time; hollow marks are below the error of the "
                "reference. Right: the height at the end, means with 95 % intervals; the band is 1 %.",
            ),
            Grid(context.headed("space_substeps", found), "Orders in h; 0: no number of substeps.", "space_orders"),
            Grid(context.headed("space_substeps", made), "All errors.", "space_accuracy", folded=True),
            Follows("In three dimensions, too, compare heights and ratios of many cells, not places of nuclei."),
        ],
    )


def findings(context: Context) -> Sequence[Finding]:
    """State how many findings for isolated cells hold in a growing and in a periodic sheet."""
    compared = context.tables["space_compared"]
    said = []
    for of, where in ((isolated.GROWING, "a growing sheet"), (isolated.PERIODIC, "a periodic sheet")):
        held, other = ((compared[f"{of}_verdict"] == word).sum() for word in ("holds", "does not hold"))
        said.append(f"in {where} {held} hold and the opposite is found for {other}")
    html = (
        f"Of {len(compared)} findings of chapter 4 for isolated cells, {said[0]}; {said[1]}. The others are not "
        "decided by these cells."
    )
    return [Finding(html, ISOLATED)]


CHAPTER = Chapter(
    "space",
    "Third dimension",
    "Does a tissue in three dimensions grow, and lose cells, as its slice does?",
    run,
    sections,
    findings,
    tables=("space_",),
)
