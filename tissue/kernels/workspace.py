"""Where substeps are made: the cells of one tissue, or of eight side by side."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from dincl.compiled import StructPointer, reader, struct_type
from dincl.compiled.lanes import WIDTH
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


class Workspace(NamedTuple):
    """The cells of one tissue, (n,), or of eight side by side, (n, WIDTH).

    Tissues with fewer cells than others are filled up with cells that lie far from everything and never move. The
    spring W = alpha (d - l)^2 / l^p, l = 1 + eta, moves X by -k (1 - l / d) (X - A), k = 2 alpha (h / mu) / l^p; a
    junction has k = (h / mu) junction_factor (alpha_i + alpha_j) / 2.
    """

    # Copies of the cells, and coefficients that stay the same until the rules change again
    x: Floats
    y: Floats
    ax: Floats
    ay: Floats
    bx: Floats
    by: Floats
    radius: Floats
    k_ax: Floats
    k_bx: Floats
    k_axb: Floats
    l_ax: Floats
    l_bx: Floats
    moves: Floats  # whether forces move the basal point: 1, or 0 for one that moves by itself (4.1)
    held: Floats  # whether the basal layer holds it: 1 or 0
    runs: Floats  # how far a basal point that moves by itself goes in a substep
    soft: Floats  # R_soft and strength of the repulsion, which matter where they differ
    stiff_xx: Floats
    limit: Floats  # max_basal of the cell: of two neighbours the mean
    in_apical: Floats  # whether a cell is in the apical layer: 1 or 0
    # Of the junction of a cell with the one before it in the apical layer: whether there is one, 1 or 0
    joined: Floats
    rest: Floats
    k_aa: Floats
    # What is computed on the way
    push_x: Floats  # push of the soft discs on the nucleus, for strength 1
    push_y: Floats
    drag_x: Floats  # displacement of the apical point by the junctions
    drag_y: Floats
    # Of a basal point that the layer holds: its place along it, on a line bx itself, and there the direction
    along: Floats
    tangent_x: Floats
    tangent_y: Floats
    ends: Floats  # where the basal sweeps bring the points of the layer
    before_x: Floats  # nuclei before the sweep
    before_y: Floats
    # Of cells or blocks of them, see ``tissue.kernels.near``
    right: Floats  # ends of the box around a block; those on the left and below with the other sign
    left: Floats
    top: Floats
    bottom: Floats
    front: Floats  # the rightmost end of this block and of those before
    id: Integers
    noise_key: Integers  # two words: of the noise in substeps, see ``tissue.model.noise``
    counts: Floats  # two numbers: corrections of discs and of basal points
    # Who may be near whom, one number for all tissues
    first: Integers  # (n,): of each cell or block the first one that may be near it
    last: Integers  # (n,): of each cell, behind the last one
    begin: Integers  # (n,): ranges of cells that may be near the one at hand
    end: Integers
    ranges: Integers  # (1,): how many there are
    cells: Integers  # numbers of cells, one for each tissue
    links: Integers  # of the junctions apart from the layers: how many, then the places of both cells, seen flat
    pairs: Integers  # (1,): pairs looked at for the repulsion
    # Of one substep
    substeps: int  # in one dt
    repulsion: float  # strength of all pushes; 1 where each cell has its own, see ``mixed``
    mixed: int  # 0, or the power p of R in the repulsion of cells whose soft discs differ
    soft_end: float  # the largest R_soft, a little more
    max_basal: float  # of control cells
    deviation: float  # of the noise in a substep
    bent: int  # whether the basal layer is not a straight line, 1 or 0
    curve: CurveNumbers
    z: float  # third coordinates are not there, see ``dincl.compiled.lanes``
    az: float
    bz: float
    push_z: float
    drag_z: float
    surface: Surface  # the plane
    forces: int  # where those of users are, see ``tissue.step.user_forces``; 0: there are none


# What a slice does not have.
ABSENT: dict[str, Any] = {**dict.fromkeys(("z", "az", "bz", "push_z", "drag_z"), 0.0), "surface": FLAT_SURFACE}
# How long the arrays are that have no place for each cell.
SHORT = {"noise_key": 2, "counts": 2}
WHOLE = ("id", "noise_key")
# Whole numbers that are the same for all tissues of a company.
SAME = ("first", "last", "begin", "end", "ranges", "cells", "pairs", "links")


class Workspaces:
    """A workspace of two forms, on the same memory: ``flat``, (m,) numbers, and ``wide``, (m / WIDTH, WIDTH).

    Cell i of a tissue alone is number i, that of tissue k of eight number WIDTH i + k. The ``noise_key`` of a tissue
    alone is apart in both: two words, and two for each lane. ``block`` has the arrays with a number for each cell.
    """

    def __init__(
        self,
        capacity: int,
        width: int,
        numbers: Numbers,
        scale: float,
        curve: CurveNumbers,
        forces: int = 0,
        named: Sequence[Numbers] = (),
    ) -> None:
        m = -(-capacity * width // WIDTH) * WIDTH
        names = Workspace._fields[: Workspace._fields.index("first")]
        self.block = aligned(len(names), m)
        block = {name: line[:m] for name, line in zip(names, self.block, strict=True)}
        for name in WHOLE:
            block[name] = block[name].view(np.int64)
        block["soft"][:] = 1.0  # where there is no cell, too
        same = _common(capacity, width, (numbers, *named), scale) | {
            "bent": curve.bent,
            "curve": curve,
            "forces": forces,
        }
        self.pairs: Integers = same["pairs"]
        flat = {name: line[: SHORT.get(name, m) * (width if name in SHORT else 1)] for name, line in block.items()}
        wide = {name: line.reshape(-1, WIDTH)[: SHORT.get(name)] for name, line in block.items()}
        if width == 1:
            wide |= {name: np.zeros((SHORT[name], WIDTH), line.dtype) for name, line in block.items() if name in SHORT}
        if not curve.bent:
            flat["along"], wide["along"] = flat["bx"], wide["bx"]
        # For kernels these are ``Workspace``.
        self.flat: Any = StructPointer(Workspace(**flat, **same), FLAT)
        self.wide: Any = StructPointer(Workspace(**wide, **same), _WIDE)


def _common(capacity: int, width: int, kinds: Sequence[Numbers], scale: float) -> dict[str, Any]:
    """Make what both forms share; ``kinds``: the numbers of control cells, then those of the named types."""
    numbers, mixed = kinds[0], len({(one.soft_radius, one.repulsion) for one in kinds}) > 1
    lengths = {
        "first": capacity,
        "last": capacity,
        "begin": capacity,
        "end": capacity,
        "ranges": 1,
        "cells": width,
        "pairs": 1,
        "links": 1 + 2 * capacity * width,
    }
    return ABSENT | {
        **{name: np.zeros(length, np.int64) for name, length in lengths.items()},
        "substeps": int(numbers.substeps),
        "repulsion": 1.0 if mixed else float(scale * numbers.repulsion),
        "mixed": int(numbers.power) if mixed else 0,
        "soft_end": max(one.soft_radius for one in kinds) * SOFT_END,
        "max_basal": float(numbers.max_basal),
        "deviation": float(np.sqrt(numbers.substep_variance)),
    }


def aligned(lines: int, length: int) -> NDArray[np.float64]:
    """Make lines of zeros of this length and eight more, which none uses: no two lines share a place in the cache.

    Eight numbers lie in one line of the cache.
    """
    zeros = np.zeros(lines * (length + WIDTH) + WIDTH - 1)
    begin = -zeros.ctypes.data % (8 * WIDTH) // 8
    return zeros[begin : begin + lines * (length + WIDTH)].reshape(lines, -1)


def _example(*shape: int) -> Workspace:
    """Return a workspace for its types."""
    whole = {*WHOLE, *SAME}
    kinds = {name: np.int64 if name in whole else np.float64 for name in Workspace._fields}
    plain: dict[str, Any] = ABSENT | {
        "substeps": 0,
        "repulsion": 0.0,
        "mixed": 0,
        "soft_end": 0.0,
        "max_basal": 0.0,
        "deviation": 0.0,
    }
    plain |= {"bent": 0, "curve": STRAIGHT, "forces": 0}
    lines = dict.fromkeys(SAME, (1,))
    return Workspace(**{name: plain.get(name, np.zeros(lines.get(name, shape), kind)) for name, kind in kinds.items()})


FLAT, _WIDE = struct_type(_example(1)), struct_type(_example(1, WIDTH))
workspace_at, wide_workspace_at = reader(_example(1)), reader(_example(1, WIDTH))
