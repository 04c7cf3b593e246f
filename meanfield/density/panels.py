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

# Degree of the polynomial on each panel, and as many Gauss points as projection to this degree needs to be exact.
DEGREE = 15
GAUSS_NODES, GAUSS_WEIGHTS = legendre.leggauss(DEGREE + 1)
# Maps values at the nodes to Legendre coefficients.
PROJECTION = (legendre.legvander(GAUSS_NODES, DEGREE) * GAUSS_WEIGHTS[:, None]).T
PROJECTION *= (np.arange(DEGREE + 1) + 0.5)[:, None]
# A panel is resolved if its last TAIL coefficients are below rounding relative to the largest coefficient of all
# panels, or if they change the mass by less than rounding: panels around an unlisted kink shrink until this holds.
TAIL, RESOLVED = 3, 1e-15
# Far from the origin, coordinates are rounded relative to the size of a panel, by up to eps/2 |x| / half in s, and the
# values of the density with them: coefficients below this many eps |x| / half are rounding, too.
COORDINATE_ROUNDING = 2 * float(np.finfo(np.float64).eps)
MAX_HALVINGS = 60
# Unresolved panels at one level of halving; each takes 16 values of the density.
MAX_PANELS = 100_000
# The mass of a density on a grid differs from 1 by the error of its first quadrature.
GRID_MASS_TOLERANCE = 1e-8
# Newton's method falls back on bisection, so it ends after at most as many steps as a number has bits.
MAX_NEWTON_STEPS, NEWTON_CONVERGED = 60, 2.0**-51
# Points whose polynomials are evaluated together, for memory.
POINTS_PER_BLOCK = 100_000


