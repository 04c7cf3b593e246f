"""Where substeps in three dimensions are made: the cells of one tissue, their edges, and who is near whom."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from dincl.compiled import StructPointer, inner, reader, struct_type
from dincl.compiled.lanes import WIDTH, floored, fma
from dincl.errors import InvalidProblem
from tissue.kernels.quads import QUAD_WIDTH
from tissue.kernels.workspace import SOFT, aligned
from tissue.state.cells import Floats, Integers
from tissue.state.surface import FLAT_SURFACE, Surface

# What is counted, and where in SurfaceWorkspace.counts: pairs looked at for the repulsion, lists of pairs made.
SURFACE_COUNTERS = ("substeps", "corrections", "basal_corrections", "pairs", "lists")
SUBSTEPS, CORRECTIONS, BASAL_CORRECTIONS, PAIRS, LISTS = range(len(SURFACE_COUNTERS))
# Places in SurfaceWorkspace.sizes: how many edges there are, and whether basal neighbours have an order: a row's.
JUNCTIONS, NEIGHBOURS, ORDERED = range(3)
# Places in SurfaceWorkspace.state. FRESH: whether there are lists; OUT_OF_RANGE: how many nuclei went farther than
# these allow; WHOLE: how many rows of soft pairs are listed; FOUND: how many pairs of hard balls were found, then
# of nuclei out of range; ALL: whether these found no room, and each meets each; DISPLACED: how many meet all in a
# sweep; MANY: how many bins there are along x, y and z.
FRESH, OUT_OF_RANGE, WHOLE, FOUND, ALL, DISPLACED, MANY = range(7)
# Room for pairs of a cell, on average. The lists of a tissue have half of it; heaps that need more cost time.
SOFT_ROOM, HARD_ROOM = 64, 24
# The most ranges of cells near one bin.
NEAR = 27
# A period is longer, so that a nucleus meets one image of each other: twice their range.
SHORTEST_PERIOD = 2.0 * SOFT

Short = NDArray[np.int32]


class Period(NamedTuple):
    """The period of an axis and its inverse; both 0 where there is none."""

    length: float
    inverse: float


class SurfaceWorkspace(NamedTuple):
    """The cells of one tissue, (n,), or in rows of eight, (n / WIDTH, WIDTH), and what substeps know beside them.

    Coefficients are those of ``tissue.kernels.workspace.Workspace``: a spring moves X by -k (1 - l / d) (X - A),
    k = 2 alpha (h / mu) / l^p; a junction has k = (h / mu) junction_factor (alpha_i + alpha_j) / 2.
    """

    # Copies of the cells, and coefficients that stay the same until the rules change again
    x: Floats
    y: Floats
    z: Floats
    ax: Floats
    ay: Floats
    az: Floats
    bx: Floats
    by: Floats
    bz: Floats
    radius: Floats
    k_ax: Floats
    k_bx: Floats
    k_axb: Floats
    l_ax: Floats
    l_bx: Floats
    moves: Floats  # whether forces move the basal point: 1, or 0 for one that moves by itself (4.1)
    held: Floats  # whether the surface holds it: 1 or 0
    runs: Floats  # how far a basal point that moves by itself goes in a substep
    # What is computed on the way
    push_x: Floats  # push of the soft balls on the nucleus, for strength 1
    push_y: Floats
    push_z: Floats
    drag_x: Floats  # displacement of the apical point by the junctions
    drag_y: Floats
    drag_z: Floats
    made_x: Floats  # nuclei when the lists were made
    made_y: Floats
    made_z: Floats
    before_x: Floats  # nuclei before the sweep
    before_y: Floats
    before_z: Floats
    id: Integers
    noise_key: Integers  # (2,) or (2, WIDTH): of the noise in substeps, see ``tissue.model.noise``
    # Edges; ``sizes`` says how many are in use
    junctions: Integers  # (m, 2): the cells i and j of each junction
    rest: Floats  # (m,): its rest length
    k_aa: Floats
    neighbours: Integers  # (m, 2): basal neighbours, in the order of their sweep
    sizes: Integers
    # Nuclei in bins, see ``bins``; a place is a number in the order of the bins
    order: Integers  # (n,): the cell of each place
    bin: Integers  # (n,): of each cell
    start: Integers  # of each bin the first place
    place_x: Floats  # of each place, when it was sorted
    place_y: Floats
    place_z: Floats
    place_radius: Floats
    begin: Integers  # (NEAR,): ranges of places that may be near the bin at hand
    end: Integers
    # Pairs, see ``lists``
    row: Integers  # (n,): where the soft pairs of each place begin
    row_end: Integers  # (n,): and end
    listed: Short  # the places before it that may be near it, in fours
    found: Integers  # (m, 2): pairs of cells whose balls may meet, as found for the list; then of those out of range
    hard_row: Integers  # (n + 1,): where the pairs of cell i begin
    hard: Integers  # the cells j < i whose balls may meet that of cell i, increasing
    cutoff: Floats  # (1,): of the soft pairs
    out_of_range: Integers  # (n,): cells whose nuclei have gone farther than the lists allow
    far: Integers  # (n,): of each cell whether it was pushed far, see ``balls``
    displaced: Integers  # (n,): those that were
    at: Floats  # of each place x, y, z and nothing, one after the other
    pushed: Floats  # likewise the push on it
    state: Integers
    counts: Integers
    # Of one substep
    substeps: int  # in one dt
    repulsion: float
    max_basal: float
    deviation: float  # of the noise in a substep
    bent: int  # 0: the surface is no curve
    along: float
    tangent_x: float
    tangent_y: float
    surface: Surface
    along_x: Period
    along_z: Period


class SurfaceNumbers(NamedTuple):
    """The numbers of a workspace."""

    substeps: int
    repulsion: float  # k of the soft repulsion times h / mu
    max_basal: float
    deviation: float = 0.0


class SurfaceWorkspaces:
    """A workspace of two forms on the same memory: ``flat``, (n,) numbers, and ``wide``, (n / WIDTH, WIDTH).

    There is room for ``capacity`` cells, ``edges`` junctions and as many basal neighbours. Raises InvalidProblem for a
    period that is not above SHORTEST_PERIOD.
    """

    def __init__(self, capacity: int, edges: int, numbers: SurfaceNumbers, surface: Surface = FLAT_SURFACE) -> None:
        m = -(-capacity // WIDTH) * WIDTH
        names = SurfaceWorkspace._fields[: SurfaceWorkspace._fields.index("noise_key")]
        block = dict(zip(names, (line[:m] for line in aligned(len(names), m)), strict=True))
        block["id"] = block["id"].view(np.int64)
        rows = {name: line.reshape(-1, WIDTH) for name, line in block.items()}
        periods = {f"along_{axis}": period(f"period_{axis}", getattr(surface, f"period_{axis}")) for axis in "xz"}
        same = _common(m, edges) | numbers._asdict() | {"surface": surface} | periods
        self.pairs: Integers = same["counts"][PAIRS:]
        # For kernels these are ``SurfaceWorkspace``.
        self.flat: Any = StructPointer(SurfaceWorkspace(**block, noise_key=np.zeros(2, np.int64), **same), SURFACE_FLAT)
        self.wide: Any = StructPointer(
            SurfaceWorkspace(**rows, noise_key=np.zeros((2, WIDTH), np.int64), **same), _WIDE
        )


def period(name: str, length: float) -> Period:
    """Return what kernels know of a period; raises InvalidProblem for one in which a nucleus meets two images of
    another.
    """
    if not length > SHORTEST_PERIOD:
        raise InvalidProblem(
            f"surface.{name} = {length}: must be above {SHORTEST_PERIOD:g}, twice the range of nuclei, or inf"
        )
    return Period(length, 1.0 / length) if math.isfinite(length) else Period(0.0, 0.0)


def _common(m: int, edges: int) -> dict[str, Any]:
    """Return the arrays that are the same in both forms."""
    pairs, soft = HARD_ROOM * m, (SOFT_ROOM + 1) * m + 2 * QUAD_WIDTH
    whole = {"junctions": (edges, 2), "neighbours": (edges, 2), "sizes": 3, "order": m, "bin": m, "start": 2 * m + 1}
    whole |= {"begin": NEAR, "end": NEAR, "row": m, "row_end": m, "found": (pairs, 2), "hard_row": m + 1, "hard": pairs}
    whole |= {"out_of_range": m, "far": m, "displaced": m, "state": MANY + 3, "counts": len(SURFACE_COUNTERS)}
    floats = {"rest": edges, "k_aa": edges, "cutoff": 1, "at": 4 * (m + 1), "pushed": 4 * (m + 1)}
    floats |= dict.fromkeys(("place_x", "place_y", "place_z", "place_radius"), m + WIDTH)
    curve: dict[str, Any] = {"bent": 0, "along": 0.0, "tangent_x": 0.0, "tangent_y": 0.0}
    made: dict[str, Any] = curve | {name: np.zeros(shape, np.int64) for name, shape in whole.items()}
    return made | {name: np.zeros(shape) for name, shape in floats.items()} | {"listed": np.zeros(soft, np.int32)}


def _example(*shape: int) -> SurfaceWorkspace:
    """Return a workspace for its types."""
    names = SurfaceWorkspace._fields[: SurfaceWorkspace._fields.index("id")]
    block: dict[str, Any] = {name: np.zeros(shape) for name in names}
    block |= {name: np.zeros(shape, np.int64) for name in ("id", "noise_key")}
    none: dict[str, Any] = {"surface": FLAT_SURFACE, "along_x": Period(0.0, 0.0), "along_z": Period(0.0, 0.0)}
    return SurfaceWorkspace(**block, **_common(1, 1), **SurfaceNumbers(0, 0.0, 0.0)._asdict(), **none)


SURFACE_FLAT, _WIDE = struct_type(_example(1)), struct_type(_example(1, WIDTH))
surface_workspace_at, wide_surface_workspace_at = reader(_example(1)), reader(_example(1, WIDTH))


Lane = Any  # a double, or eight


@inner
def nearest(d: Lane, length: float, inverse: float) -> Lane:
    """d - length floor(d / length + 1/2), at most half a period in magnitude; d where both numbers are 0."""
    return d - length * floored(fma(d, inverse, 0.5))


@inner
def periods(work: SurfaceWorkspace) -> tuple[float, float, float, float]:
    """Return the period along x and its inverse, then along z."""
    along_x, along_z = work.along_x, work.along_z
    return along_x.length, along_x.inverse, along_z.length, along_z.inverse
