"""One Euler step of the transport equation f_t + div(f u) = 0 on one or two axes: MUSCL with upwind fluxes."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from dincl.compiled import kernel

Floats = NDArray[np.float64]
# A cell with less density gives nothing away: products of it with a speed and a time step could leave the normal
# numbers, where rounding is no longer relative and might make a density negative.
VANISHING = 1e-250


@kernel
def half_slope(before: float, here: float, after: float) -> float:
    """Half the difference across a cell, limited (monotonised central): minmod((after - before) / 4, both one-sided).

    ``here`` plus or minus it lies between the neighbours: with densities >= 0 both values at the faces are >= 0 and at
    most 2 ``here``, also after rounding. It is the central difference wherever the density is smooth and monotone.
    """
    left, right = here - before, after - here
    if left > 0.0 and right > 0.0:
        return min(0.25 * (left + right), left, right)
    if left < 0.0 and right < 0.0:
        return max(0.25 * (left + right), left, right)
    return 0.0


@kernel
def value_at(here: float, before: float, after: float, side: float) -> float:
    """The density of a cell at its upper (side = 1) or lower (side = -1) face."""
    return here + side * half_slope(before, here, after) if here >= VANISHING else 0.0


@kernel
def _flux(f: Floats, i: int, j: int, along: int, speed: float) -> float:
    """Speed times the upwind value at the upper face of cell (i, j) along an axis; cells at a wall have no slope."""
    side = 1.0
    if speed < 0.0:
        side = -1.0
        i, j = i + (1 - along), j + along
    here = f[i, j]
    if along == 0:
        inner = 0 < i < f.shape[0] - 1
        before, after = (f[i - 1, j], f[i + 1, j]) if inner else (here, here)
    else:
        inner = 0 < j < f.shape[1] - 1
        before, after = (f[i, j - 1], f[i, j + 1]) if inner else (here, here)
    return speed * value_at(here, before, after, side)


@kernel
def euler_step(
    f: Floats, speed0: Floats, speed1: Floats, ratio: Floats, base: Floats, keep: float, out: Floats
) -> tuple[float, float]:
    """out = new + keep (base - new) with new = f - ratio . difference of the fluxes; closed walls around the grid.

    A cell gives away at most the share  sum_axes ratio max(u_upper, -u_lower, 0) 2  of its density f, because the two
    values at its faces are >= 0 and add up to 2 f. As long as no share exceeds 1, out >= 0 if f, base >= 0.
    (The weights keep and 1 - keep would, rounded, not add up to 1, and the mass would drift.)

    Parameters
    ----------
    f, base, out : (n0, n1)
        Densities >= 0; ``out`` is filled and must be neither of the others.
    speed0, speed1 : (n0 + 1, n1), (n0, n1 + 1)
        Speeds u across the faces of the two axes.
    ratio : (2,)
        Time step over spacing, per axis.
    keep : float
        Weight of ``base``, from 0 to 1.

    Returns
    -------
    share : float
        The largest of those shares.
    leaving : float
        Density that the walls held back, summed over the cells at them.
    """
    n0, n1 = f.shape
    below = np.zeros(n1)
    share, leaving = 0.0, 0.0
    for i in range(n0):
        left = 0.0
        for j in range(n1):
            upper = _flux(f, i, j, 0, speed0[i + 1, j]) if i < n0 - 1 else 0.0
            right = _flux(f, i, j, 1, speed1[i, j + 1]) if j < n1 - 1 else 0.0
            new = f[i, j] - ratio[0] * (upper - below[j]) - ratio[1] * (right - left)
            out[i, j] = new + keep * (base[i, j] - new)
            below[j], left = upper, right
            given = ratio[0] * max(speed0[i + 1, j], -speed0[i, j], 0.0)
            given += ratio[1] * max(speed1[i, j + 1], -speed1[i, j], 0.0)
            share = max(share, 2.0 * given)
    for j in range(n1):
        leaving += ratio[0] * (max(-speed0[0, j], 0.0) * f[0, j] + max(speed0[n0, j], 0.0) * f[n0 - 1, j])
    for i in range(n0):
        leaving += ratio[1] * (max(-speed1[i, 0], 0.0) * f[i, 0] + max(speed1[i, n1], 0.0) * f[i, n1 - 1])
    return share, leaving
