"""The potential energy of a tissue in three dimensions, in plain NumPy: the terms of (3.14), each in vector form.

The terms are those of ``tissue.model``, functions of distances and angles. All formulas hold for complex coordinates,
too, so that a complex step differentiates them: distances are sqrt(d . d), without conjugation, and comparisons and
nearest images look at the real part.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from dincl.checks import bounded
from dincl.constants import LARGEST
from dincl.errors import InvalidProblem
from tissue.model import bending, junctions, repulsion, springs
from tissue.model.repulsion import SOFT
from tissue.state.cells import Floats, Integers
from tissue.state.surface import FLAT_SURFACE, Surface


class Elastic(NamedTuple):
    """What the energy depends on beside the points: n cells, m junctions."""

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


class SpaceParts(NamedTuple):
    """The terms of (3.14), each summed over the tissue."""

    ax: float  # apical springs (3.9)
    bx: float  # basal springs (3.10)
    aa: float  # junctions (3.11)
    axb: float  # straightness (3.12)
    xx: float  # soft repulsion (3.13)


def space_energy(x: Floats, a: Floats, b: Floats, elastic: Elastic, surface: Surface = FLAT_SURFACE) -> float:
    """W, the sum of ``space_parts``, with its arguments and errors; complex for complex coordinates."""
    return sum(space_parts(x, a, b, elastic, surface))


def space_parts(x: Floats, a: Floats, b: Floats, elastic: Elastic, surface: Surface = FLAT_SURFACE) -> SpaceParts:
    """The terms of W, each as in the file of its name: ``springs``, ``junctions``, ``bending``, ``repulsion``.

    Parameters
    ----------
    x, a, b
        (3, n): nuclei, apical and basal points; may be complex.
    elastic
        Stiffnesses and lengths.
    surface
        Its periods: junctions and repulsion act between the nearest images.

    Raises
    ------
    InvalidProblem
        For coordinates that are not finite, and for two points that act on each other in one place.
    """
    for name, points in (("x", x), ("a", a), ("b", b)):
        if not bounded(points.real):
            raise InvalidProblem(f"{name} has coordinates that are not finite, or beyond {LARGEST:g} in magnitude")
    u, v = a - x, b - x
    to_a, to_b = lengths("nucleus and apical point", u), lengths("nucleus and basal point", v)
    i, j = elastic.junctions.T
    apart = lengths("apical points of a junction", nearest_image(a[:, j] - a[:, i], surface))
    return SpaceParts(
        ax=np.sum(springs.energy(to_a, elastic.l_ax, elastic.stiff_ax, elastic.power)),
        bx=np.sum(springs.energy(to_b, elastic.l_bx, elastic.stiff_bx, elastic.power)),
        aa=np.sum(junctions.energy(apart, elastic.rest, elastic.k_aa)),
        axb=np.sum(bending.energy((u / to_a * (v / to_b)).sum(axis=0), elastic.stiff_axb)),
        xx=_repulsion(x, elastic.repulsion, surface),
    )


def _repulsion(x: Floats, k: float, surface: Surface) -> float:
    """The soft repulsion of all pairs; each nucleus is compared with all before it."""
    total = 0.0
    for i in range(1, x.shape[1]):
        d = nearest_image(x[:, :i] - x[:, i : i + 1], surface)
        d = d[:, (d.real**2).sum(axis=0) < SOFT**2]
        total += np.sum(repulsion.energy(lengths("nuclei", d), k))
    return total


def nearest_image(d: Floats, surface: Surface) -> Floats:
    """Differences (3, m) to the nearest image: d - period floor(d / period + 1/2) along x and z."""
    d = d.copy()
    for axis, period in ((0, surface.period_x), (2, surface.period_z)):
        if math.isfinite(period):
            d[axis] -= period * np.floor(d[axis].real / period + 0.5)
    return d


def lengths(what: str, arrows: Floats) -> Floats:
    """|d|, (m,), of arrows (3, m); raises InvalidProblem for one without length."""
    length: Floats = np.sqrt((arrows * arrows).sum(axis=0))
    if (length.real == 0).any():
        raise InvalidProblem(f"{what} lie on one point: must be apart, to have a direction")
    return length
