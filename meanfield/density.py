"""Probability densities of the particles at the start of a run: f on a box of R^nx, nx = 1, 2, 3, and 0 outside.

On a line a density is resolved to rounding by polynomials on panels, so that its integrals and quantiles are exact.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, partial

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import ArrayLike, NDArray

from dincl import checks
from dincl.callables import UserFunction
from dincl.errors import InvalidProblem
from dincl.status import Status

Floats = NDArray[np.float64]
Pdf = Callable[[Floats], Floats]
Sampler = Callable[[np.random.Generator, int], Floats]

MAX_AXES = 3
# The integral of a density must be 1 to this accuracy; in d >= 2 it is computed with CHECK_NODES Gauss points per axis.
# Coordinates far from the origin are rounded, and the integral with them, by eps times their distance over the width of
# the density, which may be 16 times narrower than its box, as a normal density is.
MASS_TOLERANCE, CHECK_NODES = 1e-10, 64
MASS_ROUNDING = 64 * float(np.finfo(np.float64).eps)
# A normal density is cut at this many deviations: the mass outside, 1e-16 for each axis, is below rounding.
CUT = 8.3
# Rejection sampling: the bound of f over its largest value at the Gauss points; points per round, for memory; rounds.
BOUND_RATIO, MAX_TRIES, MAX_REJECTION_ROUNDS = 1.25, 1_000_000, 200
# Points per call, for memory; Gauss points per axis, because computing n of them takes O(n^3) operations.
MAX_POINTS, MAX_NODES_PER_AXIS = 10_000_000, 2_048
PDF = UserFunction("pdf", ("x",), Status.FUNCTION_FAILED)
SAMPLER = UserFunction("sampler", ("rng", "n"), Status.FUNCTION_FAILED)
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
# Newton's method falls back on bisection, so it ends after at most as many steps as a number has bits.
MAX_NEWTON_STEPS, NEWTON_CONVERGED = 60, 2.0**-51
# Points whose polynomials are evaluated together, for memory.
POINTS_PER_BLOCK = 100_000


@dataclass(frozen=True, eq=False)
class Density:
    """Density f(x) >= 0 with int f = 1, smooth on the box [lower, upper] except at ``breaks``, and 0 outside.

    Parameters
    ----------
    pdf
        f: points (n, nx) in the box -> values (n,).
    lower, upper
        corners of the box (nx,), nx = 1, 2 or 3.
    breaks
        in one dimension: points inside the box where f or a derivative jumps; quadrature is split there.
    sampler
        (rng, n) -> (n, nx) independent points of this density. None: quantiles in one dimension, rejection otherwise.

    Raises
    ------
    FunctionFailed
        if pdf or sampler raises (its exception is the cause) or returns an invalid value, at construction or later.
    InvalidProblem
        if the integral is not 1 to 1e-10. In one dimension, a density that 100 000 panels do not resolve is refused. In
        two and three dimensions the integral is computed with 64 Gauss points per axis, and a density that these do not
        resolve is refused.
    """

    pdf: Pdf
    lower: Floats
    upper: Floats
    breaks: tuple[float, ...] = ()
    sampler: Sampler | None = None

    def __post_init__(self) -> None:
        lower, upper = _corners(self.lower, self.upper)
        checks.function("pdf", self.pdf, "a function of points (n, nx)")
        if self.sampler is not None:
            checks.function("sampler", self.sampler, "a function of (rng, n)")
        for name, value in (("lower", lower), ("upper", upper), ("breaks", _breaks_within(self.breaks, lower, upper))):
            object.__setattr__(self, name, value)
        if self.nx == 1:
            edges, coefficients = self._resolved
            mass = float(np.diff(edges) @ coefficients[:, 0])
        else:
            points, volumes = gauss_product(self._pieces(), CHECK_NODES)
            mass = float(self._values(points) @ volumes)
        farthest = np.maximum(np.abs(lower), np.abs(upper)) / (upper - lower)
        allowed = MASS_TOLERANCE + MASS_ROUNDING * float(farthest.max())
        if abs(mass - 1.0) > allowed:
            raise InvalidProblem(f"pdf: its integral over the box is {mass:.12g}: must be 1 to {allowed:.3g}")

    @classmethod
    def uniform(cls, lower: ArrayLike, upper: ArrayLike) -> Density:
        """Build f = 1 / volume on the box."""
        low, high = _corners(lower, upper)
        return cls(partial(_uniform, low, high), low, high, sampler=partial(_uniform_sample, low, high))

    @classmethod
    def normal(cls, mean: ArrayLike, deviation: ArrayLike) -> Density:
        """Build f = prod_k exp(-(x_k - mean_k)^2 / (2 s_k^2)) / (sqrt(2 pi) s_k), cut at 8.3 deviations on each axis.

        Parameters
        ----------
        mean
            (nx,), or a number.
        deviation
            s > 0 of each axis (nx,), or one number for all axes.
        """
        centre, s = _with_widths("mean", mean, "deviation", deviation)
        return cls(partial(_normal, centre, s), centre - CUT * s, centre + CUT * s, sampler=partial(_drawn, centre, s))

    @classmethod
    def bump(cls, centre: ArrayLike, radius: ArrayLike) -> Density:
        """Build f = prod_k 315 / (256 r_k) (1 - s_k^2)^4, s_k = (x_k - centre_k) / r_k, on |s_k| <= 1, of class C^3.

        Parameters
        ----------
        centre
            (nx,), or a number.
        radius
            r > 0 of each axis (nx,), or one number for all axes.
        """
        middle, r = _with_widths("centre", centre, "radius", radius)
        return cls(partial(_bump, middle, r), middle - r, middle + r)

    @property
    def nx(self) -> int:
        """Dimension of the space."""
        return len(self.lower)

    @cached_property
    def panels(self) -> Panels:
        """Density as a piecewise polynomial, to rounding; in one dimension only."""
        self._check_line("panels")
        edges, coefficients = self._resolved
        return Panels(edges, coefficients / float(np.diff(edges) @ coefficients[:, 0]))

    @cached_property
    def _resolved(self) -> tuple[Floats, Floats]:
        return _resolve(lambda x: self._values(x[:, None]), self._pieces()[0])

    def density(self, x: ArrayLike) -> Floats:
        """Evaluate f at points (n, nx), 0 outside the box."""
        points = checks.shaped("x", x, (None, self.nx))
        values = np.zeros(len(points))
        inside = ((self.lower <= points) & (points <= self.upper)).all(axis=1)
        if inside.any():
            values[inside] = self._values(points[inside])
        return values

    def sample(self, rng: np.random.Generator, n: int) -> Floats:
        """Draw independent points (n, nx).

        Raises
        ------
        InvalidProblem
            if rng is no generator, n is no integer from 1 to 10^7, or rejection accepts too few of 2 * 10^8 points.
        FunctionFailed
            if sampler or pdf fails.
        """
        rng, n = checks.generator("rng", rng), checks.integer("n", n, least=1, most=MAX_POINTS)
        if self.sampler is not None:
            with np.errstate(all="ignore"):
                return SAMPLER.evaluated(self.sampler, rng, n, shape=(n, self.nx))
        return self.panels.quantile(rng.random(n))[:, None] if self.nx == 1 else self._rejected(rng, n)

    def quantiles(self, n: int) -> Floats:
        """Compute the quantiles (n, 1) of the probabilities (i - 1/2) / n, i = 1 ... n.

        No other n points of equal weight are closer to the density in W1.

        Raises
        ------
        InvalidProblem
            in more than one dimension, or if n is no integer from 1 to 10^7.
        """
        n = checks.integer("n", n, least=1, most=MAX_POINTS)
        self._check_line("quantiles")
        return self.panels.quantile((np.arange(n) + 0.5) / n)[:, None]

    def nodes(self, n: int) -> tuple[Floats, Floats]:
        """Compute Gauss-Legendre points (Q, nx) and weights (Q,) for integrals against f; the weights sum to 1.

        Parameters
        ----------
        n
            points per axis and smooth piece.

        Raises
        ------
        InvalidProblem
            if n is no integer from 1 to 2048, Q would be more than 10^7, or f is 0 at all points.
        """
        n = checks.integer("n", n, least=1, most=MAX_NODES_PER_AXIS)
        count = (n * (len(self.breaks) + 1)) ** self.nx
        if count > MAX_POINTS:
            raise InvalidProblem(f"n = {n}: gives {count} Gauss points: must be at most {MAX_POINTS}")
        points, volumes = gauss_product(self._pieces(), n)
        weights = volumes * self._values(points)
        total = weights.sum()
        if not total > 0.0:
            raise InvalidProblem(f"n = {n}: the density is 0 at all Gauss points: n must be larger")
        return points, weights / total

    def moments(self) -> tuple[Floats, Floats]:
        """Compute mean (nx,) and second moment int x x^T f (nx, nx), to rounding if quadrature resolves the density.

        Both are summed about the centre c of the box, so that a distant box adds no rounding but that of its points:
        int x x^T f = int z z^T f + c z^T + z c^T + c c^T with x = c + z and the mean of z.
        """
        c = self.lower + (self.upper - self.lower) / 2
        pieces = self._pieces() if self.nx > 1 else [self.panels.edges]
        z, volumes = gauss_product([e - k for e, k in zip(pieces, c, strict=True)], CHECK_NODES if self.nx > 1 else 16)
        weights = volumes * self._values(np.clip(c + z, self.lower, self.upper))
        weights /= weights.sum()
        mean, second = weights @ z, np.einsum("q,qi,qj->ij", weights, z, z, optimize=True)
        return c + mean, second + np.outer(c, mean) + np.outer(mean, c) + np.outer(c, c)

    def _check_line(self, what: str) -> None:
        if self.nx != 1:
            raise InvalidProblem(f"nx = {self.nx}: {what} need one dimension; use sample() or nodes()")

    def _pieces(self) -> list[Floats]:
        """Return for each axis the ends of the smooth pieces."""
        return [np.array([a, *self.breaks, b]) for a, b in zip(self.lower, self.upper, strict=True)]

    def _values(self, points: Floats) -> Floats:
        with np.errstate(all="ignore"):
            values = PDF.evaluated(self.pdf, points, shape=(len(points),))
        if (values < 0).any():
            where = int(np.flatnonzero(values < 0)[0])
            PDF.refuse(f"returned {values[where]} at x = {points[where]}: must be >= 0.")
        return values

    def _rejected(self, rng: np.random.Generator, n: int) -> Floats:
        """Draw points by rejection; if f exceeds its assumed bound, restart with a higher bound."""
        points, _ = gauss_product(self._pieces(), CHECK_NODES)
        bound = BOUND_RATIO * float(self._values(points).max())
        volume, found = float(np.prod(self.upper - self.lower)), np.empty((0, self.nx))
        for _ in range(MAX_REJECTION_ROUNDS):
            tries = min(MAX_TRIES, int(BOUND_RATIO * (n - len(found)) * max(bound * volume, 1.0)) + 1)
            x = rng.uniform(self.lower, self.upper, (tries, self.nx))
            f = self._values(x)
            if f.max() > bound:
                found, bound = found[:0], BOUND_RATIO * float(f.max())
            else:
                found = np.concatenate([found, x[rng.random(tries) * bound < f]])
            if len(found) >= n:
                return found[:n]
        raise InvalidProblem(
            f"pdf: {MAX_REJECTION_ROUNDS} rounds of at most {MAX_TRIES} points gave {len(found)} of {n} by rejection: "
            "the density must fill more of its box, or have a sampler"
        )


# Functions of the built-in densities, of points (n, nx) in their box; ``partial`` of a function of a module pickles.


def _uniform(lower: Floats, upper: Floats, x: Floats) -> Floats:
    return np.full(len(x), 1.0 / float(np.prod(upper - lower)))


def _uniform_sample(lower: Floats, upper: Floats, rng: np.random.Generator, n: int) -> Floats:
    return rng.uniform(lower, upper, (n, len(lower)))


def _normal(centre: Floats, s: Floats, x: Floats) -> Floats:
    return np.asarray(np.exp(-(((x - centre) / s) ** 2).sum(axis=1) / 2) / np.prod(np.sqrt(2 * np.pi) * s))


def _drawn(centre: Floats, s: Floats, rng: np.random.Generator, n: int) -> Floats:
    return np.clip(centre + rng.standard_normal((n, len(centre))) * s, centre - CUT * s, centre + CUT * s)


def _bump(centre: Floats, radius: Floats, x: Floats) -> Floats:
    s = (x - centre) / radius
    return np.asarray(np.prod(315 / (256 * radius) * np.maximum(1 - s * s, 0.0) ** 4, axis=1))


def _row(name: str, value: ArrayLike, length: int | None) -> Floats:
    """Return numbers as an array of shape (length,), of any length for None; a single number becomes shape (1,)."""
    return checks.shaped(name, np.atleast_1d(checks.array(name, value)), (length,))


def _with_widths(name: str, middle: ArrayLike, word: str, widths: ArrayLike) -> tuple[Floats, Floats]:
    """Return a point and the width of each axis, both (nx,); InvalidProblem unless the widths are > 0."""
    centre, given = _row(name, middle, None), _row(word, widths, None)
    if len(given) not in (1, len(centre)) or (given <= 0).any():
        raise InvalidProblem(f"{word} = {checks.describe(given)}: must be > 0, one number or {len(centre)}")
    return centre, np.array(np.broadcast_to(given, centre.shape))


def _corners(lower: ArrayLike, upper: ArrayLike) -> tuple[Floats, Floats]:
    """Return the lower and the upper corner (nx,) of a box; InvalidProblem unless lower < upper and nx <= 3."""
    low = _row("lower", lower, None)
    high = _row("upper", upper, len(low))
    if len(low) > MAX_AXES:
        raise InvalidProblem(f"lower = {checks.describe(low)}: must have 1, 2 or 3 components")
    if not (low < high).all():
        raise InvalidProblem(f"upper = {checks.describe(high)}: must be > lower = {checks.describe(low)}")
    return low, high


def _breaks_within(breaks: tuple[float, ...], lower: Floats, upper: Floats) -> tuple[float, ...]:
    """Return breaks in increasing order; InvalidProblem unless all of them lie inside the box, in one dimension."""
    listed = checks.items("breaks", breaks, object, "a list of numbers")
    found = tuple(sorted({checks.number("breaks", value) for value in listed}))
    if found and (len(lower) > 1 or not lower[0] < found[0] or not found[-1] < upper[0]):
        raise InvalidProblem(f"breaks = {found}: must lie inside the box, in one dimension")
    return found


def product_points(axes: list[Floats]) -> Floats:
    """Return all points of a product of axes, shape (Q, len(axes)); the last axis runs fastest."""
    return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, len(axes))


def gauss_product(pieces: list[Floats], n: int) -> tuple[Floats, Floats]:
    """Return points (Q, nx) and weights (Q,) of a product of composite Gauss-Legendre rules.

    Parameters
    ----------
    pieces
        for each axis the ends of its pieces, increasing.
    n
        Gauss points per axis and piece.
    """
    s, weight = np.polynomial.legendre.leggauss(n)
    half = [np.diff(ends)[:, None] / 2 for ends in pieces]
    axes = [((ends[1:] + ends[:-1])[:, None] / 2 + h * s).ravel() for ends, h in zip(pieces, half, strict=True)]
    weights = np.array(1.0)
    for h in half:
        weights = np.multiply.outer(weights, (h * weight).ravel())
    return product_points(axes), weights.ravel()


@dataclass(frozen=True, eq=False)
class Panels:
    """Density f(x) = sum_k c_pk P_k(s) on panel p, Legendre polynomials P_k of s in [-1, 1]; f = 0 elsewhere.

    ``Density.panels`` and ``GridMotion.density`` return it.

    Parameters
    ----------
    edges
        ends of the panels (P + 1,), increasing.
    coefficients
        c (P, degree + 1), with the mass 1.
    """

    edges: Floats
    coefficients: Floats

    @cached_property
    def _cumulative(self) -> tuple[Floats, Floats]:
        """F at the edges, and the Legendre coefficients of F on the panels, of shape (degree + 2, P)."""
        half = np.diff(self.edges) / 2
        inner = legendre.legint(self.coefficients.T, lbnd=-1, axis=0) * half
        at_edges = np.append(0.0, np.cumsum(2 * half * self.coefficients[:, 0]))
        at_edges /= at_edges[-1]
        inner[0] += at_edges[:-1]
        return at_edges, inner

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


def _resolve(pdf: Pdf, pieces: Floats) -> tuple[Floats, Floats]:
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
