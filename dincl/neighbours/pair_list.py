"""Discs of one family that may not overlap, and the list of those pairs that are near each other.

The list holds all pairs closer than the sum of their radii plus 2 ``skin``. It is complete while no disc is farther
than ``skin`` from where the list was made, also in the middle of a sweep; when one is, the sweep is undone and repeated
with a new list. So the result is that of looking at all pairs.
"""

from typing import Any, NamedTuple

import numpy as np

from dincl.compiled import inner
from dincl.compiled.arrays import Floats, Indices, Offsets
from dincl.compiled.structs import reader
from dincl.drifts.functions import call_drift
from dincl.rows.formulas import project, square_distance

# Places in ``number``: sweeps since the list was made; lists made; pairs looked at, and corrections, in all sweeps; two
# discs whose centres coincide.
SERVED, BUILDS, LOOKED_AT, CORRECTIONS, ONE, OTHER, NUMBERS = range(7)
# How a sweep ends.
DONE, MEETING, STALE, FAILED = range(4)
# A new list is to serve that many sweeps, at least and at most: the skin is doubled or halved.
FEWEST, MOST = 16, 128
# Of so many discs all pairs are compared, which is then faster than a grid (measured for d = 2 and 3).
ALL_PAIRS = 90


class PairList(NamedTuple):
    """m discs with their near pairs: those of disc i are ``partner[start[i]:start[i + 1]]``, all j < i, ascending."""

    disc: Offsets  # (m,): which particles they are, or (0,) where they are all particles
    radius: Floats  # (m,)
    start: Offsets  # (m + 1,)
    partner: Indices
    point: Floats  # (m d,): their positions, or (0,) where they are all particles
    reference: Floats  # (m d,): positions for which the list was made
    backup: Floats  # (m d,): positions before a sweep
    skin: Floats  # (2,): of this list, and the widest [length]
    number: Offsets  # (NUMBERS,)
    search: int  # address of the function that lists the near pairs of many discs


# For its types.
_NONE, _FLOATS = np.zeros(0, dtype=np.int64), np.zeros(0)
_FEW = np.zeros(0, dtype=np.int32)
EXAMPLE = PairList(_NONE, _FLOATS, _NONE, _FEW, _FLOATS, _FLOATS, _FLOATS, _FLOATS, _NONE, 0)
pair_list_at = reader(EXAMPLE)


@inner
def has_moved(x: Floats, pairs: PairList, axes: Any) -> bool:
    """Copy x into ``backup``, and tell whether a disc is farther than the skin from its reference."""
    reference, backup, allowed, far = pairs.reference, pairs.backup, pairs.skin[0] * pairs.skin[0], 0
    d = len(axes)
    for i in range(pairs.radius.size):
        square = square_distance(x, i * d, reference, i * d, axes)
        for k in range(d):
            backup[i * d + k] = x[i * d + k]
        far += square > allowed
    return far > 0


@inner
def list_all(x: Floats, pairs: PairList, axes: Any) -> None:
    """List the near pairs of a few discs."""
    start, partner, radius, skin, d, count = pairs.start, pairs.partner, pairs.radius, pairs.skin[0], len(axes), 0
    for i in range(radius.size):
        for j in range(i):
            # Every pair is written, and only a near one is counted: a branch that nobody can predict is spared.
            partner[count] = j
            limit = radius[i] + radius[j] + 2.0 * skin
            count += square_distance(x, i * d, x, j * d, axes) <= limit * limit
        start[i + 1] = count


@inner
def renew(x: Floats, pairs: PairList, axes: Any) -> bool:
    """Make a new list around x; a skin that was too narrow or too wide is changed first. False if that failed."""
    served, skin = pairs.number[SERVED], pairs.skin
    if pairs.number[BUILDS] > 0:
        if served == 0 or (served < FEWEST and 2.0 * skin[0] <= skin[1]):
            skin[0] *= 2.0
        elif served > MOST:
            skin[0] *= 0.5
    m, d = pairs.radius.size, len(axes)
    if m <= ALL_PAIRS:
        list_all(x, pairs, axes)
    elif call_drift(pairs.search, 0.0, x, pairs.reference, m, d, skin) != 0:
        return False
    reference = pairs.reference
    for k in range(m * d):
        reference[k] = x[k]
    pairs.number[SERVED] = 0
    pairs.number[BUILDS] += 1
    return True


