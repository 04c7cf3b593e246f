"""Chapter 3, section 2.2.7: whether states stay feasible at cell events, and how far Proposition 1.22 reaches."""

from __future__ import annotations

from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from verification.claims import Evidence, Verdict, at_least, equal
from verification.thesis.text.quoted import claim

Floats = NDArray[np.float64]
# Table 2 and (3.7), in μm; (3.4) in units of R_soft.
R_SOFT, HARD, OFFSET, ENLARGED = 5.0, 1.66, 0.05, 0.7
ROUNDING = 1e-9


def daughters() -> Floats:
    """The nuclei of both daughters right after (3.7) [μm], shape (2, 2)."""
    return np.array([[-OFFSET, 0.0], [OFFSET, 0.0]])


def distance(nuclei: Floats) -> float:
    """Of the two."""
    return float(np.linalg.norm(nuclei[1] - nuclei[0]))


def projected(nuclei: Floats, radius: float) -> Floats:
    """The nearest point of (C1) for two nuclei, by Example 2.5."""
    apart = distance(nuclei)
    move = max(2 * radius - apart, 0.0) / 2 * (nuclei[1] - nuclei[0]) / apart
    moved: Floats = nuclei + np.stack((-move, move))
    return moved


def growing() -> tuple[float, float]:
    """Two nuclei that touch when one enters mitosis: their distance, and what (C1) asks for from then on [μm]."""
    return 2 * HARD, HARD + ENLARGED * R_SOFT


@claim(
    "c3.at-all-times",
    "The state is feasible at all times, also right after a cell event.",
    "sections 2.2 and 3.2",
    Verdict.CORRECTED,
)
def _at_all_times() -> Evidence:
    born, asked = distance(daughters()), 2 * HARD
    touching, needed = growing()
    after = distance(projected(daughters(), HARD))
    return Evidence(
        f"after (3.7) two nuclei are {born:.2f} μm apart, (C1) asks for {asked:.2f} μm; nuclei that touch at "
        f"{touching:.2f} μm must be {needed:.2f} μm apart once one of them is in mitosis. Projected onto S the "
        f"daughters are {after:.2f} μm apart",
        printed=(
            at_least("distance of daughters after (3.7) [μm]", born, asked),
            at_least("distance of touching nuclei at mitosis [μm]", touching, needed),
        ),
        corrected=(at_least("distance of daughters after the projection [μm]", after, asked - ROUNDING),),
    )


def asked_distances(radii: Floats) -> list[float]:
    """(C1): the least distance of each pair."""
    return [float(one + other) for one, other in combinations(radii, 2)]


@claim(
    "c3.equal-radii",
    "The feasible set is that of Proposition 1.22, hence prox-regular.",
    "section 3.2",
    Verdict.CORRECTED,
    chosen="three cells; whether S is prox-regular with two radii is left open",
)
def _equal_radii() -> Evidence:
    mixed = asked_distances(np.array([HARD, HARD, ENLARGED * R_SOFT]))
    alike = asked_distances(np.full(3, HARD))
    return Evidence(
        f"with one of three cells in mitosis (C1) asks for the distances {', '.join(f'{d:.2f}' for d in mixed)} μm, "
        "and no 2R of Proposition 1.22 is all of them; outside of mitosis it is 3.32 μm for each pair",
        printed=(equal("largest over smallest distance, one in mitosis", max(mixed) / min(mixed), 1.0, ROUNDING),),
        corrected=(equal("largest over smallest distance, none in mitosis", max(alike) / min(alike), 1.0, ROUNDING),),
    )
