"""The stiffest motions that every tissue has: the eigenvalues of the Hessian of W that limit the steps.

A substep h of explicit Euler is stable where h lambda / mu < 2 for all eigenvalues lambda. These are of motions that
every growing tissue makes, whatever its state, so that longer steps cannot be right; other states are stiffer, and a
run that meets them ends with the Status UNSTABLE. Each is of one kind of force, with no other at work:

    bending    2 alpha / R^2             a cell in mitosis: its nucleus R from its apical point, its basal point far
    springs    4 alpha_ax / R^p          its apical spring of length l = R, both ends free: W = alpha (d - l)^2 / l^p
               2 alpha_bx / R^p          the basal one, whose basal end is held
    junctions  2 k (1 + cos(pi / n))     neighbours of a row of n move against each other
               6 k                       the same in a sheet of triangles
    repulsion  2 k / R^p                 two nuclei that overlap

with the soft radius R of the cells, 1 but for types with one of their own.
"""

from __future__ import annotations

import math

from tissue.state.numbers import Numbers

# Of h lambda / mu.
LIMIT = 2.0


def cell_stiffness(numbers: Numbers) -> float:
    """Return the largest of these eigenvalues for cells of these numbers alone, and pairs of their nuclei."""
    radius, springs = numbers.soft_radius, max(4.0 * numbers.alpha_ax, 2.0 * numbers.alpha_bx, 2.0 * numbers.repulsion)
    return max(2.0 * numbers.alpha_axb / radius**2, springs / radius**numbers.spring_power)


def junction_stiffness(k: float, cells: int, *, in_space: bool) -> float:
    """Return that of junctions of stiffness k between so many cells."""
    return 6.0 * k if in_space else 2.0 * k * (1.0 + math.cos(math.pi / cells))


def least_substeps(dt: float, mu: float, stiffness: float) -> int:
    """Return the fewest substeps of dt that are stable: h / mu is below 2 / lambda."""
    return math.floor(dt / mu * stiffness / LIMIT) + 1
