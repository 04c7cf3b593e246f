"""Cells and their networks copied to the board in space, where substeps are made, and back."""

from __future__ import annotations

from dincl.compiled import inner
from tissue.model.springs import coefficient
from tissue.network.halfedges import LEFT, begins_edge, is_row, preceding
from tissue.state.network import Network
from tissue.state.numbers import Numbers
from tissue.state.store import BASAL_CORRECTIONS, CELLS, CORRECTIONS, SUBSTEPS, Store
from tissue.step import space_board as on_board
from tissue.step.space_board import JUNCTIONS, NEIGHBOURS, ORDERED, SpaceBoard


@inner
def copy_to_board(store: Store, board: SpaceBoard, numbers: Numbers, scale: float) -> int:
    """Copy a tissue to the board; ``scale`` = h / mu; how many cells it has."""
    cells, motion, n = store.cells, store.motion, store.sizes[CELLS]
    for i in range(n):
        board.x[i], board.y[i], board.z[i] = cells.x[i], cells.y[i], cells.z[i]
        board.ax[i], board.ay[i], board.az[i] = cells.ax[i], cells.ay[i], cells.az[i]
        board.bx[i], board.by[i], board.bz[i] = cells.bx[i], cells.by[i], cells.bz[i]
        board.radius[i], board.id[i] = cells.radius[i], cells.id[i]
        l_ax, l_bx = numbers.soft_radius + cells.rest_ax[i], numbers.soft_radius + cells.rest_bx[i]
        board.l_ax[i], board.l_bx[i] = l_ax, l_bx
        board.k_ax[i] = coefficient(scale, cells.stiff_ax[i], l_ax, numbers.power)
        board.k_bx[i] = coefficient(scale, cells.stiff_bx[i], l_bx, numbers.power)
        board.k_axb[i] = scale * cells.stiff_axb[i]
        board.b_moves[i], board.runs[i], board.held[i] = motion.moves[i], motion.runs[i], motion.held[i]
    for word in range(2):
        board.noise_key[word] = store.noise_key[word]
    for k in range(len(board.counts)):
        board.counts[k] = 0
    _list_junctions(store, board, scale * numbers.junction_factor)
    _list_neighbours(store.space.basal, board)
    cells_copied: int = n
    return cells_copied


@inner
def _list_junctions(store: Store, board: SpaceBoard, scale: float) -> None:
    """The junctions of the apical network, each once, with k = scale (alpha_i + alpha_j) / 2."""
    network, alpha, count = store.space.apical, store.cells.stiff_aa, 0
    for h in range(3 * network.triangles[0]):
        if begins_edge(network, h):
            i, j = network.corner[h], network.corner[network.twin[h]]
            board.junctions[count, 0], board.junctions[count, 1] = i, j
            board.rest[count] = network.rest[h]
            board.k_aa[count] = scale * (0.5 * (alpha[i] + alpha[j]))
            count += 1
    board.sizes[JUNCTIONS] = count


@inner
def _list_neighbours(network: Network, board: SpaceBoard) -> None:
    """The edges of the basal network, each once; those of a row of cells forward, with its left side on the left."""
    count, ordered = 0, is_row(network)
    for h in range(3 * network.triangles[0]):
        if begins_edge(network, h):
            first = network.twin[h] if ordered and network.corner[preceding(h)] != LEFT else h
            ends = network.corner[first], network.corner[network.twin[first]]
            board.neighbours[count, 0], board.neighbours[count, 1] = ends
            count += 1
    board.sizes[NEIGHBOURS], board.sizes[ORDERED] = count, ordered


@inner
def copy_from_board(board: SpaceBoard, store: Store) -> None:
    """Copy positions and counts back."""
    cells = store.cells
    for i in range(store.sizes[CELLS]):
        cells.x[i], cells.y[i], cells.z[i] = board.x[i], board.y[i], board.z[i]
        cells.ax[i], cells.ay[i], cells.az[i] = board.ax[i], board.ay[i], board.az[i]
        cells.bx[i], cells.by[i], cells.bz[i] = board.bx[i], board.by[i], board.bz[i]
    store.counts[SUBSTEPS] += board.counts[on_board.SUBSTEPS]
    store.counts[CORRECTIONS] += board.counts[on_board.CORRECTIONS]
    store.counts[BASAL_CORRECTIONS] += board.counts[on_board.BASAL_CORRECTIONS]
