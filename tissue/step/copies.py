"""Cells copied to the board, where substeps are made, and back."""

from __future__ import annotations

from dincl.compiled import inner
from tissue.kernels.board import FAR, RUNNING, Board
from tissue.kernels.curve import course
from tissue.kernels.layers import chained_before
from tissue.kernels.numbers import numbers_of
from tissue.model.springs import coefficient
from tissue.state.cells import Integers
from tissue.state.numbers import Numbers
from tissue.state.store import APICAL, BASAL, BASAL_CORRECTIONS, CELLS, CORRECTIONS, SUBSTEPS, Store, store_at


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
    for i in range(board.cells[k]):
        place = width * i + k
        board.x[place], board.y[place] = cells.x[i], cells.y[i]
        board.ax[place], board.ay[place] = cells.ax[i], cells.ay[i]
        board.bx[place], board.by[place] = cells.bx[i], cells.by[i]
        if board.bent:
            at = course(board.curve, cells.along[i])
            board.along[place], board.tangent_x[place], board.tangent_y[place] = cells.along[i], at[2], at[3]
        board.radius[place], board.id[place] = cells.radius[i], cells.id[i]
        own = numbers_of(numbers, cells.kind[i])
        board.soft[place], board.stiff_xx[place] = own.soft_radius, scale * own.repulsion
        board.reach[place] = own.max_basal
        l_ax, l_bx = own.soft_radius + cells.rest_ax[i], own.soft_radius + cells.rest_bx[i]
        board.l_ax[place], board.l_bx[place] = l_ax, l_bx
        board.k_ax[place] = coefficient(scale, cells.stiff_ax[i], l_ax, numbers.power)
        board.k_bx[place] = coefficient(scale, cells.stiff_bx[i], l_bx, numbers.power)
        board.k_axb[place] = scale * cells.stiff_axb[i]
        board.bx_moves[place], board.by_moves[place] = motion.moves[i], motion.moves[i] * (1.0 - motion.held[i])
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
            put_back(board, store, k)
            store.counts[SUBSTEPS] += board.substeps
            store.counts[CORRECTIONS] += int(board.counts[k])
            store.counts[BASAL_CORRECTIONS] += int(board.counts[width + k])


@inner
def put_back(board: Board, store: Store, k: int) -> None:
    """Copy the positions of lane k back to its tissue."""
    cells, width = store.cells, len(board.cells)
    pairs = (cells.x, board.x), (cells.y, board.y), (cells.ax, board.ax), (cells.ay, board.ay)
    for mine, theirs in (*pairs, (cells.bx, board.bx), (cells.by, board.by)):
        for i in range(board.cells[k]):
            mine[i] = theirs[width * i + k]
    if board.bent:
        for i in range(board.cells[k]):
            cells.along[i] = board.along[width * i + k]
