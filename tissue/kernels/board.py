"""Where substeps are made: the cells of one tissue, or of eight side by side."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from dincl.compile import inner
from dincl.kernels.handles import reader
from tissue.kernels.chains import chained_before
from tissue.kernels.curve import CurveNumbers, course
from tissue.kernels.handed import Handed, kind_of_handle
from tissue.kernels.lanes import WIDTH
from tissue.kernels.store import (
    APICAL,
    BASAL,
    BASAL_CORRECTIONS,
    CELLS,
    CORRECTIONS,
    STRAIGHT,
    SUBSTEPS,
    Store,
    store_at,
)
from tissue.model.cells import Floats, Integers
from tissue.model.numbers import Numbers

# What ``ended`` says of a tissue, if not the number of the step that failed.
RUNNING, EMPTY = 0, -1
# Far from every cell, and from each other: the places that are empty.
FAR = 1e6
# A nucleus that is farther out is lost, before it comes near them [R_soft].
LOST = FAR / 2


class Board(NamedTuple):
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
    bx_moves: Floats
    by_moves: Floats
    runs: Floats
    # Layers: whether a cell is inside, 1 or 0
    in_apical: Floats
    in_basal: Floats
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
    noise_key: Integers  # two words: of the noise in substeps, see ``tissue.kernels.normals``
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
    repulsion: float
    max_basal: float
    deviation: float  # of the noise in a substep
    bent: int  # whether the basal layer is not a straight line, 1 or 0
    curve: CurveNumbers


# How long the arrays are that have no place for each cell.
SHORT = {"noise_key": 2, "counts": 2}
WHOLE = ("id", "noise_key")
# Whole numbers that are the same for all tissues of a company.
SAME = ("first", "last", "begin", "end", "ranges", "cells", "pairs", "links")


class Boards:
    """A board of two forms, on the same memory: ``flat``, (m,) numbers, and ``wide``, (m / WIDTH, WIDTH).

    Cell i of a tissue alone is number i, that of tissue k of eight number WIDTH i + k. The ``noise_key`` of a tissue
    alone is apart in both: two words, and two for each lane. ``block`` has the arrays with a number for each cell.
    """

    def __init__(self, capacity: int, width: int, numbers: Numbers, scale: float, curve: CurveNumbers) -> None:
        m = -(-capacity * width // WIDTH) * WIDTH
        names = Board._fields[: Board._fields.index("first")]
        self.block = _aligned(len(names), m)
        block = {name: line[:m] for name, line in zip(names, self.block, strict=True)}
        for name in WHOLE:
            block[name] = block[name].view(np.int64)
        same = _common(capacity, width, numbers, scale) | {"bent": curve.bent, "curve": curve}
        self.pairs: Integers = same["pairs"]
        flat = {name: line[: SHORT.get(name, m) * (width if name in SHORT else 1)] for name, line in block.items()}
        wide = {name: line.reshape(-1, WIDTH)[: SHORT.get(name)] for name, line in block.items()}
        if width == 1:
            wide |= {name: np.zeros((SHORT[name], WIDTH), line.dtype) for name, line in block.items() if name in SHORT}
        if not curve.bent:
            flat["along"], wide["along"] = flat["bx"], wide["bx"]
        # For kernels these are ``Board``.
        self.flat: Any = Handed(Board(**flat, **same), _FLAT)
        self.wide: Any = Handed(Board(**wide, **same), _WIDE)


def _common(capacity: int, width: int, numbers: Numbers, scale: float) -> dict[str, Any]:
    """What is the same in both forms."""
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
    variance = numbers.variance * numbers.dt / numbers.substeps if numbers.noise_in_substeps else 0.0
    return {
        **{name: np.zeros(length, np.int64) for name, length in lengths.items()},
        "substeps": int(numbers.substeps),
        "repulsion": float(scale * numbers.repulsion),
        "max_basal": float(numbers.max_basal),
        "deviation": float(np.sqrt(variance)),
    }


def _aligned(lines: int, length: int) -> NDArray[np.float64]:
    """Zeros, lines of this length and eight more, which none uses: so no two lines share a place in the cache.

    Eight numbers lie in one line of the cache.
    """
    zeros = np.zeros(lines * (length + WIDTH) + WIDTH - 1)
    begin = -zeros.ctypes.data % (8 * WIDTH) // 8
    return zeros[begin : begin + lines * (length + WIDTH)].reshape(lines, -1)


def _example(*shape: int) -> Board:
    """A board for its types."""
    whole = {*WHOLE, *SAME}
    kinds = {name: np.int64 if name in whole else np.float64 for name in Board._fields}
    plain: dict[str, Any] = {"substeps": 0, "repulsion": 0.0, "max_basal": 0.0, "deviation": 0.0}
    plain |= {"bent": 0, "curve": STRAIGHT}
    lines = dict.fromkeys(SAME, (1,))
    return Board(**{name: plain.get(name, np.zeros(lines.get(name, shape), kind)) for name, kind in kinds.items()})


_FLAT, _WIDE = kind_of_handle(_example(1)), kind_of_handle(_example(1, WIDTH))
board_at, wide_board_at = reader(_example(1)), reader(_example(1, WIDTH))


@inner
def copy_in(stores: Integers, ended: Integers, board: Board, numbers: Numbers, scale: float) -> int:
    """Copy the tissues that run to the board, seen flat; ``scale`` = h / mu; the largest number of cells."""
    width, largest = len(ended), 0
    board.links[0] = 0
    for k in range(width):
        board.cells[k] = store_at(stores[k]).sizes[CELLS] if ended[k] == RUNNING else 0
        largest = max(largest, board.cells[k])
    for k in range(width):
        for i in range(board.cells[k], largest):
            _fill(board, i, width * i + k)
        for i in range(largest):
            board.in_apical[width * i + k] = board.in_basal[width * i + k] = board.joined[width * i + k] = 0.0
        if ended[k] == RUNNING:
            _copy(store_at(stores[k]), k, width, board, numbers, scale)
    return largest


@inner
def _copy(store: Store, k: int, width: int, board: Board, numbers: Numbers, scale: float) -> None:
    """Copy a tissue to lane k."""
    cells, motion = store.cells, store.motion
    squared = numbers.power == 2
    for i in range(board.cells[k]):
        place = width * i + k
        board.x[place], board.y[place] = cells.x[i], cells.y[i]
        board.ax[place], board.ay[place] = cells.ax[i], cells.ay[i]
        board.bx[place], board.by[place] = cells.bx[i], cells.by[i]
        if board.bent:
            at = course(board.curve, cells.along[i])
            board.along[place], board.tangent_x[place], board.tangent_y[place] = cells.along[i], at[2], at[3]
        board.radius[place], board.id[place] = cells.radius[i], cells.id[i]
        l_ax, l_bx = 1.0 + cells.rest_ax[i], 1.0 + cells.rest_bx[i]
        board.l_ax[place], board.l_bx[place] = l_ax, l_bx
        board.k_ax[place] = 2.0 * scale * cells.stiff_ax[i] / (l_ax * l_ax if squared else l_ax)
        board.k_bx[place] = 2.0 * scale * cells.stiff_bx[i] / (l_bx * l_bx if squared else l_bx)
        board.k_axb[place] = scale * cells.stiff_axb[i]
        board.bx_moves[place], board.by_moves[place] = motion.bx_moves[i], motion.by_moves[i]
        board.runs[place] = motion.runs[i]
    for s in range(store.sizes[APICAL]):
        i, place = store.layers.apical[s], width * store.layers.apical[s] + k
        board.in_apical[place] = 1.0
        if s > 0 or (board.curve.ring > 0.0 and store.sizes[APICAL] > 2):
            before = store.layers.apical[s - 1 if s > 0 else store.sizes[APICAL] - 1]
            board.joined[place], board.rest[place] = 1.0, cells.rest_aa[before]
            board.k_aa[place] = scale * numbers.junction_factor * (0.5 * (cells.stiff_aa[before] + cells.stiff_aa[i]))
    _copy_links(store, k, width, board, scale * numbers.junction_factor)
    for s in range(store.sizes[BASAL]):
        board.in_basal[width * store.layers.basal[s] + k] = 1.0
    for word in range(2):
        board.noise_key[width * word + k] = store.noise_key[word]
        board.counts[width * word + k] = 0.0


@inner
def _copy_links(store: Store, k: int, width: int, board: Board, scale: float) -> None:
    """Copy the junctions of a tissue that are apart from its layer; their cells have no other."""
    cells, links = store.cells, board.links
    for i in range(board.cells[k]):
        first = chained_before(cells, i)
        if first >= 0:
            place, number = width * i + k, links[0]
            links[1 + 2 * number], links[2 + 2 * number] = place, width * first + k
            links[0] += 1
            board.rest[place] = cells.rest_aa[first]
            board.k_aa[place] = scale * (0.5 * (cells.stiff_aa[first] + cells.stiff_aa[i]))


@inner
def _fill(board: Board, i: int, place: int) -> None:
    """An empty place: a cell that stands upright, far from everything and from its like, without forces."""
    board.x[place] = board.ax[place] = board.bx[place] = FAR * (1 + i)
    board.y[place], board.ay[place], board.by[place] = 0.0, 1.0, -1.0
    board.radius[place] = board.k_ax[place] = board.k_bx[place] = board.k_axb[place] = 0.0
    board.bx_moves[place] = board.by_moves[place] = board.runs[place] = 0.0


@inner
def copy_out(board: Board, stores: Integers) -> None:
    """Copy positions and counts back to the tissues on the board, seen flat."""
    width = len(board.cells)
    for k in range(width):
        if board.cells[k] > 0:
            store = store_at(stores[k])
            cells = store.cells
            for i in range(board.cells[k]):
                place = width * i + k
                cells.x[i], cells.y[i] = board.x[place], board.y[place]
                cells.ax[i], cells.ay[i] = board.ax[place], board.ay[place]
                cells.bx[i], cells.by[i] = board.bx[place], board.by[place]
                if board.bent:
                    cells.along[i] = board.along[place]
            store.counts[SUBSTEPS] += board.substeps
            store.counts[CORRECTIONS] += int(board.counts[k])
            store.counts[BASAL_CORRECTIONS] += int(board.counts[width + k])
