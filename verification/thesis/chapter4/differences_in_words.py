"""The rows of ``differences`` and the printed ratios in words, for readers who do not read formulas."""

from __future__ import annotations

from collections.abc import Mapping

# By row: as printed, as published.
ROWS: Mapping[str, tuple[str, str]] = {
    "energy of the cytoskeleton": (
        "a spring from the nucleus to an end of the cell is the softer the longer it is, in proportion to its length",
        "in proportion to the square of its length: one of 4 R_soft is 4 times softer than as printed",
    ),
    "energy of the apical junctions": ("the springs between neighbours at the apical side", "a quarter as strong"),
    "energy of the soft repulsion": ("nuclei that are pressed together push each other apart", "half as strong"),
    "rest length at least 0": ("springs may adapt to lengths below the radius of the nucleus", "they may not"),
    "junctions stiffer from G2 on": (
        "the junctions of a cell do not change in its cycle",
        "twice as stiff in G2, mitosis",
    ),
    "freed spring softer": ("after [A] or [B] the freed spring keeps its stiffness", "it keeps a tenth of it"),
    "hard radius": ("the hard core of a nucleus has a radius of 1/3 R_soft", "0.3 R_soft"),
    "distance of daughters": ("daughters begin 0.05 μm beside their mother's place", "0.25 μm"),
    "nuclei at the start": (
        "anywhere in the tissue, at random",
        "evenly spread along the tissue, in the middle two thirds of its height",
    ),
    "cells at the start": ("60", "51"),
    "damping": ("0.15 h", "0.2 h: all cells move more slowly"),
    "time step": ("0.1 h in 20 substeps", "0.05 h in 40 substeps"),
}
# How cells are counted.
COUNTING = (
    "at 48 h, where they are then",
    "at 54 h; outside also on average over the next hour and the rest of the run",
)
OUTCOMES = {"apical": "leaves apically", "basal": "leaves basally", "below": "lies below all control cells"}


def in_words(scenario: str, what: str) -> str:
    """A ratio, such as "[A] without INM leaves basally"."""
    return f"{scenario.replace('no INM', 'without INM')} {OUTCOMES[what]}"
