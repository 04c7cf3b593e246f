"""Where substeps are made: the cells of one tissue, or of eight side by side."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated, Any, NamedTuple

import numpy as np

from dincl.compiled import StructPointer, reader, struct_type
from tissue.kernels.layout import CellFloats, CellIntegers, OfCells, PerTissue, Shared, Size, both_forms
from tissue.state.basal_curve import CurveNumbers
from tissue.state.cells import Floats, Integers
from tissue.state.numbers import Numbers
from tissue.state.running import STRAIGHT
from tissue.state.surface import FLAT_SURFACE, Surface

# What ``ended`` says of a tissue, if not the number of the step that failed.
RUNNING, EMPTY = 0, -1
# Far from every cell, and from each other: the places that are empty.
FAR = 1e6
# Distance below which two nuclei repel each other [R_soft].
SOFT = 2.0
# Radius of the soft discs, a little more than 1: a pair at the end of the range, of which rounding decides
# whether it repels, is looked at in every company.
SOFT_END = 1.0 + 1e-9
# A nucleus that is farther out is lost, before it comes near them [R_soft].
LOST = FAR / 2

# Arrays of whole numbers that are the same for all tissues side by side.
One = Annotated[Integers, Shared(lambda size: 1)]
OfTissues = Annotated[Integers, Shared(lambda size: size.width)]
Links = Annotated[Integers, Shared(lambda size: 1 + 2 * size.cells * size.width)]


class Workspace(NamedTuple):
    """The cells of one tissue, (n,), or of eight side by side, (n, WIDTH).

    Tissues with fewer cells than others are filled up with cells that lie far from everything and never move. The
    spring W = alpha (d - l)^2 / l^p, l = 1 + eta, moves X by -k (1 - l / d) (X - A), k = 2 alpha (h / mu) / l^p; a
    junction has k = (h / mu) junction_factor (alpha_i + alpha_j) / 2.
    """

    # Copies of the cells, and coefficients that stay the same until the rules change again
    x: CellFloats
    y: CellFloats
    ax: CellFloats
    ay: CellFloats
    bx: CellFloats
    by: CellFloats
    radius: CellFloats
    k_ax: CellFloats
    k_bx: CellFloats
    k_axb: CellFloats
    l_ax: CellFloats
    l_bx: CellFloats
    moves: CellFloats  # whether forces move the basal point: 1, or 0 for one that moves by itself (4.1)
    held: CellFloats  # whether the basal layer holds it: 1 or 0
    runs: CellFloats  # how far a basal point that moves by itself goes in a substep
    soft: CellFloats  # R_soft and strength of the repulsion, which matter where they differ
    stiff_xx: CellFloats
    limit: CellFloats  # max_basal_distance of the cell: of two neighbours the mean
    in_apical: CellFloats  # whether a cell is in the apical layer: 1 or 0
    # Of the junction of a cell with the one before it in the apical layer: whether there is one, 1 or 0
    joined: CellFloats
    rest: CellFloats
    k_aa: CellFloats
    # What is computed on the way
    push_x: CellFloats  # push of the soft discs on the nucleus, for strength 1
    push_y: CellFloats
    drag_x: CellFloats  # displacement of the apical point by the junctions
    drag_y: CellFloats
    # Of a basal point that the layer holds: its place along it, on a line bx itself, and there the direction
    along: CellFloats
    tangent_x: CellFloats
    tangent_y: CellFloats
    ends: CellFloats  # where the basal sweeps bring the points of the layer
    before_x: CellFloats  # nuclei before the sweep
    before_y: CellFloats
    # Of cells or blocks of them, see ``tissue.kernels.near``
    right: CellFloats  # ends of the box around a block; those on the left and below with the other sign
    left: CellFloats
    top: CellFloats
    bottom: CellFloats
    front: CellFloats  # the rightmost end of this block and of those before
    id: CellIntegers
    noise_key: Annotated[Integers, PerTissue(2, np.int64)]  # of the noise in substeps, see ``tissue.model.noise``
    counts: Annotated[Floats, PerTissue(2)]  # corrections of discs and of basal points
    repulsion: Annotated[Floats, PerTissue(1)]  # strength of all pushes; 1 where each cell has its own, see ``mixed``
    deviation: Annotated[Floats, PerTissue(1)]  # of the noise in a substep
    # Who may be near whom, one number for all tissues
    first: OfCells  # of each cell or block the first one that may be near it
    last: OfCells  # of each cell, behind the last one
    begin: OfCells  # ranges of cells that may be near the one at hand
    end: OfCells
    ranges: One  # how many there are
    cells: OfTissues  # numbers of cells, one for each tissue
    links: Links  # of the junctions apart from the layers: how many, then the places of both cells, seen flat
    pairs: One  # pairs looked at for the repulsion
    # Of one substep
    substeps: int = 0  # in one dt
    mixed: int = 0  # 0, or the power p of R in the repulsion of cells whose soft discs differ
    soft_end: float = 0.0  # the largest R_soft, a little more
    bent: int = 0  # whether the basal layer is not a straight line, 1 or 0
    curve: CurveNumbers = STRAIGHT
    z: float = 0.0  # third coordinates are not there, see ``tissue.kernels.lanes``
    az: float = 0.0
    bz: float = 0.0
    push_z: float = 0.0
    drag_z: float = 0.0
    surface: Surface = FLAT_SURFACE  # the plane
    forces: int = 0  # where those of users are, see ``tissue.step.user_forces``; 0: there are none


def is_mixed(kinds: Sequence[Numbers]) -> int:
    """Return the power p of R in the repulsion where the soft discs of the types of cells differ, else 0."""
    return int(kinds[0].spring_power) if len({(one.soft_radius, one.repulsion) for one in kinds}) > 1 else 0


class Workspaces:
    """A workspace of both forms, on the same memory, for the cells of one tissue or of eight; for kernels they are
    ``Workspace``.

    ``kinds``: of each tissue the numbers of its types of cells, of one where they are the same for all; ``scales``
    likewise. What the fields without an array say must be the same for all.
    """

    def __init__(
        self,
        capacity: int,
        width: int,
        kinds: Sequence[Sequence[Numbers]],
        scales: Floats,
        curve: CurveNumbers,
        forces: int = 0,
    ) -> None:
        numbers, mixed = kinds[0][0], is_mixed(kinds[0])
        strengths = [scale * one[0].repulsion for one, scale in zip(kinds, scales, strict=True)]
        flat, wide = both_forms(
            Workspace,
            Size(capacity, width),
            substeps=int(numbers.substeps),
            repulsion=1.0 if mixed else strengths,
            mixed=mixed,
            soft_end=max(one.soft_radius for mine in kinds for one in mine) * SOFT_END,
            deviation=np.sqrt([mine[0].substep_variance for mine in kinds]),
            bent=curve.bent,
            curve=curve,
            forces=forces,
        )
        flat.soft[:] = 1.0  # where there is no cell, too
        if not curve.bent:
            flat, wide = flat._replace(along=flat.bx), wide._replace(along=wide.bx)
        self.pairs: Integers = flat.pairs
        self.flat: Any = StructPointer(flat)
        self.wide: Any = StructPointer(wide)


_FLAT, _WIDE = both_forms(Workspace, Size(1))
WORKSPACE = struct_type(_FLAT)
workspace_at, wide_workspace_at = reader(_FLAT), reader(_WIDE)
