"""The basal layer as a curve: a line, an ellipse or a curve through points, by arclength; lengths in R_soft."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.special import ellipe, roots_legendre

from tissue.state.cells import Floats

# The curve turns by at most this angle within a piece [rad], so that a quintic polynomial differs from it by 1e-15 of
# its curvature radius; bounds of the number of pieces.
TURN, FEWEST, MOST = 0.02, 64, 8192
# Intervals, about, on which the length is measured.
GRID = 512
# Numbers of a piece: coefficients of u^0 to u^5 of x, then of y, with u from 0 to 1.
ORDER = 6
# Steps of Newton's method from the nearest end of a piece: it doubles its digits.
NEWTON = 6
# Distances from points to pieces that are computed at once: 2 MB.
BLOCK = 1 << 18

# Position, first and second derivative by a parameter, (2, m) each.
CurveFunction = Callable[[Floats], tuple[Floats, Floats, Floats]]


@dataclass(frozen=True, eq=False)
class BasalCurve:
    """gamma(s), |gamma'| = 1, with the tissue on the left of its direction; s = 0 is the middle of the tissue.

    Attributes
    ----------
    table
        (pieces + 1, 12): polynomials of pieces of equal length, see ORDER; the last one again the first. Without
        pieces it is the line gamma(s) = (s, 0).
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
        return max(0, len(self.table) - 1)

    @property
    def largest_curvature(self) -> float:
        """max kappa, kappa > 0 where the tissue is on the inner side [1 / R_soft]; 0 if it never is."""
        if self.pieces == 0:
            return 0.0
        s = np.linspace(0.0, self.length, self.pieces + 1) - self.origin
        _, (tx, ty), (cx, cy) = self.evaluate(s)
        return max(0.0, float((tx * cy - ty * cx).max()))

    @property
    def area(self) -> float:
        """What a closed curve encloses; below 0 with the tissue outside."""
        nodes, weights = _gauss(ORDER)
        piece = self.length / self.pieces
        s: Floats = piece * (np.arange(self.pieces)[:, None] + (1 + nodes) / 2) - self.origin
        (x, y), (tx, ty), _ = self.evaluate(s.ravel())
        return float(piece / 4 * ((x * ty - y * tx).reshape(s.shape) @ weights).sum())

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
        nodes = np.linspace(0.0, self.length, self.pieces + 1) - self.origin
        near = self.evaluate(nodes)[0]
        step = max(1, BLOCK // len(nodes))
        blocks = [slice(k, k + step) for k in range(0, len(x), step)]
        nearest = [((x[b, None] - near[0]) ** 2 + (y[b, None] - near[1]) ** 2).argmin(axis=1) for b in blocks]
        s: Floats = nodes[np.concatenate(nearest)]
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
        first, second = np.stack((a * cosine, side * b * sine)), np.stack((-a * sine, side * b * cosine))
        return np.stack((a * sine, side * b * (1 - cosine))), first, second

    return _by_arclength(evaluate, np.linspace(0.0, 2 * np.pi, FEWEST + 1), around=True, ring=ring, origin=0.0)


def through(points: Floats, *, around: bool) -> BasalCurve:
    """Return the cubic spline through points (m, 2), m >= 4; the tissue is on its left.

    Closed, the last point equals the first and s = 0 is there; open, s = 0 is in the middle, and the curve goes on
    straight at its ends.
    """
    chords = np.hypot(*np.diff(points, axis=0).T)
    knots = np.concatenate(([0.0], np.cumsum(np.sqrt(chords))))  # centripetal: no loops between unequal distances
    spline = CubicSpline(knots, points, bc_type="periodic" if around else "natural")

    def evaluate(t: Floats) -> tuple[Floats, Floats, Floats]:
        first, second, third = (np.ascontiguousarray(spline(t, order).T) for order in range(3))
        return first, second, third

    return _by_arclength(evaluate, knots, around=around, ring=around, origin=None)


def _by_arclength(
    evaluate: CurveFunction, knots: Floats, *, around: bool, ring: bool, origin: float | None
) -> BasalCurve:
    """Return the table of a curve that is smooth between its knots."""
    t, lengths = _measured(evaluate, knots)
    turns = _turning(evaluate, t)
    pieces = int(np.clip(np.ceil(lengths[-1] * turns / TURN), FEWEST, MOST))
    s = np.linspace(0.0, lengths[-1], pieces + 1)
    at = _parameters_at(evaluate, t, lengths, s)
    position, first, second = evaluate(at)
    speed = np.hypot(*first)
    tangent = first / speed
    bend = (second - tangent * (tangent * second).sum(axis=0)) / speed**2
    table = _quintics(position, tangent, bend, s[1])
    if not ring and origin is None:
        origin = lengths[-1] / 2
    # Behind the last piece: where it comes back to, or on which it goes on straight.
    last = table[:1]
    if not around:
        last = np.zeros((1, 2, ORDER))
        last[0, :, 0], last[0, :, 1] = position[:, -1], tangent[:, -1] * s[1]
    behind = np.vstack((table, last.reshape(1, *table.shape[1:])))
    return BasalCurve(behind, float(lengths[-1]), float(origin or 0.0), around, ring)


def _measured(evaluate: CurveFunction, knots: Floats) -> tuple[Floats, Floats]:
    """Return a fine grid of parameters, and the length of the curve up to each."""
    fine = max(4, GRID // (len(knots) - 1))
    t = np.append((knots[:-1, None] + np.diff(knots)[:, None] * np.arange(fine) / fine).ravel(), knots[-1])
    return t, np.concatenate(([0.0], np.cumsum(_length(evaluate, t[:-1], t[1:]))))


def _gauss(points: int) -> tuple[Floats, Floats]:
    """Nodes and weights of Gauss and Legendre on [-1, 1]."""
    nodes, weights = roots_legendre(points)
    return nodes, weights


def _length(evaluate: CurveFunction, begin: Floats, end: Floats) -> Floats:
    """Return the length between parameters, by Gauss and Legendre with twelve points."""
    nodes, weights = _gauss(12)
    half = (end - begin) / 2
    at = (begin + half)[:, None] + half[:, None] * nodes
    speed = np.hypot(*evaluate(at.ravel())[1]).reshape(at.shape)
    length: Floats = half * (speed @ weights)
    return length


def _turning(evaluate: CurveFunction, t: Floats) -> float:
    """Return the largest curvature, of either sign."""
    _, (x, y), (xx, yy) = evaluate(t)
    return float(np.abs((x * yy - y * xx) / np.hypot(x, y) ** 3).max())


def _parameters_at(evaluate: CurveFunction, t: Floats, lengths: Floats, s: Floats) -> Floats:
    """Return the parameters at the arclengths s, by Newton's method within the grid."""
    k = np.clip(np.searchsorted(lengths, s, side="right") - 1, 0, len(t) - 2)
    at = t[k] + (s - lengths[k]) / (lengths[k + 1] - lengths[k]) * (t[k + 1] - t[k])
    for _ in range(4):
        missing = s - lengths[k] - _length(evaluate, t[k], at)
        at = at + missing / np.hypot(*evaluate(at)[1])
    return at


def _quintics(position: Floats, tangent: Floats, bend: Floats, h: float) -> Floats:
    """Return the polynomials with these values at the ends of pieces of length h: (pieces, 12)."""
    way, (m, n), (a, b) = (
        np.diff(position),
        (h * tangent[:, :-1], h * tangent[:, 1:]),
        (h**2 * bend[:, :-1], h**2 * bend[:, 1:]),
    )
    c = (
        position[:, :-1],
        m,
        a / 2,
        10 * way - 6 * m - 4 * n - (3 * a - b) / 2,
        -15 * way + 8 * m + 7 * n + 1.5 * a - b,
        6 * way - 3 * (m + n) - (a - b) / 2,
    )
    return np.stack(c, axis=-1).transpose(1, 0, 2).reshape(-1, 2 * ORDER)
