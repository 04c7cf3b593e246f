"""Where substeps in three dimensions are made: the cells of one tissue, their edges, and who is near whom."""

from __future__ import annotations

import math
from typing import Annotated, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from dincl.compiled import StructPointer, inner, reader, struct_type
from dincl.errors import InvalidProblem
from tissue.kernels.lanes import WIDTH, floored, fma
from tissue.kernels.layout import CellFloats, CellIntegers, Lane, OfCells, PerTissue, Shared, Size, both_forms
from tissue.kernels.workspace import SOFT
from tissue.state.cells import Floats, Integers
from tissue.state.running import COUNTERS, DIVISIONS
from tissue.state.surface import FLAT_SURFACE, Surface

# What is counted, in SurfaceWorkspace.counts: as in a state, but for divisions, then pairs looked at for the repulsion,
# and lists of pairs made.
SURFACE_COUNTERS = (*COUNTERS[:DIVISIONS], "pairs", "lists")
PAIRS, LISTS = DIVISIONS, DIVISIONS + 1
# Places in SurfaceWorkspace.sizes: how many edges there are.
JUNCTIONS, NEIGHBOURS = range(2)
# Places in SurfaceWorkspace.state. FRESH: whether there are lists; WHOLE: how many rows of soft pairs are listed;
# FOUND: how many pairs of hard balls were found; ALL: whether these found no room, and each meets each; MANY: how many
# bins there are along x, y and z.
FRESH, WHOLE, FOUND, ALL, MANY = range(5)
# Room for pairs of a cell, on average. The lists of a tissue have half of it; heaps that need more cost time.
SOFT_ROOM, HARD_ROOM = 64, 24
# Pairs of the soft repulsion are computed in fours.
QUAD_WIDTH = 4
# The most ranges of cells near one bin.
NEAR = 27
# A period is longer, so that a nucleus meets one image of each other: twice their range.
SHORTEST_PERIOD = 2.0 * SOFT

Short = NDArray[np.int32]
# Arrays that are the same in both forms.
Edges = Annotated[Integers, Shared(lambda size: (size.edges, 2))]
OfEdges = Annotated[Floats, Shared(lambda size: size.edges, np.float64)]
Places = Annotated[Floats, Shared(lambda size: size.cells + WIDTH, np.float64)]
Quads = Annotated[Floats, Shared(lambda size: 4 * (size.cells + 1), np.float64)]
Ranges = Annotated[Integers, Shared(lambda size: NEAR)]
Listed = Annotated[Short, Shared(lambda size: (SOFT_ROOM + 1) * size.cells + 2 * QUAD_WIDTH, np.int32)]
Pairs = Annotated[Integers, Shared(lambda size: (HARD_ROOM * size.cells, 2))]
Partners = Annotated[Integers, Shared(lambda size: HARD_ROOM * size.cells)]
Marks = Annotated[Integers, Shared(lambda size: MANY + 3)]
Counts = Annotated[Integers, Shared(lambda size: len(SURFACE_COUNTERS))]


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
    x: CellFloats
    y: CellFloats
    z: CellFloats
    ax: CellFloats
    ay: CellFloats
    az: CellFloats
    bx: CellFloats
    by: CellFloats
    bz: CellFloats
    radius: CellFloats
    k_ax: CellFloats
    k_bx: CellFloats
    k_axb: CellFloats
    l_ax: CellFloats
    l_bx: CellFloats
    moves: CellFloats  # whether forces move the basal point: 1, or 0 for one that moves by itself (4.1)
    held: CellFloats  # whether the surface holds it: 1 or 0
    runs: CellFloats  # how far a basal point that moves by itself goes in a substep
    # What is computed on the way
    push_x: CellFloats  # push of the soft balls on the nucleus, for strength 1
    push_y: CellFloats
    push_z: CellFloats
    drag_x: CellFloats  # displacement of the apical point by the junctions
    drag_y: CellFloats
    drag_z: CellFloats
    made_x: CellFloats  # nuclei when the lists were made
    made_y: CellFloats
    made_z: CellFloats
    id: CellIntegers
    noise_key: Annotated[Integers, PerTissue(2, np.int64)]  # of the noise in substeps, see ``tissue.model.noise``
    repulsion: Annotated[Floats, PerTissue(1)]  # k of the soft repulsion times h / mu
    deviation: Annotated[Floats, PerTissue(1)]  # of the noise in a substep
    # Edges; ``sizes`` says how many are in use
    junctions: Edges  # the cells i and j of each junction
    rest: OfEdges  # its rest length
    k_aa: OfEdges
    neighbours: Edges  # basal neighbours, in the order of their sweep
    sizes: Annotated[Integers, Shared(lambda size: 2)]
    # Nuclei in bins, see ``bins``; a place is a number in the order of the bins
    order: OfCells  # the cell of each place
    bin: OfCells  # of each cell
    start: Annotated[Integers, Shared(lambda size: 2 * size.cells + 1)]  # of each bin the first place
    place_x: Places  # of each place, when it was sorted
    place_y: Places
    place_z: Places
    place_radius: Places
    begin: Ranges  # ranges of places that may be near the bin at hand
    end: Ranges
    # Pairs, see ``lists``
    row: OfCells  # where the soft pairs of each place begin
    row_end: OfCells  # and end
    listed: Listed  # the places before it that may be near it, in fours
    found: Pairs  # pairs of cells whose balls may meet, as found for the list
    hard_row: Annotated[Integers, Shared(lambda size: size.cells + 1)]  # where the pairs of cell i begin
    hard: Partners  # the cells j < i whose balls may meet that of cell i, increasing
    cutoff: Annotated[Floats, Shared(lambda size: 1, np.float64)]  # of the soft pairs
    at: Quads  # of each place x, y, z and nothing, one after the other
    pushed: Quads  # likewise the push on it
    state: Marks
    counts: Counts
    cells: Annotated[Integers, Shared(lambda size: 1)]  # how many there are
    # Of one substep
    substeps: int = 0  # in one dt
    max_basal_distance: float = 0.0
    bent: int = 0  # 0: the surface is no curve
    along: float = 0.0
    tangent_x: float = 0.0
    tangent_y: float = 0.0
    surface: Surface = FLAT_SURFACE
    along_x: Period = Period(0.0, 0.0)
    along_z: Period = Period(0.0, 0.0)
    forces: int = 0  # where those of users are, see ``tissue.step.user_forces``; 0: there are none


