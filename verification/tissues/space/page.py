"""The third dimension: how sheets grow, whether isolated cells go where they go in slices, and what is left open."""

from __future__ import annotations

from verification.site.context import Context
from verification.tissues.space import choices, figures, growth, isolated, sheet

FOLDED = {"layer": "Tissue", "cells": "Cells", "both": "Share of divisions that keep both daughters"}
FOLDED |= {"folded": "Runs with a folded layer", "runs": "Runs"}


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


def show(context: Context) -> None:
    """Give the fitted sheet, growth, isolated cells, choices left open."""
    tables = context.tables
    fitted, heights, ratios = (tables[f"space_{name}"] for name in ("sheet_means", "heights", "isolated_ratios"))
    kept = fitted[fitted["t"].isin((0.0, 6.0, 24.0, 48.0))]
    context.show("space_sheet", context.headed("space_sheet", kept), "space_sheet_means")
    context.draw("space_growth", figures.draw_growth, heights)
    last = heights[heights["t"] == growth.END]
    context.show("space_heights", context.headed("space_growth", last))
    folded = last[last["folded"] > 0]
    context.show("space_folded", folded[list(FOLDED)].rename(columns=FOLDED), "space_heights")
    context.draw("space_isolated", figures.draw_isolated, ratios)
    for name in ("compared", "isolated_ratios"):
        context.show(f"space_{name}", context.headed("space_isolated", tables[f"space_{name}"]))
    for name in ("means", "ratios"):
        context.show(f"space_choices_{name}", context.headed("space_choices", tables[f"space_choices_{name}"]))
