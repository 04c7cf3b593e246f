"""The velocity of a frozen tissue in space, -grad W / mu, compiled: terms and formulas are those of the substeps."""

from __future__ import annotations

from typing import NamedTuple

from tissue.kernels import kernel
from tissue.kernels.workspace import SOFT
from tissue.model.junctions import pulling
from tissue.model.motion import pulls
from tissue.model.repulsion import repelling
from tissue.state.cells import Floats, Integers


class Rates(NamedTuple):
    """What the velocity depends on beside the points: coefficients as those of ``SurfaceWorkspace``, for h = 1 hour."""

    k_ax: Floats  # (n,)
    k_bx: Floats
    k_axb: Floats
    l_ax: Floats
    l_bx: Floats
    held: Integers  # the basal points that have no velocity in y
    junctions: Integers  # (m, 2)
    rest: Floats  # (m,)
    k_aa: Floats
    repulsion: float


@kernel
def flow(x: Floats, rates: Rates, velocity: Floats) -> None:
    """Write the velocities (3n, 3) of nuclei, apical and basal points x on an open plane.

    All pairs of nuclei are looked at, each once. A junction without length has no direction, and does nothing.
    """
    n = len(rates.k_ax)
    velocity[:] = 0.0
    for i in range(n):
        u = x[n + i, 0] - x[i, 0], x[n + i, 1] - x[i, 1], x[n + i, 2] - x[i, 2]
        v = x[2 * n + i, 0] - x[i, 0], x[2 * n + i, 1] - x[i, 1], x[2 * n + i, 2] - x[i, 2]
        ax, bx = (rates.k_ax[i], rates.l_ax[i]), (rates.k_bx[i], rates.l_bx[i])
        on_a, on_b, _ = pulls(u, v, ax, bx, rates.k_axb[i])
        for c in range(3):
            velocity[i, c] -= on_a[c] + on_b[c]
            velocity[n + i, c], velocity[2 * n + i, c] = on_a[c], on_b[c]
        for j in range(i):
            dx, dy, dz = x[i, 0] - x[j, 0], x[i, 1] - x[j, 1], x[i, 2] - x[j, 2]
            square = dx * dx + dy * dy + dz * dz
            if square < SOFT * SOFT:
                push = rates.repulsion * repelling(square)
                for c in range(3):
                    velocity[i, c] += push * (x[i, c] - x[j, c])
                    velocity[j, c] -= push * (x[i, c] - x[j, c])
    for edge in range(len(rates.rest)):
        i, j, k = n + rates.junctions[edge, 0], n + rates.junctions[edge, 1], rates.k_aa[edge]
        dx, dy, dz = x[j, 0] - x[i, 0], x[j, 1] - x[i, 1], x[j, 2] - x[i, 2]
        square = dx * dx + dy * dy + dz * dz
        if square > 0.0:
            pull = pulling(square, rates.rest[edge], k)
            for c in range(3):
                velocity[i, c] += pull * (x[j, c] - x[i, c])
                velocity[j, c] -= pull * (x[j, c] - x[i, c])
    for i in rates.held:
        velocity[2 * n + i, 1] = 0.0
