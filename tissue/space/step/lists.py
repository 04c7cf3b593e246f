"""Lists of the pairs of nuclei that may act on each other, which hold until one has gone too far (Verlet, 1967).

A pair is listed if it is nearer than the range and a skin. As long as no nucleus has moved by half of the skin since,
no other pair is within the range.
"""

from __future__ import annotations

from dincl.compile import inner
from tissue.kernels.lanes import WIDTH, fma, load, lowest_bit, maximum, positive_bits, spread, where_positive
from tissue.model.repulsion import SOFT
from tissue.space.step.bins import find_beside, sort_in_bins
from tissue.space.step.board import FRESH, LISTS, MANY, WHOLE, SpaceBoard
from tissue.space.step.eight import load_from
from tissue.space.step.hard_pairs import add_hard, begin_hard, end_hard
from tissue.space.step.images import nearest, periods
from tissue.space.step.quads import QUAD_WIDTH

# Thicker ones make longer lists, thinner ones more of them [R_soft].
SKIN = 0.4
# How far a nucleus may move, less some rounding.
HALF_SKIN = 0.499 * SKIN
# A margin that finds none.
NO_BALLS = -1e300


@inner
def have_strayed(board: SpaceBoard, rows: int) -> bool:
    """Whether a nucleus has moved by half of the skin since the lists were made; the board is in rows."""
    far = spread(board.x, 0.0)
    for i in range(rows):
        dx, dy = load(board.x, i) - load(board.made_x, i), load(board.y, i) - load(board.made_y, i)
        dz = load(board.z, i) - load(board.made_z, i)
        far = maximum(fma(dx, dx, fma(dy, dy, dz * dz)), far)
    strayed: bool = positive_bits(far - HALF_SKIN * HALF_SKIN) != 0
    return strayed


@inner
def make_lists(board: SpaceBoard, n: int) -> None:
    """Both lists, from where the nuclei are now."""
    soft, hard = SOFT + SKIN, 2.0 * largest_radius(board, n) + SKIN
    list_pairs(board, n, max(soft, hard) if board.repulsion != 0.0 else hard)
    for i in range(n):
        board.made_x[i], board.made_y[i], board.made_z[i] = board.x[i], board.y[i], board.z[i]
    board.state[FRESH] = 1


@inner
def largest_radius(board: SpaceBoard, n: int) -> float:
    """The radius of the largest hard ball."""
    largest = 0.0
    for i in range(n):
        largest = max(largest, board.radius[i])
    return largest


@inner
def list_pairs(board: SpaceBoard, n: int, reach: float) -> None:
    """List the nuclei that are nearer than ``reach``, and of these the hard balls whose gap is below the skin.

    Rows that may find no room are left out: they are found when they are asked for.
    """
    board.state[FRESH] = 0
    board.state[MANY], board.state[MANY + 1], board.state[MANY + 2] = sort_in_bins(board, n, reach)
    begin_hard(board, n)
    whole, end, room = 0, 0, len(board.listed) - n - QUAD_WIDTH
    for b in range(board.state[MANY] * board.state[MANY + 1] * board.state[MANY + 2]):
        if board.start[b] < board.start[b + 1]:
            ranges = find_beside(board, b)
            for p in range(board.start[b], board.start[b + 1]):
                fits = end + p <= room - QUAD_WIDTH
                into = end if fits else room
                last = _list_row(board, p, ranges, reach, into, SKIN)
                if fits:
                    board.row[p], board.row_end[p], whole = into, last, p + 1
                    end = fill_up(board, last, n)
    board.state[WHOLE] = whole
    board.counts[LISTS] += 1
    end_hard(board, n)


@inner
def row_of(board: SpaceBoard, p: int, n: int) -> tuple[int, int]:
    """Where the soft pairs of place p begin and end among those listed."""
    if p < board.state[WHOLE]:
        return board.row[p], board.row_end[p]
    into = len(board.listed) - n - QUAD_WIDTH
    end = _list_row(board, p, find_beside(board, board.bin[board.order[p]]), SOFT + SKIN, into, NO_BALLS)
    fill_up(board, end, n)
    return into, end


@inner
def fill_up(board: SpaceBoard, end: int, n: int) -> int:
    """Fill a row that ends there up to fours by the place behind the last: where the next one begins."""
    while end % QUAD_WIDTH != 0:
        board.listed[end] = n
        end += 1
    return end


@inner
def _list_row(board: SpaceBoard, p: int, ranges: int, reach: float, into: int, margin: float) -> int:
    """List the places before p that are nearer than ``reach``, from ``into`` on: where they end.

    Of these find the hard balls whose gap is below the margin.
    """
    x, y, z, radius, listed = board.place_x, board.place_y, board.place_z, board.place_radius, board.listed
    length_x, by_x, length_z, by_z = periods(board)
    for k in range(ranges):
        end = min(board.end[k], p)
        for q in range(board.begin[k], end, WIDTH):
            dx, dy = nearest(load_from(x, q) - x[p], length_x, by_x), load_from(y, q) - y[p]
            dz = nearest(load_from(z, q) - z[p], length_z, by_z)
            square = fma(dx, dx, fma(dy, dy, dz * dz))
            near = positive_bits(reach * reach - square)
            if end - q < WIDTH:
                near &= (1 << (end - q)) - 1
            if near:
                balls = load_from(radius, q) + (radius[p] + margin)
                touch = near & positive_bits(where_positive(balls, balls * balls) - square)
                for lane in range(WIDTH):
                    listed[into] = q + lane
                    into += near >> lane & 1
                while touch:
                    add_hard(board, board.order[p], board.order[q + lowest_bit(touch)])
                    touch &= touch - 1
    return into
