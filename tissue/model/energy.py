"""The potential energy of a tissue, and the forces, in plain NumPy; lengths in units of R_soft, energies without unit.

All formulas hold for complex coordinates, too, so that a complex step differentiates them: distances are sqrt(d . d),
without conjugation, and comparisons look at the real part.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from dincl.checks import bounded
from dincl.constants import LARGEST
from dincl.errors import InvalidProblem
from dincl.neighbours.search import neighbour_pairs
from tissue.model import bending, junctions, repulsion, springs
from tissue.model.repulsion import SOFT
from tissue.state.basal_curve import LINE, BasalCurve
from tissue.state.cells import CellLayers, Cells, Floats, Forces, Integers
from tissue.state.numbers import Numbers


class Parts(NamedTuple):
    """The terms of (3.14), each summed over the tissue."""

    ax: float  # apical springs (3.9)
    bx: float  # basal springs (3.10)
    aa: float  # apical junctions (3.11)
    axb: float  # straightness (3.12)
    xx: float  # soft repulsion (3.13)


def energy(cells: Cells, layers: CellLayers, numbers: Numbers, curve: BasalCurve = LINE) -> float:
    """W = sum_i (W_i^ax + W_i^bx + W_i^axb) + sum_{(i, j) in A} W_ij^aa + sum_{j < i} W_ij^xx  (3.14).

    Arguments and errors are those of ``parts``; complex for complex coordinates.
    """
    return sum(parts(cells, layers, numbers, curve))


def parts(cells: Cells, layers: CellLayers, numbers: Numbers, curve: BasalCurve = LINE) -> Parts:
    """The terms of W, each as in the file of its name: ``springs``, ``junctions``, ``bending``, ``repulsion``.

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
    arrows = _arrows(cells, layers, curve)
    l_ax, l_bx = _spring_lengths("rest_ax", cells.rest_ax), _spring_lengths("rest_bx", cells.rest_bx)
    ends = arrows.aa.start, arrows.aa.end
    return Parts(
        ax=np.sum(springs.energy(arrows.xa.length, l_ax, cells.stiff_ax, numbers.power)),
        bx=np.sum(springs.energy(arrows.xb.length, l_bx, cells.stiff_bx, numbers.power)),
        aa=np.sum(junctions.energy(arrows.aa.length, cells.rest_aa[ends[0]], _stiffness(cells, arrows.aa, numbers))),
        axb=np.sum(bending.energy(_cosine(arrows), cells.stiff_axb)),
        xx=np.sum(repulsion.energy(arrows.xx.length, numbers.repulsion)),
    )


def forces(cells: Cells, layers: CellLayers, numbers: Numbers, curve: BasalCurve = LINE) -> Forces:
    r"""-grad W, with u = (A - X)/|A - X|, v = (B - X)/|B - X|, c = u . v = cos gamma.

        on A_i  -2 alpha^ax (|A - X| - l)/l^p u - alpha^axb (v - c u)/|A - X|  + junctions
        on B_i  -2 alpha^bx (|B - X| - l)/l^p v - alpha^axb (u - c v)/|B - X|
        on X_i  the opposite of both sums                                      + repulsion

    A junction pulls A_i towards A_j with k_ij (|A_j - A_i| - eta_i^aa), and A_j the opposite way; the repulsion pulls
    X_i towards X_j with k_xx (|X_i - X_j| - 2) < 0. Arguments and errors are those of ``parts``.
    """
    arrows = _arrows(cells, layers, curve)
    xa, xb, aa, cosine = arrows.xa, arrows.xb, arrows.aa, _cosine(arrows)
    l_ax, l_bx = _spring_lengths("rest_ax", cells.rest_ax), _spring_lengths("rest_bx", cells.rest_bx)
    on_a = -springs.tension(xa.length, l_ax, cells.stiff_ax, numbers.power) * xa.unit
    on_b = -springs.tension(xb.length, l_bx, cells.stiff_bx, numbers.power) * xb.unit
    on_a += bending.force(xa.unit, xb.unit, xa.length, cosine, cells.stiff_axb)
    on_b += bending.force(xb.unit, xa.unit, xb.length, cosine, cells.stiff_axb)
    on_x = -(on_a + on_b)
    _pull(on_a, aa, junctions.tension(aa.length, cells.rest_aa[aa.start], _stiffness(cells, aa, numbers)))
    _pull(on_x, arrows.xx, repulsion.tension(arrows.xx.length, numbers.repulsion))
    return Forces(*on_x, *on_a, *on_b)


