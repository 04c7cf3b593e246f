"""Euler step of the transport equation f_t + div(f u) = 0 on one or two axes: MUSCL with upwind fluxes."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from dincl.compiled import kernel

Floats = NDArray[np.float64]
# Cells with less density have no outflow. Its products with speeds and time steps could be subnormal numbers, whose
# rounding error is not relative and could make a density negative.
VANISHING = 1e-250


@kernel
def half_slope(before: float, here: float, after: float) -> float:
    """Compute half the limited slope of a cell: minmod((after - before) / 4, here - before, after - here).

    This is the monotonised central limiter. ``here`` plus or minus the result lies between the neighbours: for
    densities >= 0 both face values are >= 0 and at most 2 ``here``, also after rounding. Where the density is smooth
    and monotone, the slope is the central difference.
    """
    left, right = here - before, after - here
    if left > 0.0 and right > 0.0:
        return min(0.25 * (left + right), left, right)
    if left < 0.0 and right < 0.0:
        return max(0.25 * (left + right), left, right)
    return 0.0


@kernel
def value_at(here: float, before: float, after: float, side: float) -> float:
    """Compute the density of a cell at its upper (side = 1) or lower (side = -1) face."""
    return here + side * half_slope(before, here, after) if here >= VANISHING else 0.0


@kernel
def _flux(f: Floats, i: int, j: int, along: int, speed: float) -> float:
    """Compute speed times upwind value at the upper face of cell (i, j) along an axis; cells at walls have no slope."""
    side = 1.0
    if speed < 0.0:
        side = -1.0
        i, j = i + (1 - along), j + along
    here = f[i, j]
    if along == 0:
        interior = 0 < i < f.shape[0] - 1
        before, after = (f[i - 1, j], f[i + 1, j]) if interior else (here, here)
    else:
        interior = 0 < j < f.shape[1] - 1
        before, after = (f[i, j - 1], f[i, j + 1]) if interior else (here, here)
    return speed * value_at(here, before, after, side)


@kernel
def euler_step(
    f: Floats, speed0: Floats, speed1: Floats, ratio: Floats, start: Floats, start_weight: float, out: Floats
) -> tuple[float, float]:
    """Compute out = new + start_weight (start - new) with new = f - ratio . difference of the fluxes.

    The grid has closed walls. The outflow of a cell is at most the fraction  sum_axes ratio max(u_upper, -u_lower, 0) 2
    of its density f, because its two face values are >= 0 and their sum is 2 f. If no fraction exceeds 1, out >= 0 for
    f, start >= 0. (The mean is written as a difference because start_weight and 1 - start_weight, rounded, need not sum
    to 1, and the mass would drift.)

    Parameters
    ----------
    f, start, out : (n0, n1)
        densities >= 0; ``out`` is overwritten and must be a different array.
    speed0, speed1 : (n0 + 1, n1), (n0, n1 + 1)
        speeds u across the faces of the two axes.
    ratio : (2,)
        time step over spacing, per axis.
    start_weight : float
        weight of ``start``, from 0 to 1.

    Returns
    -------
    outflow : float
        largest outflow fraction of a cell.
    blocked : float
        density that the walls held back, summed over the cells at the walls.
    """
    n0, n1 = f.shape
    below = np.zeros(n1)
    outflow, blocked = 0.0, 0.0
    for i in range(n0):
        left = 0.0
        for j in range(n1):
            upper = _flux(f, i, j, 0, speed0[i + 1, j]) if i < n0 - 1 else 0.0
            right = _flux(f, i, j, 1, speed1[i, j + 1]) if j < n1 - 1 else 0.0
            new = f[i, j] - ratio[0] * (upper - below[j]) - ratio[1] * (right - left)
            out[i, j] = new + start_weight * (start[i, j] - new)
            below[j], left = upper, right
            outward = ratio[0] * max(speed0[i + 1, j], -speed0[i, j], 0.0)
            outward += ratio[1] * max(speed1[i, j + 1], -speed1[i, j], 0.0)
            outflow = max(outflow, 2.0 * outward)
    for j in range(n1):
        blocked += ratio[0] * (max(-speed0[0, j], 0.0) * f[0, j] + max(speed0[n0, j], 0.0) * f[n0 - 1, j])
    for i in range(n0):
        blocked += ratio[1] * (max(-speed1[i, 0], 0.0) * f[i, 0] + max(speed1[i, n1], 0.0) * f[i, n1 - 1])
    return outflow, blocked
