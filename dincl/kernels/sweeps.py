"""Gauss-Seidel sweeps: one constraint after the other is met by the shortest move, in a fixed order, in place.

Here those on distances; the ones on affine rows come from ``affine``.
"""

import numpy as np

from dincl.compiled import kernel
from dincl.kernels.affine import dual_sweeps, sweep_affine, sweep_half_space
from dincl.kernels.arrays import Axes, Floats, Indices, Offsets, axes_of

__all__ = [
    "COINCIDENT",
    "OK",
    "STALE",
    "drifted",
    "dual_sweeps",
    "sweep_affine",
    "sweep_distance",
    "sweep_half_space",
    "sweep_pairs",
]

# How a sweep ended.
OK = 0
COINCIDENT = 1
STALE = 2


def sweep_pairs(
    x: Floats, start: Offsets, partner: Indices, radius: Floats, reference: Floats, slack: float
) -> tuple[int, int, int, int]:
    """Project onto |X_i - X_j| >= r_i + r_j, pair after pair: i ascending, for each i its partners ascending, once.

    With e = (X_i - X_j) / |X_i - X_j| and overlap o = r_i + r_j - |X_i - X_j| > 0:  X_i += o/2 e,  X_j -= o/2 e.

    Parameters
    ----------
    x : (n, d), C-contiguous
        Centres [length], changed in place.
    start, partner : (n + 1,), (m,)
        Candidate pairs, as from ``neighbours.near_pairs``.
    radius : (n,)
        Radii [length].
    reference : (n, d)
        Centres for which the candidate pairs were listed.
    slack : float
        How far [length] a disc may be from its reference before the list may miss a pair.

    Returns
    -------
    corrections : int
        Pairs moved.
    code : int
        ``OK``; ``COINCIDENT``: the centres of pair (i, j) give no direction; ``STALE``: one of them was moved
        farther than `slack` from its reference. The sweep stops at a code other than ``OK``.
    i, j : int
        The pair it stopped at, -1 if it did not stop.

    Notes
    -----
    Thesis, Example 2.5; Algorithm 1 of chapter 2 misprints the sign.
    """
    return _sweep_pairs(x, start, partner, radius, reference, slack, axes_of(x))


@kernel
def _sweep_pairs(
    x: Floats,
    start: Offsets,
    partner: Indices,
    radius: Floats,
    reference: Floats,
    slack: float,
    axes: Axes,
) -> tuple[int, int, int, int]:
    corrections = 0
    allowed = slack * slack
    for i in range(x.shape[0]):
        for p in range(start[i], start[i + 1]):
            j = int(partner[p])
            square = 0.0
            for k in range(len(axes)):
                square += (x[i, k] - x[j, k]) * (x[i, k] - x[j, k])
            length = radius[i] + radius[j]
            if square >= length * length:
                continue
            # Half the overlap over the distance; the division does not wait for the root.
            inverse = 0.5 * length / square
            if inverse == np.inf:
                return corrections, COINCIDENT, i, j
            share = np.sqrt(square) * inverse - 0.5
            drift_i, drift_j = 0.0, 0.0
            for k in range(len(axes)):
                move = share * (x[i, k] - x[j, k])
                x[i, k] += move
                x[j, k] -= move
                drift_i += (x[i, k] - reference[i, k]) * (x[i, k] - reference[i, k])
                drift_j += (x[j, k] - reference[j, k]) * (x[j, k] - reference[j, k])
            corrections += 1
            if drift_i > allowed or drift_j > allowed:
                return corrections, STALE, i, j
    return corrections, OK, -1, -1


def drifted(x: Floats, reference: Floats, slack: float, backup: Floats) -> bool:
    """Copy x into backup and say whether any |X_i - reference_i| > slack, in one pass.

    Parameters
    ----------
    x, reference, backup : (n, d), C-contiguous
        Centres, earlier centres, and where the copy goes [length].
    slack : float
        Allowed distance [length].
    """
    return _drifted(x, reference, slack, backup, axes_of(x))


@kernel
def _drifted(x: Floats, reference: Floats, slack: float, backup: Floats, axes: Axes) -> bool:
    allowed = slack * slack
    far = 0
    for i in range(x.shape[0]):
        square = 0.0
        for k in range(len(axes)):
            difference = x[i, k] - reference[i, k]
            square += difference * difference
            backup[i, k] = x[i, k]
        far += square > allowed
    return far > 0


def sweep_distance(
    x: Floats, i: Offsets, j: Offsets, length: Floats, sign: float, anchor: Floats
) -> tuple[int, int, int]:
    """Project onto sign (|X_i - X_j| - length) >= 0, row after row: sign = 1 keeps apart, sign = -1 keeps together.

    A violated row moves both points by half the violation along their line; with j = -1 the other end is the fixed
    point anchor[row] and X_i moves the whole way.

    Parameters
    ----------
    x : (n, d), C-contiguous
        Points [length], changed in place.
    i, j : (m,)
        Rows of x; j may be -1.
    length : (m,)
        Least or largest distances [length].
    sign : float
        1.0 or -1.0.
    anchor : (m, d) or (0, d)
        Fixed points [length]; may be empty if no j is -1.

    Returns
    -------
    corrections : int
        Rows moved.
    code : int
        ``OK``, or ``COINCIDENT``: the two points of a row that keeps apart give no direction; the sweep stops there.
    row : int
        The row it stopped at, -1 if it did not stop.
    """
    return _sweep_distance(x, i, j, length, sign, anchor, axes_of(x))


@kernel
def _sweep_distance(
    x: Floats, i: Offsets, j: Offsets, length: Floats, sign: float, anchor: Floats, axes: Axes
) -> tuple[int, int, int]:
    corrections = 0
    for row in range(length.size):
        one, other = int(i[row]), int(j[row])
        square = 0.0
        for k in range(len(axes)):
            end = anchor[row, k] if other < 0 else x[other, k]
            square += (x[one, k] - end) * (x[one, k] - end)
        if sign * (square - length[row] * length[row]) >= 0.0:
            continue
        stretch = length[row] / np.sqrt(square)
        if stretch == np.inf:
            return corrections, COINCIDENT, row
        share = stretch - 1.0 if other < 0 else 0.5 * (stretch - 1.0)
        for k in range(len(axes)):
            if other < 0:
                x[one, k] += share * (x[one, k] - anchor[row, k])
            else:
                move = share * (x[one, k] - x[other, k])
                x[one, k] += move
                x[other, k] -= move
        corrections += 1
    return corrections, OK, -1
