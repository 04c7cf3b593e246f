"""Chapter 3, Tables 1 and 2: entries that are not those of the text and of what was run."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from tissue.files.parameters import preset
from tissue.frames.observables import widths
from tissue.runs.simulate import simulate
from verification.claims import Evidence, Verdict, at_least, equal
from verification.thesis.text.quoted import claim

SEED, MANY = 0, 12
# Table 1 in μm; the first height of Figure 16, whose unit is R_soft.
R_SOFT, HEIGHT, WIDTH = 5.0, 50.0, 40.0
FIRST_HEIGHT = 8.0
# In src/core/parameters.jl of the published program SteffenPL/sEMTor.jl, line 18: size = [N_init/3, 8].
PUBLISHED_HEIGHT = 8.0
# Table 1: cells, and the distance of their apical points [μm].
CELLS, SPACING = 60, 1.66
# Table 2, in minutes.
G2, MITOSIS = 30.0, 30.0
TOL = 1e-6
# z of a 99.9 % interval.
Z = 3.29


@claim(
    "c3.box",
    "The height and the width of the tissue at the start.",
    "Table 1",
    Verdict.CORRECTED,
)
def _box() -> Evidence:
    """Table 1 against Figure 16 and the published program; by elimination the other value is the width."""
    return Evidence(
        f"Figure 16 begins at a height of {FIRST_HEIGHT:g} in units of R^soft: h = 50 μm would be "
        f"{HEIGHT / R_SOFT:g}, 40 μm is {WIDTH / R_SOFT:g}. The published program begins {PUBLISHED_HEIGHT:g} high "
        "(init_zone in src/core/parameters.jl, line 18, of SteffenPL/sEMTor.jl): the two values are swapped",
        printed=(equal("h^init of the table over R_soft", HEIGHT / R_SOFT, FIRST_HEIGHT, TOL),),
        corrected=(
            equal("w^init of the table over R_soft", WIDTH / R_SOFT, FIRST_HEIGHT, TOL),
            equal("w^init over R_soft against the published height", WIDTH / R_SOFT, PUBLISHED_HEIGHT, TOL),
        ),
    )


def row(cells: int) -> float:
    """The width of so many apical points at the distance of Table 1, half a distance beyond both ends [μm]."""
    return cells * SPACING


def zone(cells: int) -> float:
    """The width [μm] that the published program gives to so many cells, N_init/3 in R_soft (line 18, as above)."""
    return cells / 3 * R_SOFT


@claim(
    "c3.row",
    "The number of cells, the distance of their apical points, and the width of the tissue at the start.",
    "Table 1",
    Verdict.CORRECTED,
    chosen="the row reaches half a distance beyond its ends; a distance more or less is left open",
)
def _row() -> Evidence:
    """The entries of Table 1 against each other, with both of its lengths as the width; then the published rule."""
    wide, narrow = row(CELLS), row(CELLS // 2)
    return Evidence(
        f"{CELLS} apical points at {SPACING:g} μm are {wide:.0f} μm wide, the table has {WIDTH:g} μm, with c3.box "
        f"{HEIGHT:g} μm; the published rule gives {zone(CELLS):.0f} μm to 60 cells and {zone(CELLS // 2):.0f} μm to "
        f"its 30, whose row is {narrow:.1f} μm wide",
        printed=(equal("width of the row, 40 μm printed [μm]", wide, WIDTH, SPACING),),
        corrected=(
            equal("width of the row of 60 cells [μm]", wide, zone(CELLS), SPACING),
            equal("width of the row of 30 cells, 50 μm [μm]", narrow, HEIGHT, SPACING),
        ),
    )


def basal_width(distance: str) -> float:
    """The width of the basal layer after an hour [R_soft]."""
    changes = {"tissue.max_basal_distance": distance, "tissue.basal_spacing": distance, "numerics.t_end": "1 h"}
    return float(widths(simulate(preset("thesis").changed(changes), 0).final).basal)


@claim(
    "c3.basal",
    "How far neighbouring basal points may be apart.",
    "Table 1",
    Verdict.CORRECTED,
    chosen="10⁻⁶ μm in place of 0",
)
def _basal() -> Evidence:
    """0 itself is refused, so a bound near it stands for it."""
    printed, right = basal_width("1e-6 um"), basal_width("1/3 R_soft")
    return Evidence(
        "by (C2) 0 μm puts all basal points in one place. 60 cells with sweeps of PBD, after 1 h: a bound of 10⁻⁶ μm "
        f"shrinks the basal layer to {printed:.1f} R_soft, the bound R_soft/3 keeps it {right:.1f} wide",
        printed=(at_least("basal width with the printed bound [R_soft]", printed, WIDTH / R_SOFT),),
        corrected=(at_least("basal width with R_soft/3 [R_soft]", right, WIDTH / R_SOFT),),
        seed=0,
    )


def singles(two: float) -> tuple[int, int]:
    """Cycles that end within the shortest cycle, and those that bring one cell, if two stay with probability ``two``.

    No cell ends its cycle twice: new cells are the pairs, all other cells that are born are single.
    """
    ends = single = 0
    for seed in range(MANY):
        run = simulate(preset("thesis").changed({"numerics.t_end": "10 h", "tissue.two_daughters": two}), seed)
        born, new = int((run.final.cells.birth > 0).sum()), int((run.final.cells.mother >= 0).sum())
        ends, single = ends + born - new, single + born - 2 * new
    return ends, single


@claim(
    "c3.offspring",
    "How often a division brings a single cell.",
    "Table 1",
    Verdict.CORRECTED,
)
def _offspring() -> Evidence:
    """By the rule of sections 2.1 and 2.2.5, against what the table says of the same number."""
    ends, single = singles(0.2)
    share = single / ends
    half = Z * math.sqrt(share * (1 - share) / ends)
    needed = (Z / (0.5 * (0.8 - 0.2))) ** 2 * share * (1 - share)
    return Evidence(
        f"sections 2.1 and 2.2.5 keep a second daughter in 20 % of the divisions: of {ends} cycles that end, {single} "
        f"({100 * share:.0f} %, 99.9 % interval ± {100 * half:.0f} %) bring a single offspring, not 20 %",
        printed=(equal("share of single offspring", share, 0.2, 0.1, (share - half, share + half)),),
        corrected=(equal("share of single offspring", share, 0.8, 0.1, (share - half, share + half)),),
        seed=SEED,
        runs_needed=math.ceil(MANY * needed / ends),
    )


def text_rule(age: np.ndarray, cycle: float) -> np.ndarray:
    """(3.4): whether the radius is the enlarged one."""
    return age >= cycle - MITOSIS / 60


def enlarged_minutes(rule: Callable[[np.ndarray, float], np.ndarray], cycle: float) -> float:
    """How long of a cycle of so many hours."""
    ages = (np.arange(60 * 60 * int(cycle)) + 0.5) / 3600
    return float(rule(ages, cycle).sum()) / 60


@claim(
    "c3.enlarged",
    "The phases in which a nucleus has the larger hard radius.",
    "Table 2, (3.4)",
    Verdict.CORRECTED,
)
def _enlarged() -> Evidence:
    by_text = enlarged_minutes(text_rule, 14.0)
    return Evidence(
        f"by (3.4), as in sections 2.1 and 2.2.8, the radius is 0.7 R^soft for {by_text:.0f} min of a cycle; by the "
        f"table for {G2 + MITOSIS:.0f} min",
        printed=(equal("minutes with the larger radius by (3.4)", by_text, G2 + MITOSIS, 1.0),),
        corrected=(equal("minutes with the larger radius by (3.4)", by_text, MITOSIS, 1.0),),
    )
