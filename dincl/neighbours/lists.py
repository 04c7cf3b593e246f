"""Lists of close pairs of discs of one family that may not overlap, and sweeps over them.

A list holds all pairs closer than the sum of their radii plus 2 ``skin``. It is complete while no disc is farther than
``skin`` from its place when the list was made, also in the middle of a sweep; otherwise the sweep is undone and
repeated with a new list. So the result is that of a sweep over all pairs.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from dincl.compiled import call, inner
from dincl.compiled.arrays import Floats, Offsets, empty
from dincl.compiled.calls import SETS as SEARCH
from dincl.compiled.structs import reader
from dincl.neighbours import ALL_PAIRS, FEWEST_SWEEPS, MOST_SWEEPS
from dincl.rows.formulas import square_distance, to_image
from dincl.system.arrays import COINCIDENT, NEED_ROOM, OK, REPEAT, SETS, STALE

# Places in ``number``: sweeps since the list was made; lists made; candidates and corrections in all sweeps; two discs
# whose centres coincide; 1 if the list is to be made anew; its pairs.
SWEEPS, BUILDS, CANDIDATES, CORRECTIONS, ONE, OTHER, OUTDATED, COUNT, NUMBERS = range(9)
# What is known of a list before a sweep: nothing, or whether it is outdated and the discs are where the step put them.
UNKNOWN, COMPLETE, INCOMPLETE = range(3)

call_search = call(SEARCH)
# What a search returns whose pairs have no room.
NO_ROOM = 2


class PairList(NamedTuple):
    """m discs and their ``number[COUNT]`` close pairs i = ``first[p]`` > j = ``second[p]``, i ascending, then j."""

    disc: Offsets  # (m,): the particles, or (0,) for all particles
    radius: Floats  # (m,)
    first: NDArray[np.uint32]  # unsigned, so that the compiler knows that no index is negative
    second: NDArray[np.uint32]
    multiplier: Floats  # of the pairs, or (0,) for schemes that have none
    point: Floats  # (m d,): positions of the discs, or (0,) for all particles
    reference: Floats  # (m d,): positions for which the list was made
    backup: Floats  # (m d,): positions before a sweep
    scale: Floats  # (m,): of scaled coordinates, see ``dincl.mobility``, and their origins; (0,) for plain ones
    origin: Floats  # (m d,)
    box: Floats  # (d,): periods of the axes, 0 for one that does not repeat
    skin: Floats  # (2,): of this list, and the widest [length]
    grown: Floats  # (1,): by how much a disc has grown since the list was made, at most [length]
    number: Offsets  # (NUMBERS,)
    search: int  # address of the function that lists the pairs of many discs: 0, 1 on failure or 2 if there is no room


class Move(NamedTuple):
    """The step x + h F, or x + h (v + h F) where there is a velocity, before the sweeps."""

    h: float
    x: Floats
    v: Floats
    rate: Floats


pair_list_at = reader(empty(PairList))


@inner
def move_all(move: Move, after: Floats) -> None:
    """Write all particles after the step before the sweeps."""
    h, x, v, rate = move.h, move.x, move.v, move.rate
    if v.size > 0:
        for k in range(after.size):
            after[k] = x[k] + h * (v[k] + h * rate[k])
    else:
        for k in range(after.size):
            after[k] = x[k] + h * rate[k]


@inner
def move_all_at_once(move: Move, after: Floats, pairs: PairList, axes: Any) -> int:
    """Do ``move_all``, in one pass over the memory with ``is_outdated``; return COMPLETE or INCOMPLETE."""
    if move.v.size > 0:
        move_all(move, after)
        return INCOMPLETE if is_outdated(after, pairs, axes) else COMPLETE
    h, x, rate, reference = move.h, move.x, move.rate, pairs.reference
    allowed, far, d = allowed_square(pairs), 0, len(axes)
    for i in range(0, after.size, d):
        for k in range(d):
            after[i + k] = x[i + k] + h * rate[i + k]
        far += square_distance(after, i, reference, i, axes) > allowed
    return INCOMPLETE if far > 0 or has_no_list(pairs) else COMPLETE


@inner
def has_no_list(pairs: PairList) -> bool:
    """Return whether there is no list, or one that is outdated wherever the discs are."""
    return bool(pairs.number[BUILDS] == 0 or pairs.number[OUTDATED] != 0)


@inner
def is_outdated(x: Floats, pairs: PairList, axes: Any) -> bool:
    """Return whether there is no list, or a disc is farther than the skin from its reference."""
    reference, allowed, far, d = pairs.reference, allowed_square(pairs), 0, len(axes)
    for i in range(pairs.radius.size):
        far += square_distance(x, i * d, reference, i * d, axes) > allowed
    return far > 0 or has_no_list(pairs)


@inner
def allowed_square(pairs: PairList) -> float:
    """Compute the square of how far a disc may be from its reference; negative if discs have grown too much."""
    left = pairs.skin[0] - pairs.grown[0]
    return float(left * left if left >= 0.0 else -1.0)


@inner
def rebuild(x: Floats, pairs: PairList, axes: Any) -> int:
    """List the pairs around x, after a change of a skin that was too narrow or too wide: OK, SETS or NEED_ROOM."""
    sweeps, skin, before = pairs.number[SWEEPS], pairs.skin, pairs.skin[0]
    if pairs.number[BUILDS] > 0:
        if sweeps == 0 or (sweeps < FEWEST_SWEEPS and 2.0 * skin[0] <= skin[1]):
            skin[0] *= 2.0
        elif sweeps > MOST_SWEEPS:
            skin[0] *= 0.5
    m, d = pairs.radius.size, len(axes)
    if m <= ALL_PAIRS:
        compare_few(x, pairs, axes)
    else:
        failed = call_search(pairs.search, 0.0, x, 0)
        if failed != 0:
            skin[0] = before
            return NEED_ROOM if failed == NO_ROOM else SETS
    reference = pairs.reference
    for k in range(m * d):
        reference[k] = x[k]
    pairs.grown[0] = 0.0
    pairs.number[SWEEPS] = pairs.number[OUTDATED] = 0
    pairs.number[BUILDS] += 1
    return OK


@inner
def compare_few(x: Floats, pairs: PairList, axes: Any) -> None:
    """List the pairs of few discs by comparing all of them."""
    first, second, radius, skin, d, count = pairs.first, pairs.second, pairs.radius, pairs.skin[0], len(axes), 0
    plain = pairs.scale.size == 0
    for i in range(radius.size):
        for j in range(i):
            # Every pair is written and only a close one is counted: this spares a branch that nobody can predict.
            first[count], second[count] = i, j
            limit = radius[i] + radius[j] + 2.0 * skin
            square = square_distance(x, i * d, x, j * d, axes) if plain else square_of_arrow(x, pairs, i, j, axes)
            count += square <= limit * limit
    pairs.number[COUNT] = count


@inner
def arrow_between(x: Floats, pairs: PairList, i: int, j: int, k: int, d: int) -> float:
    """Compute component k of the arrow from disc j to disc i in scaled coordinates, the shortest to an image."""
    one, other = i * d + k, j * d + k
    arrow = (pairs.origin[one] - pairs.origin[other]) + (pairs.scale[i] * x[one] - pairs.scale[j] * x[other])
    return float(to_image(arrow, pairs.box[k]))


@inner
def square_of_arrow(x: Floats, pairs: PairList, i: int, j: int, axes: Any) -> float:
    """Compute the square of the length of the arrow between two discs."""
    square = 0.0
    for k in range(len(axes)):
        arrow = arrow_between(x, pairs, i, j, k, len(axes))
        square += arrow * arrow
    return square


@inner
def project_pair(
    x: Floats, pairs: PairList, i: int, j: int, length: float, p: int, begin: bool, compliance: float, axes: Any
) -> int:
    """Move a pair apart: 1 if it moved, 0 if it does not overlap, -1 if its centres coincide.

    With e = (X_i - X_j) / |X_i - X_j| and the overlap v > 0:  X_i += v/2 e,  X_j -= v/2 e.
    """
    i, j = i * len(axes), j * len(axes)
    square = square_distance(x, i, x, j, axes)
    if square >= length * length:
        return 0
    # The division does not wait for the root.
    inverse = 0.5 * length / square
    if inverse == np.inf:
        return -1
    share = np.sqrt(square) * inverse - 0.5
    for k in range(len(axes)):
        move = share * (x[i + k] - x[j + k])
        x[i + k] += move
        x[j + k] -= move
    return 1


@inner
def correct_pair(
    x: Floats, pairs: PairList, i: int, j: int, length: float, p: int, begin: bool, compliance: float, axes: Any
) -> int:
    """Move pair p along its gradient by the change of its multiplier: 1, 0 or -1 as ``project_pair``.

    For g + compliance mu = 0 with mu >= 0 the change is -(g + compliance mu) / (|grad g|^2 + compliance), at least -mu.
    """
    multiplier, i, j = pairs.multiplier, i * len(axes), j * len(axes)
    before = 0.0 if begin else multiplier[p]
    square, total = square_distance(x, i, x, j, axes), compliance
    if before == 0.0 and square >= length * length:
        multiplier[p] = 0.0
        return 0
    distance = np.sqrt(square)
    if distance == 0.0:
        return -1
    scale = 1.0 / distance
    for _ in range(2):
        for k in range(len(axes)):
            slope = scale * (x[i + k] - x[j + k])
            total += slope * slope
    after = max(before - (distance - length + compliance * before) / total, 0.0)
    multiplier[p] = after
    for k in range(len(axes)):
        step = (after - before) * (scale * (x[i + k] - x[j + k]))
        x[i + k] += step
        x[j + k] -= step
    return int(after != before)


@inner
def correct_any_pair(
    x: Floats, pairs: PairList, i: int, j: int, length: float, p: int, begin: bool, compliance: float, axes: Any
) -> int:
    """Do ``correct_pair`` in scaled coordinates and periodic boxes; without multipliers it is a projection."""
    multiplier, d, kept = pairs.multiplier, len(axes), pairs.multiplier.size > 0
    one, other, before = pairs.scale[i], pairs.scale[j], 0.0
    if kept and not begin:
        before = multiplier[p]
    square, total = square_of_arrow(x, pairs, i, j, axes), one * one + other * other + compliance
    after = 0.0
    if before != 0.0 or square < length * length:
        distance = np.sqrt(square)
        if distance == 0.0:
            return -1
        after = max(before - (distance - length + compliance * before) / total, 0.0) if total > 0.0 else 0.0
        for k in range(d):
            step = (after - before) * (arrow_between(x, pairs, i, j, k, d) / distance)
            x[i * d + k] += one * step
            x[j * d + k] -= other * step
    if kept:
        multiplier[p] = after
    return int(after != before)


def disc_sweep(visit: Callable[..., int]) -> Callable[..., int]:
    """Make the sweep over discs in which pairs are visited by a function such as ``project_pair``."""

    @inner
    def sweep_pairs(x: Floats, pairs: PairList, begin: bool, compliance: float, axes: Any) -> int:
        """Visit one pair after another; return how it ended.

        Source: Example 2.5; Algorithm 1 of chapter 2 misprints the sign.
        """
        # Arrays are read out of the struct once: the compiler cannot know that x is no part of it.
        first, second, radius = pairs.first, pairs.second, pairs.radius
        reference, allowed, corrections, d = pairs.reference, allowed_square(pairs), 0, len(axes)
        for p in range(pairs.number[COUNT]):
            i, j = int(np.int64(first[p])), int(np.int64(second[p]))
            moved = visit(x, pairs, i, j, radius[i] + radius[j], p, begin, compliance, axes)
            if moved == 0:
                continue
            if moved < 0:
                pairs.number[ONE], pairs.number[OTHER] = i, j
                return COINCIDENT
            corrections += 1
            far = square_distance(x, i * d, reference, i * d, axes) > allowed
            if far or square_distance(x, j * d, reference, j * d, axes) > allowed:
                return STALE
        pairs.number[SWEEPS] += 1
        pairs.number[CANDIDATES] += pairs.number[COUNT]
        pairs.number[CORRECTIONS] += corrections
        return OK

    @inner
    def sweep_discs(x: Floats, pairs: PairList, known: int, begin: bool, compliance: float, axes: Any) -> int:
        """Sweep over the discs at x; return how it ended.

        ``begin`` says that no sweep of this step was made before. Multipliers of earlier sweeps belong to the pairs of
        the list: then it ends STALE where the list does. No copy of x is made if something is ``known`` of the list:
        then it ends REPEAT.
        """
        backup, outdated = pairs.backup, known == INCOMPLETE
        if known == UNKNOWN:
            for k in range(backup.size):
                backup[k] = x[k]
            outdated = is_outdated(x, pairs, axes)
        while True:
            if outdated:
                if not begin and pairs.multiplier.size > 0:
                    return STALE
                for k in range(backup.size if known == UNKNOWN else 0):
                    x[k] = backup[k]
                code = rebuild(x, pairs, axes)
                if code != OK:
                    return int(code)
            code = sweep_pairs(x, pairs, begin, compliance, axes)
            if code != STALE:
                return int(code)
            if known != UNKNOWN:
                return REPEAT
            outdated = True

    return sweep_discs


@inner
def add_disc_forces(x: Floats, pairs: PairList, spring: bool, force: Floats, axes: Any) -> int:
    """Add max(0, -g)^(1 or 0) grad g of the pairs at x to the forces on all particles; return how it ended."""
    d, disc, whole = len(axes), pairs.disc, pairs.disc.size == 0
    if is_outdated(x, pairs, axes):
        code = rebuild(x, pairs, axes)
        if code != OK:
            return int(code)
    first, second, radius, plain = pairs.first, pairs.second, pairs.radius, pairs.scale.size == 0
    for p in range(pairs.number[COUNT]):
        i, j = int(np.int64(first[p])), int(np.int64(second[p]))
        square = square_distance(x, i * d, x, j * d, axes) if plain else square_of_arrow(x, pairs, i, j, axes)
        distance = np.sqrt(square)
        overlap = radius[i] + radius[j] - distance
        if not overlap > 0.0:
            continue
        if distance == 0.0:
            pairs.number[ONE], pairs.number[OTHER] = i, j
            return COINCIDENT
        scale, one, other = 1.0 / distance, i if whole else disc[i], j if whole else disc[j]
        for k in range(d):
            arrow = x[i * d + k] - x[j * d + k] if plain else arrow_between(x, pairs, i, j, k, d)
            entry = arrow * scale * (overlap if spring else 1.0)
            force[one * d + k] += entry if plain else pairs.scale[i] * entry
            force[other * d + k] -= entry if plain else pairs.scale[j] * entry
    pairs.number[SWEEPS] += 1
    return OK


@inner
def gather(x: Floats, pairs: PairList, d: int) -> None:
    """Copy the positions of the discs from the positions x of all particles."""
    disc, point = pairs.disc, pairs.point
    for q in range(disc.size):
        for k in range(d):
            point[q * d + k] = x[disc[q] * d + k]


@inner
def scatter(x: Floats, pairs: PairList, d: int) -> None:
    """Copy the positions of the discs back into x."""
    disc, point = pairs.disc, pairs.point
    for q in range(disc.size):
        for k in range(d):
            x[disc[q] * d + k] = point[q * d + k]
