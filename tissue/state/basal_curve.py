"""The basal layer as a curve: a line, an ellipse or a curve through points, by arclength; lengths in R_soft."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy.interpolate import BPoly, CubicSpline, PPoly
from scipy.spatial import cKDTree
from scipy.special import ellipe, roots_legendre

from tissue.state.cells import Floats

# The curve turns by at most this angle within a piece [rad], so that a quintic polynomial differs from it by 1e-15 of
# its curvature radius; bounds of the number of pieces.
TURN, FEWEST_PIECES, MOST_PIECES = 0.02, 64, 8192
# Intervals, about, on which the length is measured.
INTERVALS = 512
# Numbers of a piece: coefficients of u^0 to u^5 of x, then of y, with u from 0 to 1.
ORDER = 6
# Steps of Newton's method from the nearest end of a piece: it doubles its digits.
NEWTON = 6

# Position, first and second derivative by a parameter, (m, 2) each.
CurveFunction = Callable[[Floats], tuple[Floats, Floats, Floats]]


@dataclass(frozen=True, eq=False)
class BasalCurve:
    """gamma(s), |gamma'| = 1, with the tissue on the left of its direction; s = 0 is the middle of the tissue.

    Attributes
    ----------
    table
        (pieces, 12): polynomials of pieces of equal length, see ORDER. Without pieces it is the line gamma(s) = (s, 0).
    length
        Of the curve; it goes on along its tangents, or around.
    origin
        From the beginning of the table to s = 0.
    around
        Whether the curve is closed.
    ring
        Whether the tissue is closed, too: then the last cell is the neighbour of the first one.
    """

    table: Floats
    length: float = 0.0
    origin: float = 0.0
    around: bool = False
    ring: bool = False

    @property
    def pieces(self) -> int:
        """How many there are; 0 for the line."""
        return len(self.table)

    @property
    def largest_curvature(self) -> float:
        """max kappa, kappa > 0 where the tissue is on the inner side [1 / R_soft]; 0 if it never is."""
        if self.pieces == 0:
            return 0.0
        _, (tx, ty), (cx, cy) = self.evaluate(self._ends)
        return max(0.0, float((tx * cy - ty * cx).max()))

    @property
    def area(self) -> float:
        """Area that a closed curve encloses, by the trapezoidal rule; below 0 with the tissue outside."""
        (x, y), (tx, ty), _ = self.evaluate(self._ends[1:])
        return float((x * ty - y * tx).sum() * self.length / self.pieces / 2)

    @property
    def _ends(self) -> Floats:
        """Arclengths of the ends of all pieces, (pieces + 1,)."""
        return np.linspace(0.0, self.length, self.pieces + 1) - self.origin

    def evaluate(self, s: Floats) -> tuple[Floats, Floats, Floats]:
        """gamma, gamma', gamma'' at the arclengths s (m,), each (2, m)."""
        if self.pieces == 0:
            zero, one = np.zeros(len(s)), np.ones(len(s))
            return np.stack((s, zero)), np.stack((one, zero)), np.stack((zero, zero))
        per_length = self.pieces / self.length
        v = (s + self.origin) * per_length
        inside = v - self.pieces * np.floor(v / self.pieces) if self.around else np.clip(v, 0.0, self.pieces)
        piece = np.minimum(np.floor(inside), self.pieces - 1.0)
        u = inside - piece
        c = self.table[piece.astype(np.int64)].reshape(-1, 2, ORDER).transpose(2, 1, 0)
        position = c[0] + u * (c[1] + u * (c[2] + u * (c[3] + u * (c[4] + u * c[5]))))
        first = c[1] + u * (2 * c[2] + u * (3 * c[3] + u * (4 * c[4] + u * 5 * c[5])))
        second = 2 * c[2] + u * (6 * c[3] + u * (12 * c[4] + u * 20 * c[5]))
        beyond = np.zeros(len(s)) if self.around else v - inside
        return position + beyond * first, first * per_length, second * per_length**2 * (beyond == 0)

    def above(self, s: Floats, heights: Floats) -> tuple[Floats, Floats]:
        """Return the points gamma(s) + h n, n the normal to the side of the tissue: x and y, each (m,)."""
        (x, y), (tx, ty), _ = self.evaluate(s)
        return x - heights * ty, y + heights * tx

    def heights(self, x: Floats, y: Floats) -> Floats:
        """Return the distance of points from the curve, (m,): along its normal, below 0 on the other side of it."""
        if self.pieces == 0:
            return y.copy()
        (at_x, at_y), (tx, ty), _ = self.evaluate(self.feet(x, y))
        heights: Floats = (y - at_y) * tx - (x - at_x) * ty
        return heights

    def feet(self, x: Floats, y: Floats) -> Floats:
        """Return the arclength of the point of the curve that is nearest to each point, (m,); within half a turn of s =
        0.
        """
        if self.pieces == 0:
            return x.copy()
        _, nearest = cKDTree(self.evaluate(self._ends)[0].T).query(np.column_stack((x, y)))
        s: Floats = self._ends[nearest]
        for _ in range(NEWTON):
            position, tangent, bend = self.evaluate(s)
            away = np.stack((x, y)) - position
            slope = (tangent**2 - away * bend).sum(axis=0)
            s = s + (away * tangent).sum(axis=0) / np.maximum(slope, 0.1)
        return s - self.length * np.round(s / self.length) if self.around else s


