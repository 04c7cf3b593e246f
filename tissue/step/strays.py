"""The few nuclei that have gone farther than the lists allow: each is compared with all others, in each substep."""

from __future__ import annotations

from dincl.compiled import inner
from dincl.compiled.lanes import WIDTH, fma, load, lowest_bit, positive_bits
from tissue.model.repulsion import SOFT, repelling
from tissue.step.images import nearest, periods
from tissue.step.lists import HALF_SKIN, SKIN, find_strays
from tissue.step.space_board import ALL, FOUND, PAIRS, STRAYS, SpaceBoard


@inner
def push_strays(board: SpaceBoard, n: int, wide: SpaceBoard, rows: int) -> None:
    """Add the pushes of the pairs that are not listed, in the order of the strays, for each in that of the cells."""
    length_x, by_x, length_z, by_z = periods(board)
    x, y, z = wide.x, wide.y, wide.z
    for number in range(board.state[STRAYS] if board.repulsion != 0.0 else 0):
        i = board.strays[number]
        for row in range(rows):
            dx, dy = nearest(load(x, row) - board.x[i], length_x, by_x), load(y, row) - board.y[i]
            dz = nearest(load(z, row) - board.z[i], length_z, by_z)
            near = positive_bits(SOFT * SOFT - fma(dx, dx, fma(dy, dy, dz * dz)))
            while near:
                j = WIDTH * row + lowest_bit(near)
                if j < n and j != i and not _is_listed(board, i, j) and (j < i or not _has_strayed(board, j)):
                    _push(board, i, j)
                near &= near - 1
        board.counts[PAIRS] += n - 1


@inner
def _is_listed(board: SpaceBoard, i: int, j: int) -> bool:
    """Whether two nuclei are a pair of the list: as it is decided where the list is made, to the last bit."""
    length_x, by_x, length_z, by_z = periods(board)
    x, y, z = board.made_x, board.made_y, board.made_z
    dx, dy, dz = nearest(x[i] - x[j], length_x, by_x), y[i] - y[j], nearest(z[i] - z[j], length_z, by_z)
    listed: bool = board.reach[0] * board.reach[0] - fma(dx, dx, fma(dy, dy, dz * dz)) > 0.0
    return listed


@inner
def _has_strayed(board: SpaceBoard, i: int) -> bool:
    """Whether cell i is among the strays."""
    dx, dy, dz = board.x[i] - board.made_x[i], board.y[i] - board.made_y[i], board.z[i] - board.made_z[i]
    strayed: bool = fma(dx, dx, fma(dy, dy, dz * dz)) - HALF_SKIN * HALF_SKIN > 0.0
    return strayed


@inner
def _push(board: SpaceBoard, i: int, j: int) -> None:
    """Push nuclei i and j apart."""
    length_x, by_x, length_z, by_z = periods(board)
    x, y, z = board.x, board.y, board.z
    dx, dy, dz = nearest(x[i] - x[j], length_x, by_x), y[i] - y[j], nearest(z[i] - z[j], length_z, by_z)
    weight = repelling(fma(dx, dx, fma(dy, dy, dz * dz)))
    board.push_x[i], board.push_x[j] = fma(weight, dx, board.push_x[i]), fma(-weight, dx, board.push_x[j])
    board.push_y[i], board.push_y[j] = fma(weight, dy, board.push_y[i]), fma(-weight, dy, board.push_y[j])
    board.push_z[i], board.push_z[j] = fma(weight, dz, board.push_z[i]), fma(-weight, dz, board.push_z[j])


@inner
def list_strays(board: SpaceBoard, n: int, wide: SpaceBoard, rows: int) -> None:
    """List for the sweep over hard balls the pairs of strays whose gap is now below two skins, in its order.

    Whoever is not listed here or there is not met: since now a stray is pushed by half of the skin, and another nucleus
    is within half of the skin of where it was listed. Those that find no room make each nucleus meet each.
    """
    length_x, by_x, length_z, by_z = periods(board)
    board.state[FOUND], strays = 0, find_strays(wide, rows, n)
    for number in range(strays):
        i = board.strays[number]
        for row in range(rows):
            dx, dy = nearest(load(wide.x, row) - board.x[i], length_x, by_x), load(wide.y, row) - board.y[i]
            dz = nearest(load(wide.z, row) - board.z[i], length_z, by_z)
            reach = load(wide.radius, row) + (board.radius[i] + 2.0 * SKIN)
            near = positive_bits(reach * reach - fma(dx, dx, fma(dy, dy, dz * dz)))
            while near:
                j = WIDTH * row + lowest_bit(near)
                if j < n and j != i:
                    _insert(board, max(i, j), min(i, j))
                near &= near - 1


@inner
def _insert(board: SpaceBoard, i: int, j: int) -> None:
    """Put the pair where it belongs among those found, unless it is there."""
    found, k = board.found, board.state[FOUND]
    if k == len(found):
        board.state[ALL] = 1
        return
    while k > 0 and (found[k - 1, 0] > i or (found[k - 1, 0] == i and found[k - 1, 1] > j)):
        found[k, 0], found[k, 1] = found[k - 1, 0], found[k - 1, 1]
        k -= 1
    if k > 0 and found[k - 1, 0] == i and found[k - 1, 1] == j:
        for m in range(k, board.state[FOUND]):
            found[m, 0], found[m, 1] = found[m + 1, 0], found[m + 1, 1]
    else:
        found[k, 0], found[k, 1] = i, j
        board.state[FOUND] += 1


@inner
def has_strayed_before(board: SpaceBoard, i: int) -> bool:
    """Whether cell i was among the strays before the sweep."""
    dx, dy = board.before_x[i] - board.made_x[i], board.before_y[i] - board.made_y[i]
    dz = board.before_z[i] - board.made_z[i]
    strayed: bool = fma(dx, dx, fma(dy, dy, dz * dz)) - HALF_SKIN * HALF_SKIN > 0.0
    return strayed
