"""Piecewise polynomial densities on a line, whose integrals are exact to rounding."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import ArrayLike, NDArray

from dincl import checks
from dincl.errors import InvalidProblem

Floats = NDArray[np.float64]
Pdf = Callable[[Floats], Floats]

# Degree of the polynomial on each panel, and Gauss points: exact for the products of projection.
DEGREE = 15
NODES, SHARES = legendre.leggauss(DEGREE + 1)
# Values at the nodes -> Legendre coefficients.
PROJECTION = (legendre.legvander(NODES, DEGREE) * SHARES[:, None]).T * (np.arange(DEGREE + 1) + 0.5)[:, None]
# A panel is resolved where its last coefficients are at rounding beside the largest of all panels, or where what they
# may add to the mass is: so a kink or a jump that was not announced ends up in a panel of no width.
LAST, RESOLVED = 3, 1e-15
MOST_HALVINGS = 60
# Panels that are still too coarse at one level of halving: 16 values of the density on each.
MOST_PANELS = 100_000
# The mass of a grid density, which a time integration keeps to rounding, may be off by its first quadrature.
MASS_TOLERANCE = 1e-8
# Newton's method falls back on halving, so that it ends after at most the bits of a number.
MOST_STEPS, SETTLED = 60, 2.0**-51
# Points whose polynomials are evaluated together, to stay in memory.
BLOCK = 100_000


@dataclass(frozen=True, eq=False)
class Panels:
    """f(x) = sum_k c_pk P_k(s) on panel p, with the Legendre polynomials P_k of s in [-1, 1]; f = 0 elsewhere.

    Parameters
    ----------
    edges
        Ends of the panels (P + 1,), increasing.
    coefficients
        c (P, degree + 1); scaled so that the mass is 1.

    Raises
    ------
    InvalidProblem
        If the mass is not 1 to 1e-8, or a panel has a negative one.
    """

    edges: Floats
    coefficients: Floats

    def __post_init__(self) -> None:
        edges = checks.shaped("edges", self.edges, (None,))
        if len(edges) < 2 or (np.diff(edges) <= 0).any():
            raise InvalidProblem(f"edges = {checks.describe(edges)}: must be at least two, increasing")
        found = checks.shaped("coefficients", self.coefficients, (len(edges) - 1, None))
        mass = found[:, 0] * np.diff(edges)
        if (mass < -RESOLVED).any():
            where = int(mass.argmin())
            raise InvalidProblem(f"coefficients: panel {where} has the mass {mass[where]:.3g}: must be >= 0")
        if abs(mass.sum() - 1.0) > MASS_TOLERANCE:
            raise InvalidProblem(f"coefficients: the mass is {mass.sum():.12g}: must be 1 to {MASS_TOLERANCE:g}")
        object.__setattr__(self, "edges", edges)
        object.__setattr__(self, "coefficients", found / mass.sum())

    @classmethod
    def steps(cls, edges: ArrayLike, averages: ArrayLike) -> Panels:
        """A density that is constant on cells, from their edges (P + 1,) and averages (P,)."""
        return cls(checks.array("edges", edges), checks.shaped("averages", averages, (None,))[:, None])

    @cached_property
    def _below(self) -> tuple[Floats, Floats]:
        """F at the edges, and the Legendre coefficients of F on the panels, of shape (degree + 2, P)."""
        half = np.diff(self.edges) / 2
        inner = legendre.legint(self.coefficients.T, lbnd=-1, axis=0) * half
        at_edges = np.append(0.0, np.cumsum(2 * half * self.coefficients[:, 0]))
        at_edges /= at_edges[-1]
        inner[0] += at_edges[:-1]
        return at_edges, inner

    def density(self, x: ArrayLike) -> Floats:
        """f at points (n,)."""
        x = checks.shaped("x", x, (None,))
        inside = (self.edges[0] <= x) & (x <= self.edges[-1])
        values: Floats = np.where(inside, self._blockwise(x, self.coefficients.T), 0.0)
        return values

    def distribution(self, x: ArrayLike) -> Floats:
        """F(x) = int_{-inf}^x f at points (n,)."""
        return self._blockwise(checks.shaped("x", x, (None,)), self._below[1])

    def quantile(self, p: ArrayLike) -> Floats:
        """The x with F(x) = p for probabilities (n,): Newton's method, by halving where it leaves its bracket.

        Raises
        ------
        InvalidProblem
            If one of them is none.
        """
        p = checks.shaped("p", p, (None,))
        if not ((p >= 0) & (p <= 1)).all():
            raise InvalidProblem(f"p = {checks.describe(p)}: must be probabilities, 0 to 1")
        below = self._below[0]
        panel = np.clip(np.searchsorted(below, p, side="left") - 1, 0, len(self.edges) - 2)
        # On the panel, s in [-1, 1]; a straight F is inverted by the first guess.
        rise = below[panel + 1] - below[panel]
        share = np.divide(p - below[panel], rise, out=np.full(len(p), 0.5), where=rise > 0)
        s = np.clip(2 * share - 1, -1.0, 1.0)
        low, high, active = np.full(len(p), -1.0), np.full(len(p), 1.0), np.arange(len(p))
        for _ in range(MOST_STEPS):
            moved, excess = self._newton(s[active], panel[active], p[active])
            low[active] = np.where(excess <= 0, s[active], low[active])
            high[active] = np.where(excess >= 0, s[active], high[active])
            outside = ~((low[active] <= moved) & (moved <= high[active]))
            moved = np.where(outside, (low[active] + high[active]) / 2, moved)
            settled = np.abs(moved - s[active]) <= SETTLED
            s[active] = moved
            active = active[~settled]
        x: Floats = (self.edges[panel] * (1 - s) + self.edges[panel + 1] * (1 + s)) / 2
        return x

    def _newton(self, s: Floats, panel: NDArray[np.intp], p: Floats) -> tuple[Floats, Floats]:
        """The next point on the panel, infinite where the density is 0 or less, and F - p."""
        excess = _series(s, self._below[1], panel) - p
        slope = _series(s, self.coefficients.T, panel) * (self.edges[panel + 1] - self.edges[panel]) / 2
        step = np.divide(excess, slope, out=np.full(len(s), np.inf), where=slope > np.abs(excess) / 4)
        return s - step, excess

    def _blockwise(self, x: Floats, coefficients: Floats) -> Floats:
        panel = np.clip(np.searchsorted(self.edges, x, side="right") - 1, 0, len(self.edges) - 2)
        low, high = self.edges[panel], self.edges[panel + 1]
        return _series(np.clip((2 * x - low - high) / (high - low), -1.0, 1.0), coefficients, panel)


def _series(s: Floats, coefficients: Floats, panel: NDArray[np.intp]) -> Floats:
    """sum_k c_kp P_k(s) for points s (n,), each with its own panel p (n,)."""
    found = np.empty(len(s))
    for begin in range(0, len(s), BLOCK):
        part = slice(begin, begin + BLOCK)
        found[part] = legendre.legval(s[part], coefficients[:, panel[part]], tensor=False)
    return found


def resolved(pdf: Pdf, pieces: Floats) -> tuple[Floats, Floats]:
    """Edges and coefficients of panels that give a function to rounding: they are halved until they do.

    Parameters
    ----------
    pdf
        Points (n,) -> values (n,), smooth between ``pieces`` (P + 1,).

    Raises
    ------
    InvalidProblem
        If halving does not end, or gives more than 100 000 panels at a time.
    """
    waiting, done, largest = [(pieces[:-1], pieces[1:])], [], 0.0
    for _ in range(MOST_HALVINGS):
        low, high = waiting.pop()
        middle, half = (low + high) / 2, (high - low) / 2
        values = pdf((middle[:, None] + half[:, None] * NODES).ravel()).reshape(len(low), -1)
        found = values @ PROJECTION.T
        largest = max(largest, float(np.abs(found).max()))
        tail = np.abs(found[:, -LAST:]).max(axis=1)
        fine = (tail <= RESOLVED * largest) | (tail * half <= RESOLVED / MOST_HALVINGS)
        done.append((low[fine], high[fine], found[fine]))
        if fine.all():
            first, last, coefficients = (np.concatenate(parts) for parts in zip(*done, strict=True))
            order = np.argsort(first)
            return np.append(first[order], last[order[-1]]), coefficients[order]
        low, middle, high = low[~fine], middle[~fine], high[~fine]
        if 2 * len(low) > MOST_PANELS:
            raise InvalidProblem(
                f"pdf is not resolved by {MOST_PANELS} panels of {DEGREE + 1} values between {low[0]:.9g} and "
                f"{high[-1]:.9g}: must be smooth there, except at breaks that are named"
            )
        waiting.append((np.concatenate([low, middle]), np.concatenate([middle, high])))
    raise InvalidProblem(f"pdf is not resolved after {MOST_HALVINGS} halvings near {low[0]:.9g}: name its breaks")