class SurfaceWorkspaces:
    """A workspace of both forms for ``capacity`` cells, ``edges`` junctions and as many basal neighbours.

    ``numbers`` are those of ``SurfaceWorkspace``, which kernels know both as. Raises InvalidProblem for a period that
    is not above SHORTEST_PERIOD.
    """

    def __init__(self, capacity: int, edges: int, surface: Surface = FLAT_SURFACE, **numbers: float) -> None:
        cells = -(-capacity // WIDTH) * WIDTH
        periods = {f"along_{axis}": period(f"period_{axis}", getattr(surface, f"period_{axis}")) for axis in "xz"}
        flat, wide = both_forms(SurfaceWorkspace, Size(cells, edges=edges), surface=surface, **periods, **numbers)
        self.pairs: Integers = flat.counts[PAIRS:]
        self.flat: Any = StructPointer(flat)
        self.wide: Any = StructPointer(wide)


def period(name: str, length: float) -> Period:
    """Return what kernels know of a period; raises InvalidProblem for one in which a nucleus meets two images of
    another.
    """
    if not length > SHORTEST_PERIOD:
        raise InvalidProblem(
            f"surface.{name} = {length}: must be above {SHORTEST_PERIOD:g}, twice the range of nuclei, or inf"
        )
    return Period(length, 1.0 / length) if math.isfinite(length) else Period(0.0, 0.0)


_FLAT, _WIDE = both_forms(SurfaceWorkspace, Size(1))
SURFACE_WORKSPACE = struct_type(_FLAT)
surface_workspace_at, wide_surface_workspace_at = reader(_FLAT), reader(_WIDE)


@inner
def nearest(d: Lane, length: float, inverse: float) -> Lane:
    """d - length floor(d / length + 1/2), at most half a period in magnitude; d where both numbers are 0."""
    return d - length * floored(fma(d, inverse, 0.5))


@inner
def periods(work: SurfaceWorkspace) -> tuple[float, float, float, float]:
    """Return the period along x and its inverse, then along z."""
    along_x, along_z = work.along_x, work.along_z
    return along_x.length, along_x.inverse, along_z.length, along_z.inverse
