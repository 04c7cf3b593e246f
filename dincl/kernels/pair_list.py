"""The near ones among all pairs of a few discs, listed for many sweeps."""

from typing import Any, NamedTuple

import numpy as np

from dincl.compiled import inner
from dincl.kernels.arrays import Floats, Offsets

# Places in ``number``: sweeps since the list was made; lists made; pairs looked at, and corrections, in all sweeps.
SERVED, BUILDS, LOOKED_AT, CORRECTIONS = range(4)
# What stopped a sweep over pairs, in place of the pair where two centres coincide.
DONE, STALE = -1, -2


class PairList(NamedTuple):
    """Pairs |X_i - X_j| >= length of families f; ``one`` and ``other`` are the first coordinates of i and j.

    Those of family f are ``first[f]`` ... ``first[f + 1]``, and the near ones of it likewise. The list of these is
    complete while no disc is farther than the skin from its reference.
    """

    first: Offsets
    one: Offsets
    other: Offsets
    length: Floats
    disc: Offsets  # first coordinates of all that are in pairs
    near_first: Offsets
    near_one: Offsets
    near_other: Offsets
    near_length: Floats
    reference: Floats  # (n,)
    backup: Floats  # (n,): x before a sweep
    skin: Floats  # (2,): of this list, and the widest [length]
    lasts: Offsets  # (2,): a list is to serve that many sweeps, at least and at most
    number: Offsets  # (4,)


# For its types.
_EMPTY: Any = [np.zeros(0, dtype=np.float64 if kind == "f" else np.int64) for kind in "iiifiiiiffffii"]
NO_PAIRS = PairList(*_EMPTY)


@inner
def list_again(pairs: PairList, x: Floats, d: int) -> None:
    """List the pairs closer than their length plus 2 skin; the skin grows if the last list did not serve for long."""
    served = pairs.number[SERVED]
    if pairs.number[BUILDS] > 0:
        if served == 0 or (served < pairs.lasts[0] and 2.0 * pairs.skin[0] <= pairs.skin[1]):
            pairs.skin[0] *= 2.0
        elif served > pairs.lasts[1]:
            pairs.skin[0] /= 2.0
    one, other, length, room, count = pairs.one, pairs.other, pairs.length, 2.0 * pairs.skin[0], 0
    for f in range(pairs.first.size - 1):
        for p in range(pairs.first[f], pairs.first[f + 1]):
            i, j, square, least = one[p], other[p], 0.0, length[p] + room
            for k in range(d):
                square += (x[i + k] - x[j + k]) * (x[i + k] - x[j + k])
            if square <= least * least:
                pairs.near_one[count], pairs.near_other[count] = i, j
                pairs.near_length[count] = length[p]
                count += 1
        pairs.near_first[f + 1] = count
    for k in range(x.size):
        pairs.reference[k] = x[k]
    pairs.number[SERVED] = 0
    pairs.number[BUILDS] += 1


@inner
def is_stale(pairs: PairList, x: Floats, d: int) -> bool:
    """Whether a disc is farther than the skin from where it was listed, or nothing was listed yet."""
    disc, reference, farthest = pairs.disc, pairs.reference, 0.0
    for q in range(disc.size):
        i, square = disc[q], 0.0
        for k in range(d):
            square += (x[i + k] - reference[i + k]) * (x[i + k] - reference[i + k])
        farthest = max(farthest, square)
    return bool(farthest > pairs.skin[0] * pairs.skin[0] or pairs.number[BUILDS] == 0)


@inner
def part_near(pairs: PairList, f: int, x: Floats, d: int) -> tuple[int, int]:
    """Go through the near pairs of a family, as ``sweeps.sweep_pairs`` does: corrections, and what stopped it."""
    corrections, reference, allowed = 0, pairs.reference, pairs.skin[0] * pairs.skin[0]
    one, other, lengths = pairs.near_one, pairs.near_other, pairs.near_length
    for q in range(pairs.near_first[f], pairs.near_first[f + 1]):
        i, j, length, square = one[q], other[q], lengths[q], 0.0
        for k in range(d):
            square += (x[i + k] - x[j + k]) * (x[i + k] - x[j + k])
        if square >= length * length:
            continue
        inverse = 0.5 * length / square
        if inverse == np.inf:
            return corrections, q
        share, drift_i, drift_j = np.sqrt(square) * inverse - 0.5, 0.0, 0.0
        for k in range(d):
            move = share * (x[i + k] - x[j + k])
            x[i + k] += move
            x[j + k] -= move
            drift_i += (x[i + k] - reference[i + k]) * (x[i + k] - reference[i + k])
            drift_j += (x[j + k] - reference[j + k]) * (x[j + k] - reference[j + k])
        corrections += 1
        if drift_i > allowed or drift_j > allowed:
            return corrections, STALE
    return corrections, DONE


@inner
def part_pairs(pairs: PairList, f: int, x: Floats, d: int) -> int:
    """Go through the pairs of a family; a sweep that its list does not serve is undone and repeated.

    Returns DONE, or the place in the list of a pair whose centres coincide.
    """
    if is_stale(pairs, x, d):
        list_again(pairs, x, d)
    backup = pairs.backup
    for k in range(x.size):
        backup[k] = x[k]
    corrections, stopped = part_near(pairs, f, x, d)
    while stopped == STALE:
        for k in range(x.size):
            x[k] = backup[k]
        list_again(pairs, x, d)
        corrections, stopped = part_near(pairs, f, x, d)
    pairs.number[SERVED] += 1
    pairs.number[LOOKED_AT] += pairs.near_first[f + 1] - pairs.near_first[f]
    pairs.number[CORRECTIONS] += corrections
    return stopped
