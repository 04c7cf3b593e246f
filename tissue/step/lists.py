"""Lists of the pairs of nuclei that may act on each other, which hold until one has gone too far (Verlet, 1967).

A pair is listed if it is nearer than the range and a skin. As long as both nuclei have moved by less than half of the
skin since, a pair that is not listed is beyond the range. A few nuclei may stray farther: they meet all others.
"""

from __future__ import annotations

from dincl.compiled import inner
from dincl.compiled.lanes import WIDTH, fma, load, load_from, lowest_bit, positive_bits, where_positive
from tissue.model.repulsion import SOFT
from tissue.step.bins import find_beside, sort_in_bins
from tissue.step.hard_pairs import add_hard, begin_hard, end_hard
from tissue.step.images import nearest, periods
from tissue.step.quads import QUAD_WIDTH
from tissue.step.space_board import FRESH, LISTS, MANY, STRAYS, WHOLE, SpaceBoard

# Thicker ones make longer lists, thinner ones more of them [R_soft].
SKIN = 0.4
# How far a nucleus may move, less some rounding.
HALF_SKIN = 0.499 * SKIN
# With more strays than these it is time for new lists.
MOST_STRAYS = 16
# A margin that finds none.
NO_BALLS = -1e300
# load_eight(a, k): entries k to k + 7 of a flat array.
load_eight = load_from(WIDTH)


@inner
def find_strays(board: SpaceBoard, rows: int, n: int) -> int:
    """List the cells whose nuclei have moved by half of the skin since the lists were made: how many.

    The board is in rows, of n cells.
    """
    x, y, z, made_x, made_y, made_z = board.x, board.y, board.z, board.made_x, board.made_y, board.made_z
    number = 0
    for i in range(rows):
        dx, dy = load(x, i) - load(made_x, i), load(y, i) - load(made_y, i)
        dz = load(z, i) - load(made_z, i)
        far = positive_bits(fma(dx, dx, fma(dy, dy, dz * dz)) - HALF_SKIN * HALF_SKIN)
        while far:
            board.strays[number] = WIDTH * i + lowest_bit(far)
            number += 1 if board.strays[number] < n else 0
            far &= far - 1
    return number


@inner
def refresh_lists(board: SpaceBoard, n: int, wide: SpaceBoard, rows: int) -> None:
    """Make the lists anew if it is time; else STRAYS are the nuclei that may meet others than those listed."""
    strays = find_strays(wide, rows, n)
    if board.state[FRESH] == 0 or strays > MOST_STRAYS:
        make_lists(board, n)
        strays = 0
    board.state[STRAYS] = strays


@inner
def make_lists(board: SpaceBoard, n: int) -> None:
    """Both lists, from where the nuclei are now."""
    soft, hard = SOFT + SKIN, 2.0 * largest_radius(board, n) + SKIN
    board.reach[0] = max(soft, hard) if board.repulsion != 0.0 else hard
    list_pairs(board, n, board.reach[0])
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
    end = _list_row(board, p, find_beside(board, board.bin[board.order[p]]), board.reach[0], into, NO_BALLS)
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
            dx, dy = nearest(load_eight(x, q) - x[p], length_x, by_x), load_eight(y, q) - y[p]
            dz = nearest(load_eight(z, q) - z[p], length_z, by_z)
            square = fma(dx, dx, fma(dy, dy, dz * dz))
            near = positive_bits(reach * reach - square)
            if end - q < WIDTH:
                near &= (1 << (end - q)) - 1
            if near:
                balls = load_eight(radius, q) + (radius[p] + margin)
                touch = near & positive_bits(where_positive(balls, balls * balls) - square)
                for lane in range(WIDTH):
                    listed[into] = q + lane
                    into += near >> lane & 1
                while touch:
                    add_hard(board, board.order[p], board.order[q + lowest_bit(touch)])
                    touch &= touch - 1
    return into
