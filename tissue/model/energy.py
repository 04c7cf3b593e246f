"""The potential energy of a tissue, and the forces, in plain NumPy; lengths in units of R_soft, energies without unit.

All formulas hold for complex coordinates, too, so that a complex step differentiates them: distances are sqrt(d . d),
without conjugation, and comparisons look at the real part.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from dincl.checks import bounded
from dincl.constants import LARGEST
from dincl.errors import InvalidProblem
from dincl.neighbours.search import neighbour_pairs
from tissue.kernels.workspace import SOFT
from tissue.model import junctions
from tissue.state.basal_curve import LINE, BasalCurve
from tissue.state.cells import CellLayers, Cells, Floats, Forces, Integers
from tissue.state.numbers import Numbers
from tissue.state.surface import FLAT_SURFACE, Surface


class Elastic(NamedTuple):
    """Coefficients and rest lengths of the energy, for n cells and m junctions."""

    stiff_ax: Floats  # (n,): alpha of the springs and of the bending energy
    stiff_bx: Floats
    stiff_axb: Floats
    l_ax: Floats  # (n,): lengths of the springs at rest, above 0
    l_bx: Floats
    junctions: Integers  # (m, 2): the cells i and j of each
    rest: Floats  # (m,)
    k_aa: Floats  # (m,): junction_factor (alpha_i + alpha_j) / 2
    power: int  # p of the springs
    repulsion: float  # k of the soft repulsion


class Parts(NamedTuple):
    """The terms of (3.14), each summed over the tissue."""

    ax: float  # apical springs (3.9)
    bx: float  # basal springs (3.10)
    aa: float  # apical junctions (3.11)
    axb: float  # straightness (3.12)
    xx: float  # soft repulsion (3.13)


def energy(cells: Cells, layers: CellLayers, numbers: Numbers, curve: BasalCurve = LINE) -> float:
    """Compute W = sum_i (W_i^ax + W_i^bx + W_i^axb) + sum_{(i, j) in A} W_ij^aa + sum_{j < i} W_ij^xx  (3.14).

    Arguments and errors are those of ``parts``; complex for complex coordinates.
    """
    return sum(parts(cells, layers, numbers, curve))


def parts(cells: Cells, layers: CellLayers, numbers: Numbers, curve: BasalCurve = LINE) -> Parts:
    """Compute the terms of W of a slice.

    Parameters
    ----------
    cells
        Coordinates, rest lengths and stiffnesses of n cells; the coordinates may be complex.
    layers
        The apical layer, from left to right.
    curve
        The basal layer: whether the tissue is a closed tube, whose ends are joined.
    numbers
        ``power`` p, ``junction_factor`` and ``repulsion`` k_xx.

    Raises
    ------
    InvalidProblem
        For coordinates that are not finite, two points that act on each other in one place, a spring with l <= 0.
    """
    return parts_of(*_points(cells), elastic_of(cells, layers, numbers, curve))


def elastic_of(cells: Cells, layers: CellLayers, numbers: Numbers, curve: BasalCurve = LINE) -> Elastic:
    """Collect what the energy of a slice depends on beside its points; arguments are those of ``parts``."""
    i, j = junctions.pairs(cells, layers, curve.ring)
    l_ax, l_bx = 1 + cells.rest_ax, 1 + cells.rest_bx
    if not (np.minimum(l_ax, l_bx) > 0).all():
        least = np.minimum(l_ax, l_bx).min() - 1
        raise InvalidProblem(f"cells.rest_ax, rest_bx = {least}: must be above -1, the radius R_soft")
    stiff = cells.stiff_ax, cells.stiff_bx, cells.stiff_axb
    k_aa = numbers.junction_factor * (cells.stiff_aa[i] + cells.stiff_aa[j]) / 2
    joined = np.stack((i, j), axis=1)
    return Elastic(*stiff, l_ax, l_bx, joined, cells.rest_aa[i], k_aa, numbers.spring_power, numbers.repulsion)


def parts_of(x: Floats, a: Floats, b: Floats, elastic: Elastic, surface: Surface = FLAT_SURFACE) -> Parts:
    """Compute the terms of W in two dimensions or three.

    springs        alpha (d - l)^2 / l^p                             (3.9), (3.10)
    junctions      k / 2 (d - eta)^2                                 (3.11)
    straightness   alpha (cos gamma + 1), gamma between A - X and B - X; also printed less 2 alpha  (3.12)
    repulsion      k / 2 (2 - d)^2 for d < 2; printed with a minus sign, which would attract  (3.13)

    Parameters
    ----------
    x, a, b
        (2, n) or (3, n): nuclei, apical and basal points; may be complex.
    elastic
        Stiffnesses and lengths.
    surface
        Its periods: junctions and repulsion act between the nearest images.

    Raises
    ------
    InvalidProblem
        For coordinates that are not finite, and for two points that act on each other in one place.
    """
    (xa, xb, aa, xx), e = _arrows(x, a, b, elastic, surface), elastic
    return Parts(
        ax=np.sum(e.stiff_ax * (xa.length - e.l_ax) ** 2 / e.l_ax**e.power),
        bx=np.sum(e.stiff_bx * (xb.length - e.l_bx) ** 2 / e.l_bx**e.power),
        aa=np.sum(e.k_aa / 2 * (aa.length - e.rest) ** 2),
        axb=np.sum(e.stiff_axb * ((xa.unit * xb.unit).sum(axis=0) + 1)),
        xx=np.sum(e.repulsion / 2 * (xx.length - SOFT) ** 2),
    )


def forces(cells: Cells, layers: CellLayers, numbers: Numbers, curve: BasalCurve = LINE) -> Forces:
    """Compute -grad W of a slice, see ``forces_of``; arguments and errors are those of ``parts``."""
    on_x, on_a, on_b = forces_of(*_points(cells), elastic_of(cells, layers, numbers, curve))
    return Forces(*on_x, *on_a, *on_b)


def forces_of(
    x: Floats, a: Floats, b: Floats, elastic: Elastic, surface: Surface = FLAT_SURFACE
) -> tuple[Floats, Floats, Floats]:
    r"""Compute -grad W, with u = (A - X)/|A - X|, v = (B - X)/|B - X|, c = u . v = cos gamma.

        on A_i  -2 alpha^ax (|A - X| - l)/l^p u - alpha^axb (v - c u)/|A - X|  + junctions
        on B_i  -2 alpha^bx (|B - X| - l)/l^p v - alpha^axb (u - c v)/|B - X|
        on X_i  the opposite of both sums                                      + repulsion

    A junction pulls A_i towards A_j with k_ij (|A_j - A_i| - eta_i^aa), and A_j the opposite way; the repulsion pulls
    X_i towards X_j with k_xx (|X_i - X_j| - 2) < 0. Arguments and errors are those of ``parts_of``.
    """
    (xa, xb, aa, xx), e = _arrows(x, a, b, elastic, surface), elastic
    cosine = (xa.unit * xb.unit).sum(axis=0)
    on_a = -(2 * e.stiff_ax * (xa.length - e.l_ax) / e.l_ax**e.power) * xa.unit
    on_b = -(2 * e.stiff_bx * (xb.length - e.l_bx) / e.l_bx**e.power) * xb.unit
    on_a += -e.stiff_axb * (xb.unit - cosine * xa.unit) / xa.length
    on_b += -e.stiff_axb * (xa.unit - cosine * xb.unit) / xb.length
    on_x = -(on_a + on_b)
    _pull(on_a, aa, e.k_aa * (aa.length - e.rest))
    _pull(on_x, xx, e.repulsion * (xx.length - SOFT))
    return on_x, on_a, on_b


def nearest_image(d: Floats, surface: Surface) -> Floats:
    """Compute differences (2, m) or (3, m) to the nearest image: d - period floor(d / period + 1/2) along x and z."""
    d = d.copy()
    for axis, period in ((0, surface.period_x), (2, surface.period_z)):
        if math.isfinite(period):
            d[axis] -= period * np.floor(d[axis].real / period + 0.5)
    return d


class _Bundle(NamedTuple):
    """Arrows from points of the cells ``start`` to points of the cells ``end``: length (m,), unit vector (d, m)."""

    start: Integers
    end: Integers
    length: Floats
    unit: Floats


def _arrows(
    x: Floats, a: Floats, b: Floats, elastic: Elastic, surface: Surface
) -> tuple[_Bundle, _Bundle, _Bundle, _Bundle]:
    """Return all arrows that the energy depends on: from X_i to A_i, from X_i to B_i, from A_i to A_j where a junction
    joins them, from X_i to X_j, j < i, closer than 2.
    """
    for name, points in (("x", x), ("a", a), ("b", b)):
        if not bounded(points.real):
            raise InvalidProblem(f"{name} has coordinates that are not finite, or beyond {LARGEST:g} in magnitude")
    each, (i, j) = np.arange(x.shape[1]), elastic.junctions.T
    soft_i, soft_j = _soft_pairs(x, surface)
    return (
        _bundle("nucleus and apical point", x, a, each, each),
        _bundle("nucleus and basal point", x, b, each, each),
        _bundle("apical points", a, a, i, j, surface),
        _bundle("nuclei", x, x, soft_i, soft_j, surface),
    )


def _points(cells: Cells) -> tuple[Floats, Floats, Floats]:
    """X, A, B as arrays of shape (2, n)."""
    return np.stack((cells.x, cells.y)), np.stack((cells.ax, cells.ay)), np.stack((cells.bx, cells.by))


def _soft_pairs(x: Floats, surface: Surface) -> tuple[Integers, Integers]:
    """Find the pairs (i, j < i) of nuclei (d, n) at most 2 apart: at 2 the repulsion begins from zero.

    With a period all pairs are compared.
    """
    centres = np.ascontiguousarray(x.real.T)
    if math.isfinite(surface.period_x) or math.isfinite(surface.period_z):
        i, j = np.tril_indices(len(centres), -1)
        close = (nearest_image((centres[j] - centres[i]).T, surface) ** 2).sum(axis=0) < SOFT**2
        return i[close], j[close]
    return neighbour_pairs(centres, np.full(len(centres), SOFT / 2))


def _bundle(
    what: str, tails: Floats, heads: Floats, start: Integers, end: Integers, surface: Surface = FLAT_SURFACE
) -> _Bundle:
    arrows = nearest_image(heads[:, end] - tails[:, start], surface)
    length = np.sqrt((arrows * arrows).sum(axis=0))
    met = np.flatnonzero(length.real == 0)
    if met.size:
        i, j = start[met[0]], end[met[0]]
        cells = f"cell {i}" if i == j else f"cells {i} and {j}"
        raise InvalidProblem(f"{what} of {cells} lie on one point {heads[:, j]}: must be apart, to have a direction")
    return _Bundle(start, end, length, arrows / length)


def _pull(on: Floats, arrows: _Bundle, tension: Floats) -> None:
    """Add to the forces ``on`` (d, n) that each arrow pulls its ends together with ``tension`` (m,)."""
    for along, direction in zip(on, arrows.unit, strict=True):
        np.add.at(along, arrows.start, tension * direction)
        np.add.at(along, arrows.end, -tension * direction)
