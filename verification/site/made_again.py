"""The section that says what was made again on this machine, and whether it agrees."""

from __future__ import annotations

from collections.abc import Mapping

import pandas as pd

from verification.site.agreement import Agreement
from verification.site.context import Context
from verification.site.parts import Grid, Section, Text

TITLE = "Made again on this machine"
SAID = (
    "The figures and tables above are of complete studies that ship with the program. A part of each was made again "
    "here and laid over it, row by row: rows agree whose numbers have three digits in common; times are left out. "
    "The pace is the median of the times here over those of the complete study. Seconds are those of the complete "
    "study; the page of the mean-field limit multiplies them by the pace. Far above the linear limit a tissue at rest "
    "can swing chaotically. Rounding then changes its amplitude, so rows of the maps of bending and springs may differ."
)
CAPTION = "Agreement to three digits of runs made here with those of the complete studies."


def made_again(chapter: str, context: Context, found: Mapping[str, Agreement]) -> list[Section]:
    """Return one section for the studies of a chapter, or none if nothing was rerun."""
    if not found:
        return []
    rows = pd.DataFrame(
        {
            "Study": one.title,
            "Runs made again": one.runs,
            "of": one.of,
            "Rows compared": one.rows,
            "Do not agree": one.apart,
            "Farthest": one.worst,
            "Pace": one.pace,
            "Complete study of": one.made,
        }
        for one in found.values()
    )
    context.keep(f"made_again_{chapter}", rows)
    return [Section(TITLE, [Text(SAID), Grid(rows, CAPTION, f"made_again_{chapter}")])]