LINE = BasalCurve(np.zeros((0, 2 * ORDER)))


class CurveNumbers(NamedTuple):
    """A ``BasalCurve``; the line (s, 0) if it is not bent."""

    table: Floats  # flat
    bent: int  # 1 or 0
    pieces: float
    per_length: float  # pieces over length
    origin: float
    around: int  # whether the curve is closed: 1 or 0
    ring: float  # the length, if the tissue is closed, too; else 0
    hollow: int  # whether the apical layer is inside the ring: 1 or 0


def curve_numbers(curve: BasalCurve) -> CurveNumbers:
    """Return the curve as kernels take it."""
    pieces, ring = curve.pieces, curve.length if curve.ring else 0.0
    table = np.ascontiguousarray(curve.table).ravel() if pieces else np.zeros(2 * ORDER)
    hollow = int(curve.ring and curve.area > 0.0)
    per_length = pieces / curve.length if pieces else 0.0
    return CurveNumbers(
        table, int(pieces > 0), float(pieces), per_length, curve.origin, int(curve.around), ring, hollow
    )


def ellipse(perimeter: float, aspect: float, *, inside: bool, ring: bool) -> BasalCurve:
    """Return the ellipse with its lowest point at s = 0 for a tissue inside, its highest for one outside; that is (0,
    0).

    Parameters
    ----------
    perimeter
        [R_soft]
    aspect
        The vertical half axis over the horizontal one; 1 is a circle.
    inside
        On which side the tissue is.
    ring
        Whether it is closed, or an arc of the ellipse.
    """
    longer, shorter = max(1.0, aspect), min(1.0, aspect)
    a = perimeter / (4 * longer * ellipe(1 - (shorter / longer) ** 2))
    b, side = a * aspect, 1.0 if inside else -1.0

    def evaluate(angle: Floats) -> tuple[Floats, Floats, Floats]:
        sine, cosine = np.sin(angle), np.cos(angle)
        found = (a * sine, side * b * (1 - cosine)), (a * cosine, side * b * sine), (-a * sine, side * b * cosine)
        position, first, second = (np.stack(pair, axis=-1) for pair in found)
        return position, first, second

    table, length = _by_arclength(evaluate, np.linspace(0.0, 2 * np.pi, FEWEST_PIECES + 1))
    return BasalCurve(table, length, 0.0, True, ring)


def through(points: Floats, *, around: bool) -> BasalCurve:
    """Return the cubic spline through points (m, 2), m >= 4; the tissue is on its left.

    Closed, the last point equals the first and s = 0 is there; open, s = 0 is in the middle, and the curve goes on
    straight at its ends.
    """
    chords = np.hypot(*np.diff(points, axis=0).T)
    knots = np.concatenate(([0.0], np.cumsum(np.sqrt(chords))))  # centripetal: no loops between unequal distances
    spline = CubicSpline(knots, points, bc_type="periodic" if around else "natural")
    table, length = _by_arclength(lambda t: (spline(t), spline(t, 1), spline(t, 2)), knots)
    return BasalCurve(table, length, 0.0 if around else length / 2, around, around)


def _by_arclength(evaluate: CurveFunction, knots: Floats) -> tuple[Floats, float]:
    """Return the table and the length of a curve that is smooth between its knots."""
    fine = max(4, INTERVALS // (len(knots) - 1))
    t = np.append((knots[:-1, None] + np.diff(knots)[:, None] * np.arange(fine) / fine).ravel(), knots[-1])
    # Length up to each parameter, by Gauss and Legendre, and its inverse, by dt/ds and its derivative.
    nodes, weights = roots_legendre(12)
    half = np.diff(t)[:, None] / 2
    speeds = np.linalg.norm(evaluate(t[:-1, None] + half * (1 + nodes))[1], axis=-1)
    lengths = np.concatenate(([0.0], np.cumsum((half * speeds) @ weights)))
    _, (x, y), (xx, yy) = (part.T for part in evaluate(t))
    speed = np.hypot(x, y)
    parameter = BPoly.from_derivatives(lengths, np.stack((t, 1 / speed, -(x * xx + y * yy) / speed**4), axis=1))
    curvature = np.abs(x * yy - y * xx) / speed**3
    pieces = int(np.clip(np.ceil(lengths[-1] * curvature.max() / TURN), FEWEST_PIECES, MOST_PIECES))
    # The polynomials with the derivatives of the curve by u at the ends of each piece.
    position, first, second = evaluate(parameter(np.linspace(0.0, lengths[-1], pieces + 1)))
    speed, piece = np.linalg.norm(first, axis=1, keepdims=True), lengths[-1] / pieces
    tangent = first / speed
    bend = (second - tangent * (tangent * second).sum(axis=1, keepdims=True)) / speed**2
    derivatives = np.stack((position, piece * tangent, piece**2 * bend), axis=1)
    spline = PPoly.from_bernstein_basis(BPoly.from_derivatives(np.arange(pieces + 1), derivatives))
    return spline.c[::-1].transpose(1, 2, 0).reshape(pieces, 2 * ORDER), float(lengths[-1])
