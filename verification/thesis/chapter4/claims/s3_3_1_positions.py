"""Chapter 4, sections 3.3.1 and 3.3.4: the apical-basal scale, and its intervals."""
# ruff: noqa: RUF001 - the formulas are quoted as they are printed

from __future__ import annotations

import math

import numpy as np

from tissue.state.cells import Floats
from tissue.statistics.proportions import POWER
from verification.claims import Evidence, Tables, Verdict, at_most, proved
from verification.formal.reals import implication, solver_library
from verification.thesis.text.quoted import claim

# Of the intervals D_k.
PARTS = 10
POINTS = np.concatenate((np.linspace(0.0, 1.0, 201), [-0.02, 1.03]))


@claim(
    "c4.ab-scale",
    "The scale is 0 at the basal and 1 at the apical layer; the indicators tell which cells are out.",
    "section 3.3.1, (4.3)",
    Verdict.PROVED,
    chosen="the apical layer is a graph over x",
)
def _scale() -> Evidence:
    """y of a nucleus and h > 0 of the apical layer at the same place: the scale is q = y/h."""
    z3 = solver_library()
    return proved(
        implication(
            "q = y/h is 0 for y = 0 and 1 for y = h; q < 0 means y < 0 and q > 1 means y > h",
            lambda s, y, h, q: (
                [h > 0, q * h == y],
                [z3.Implies(y == 0, q == 0), z3.Implies(y == h, q == s), (q < 0) == (y < 0), (q > 1) == (y > h)],
            ),
            "−1 on the apical layer",
        )
    )


@claim(
    "c4.contained",
    "A basally extruded cell counts as being in basal positioning, too, so the yellow ratio contains it.",
    "section 3.3.1, Figure 10",
    Verdict.PROVED,
    chosen="no control cell has left basally",
)
def _contained() -> Evidence:
    """y of an EMT cell that is out, y < 0; m is the least y of the control cells, m >= 0."""
    return proved(
        implication(
            "y^AB < 0 ≤ min y^AB of the control cells gives y^AB ≤ min: every basally extruded cell is in basal "
            "positioning",
            lambda s, y, m: ([y < 0, s * m >= 0], y <= m),
            "control cells at or below the basal layer",
        )
    )


def members(points: Floats, closed: bool, unbounded: bool) -> Floats:
    """In how many of the D_k each point lies; ``closed``: 0 counts to the first; ``unbounded``: with the rest."""
    edges = np.arange(PARTS + 1) / PARTS
    inside = (points[:, None] > edges[:-1]) & (points[:, None] <= edges[1:])
    counts = inside.sum(axis=1) + (closed & (points == 0))
    return np.asarray(counts + (unbounded & ((points < 0) | (points > 1))))


def cells_for_one(share: float) -> int | None:
    """Cells among which one of such a share is seen with the given probability: one is enough."""
    return math.ceil(math.log1p(-POWER) / math.log1p(-share)) if 0 < share < 1 else None


@claim(
    "c4.partition",
    "The intervals are a partition of the positions at the onset of EMT.",
    "section 3.3.4",
    Verdict.CORRECTED,
    needs=("emt_complete_outside",),
)
def _partition(tables: Tables) -> Evidence:
    """Exactly at 0, and by the onsets of the runs, some of which are above the apical layer."""
    found = tables["emt_complete_outside"][["outside", "of"]].sum()
    printed, right = members(POINTS, False, False), members(POINTS, True, True)
    unit = (POINTS >= 0) & (POINTS <= 1)
    return Evidence(
        printed=(
            at_most("points of [0, 1] that are not in one D_k", int((printed[unit] != 1).sum()), 0),
            at_most(f"onsets outside of all D_k, of {found['of']} in the runs", int(found["outside"]), 0),
        ),
        corrected=(
            at_most("positions not in one set, with 0 in D_1 and two unbounded intervals", int((right != 1).sum()), 0),
        ),
        runs_needed=cells_for_one(found["outside"] / found["of"]),
    )