@inner
def sweep_once(x: Floats, pairs: PairList, axes: Any) -> tuple[int, int]:
    """Project onto one near pair after another, i ascending, then j: how it ended, and the corrections made.

    Source: Example 2.5; Algorithm 1 of chapter 2 misprints the sign.
    """
    start, partner, radius, reference = pairs.start, pairs.partner, pairs.radius, pairs.reference
    allowed, corrections, d = pairs.skin[0] * pairs.skin[0], 0, len(axes)
    for i in range(radius.size):
        for p in range(start[i], start[i + 1]):
            j = int(partner[p])
            moved = project(x, i * d, x, j * d, False, radius[i] + radius[j], 1.0, axes)
            if moved == 0:
                continue
            if moved < 0:
                pairs.number[ONE], pairs.number[OTHER] = i, j
                return MEETING, corrections
            corrections += 1
            far = square_distance(x, i * d, reference, i * d, axes) > allowed
            if far or square_distance(x, j * d, reference, j * d, axes) > allowed:
                return STALE, corrections
    return DONE, corrections


@inner
def sweep_discs(x: Floats, pairs: PairList, axes: Any) -> int:
    """Sweep over the discs at x: DONE, MEETING, or FAILED if no list could be made."""
    ended, corrections = STALE, 0
    if (has_moved(x, pairs, axes) or pairs.number[BUILDS] == 0) and not renew(x, pairs, axes):
        return FAILED
    while True:
        ended, corrections = sweep_once(x, pairs, axes)
        if ended != STALE:
            break
        backup = pairs.backup
        for k in range(backup.size):
            x[k] = backup[k]
        if not renew(x, pairs, axes):
            return FAILED
    pairs.number[SERVED] += 1
    pairs.number[LOOKED_AT] += pairs.start[pairs.radius.size]
    pairs.number[CORRECTIONS] += corrections
    return ended


@inner
def push_discs(x: Floats, pairs: PairList, spring: bool, force: Floats, axes: Any) -> int:
    """Add max(0, -g)^(1 or 0) grad g of the near pairs at x to the forces on all particles; how it ended."""
    d, disc, whole = len(axes), pairs.disc, pairs.disc.size == 0
    if (has_moved(x, pairs, axes) or pairs.number[BUILDS] == 0) and not renew(x, pairs, axes):
        return FAILED
    start, partner, radius = pairs.start, pairs.partner, pairs.radius
    for i in range(radius.size):
        for p in range(start[i], start[i + 1]):
            j = int(partner[p])
            distance = np.sqrt(square_distance(x, i * d, x, j * d, axes))
            overlap = radius[i] + radius[j] - distance
            if not overlap > 0.0:
                continue
            if distance == 0.0:
                pairs.number[ONE], pairs.number[OTHER] = i, j
                return MEETING
            scale, one, other = 1.0 / distance, i if whole else disc[i], j if whole else disc[j]
            for k in range(d):
                push = (x[i * d + k] - x[j * d + k]) * scale * (overlap if spring else 1.0)
                force[one * d + k] += push
                force[other * d + k] -= push
    pairs.number[SERVED] += 1
    return DONE


@inner
def gather(x: Floats, pairs: PairList, d: int) -> None:
    """Copy the positions of the discs out of those of all particles."""
    disc, point = pairs.disc, pairs.point
    for q in range(disc.size):
        for k in range(d):
            point[q * d + k] = x[disc[q] * d + k]


@inner
def scatter(x: Floats, pairs: PairList, d: int) -> None:
    """Copy them back."""
    disc, point = pairs.disc, pairs.point
    for q in range(disc.size):
        for k in range(d):
            x[disc[q] * d + k] = point[q * d + k]