@dataclass(frozen=True, eq=False)
class Panels:
    """Density f(x) = sum_k c_pk P_k(s) on panel p, Legendre polynomials P_k of s in [-1, 1]; f = 0 elsewhere.

    Parameters
    ----------
    edges
        ends of the panels (P + 1,), increasing.
    coefficients
        c (P, degree + 1); scaled so that the mass is 1.

    Raises
    ------
    InvalidProblem
        if the mass is not 1 to 1e-8, or a panel has negative mass.
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
        if abs(mass.sum() - 1.0) > GRID_MASS_TOLERANCE:
            raise InvalidProblem(f"coefficients: the mass is {mass.sum():.12g}: must be 1 to {GRID_MASS_TOLERANCE:g}")
        object.__setattr__(self, "edges", edges)
        object.__setattr__(self, "coefficients", found / mass.sum())

    @classmethod
    def piecewise_constant(cls, edges: ArrayLike, averages: ArrayLike) -> Panels:
        """Build a density that is constant on cells, from their edges (P + 1,) and averages (P,)."""
        return cls(checks.array("edges", edges), checks.shaped("averages", averages, (None,))[:, None])

    @cached_property
    def _cumulative(self) -> tuple[Floats, Floats]:
        """F at the edges, and the Legendre coefficients of F on the panels, of shape (degree + 2, P)."""
        half = np.diff(self.edges) / 2
        inner = legendre.legint(self.coefficients.T, lbnd=-1, axis=0) * half
        at_edges = np.append(0.0, np.cumsum(2 * half * self.coefficients[:, 0]))
        at_edges /= at_edges[-1]
        inner[0] += at_edges[:-1]
        return at_edges, inner

    def density(self, x: ArrayLike) -> Floats:
        """Evaluate f at points (n,)."""
        x = checks.shaped("x", x, (None,))
        inside = (self.edges[0] <= x) & (x <= self.edges[-1])
        values: Floats = np.where(inside, self._blockwise(x, self.coefficients.T), 0.0)
        return values

    def distribution(self, x: ArrayLike) -> Floats:
        """Evaluate F(x) = int_{-inf}^x f at points (n,)."""
        return self._blockwise(checks.shaped("x", x, (None,)), self._cumulative[1])

    def quantile(self, p: ArrayLike) -> Floats:
        """Solve F(x) = p for probabilities p (n,), by Newton's method with bisection where it leaves its bracket.

        Raises
        ------
        InvalidProblem
            if a number is not from 0 to 1.
        """
        p = checks.shaped("p", p, (None,))
        if not ((p >= 0) & (p <= 1)).all():
            raise InvalidProblem(f"p = {checks.describe(p)}: must be probabilities, 0 to 1")
        at_edges = self._cumulative[0]
        panel = np.clip(np.searchsorted(at_edges, p, side="left") - 1, 0, len(self.edges) - 2)
        # The first guess s in [-1, 1] is exact if F is linear on the panel.
        rise = at_edges[panel + 1] - at_edges[panel]
        fraction = np.divide(p - at_edges[panel], rise, out=np.full(len(p), 0.5), where=rise > 0)
        s = np.clip(2 * fraction - 1, -1.0, 1.0)
        low, high, active = np.full(len(p), -1.0), np.full(len(p), 1.0), np.arange(len(p))
        for _ in range(MAX_NEWTON_STEPS):
            moved, excess = self._newton(s[active], panel[active], p[active])
            low[active] = np.where(excess <= 0, s[active], low[active])
            high[active] = np.where(excess >= 0, s[active], high[active])
            outside = ~((low[active] <= moved) & (moved <= high[active]))
            moved = np.where(outside, (low[active] + high[active]) / 2, moved)
            converged = np.abs(moved - s[active]) <= NEWTON_CONVERGED
            s[active] = moved
            active = active[~converged]
        x: Floats = (self.edges[panel] * (1 - s) + self.edges[panel + 1] * (1 + s)) / 2
        return x

    def _newton(self, s: Floats, panel: NDArray[np.intp], p: Floats) -> tuple[Floats, Floats]:
        """Compute the next Newton iterate on the panel, infinite where the density is <= 0, and F - p."""
        excess = _series(s, self._cumulative[1], panel) - p
        slope = _series(s, self.coefficients.T, panel) * (self.edges[panel + 1] - self.edges[panel]) / 2
        step = np.divide(excess, slope, out=np.full(len(s), np.inf), where=slope > np.abs(excess) / 4)
        return s - step, excess

    def _blockwise(self, x: Floats, coefficients: Floats) -> Floats:
        panel = np.clip(np.searchsorted(self.edges, x, side="right") - 1, 0, len(self.edges) - 2)
        low, high = self.edges[panel], self.edges[panel + 1]
        return _series(np.clip((2 * x - low - high) / (high - low), -1.0, 1.0), coefficients, panel)


def _series(s: Floats, coefficients: Floats, panel: NDArray[np.intp]) -> Floats:
    """Evaluate sum_k c_kp P_k(s) for points s (n,) on panels p (n,)."""
    found = np.empty(len(s))
    for begin in range(0, len(s), POINTS_PER_BLOCK):
        part = slice(begin, begin + POINTS_PER_BLOCK)
        found[part] = legendre.legval(s[part], coefficients[:, panel[part]], tensor=False)
    return found


def resolve(pdf: Pdf, pieces: Floats) -> tuple[Floats, Floats]:
    """Approximate a function to rounding by polynomials on panels, halving panels until all are resolved.

    Parameters
    ----------
    pdf
        points (n,) -> values (n,), smooth between consecutive ``pieces`` (P + 1,).

    Returns
    -------
    edges, coefficients
        as for ``Panels``.

    Raises
    ------
    InvalidProblem
        if 60 halvings are not enough, or more than 100 000 panels are unresolved at a time.
    """
    waiting, done, largest = [(pieces[:-1], pieces[1:])], [], 0.0
    for _ in range(MAX_HALVINGS):
        low, high = waiting.pop()
        middle, half = (low + high) / 2, (high - low) / 2
        values = pdf((middle[:, None] + half[:, None] * GAUSS_NODES).ravel()).reshape(len(low), -1)
        found = values @ PROJECTION.T
        largest = max(largest, float(np.abs(found).max()))
        tail = np.abs(found[:, -TAIL:]).max(axis=1)
        rounding = RESOLVED + COORDINATE_ROUNDING * np.maximum(np.abs(low), np.abs(high)) / half
        fine = (tail <= rounding * largest) | (tail * half <= RESOLVED / MAX_HALVINGS)
        done.append((low[fine], high[fine], found[fine]))
        if fine.all():
            first, last, coefficients = (np.concatenate(parts) for parts in zip(*done, strict=True))
            order = np.argsort(first)
            return np.append(first[order], last[order[-1]]), coefficients[order]
        low, middle, high = low[~fine], middle[~fine], high[~fine]
        if 2 * len(low) > MAX_PANELS:
            raise InvalidProblem(
                f"pdf is not resolved by {MAX_PANELS} panels of {DEGREE + 1} values between {low.min():.9g} and "
                f"{high.max():.9g}: must be smooth there, except at its breaks"
            )
        waiting.append((np.concatenate([low, middle]), np.concatenate([middle, high])))
    raise InvalidProblem(f"pdf is not resolved after {MAX_HALVINGS} halvings near {low.min():.9g}: list its breaks")
