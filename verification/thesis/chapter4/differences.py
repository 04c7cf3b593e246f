"""How much each difference between the model as printed and the published runs changes each printed ratio.

A fractional factorial design over all rows of the table of model variants in which they differ, of resolution VI, in
which the effect of a row is averaged over the others and confounded with none of them, nor with any two. Of the keys
in which the presets differ, those of [P] and [S] are reached by no printed ratio.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import combinations, product
from typing import NamedTuple

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from dincl.study import Key, Row, Study
from tissue.files.parameters import Parameters
from tissue.study.categories import outcome
from tissue.study.estimates import LEVEL
from verification.thesis.chapter4.ensembles import ensemble, made, values_of
from verification.thesis.chapter4.printed import END, LATER, PRINTED, Printed
from verification.thesis.chapter4.ratios import outcome_published, quantile


class Variant(NamedTuple):
    """A row of the table of model variants: the keys that it sets, and what they say in the two models."""

    keys: tuple[str, ...]
    printed: str
    published: str


ROWS: dict[str, Variant] = {
    "energy of the cytoskeleton": Variant(
        ("rules.spring_power",),
        "a spring from the nucleus to an end of the cell is the softer the longer it is, in proportion to its length",
        "in proportion to the square of its length: one of 4 R_soft is 4 times softer than as printed",
    ),
    "energy of the apical junctions": Variant(
        ("rules.junction_factor",), "the springs between neighbours at the apical side", "a quarter as strong"
    ),
    "energy of the soft repulsion": Variant(
        ("rules.repulsion_factor",), "nuclei that are pressed together push each other apart", "half as strong"
    ),
    "rest length at least 0": Variant(
        ("rules.floor_rest_length",),
        "springs may adapt to lengths below the radius of the nucleus",
        "they may not",
    ),
    "junctions stiffer from G2 on": Variant(
        ("rules.g2_stiffening",), "the junctions of a cell do not change in its cycle", "twice as stiff in G2, mitosis"
    ),
    "freed spring softer": Variant(
        ("events.freed_stiffness",),
        "after [A] or [B] the freed spring keeps its stiffness",
        "it keeps a tenth of it",
    ),
    "hard radius": Variant(
        ("cell.hard_radius",), "the hard core of a nucleus has a radius of 1/3 R_soft", "0.3 R_soft"
    ),
    "distance of daughters": Variant(
        ("division.offset",), "daughters begin 0.05 μm beside their mother's place", "0.25 μm"
    ),
    "nuclei at the start": Variant(
        ("start.nuclei", "start.nuclei_height"),
        "anywhere in the tissue, at random",
        "evenly spread along the tissue, in the middle two thirds of its height",
    ),
    "cells at the start": Variant(("tissue.cells",), "60", "51"),
    "damping": Variant(("numerics.mu",), "0.15 h", "0.2 h: all cells move more slowly"),
    "time step": Variant(("numerics.dt", "numerics.substeps"), "0.1 h in 20 substeps", "0.05 h in 40 substeps"),
}
COUNTING = "end and rule of counting"
COUNTING_ROW = Variant(
    (), "at 48 h, where they are then", "at 54 h; outside also on average over the next hour and the rest of the run"
)
# How long runs last; it decides with the rule of basal extrusion when and how ratios are counted, not what happens.
COUNTED = ("numerics.t_end",)
# By which rule and at which time [h] cells are counted: as printed, and in the published runs.
COUNTS = ((outcome, END), (outcome_published, LATER))
SCENARIOS = {"[A]": "figure10", "[B]": "figure10", "[A] no INM": "figure12", "[B] no INM": "figure12"}
# The first eight rows take all combinations. The others are products of these, so that no product of fewer than six
# rows is constant.
FREE = 8
PRODUCTS = ((0, 1, 2, 3, 4), (0, 1, 2, 5, 6), (0, 1, 3, 5, 7), (0, 2, 4, 6, 7))
DESIGN_SEED, DESIGN_RUNS = 203, 24
PUBLISHED_CELLS = 51  # with one EMT cell in their middle
FEWEST = {"scenario": "[B]", "replicates": 2}
COLUMNS = {"row": "Changed", "with": "Together with", "scenario": "Cells", "what": "Outcome"}
COLUMNS |= {"effect": "Effect", "low": "Lower end, 95 %", "high": "Upper end, 95 %"}


class Swap(NamedTuple):
    """Which rows are as in the published runs."""

    name: str
    published: frozenset[str]

    def parameters(self, scenario: str) -> Parameters:
        """Return those of a scenario of the figures; the runs end at the later end of the two presets."""
        keys = [key for name, row in ROWS.items() if name in self.published for key in row.keys]
        changes = values_of("published", (*keys, *COUNTED))
        if "tissue.cells" in changes:
            changes["tissue.cells"] = PUBLISHED_CELLS
        return ensemble(SCENARIOS[scenario]).scenarios[scenario].changed(changes)

    def cells(self, scenario: str, replicates: int) -> pd.DataFrame:
        """Make runs, and return their EMT cells."""
        return made(self.parameters(scenario), DESIGN_SEED, f"{self.name} | {scenario}", replicates).cells


def design() -> Iterator[Swap]:
    """Return the 256 settings of the factorial design, by their signs."""
    for free in product((-1, 1), repeat=FREE):
        signs = (*free, *(math.prod(free[place] for place in places) for places in PRODUCTS))
        name = "".join("+" if sign > 0 else "-" for sign in signs)
        yield Swap(name, frozenset(row for row, sign in zip(ROWS, signs, strict=True) if sign > 0))


def _printed(scenario: str) -> list[Printed]:
    return [printed for printed in PRINTED if printed.scenario == scenario]


def effects(smallest: bool = False) -> Study:
    """Average the effect of each row, and of each two, over all others."""
    keys = tuple({"scenario": scenario, "replicates": DESIGN_RUNS} for scenario in SCENARIOS)
    key, runs, by = ("scenario", "replicates"), (FEWEST,) if smallest else keys, ("what", "row", "with")
    return Study("emt_effects", "EMT: effects of rows", key, runs, averages, columns=COLUMNS, by=by)


def averages(key: Key) -> list[Row]:
    """Return by how much a row changes each printed ratio, averaged over all the others; and so for each two rows.

    With the sign s of a row in each of n settings (1: as published, -1: as printed) and the ratio p of its m runs,

        effect = 2/n sum s p,  variance = 4/n^2 sum p (1 - p)/(m - 1);

    of two rows s is the product of their signs, and the effect half of the difference that one makes to the effect of
    the other. Cells are counted at the end and by the rule of the thesis; ``COUNTING`` is the mean difference of the
    same cells.
    """
    scenario, settings = key["scenario"], list(design())
    cells = [setting.cells(scenario, key["replicates"]) for setting in settings]
    signs = np.array([[1.0 if row in setting.published else -1.0 for row in ROWS] for setting in settings])
    rows: list[Row] = []
    for printed in _printed(scenario):
        hits, other = (np.array([rule(each, printed.what, t) for each in cells], dtype=float) for rule, t in COUNTS)
        apart = other - hits
        half = quantile(LEVEL) * float(apart.std(ddof=1)) / math.sqrt(apart.size)
        found = [(names, *effect(hits, sign)) for names, sign in contrasts(signs)]
        found.append(((COUNTING, ""), float(apart.mean()), half))
        rows += [
            {**key, "row": row, "with": second, "what": printed.what, "effect": e, "low": e - h, "high": e + h}
            for (row, second), e, h in found
        ]
    return rows


def contrasts(signs: NDArray[np.float64]) -> Iterator[tuple[tuple[str, str], NDArray[np.float64]]]:
    """Give the signs of each row, then of each two rows."""
    for i, name in enumerate(ROWS):
        yield (name, ""), signs[:, i]
    for (i, name), (j, other) in combinations(enumerate(ROWS), 2):
        yield (name, other), signs[:, i] * signs[:, j]


def effect(hits: NDArray[np.float64], sign: NDArray[np.float64]) -> tuple[float, float]:
    """Return an effect and half of its 95 % interval; hits of shape (settings, replicates)."""
    settings, runs = hits.shape
    p = hits.mean(axis=1)
    half = quantile(LEVEL) * 2 / settings * math.sqrt(float((p * (1 - p)).sum()) / (runs - 1))
    return float(2 / settings * (sign * p).sum()), half
