"""Lists of close pairs of discs of one family that may not overlap, and sweeps over them.

A list holds all pairs closer than the sum of their radii plus 2 ``skin``. It is complete while no disc is farther than
``skin`` from its place when the list was made, also in the middle of a sweep; otherwise the sweep is undone and
repeated with a new list. So the result is that of a sweep over all pairs.
"""

from typing import Any, NamedTuple

import numpy as np

from dincl.compiled import inner
from dincl.compiled.arrays import Floats, Indices, Offsets
from dincl.compiled.structs import reader
from dincl.drifts.functions import call_drift
from dincl.neighbours import ALL_PAIRS, FEWEST_SWEEPS, MOST_SWEEPS
from dincl.neighbours.search import compare_all
from dincl.rows.formulas import project, square_distance

# Places in ``number``: sweeps since the list was made; lists made; candidates and corrections in all sweeps; two discs
# whose centres coincide.
SWEEPS, BUILDS, CANDIDATES, CORRECTIONS, ONE, OTHER, NUMBERS = range(7)
# How a sweep ends: done; at two coincident centres; with a list that is no longer complete; without a list.
DONE, SAME_POINT, STALE, FAILED = range(4)


class PairList(NamedTuple):
    """m discs and their close pairs: the partners of disc i are ``partner[start[i]:start[i + 1]]``, ascending j < i."""

    disc: Offsets  # (m,): the particles, or (0,) for all particles
    radius: Floats  # (m,)
    start: Offsets  # (m + 1,)
    partner: Indices
    point: Floats  # (m d,): positions of the discs, or (0,) for all particles
    reference: Floats  # (m d,): positions for which the list was made
    backup: Floats  # (m d,): positions before a sweep
    skin: Floats  # (2,): of this list, and the widest [length]
    grown: Floats  # (1,): by how much a disc has grown since the list was made, at most [length]
    number: Offsets  # (NUMBERS,)
    search: int  # address of the function that lists the pairs of many discs


# For its types.
_NONE, _FLOATS = np.zeros(0, dtype=np.int64), np.zeros(0)
_FEW = np.zeros(0, dtype=np.int32)
EXAMPLE = PairList(_NONE, _FLOATS, _NONE, _FEW, _FLOATS, _FLOATS, _FLOATS, _FLOATS, _FLOATS, _NONE, 0)
pair_list_at = reader(EXAMPLE)


@inner
def has_moved(x: Floats, pairs: PairList, axes: Any) -> bool:
    """Copy x into ``backup``; return whether a disc is farther than the skin from its reference."""
    reference, backup, allowed, far = pairs.reference, pairs.backup, allowed_square(pairs), 0
    d = len(axes)
    for i in range(pairs.radius.size):
        square = square_distance(x, i * d, reference, i * d, axes)
        for k in range(d):
            backup[i * d + k] = x[i * d + k]
        far += square > allowed
    return far > 0


@inner
def allowed_square(pairs: PairList) -> float:
    """Compute the square of how far a disc may be from its reference; negative if discs have grown too much."""
    left = pairs.skin[0] - pairs.grown[0]
    return float(left * left if left >= 0.0 else -1.0)


@inner
def rebuild(x: Floats, pairs: PairList, axes: Any) -> bool:
    """List the pairs around x, after a change of a skin that was too narrow or too wide; false on failure."""
    sweeps, skin = pairs.number[SWEEPS], pairs.skin
    if pairs.number[BUILDS] > 0:
        if sweeps == 0 or (sweeps < FEWEST_SWEEPS and 2.0 * skin[0] <= skin[1]):
            skin[0] *= 2.0
        elif sweeps > MOST_SWEEPS:
            skin[0] *= 0.5
    m, d = pairs.radius.size, len(axes)
    if m <= ALL_PAIRS:
        compare_all(x, pairs.radius, skin[0], pairs.start, pairs.partner, axes)
    elif call_drift(pairs.search, 0.0, x, pairs.reference, m, d, skin) != 0:
        return False
    reference = pairs.reference
    for k in range(m * d):
        reference[k] = x[k]
    pairs.grown[0] = 0.0
    pairs.number[SWEEPS] = 0
    pairs.number[BUILDS] += 1
    return True


@inner
def sweep_once(x: Floats, pairs: PairList, axes: Any) -> tuple[int, int]:
    """Project onto one pair after another, i ascending, then j; return how it ended and the number of corrections.

    Source: Example 2.5; Algorithm 1 of chapter 2 misprints the sign.
    """
    start, partner, radius, reference = pairs.start, pairs.partner, pairs.radius, pairs.reference
    allowed, corrections, d = allowed_square(pairs), 0, len(axes)
    for i in range(radius.size):
        for p in range(start[i], start[i + 1]):
            j = int(partner[p])
            moved = project(x, i * d, x, j * d, False, radius[i] + radius[j], 1.0, axes)
            if moved == 0:
                continue
            if moved < 0:
                pairs.number[ONE], pairs.number[OTHER] = i, j
                return SAME_POINT, corrections
            corrections += 1
            far = square_distance(x, i * d, reference, i * d, axes) > allowed
            if far or square_distance(x, j * d, reference, j * d, axes) > allowed:
                return STALE, corrections
    return DONE, corrections


@inner
def sweep_discs(x: Floats, pairs: PairList, axes: Any) -> int:
    """Sweep over the discs at x: DONE, SAME_POINT, or FAILED if no list could be made."""
    if (has_moved(x, pairs, axes) or pairs.number[BUILDS] == 0) and not rebuild(x, pairs, axes):
        return FAILED
    backup = pairs.backup
    code, corrections = sweep_once(x, pairs, axes)
    while code == STALE:
        for k in range(backup.size):
            x[k] = backup[k]
        if not rebuild(x, pairs, axes):
            return FAILED
        code, corrections = sweep_once(x, pairs, axes)
    pairs.number[SWEEPS] += 1
    pairs.number[CANDIDATES] += pairs.start[pairs.radius.size]
    pairs.number[CORRECTIONS] += corrections
    return code


@inner
def add_disc_forces(x: Floats, pairs: PairList, spring: bool, force: Floats, axes: Any) -> int:
    """Add max(0, -g)^(1 or 0) grad g of the pairs at x to the forces on all particles; return how it ended."""
    d, disc, whole = len(axes), pairs.disc, pairs.disc.size == 0
    if (has_moved(x, pairs, axes) or pairs.number[BUILDS] == 0) and not rebuild(x, pairs, axes):
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
                return SAME_POINT
            scale, one, other = 1.0 / distance, i if whole else disc[i], j if whole else disc[j]
            for k in range(d):
                entry = (x[i * d + k] - x[j * d + k]) * scale * (overlap if spring else 1.0)
                force[one * d + k] += entry
                force[other * d + k] -= entry
    pairs.number[SWEEPS] += 1
    return DONE


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
