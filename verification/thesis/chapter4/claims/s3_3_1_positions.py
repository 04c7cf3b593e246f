"""Chapter 4, sections 3.3.1 and 3.3.4: the apical-basal scale, and its intervals."""
# ruff: noqa: RUF001 - the formulas are quoted as they are printed

from __future__ import annotations

import math
from itertools import product

import numpy as np

from tissue.files.frame import Frame
from tissue.model.observables import ab_positions
from tissue.state.cells import CellLayers, Cells, Floats, empty
from tissue.study.proportions import POWER
from verification.claims import Correction, Effect, Tables, claim
from verification.evidence import Evidence, Kind, at_most

SEED = 331
LAYERS, CELLS = 60, 30
# Nuclei nearer to the layer than this count as on it: which side they are on is a matter of rounding.
ON = 1e-9
# Places on the scale: outside, at the ends, inside.
PLACES = (-0.6, -0.2, 0.0, 0.3, 1.0, 1.4)
# Of the intervals D_k.
PARTS = 10
POINTS = np.concatenate((np.linspace(0.0, 1.0, 201), [-0.02, 1.03]))


def nearest(x: Floats, y: Floats, path_x: Floats, path_y: Floats) -> Floats:
    """y_AB by the definition: y over that of the point of the apical layer that is nearest, found on a fine grid."""
    grid_x = np.linspace(path_x[0], path_x[-1], 20_001)
    grid_y = np.interp(grid_x, path_x, path_y)
    places = [int(np.argmin((grid_x - a) ** 2 + (grid_y - b) ** 2)) for a, b in zip(x, y, strict=True)]
    return np.asarray(y / grid_y[places])


def _drawn(rng: np.random.Generator) -> tuple[Frame, Floats]:
    """A random layer above the basal line; nuclei above, on and below it, and below the line; where the layer is."""
    path_x, path_y = np.cumsum(rng.uniform(0.2, 1.0, CELLS)), rng.uniform(4.0, 9.0, CELLS)
    x = rng.uniform(path_x[0], path_x[-1], CELLS)
    top = np.interp(x, path_x, path_y)
    y = rng.uniform(-2.0, 12.0, CELLS)
    y[:3] = top[:3]
    cells: Cells = empty(CELLS)._replace(x=x, y=y, ax=path_x, ay=path_y)
    return Frame(0.0, cells, CellLayers(np.arange(CELLS), np.arange(CELLS))), top


@claim(
    "c4.ab-scale",
    "The scale is 0 at the basal and 1 at the apical layer; the indicators tell which cells are out.",
    source="section 3.3.1, (4.3)",
    quote="y^AB(X_i) := y(X_i)/y(A_i^ref) … δ^basal-extr = 1 if y^AB < 0, δ^apical-extr = 1 if y^AB > 1",
    chosen="the apical layer is a graph over x",
    recorded=Kind.NOT_REFUTED,
    tried_on="60 random layers of 30 points, graphs over x",
)
def _scale() -> Evidence:
    rng = np.random.default_rng(SEED)
    wrong, tried, far = 0, 0, 0.0
    for _k in range(LAYERS):
        frame, top = _drawn(rng)
        cells, found = frame.cells, ab_positions(frame)
        clear = np.abs(cells.y - top) > ON
        wrong += int(((found > 1) != (cells.y > top))[clear].sum() + ((found < 0) != (cells.y < 0)).sum())
        tried += CELLS
        far = max(far, float(np.abs(found[~clear] - 1).max()))
    by_grid = nearest(cells.x, cells.y, cells.ax, cells.ay)
    off = float(np.abs(by_grid - found).max())
    return Evidence(
        f"For {tried} nuclei at {LAYERS} random layers y^AB > 1 and y^AB < 0 mean above the apical and below the basal "
        f"layer but in {wrong} cases; on the layer it is 1 to {far:.0e}; by a search on a grid it is the same to "
        f"{off:.0e}.",
        printed=(
            at_most("nuclei on another side than the indicator says", wrong, 0),
            at_most("|y^AB − 1| on the apical layer", far, 0.0, 1e-8),
            at_most("difference from a search on a grid", off, 0.0, 5e-3),
        ),
        seed=SEED,
    )


def indicators(positions: Floats, group: int) -> tuple[bool, bool]:
    """δ^basal-extr and δ^basal-pos of the first cell; the first ``group`` cells are EMT cells, the rest control."""
    return bool(positions[0] < 0), bool(positions[0] <= positions[group:].min())


@claim(
    "c4.contained",
    "A basally extruded cell counts as being in basal positioning, too, so the yellow ratio contains it.",
    source="section 3.3.1, Figure 10",
    quote=(
        "δ^basal-pos := 1 if y^AB(X_i) ≤ min_{j control} y^AB(X_j) … The yellow color shows the ratio of EMT cells "
        "below all epithelial cells"
    ),
    chosen="no control cell has left basally",
    recorded=Kind.NOT_REFUTED,
    tried_on="two EMT and two control cells on six places",
)
def _contained() -> Evidence:
    """All positions of two EMT and two control cells on a few places, the ends of the scale among them."""
    broken = {True: 0, False: 0}
    tried = 0
    for places in product(PLACES, repeat=4):
        positions = np.array(places)
        out, below = indicators(positions, 2)
        inside = bool((positions[2:] >= 0).all())
        broken[inside] += out and not below
        tried += inside
    return Evidence(
        f"Of {tried} states with all control cells at or above the basal layer {broken[True]} have a cell that is "
        f"basally extruded and not in basal positioning; where control cells are out {broken[False]} have.",
        printed=(at_most("states with a cell that is out and not below", broken[True], 0),),
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
    source="section 3.3.4",
    quote="(0, 1/n^D] ∪ … ∪ ((n^D−1)/n^D, 1] = [0, 1]",
    needs=("emt_complete_outside",),
    recorded=Kind.CORRECTED,
    correction=Correction(
        "[0, 1/n^D] ∪ (1/n^D, 2/n^D] ∪ … = [0, 1], and one set each for positions below 0 and above 1",
        Effect.NOTATION,
        "Figure 21: one cell of ten thousand is in no category",
        why=(
            "the first interval is open at 0, so 0 is in no D_k though the union is said to be [0, 1]; "
            "positions at the onset may lie outside of [0, 1] by (4.3)"
        ),
        place=2712,
    ),
)
def _partition(tables: Tables) -> Evidence:
    """Exactly at 0, and by the onsets of the runs, some of which are above the apical layer."""
    found = tables["emt_complete_outside"][["outside", "of"]].sum()
    printed, right = members(POINTS, False, False), members(POINTS, True, True)
    unit = (POINTS >= 0) & (POINTS <= 1)
    return Evidence(
        f"{int((printed[unit] != 1).sum())} point of [0, 1], y^AB = 0, lies in no D_k, and {found['outside']} of "
        f"{found['of']} cells of the runs begin outside of (0, 1]; with 0 in D_1 and two unbounded intervals each "
        "position lies in one set.",
        printed=(
            at_most("points of [0, 1] that are not in one D_k", int((printed[unit] != 1).sum()), 0),
            at_most("onsets outside of all D_k", int(found["outside"]), 0),
        ),
        corrected=(at_most("positions that are not in one set", int((right != 1).sum()), 0),),
        runs_needed=cells_for_one(found["outside"] / found["of"]),
    )