class _Bundle(NamedTuple):
    """Arrows from points of the cells ``start`` to points of the cells ``end``: length (m,), unit vector (2, m)."""

    start: Integers
    end: Integers
    length: Floats
    unit: Floats


class _Arrows(NamedTuple):
    """All arrows that the energy depends on."""

    xa: _Bundle  # from X_i to A_i
    xb: _Bundle  # from X_i to B_i
    aa: _Bundle  # from A_i to A_j, where a junction joins them
    xx: _Bundle  # from X_i to X_j, j < i, closer than 2


def _arrows(cells: Cells, layers: CellLayers, curve: BasalCurve) -> _Arrows:
    x, a, b = _points(cells)
    each = np.arange(len(cells.x))
    return _Arrows(
        xa=_bundle("nucleus and apical point", x, a, each, each),
        xb=_bundle("nucleus and basal point", x, b, each, each),
        aa=_bundle("apical points", a, a, *junctions.pairs(cells, layers, curve.ring)),
        xx=_bundle("nuclei", x, x, *_soft_pairs(x)),
    )


def _points(cells: Cells) -> tuple[Floats, Floats, Floats]:
    """X, A, B as arrays of shape (2, n)."""
    for name in Forces._fields:
        values = getattr(cells, name)
        if not bounded(values.real):
            k = int(np.flatnonzero(~(np.abs(values.real) <= LARGEST))[0])
            raise InvalidProblem(f"cells.{name}[{k}] = {values[k]}: must be finite, of magnitude at most {LARGEST:g}")
    return np.stack((cells.x, cells.y)), np.stack((cells.ax, cells.ay)), np.stack((cells.bx, cells.by))


def _soft_pairs(x: Floats) -> tuple[Integers, Integers]:
    """The pairs (i, j < i) of nuclei (2, n) at most 2 apart: at 2 the repulsion begins from zero."""
    centres = np.ascontiguousarray(x.real.T)
    start, partner = neighbour_pairs(centres, np.full(len(centres), SOFT / 2))
    i, j = np.repeat(np.arange(len(centres)), np.diff(start)), partner.astype(np.int64)
    return i, j


def _bundle(what: str, tails: Floats, heads: Floats, start: Integers, end: Integers) -> _Bundle:
    arrows = heads[:, end] - tails[:, start]
    length = np.sqrt((arrows * arrows).sum(axis=0))
    met = np.flatnonzero(length.real == 0)
    if met.size:
        i, j = start[met[0]], end[met[0]]
        cells = f"cell {i}" if i == j else f"cells {i} and {j}"
        raise InvalidProblem(f"{what} of {cells} lie on one point {heads[:, j]}: must be apart, to have a direction")
    return _Bundle(start, end, length, arrows / length)


def _spring_lengths(name: str, rest: Floats) -> Floats:
    """l = 1 + eta, shape (n,)."""
    length = 1 + rest
    wrong = np.flatnonzero(~(length > 0))
    if wrong.size:
        raise InvalidProblem(f"cells.{name}[{wrong[0]}] = {rest[wrong[0]]}: must be above -1, the radius R_soft")
    return length


def _stiffness(cells: Cells, arrows: _Bundle, numbers: Numbers) -> Floats:
    """k of the junctions, shape (m,)."""
    return np.asarray(junctions.stiffness(cells, (arrows.start, arrows.end), numbers.junction_factor))


def _cosine(arrows: _Arrows) -> Floats:
    """cos gamma, shape (n,)."""
    cosine: Floats = (arrows.xa.unit * arrows.xb.unit).sum(axis=0)
    return cosine


def _pull(on: Floats, arrows: _Bundle, tension: Floats) -> None:
    """Add to the forces ``on`` (2, n) that each arrow pulls its ends together with ``tension`` (m,)."""
    for along, direction in zip(on, arrows.unit, strict=True):
        np.add.at(along, arrows.start, tension * direction)
        np.add.at(along, arrows.end, -tension * direction)
