"""Probability densities of the particles at the start: f on a box of R^nx, nx = 1, 2, 3, and 0 outside."""

from __future__ import annotations

import pickle
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dincl import checks
from dincl.callables import UserFunction
from dincl.errors import InvalidProblem
from dincl.status import Status
from meanfield.density.arguments import breaks_within, corners, factor_of, row
from meanfield.density.panels import Panels, resolved
from meanfield.density.shapes import BumpShape, NormalShape, UniformShape

Floats = NDArray[np.float64]
Pdf = Callable[[Floats], Floats]
Sampler = Callable[[np.random.Generator, int], Floats]

# The integral must be 1 to this accuracy; in d >= 2 it is that of so many Gauss points per axis.
MASS_TOLERANCE, CHECK_NODES = 1e-10, 64
# A normal density is cut at so many deviations: the mass outside, 1e-16 for each axis, is below rounding.
CUT = 8.3
# Rejection: room above the largest value at the Gauss points; the tries of a round, to stay in memory; the rounds.
HEADROOM, MOST_TRIES, MOST_ROUNDS = 1.25, 1_000_000, 200
# Points of one call, to stay in memory; Gauss points per axis, whose making takes their number cubed.
MOST_POINTS, MOST_NODES = 10_000_000, 2_048
PDF = UserFunction("pdf", ("x",), Status.FUNCTION_FAILED)
SAMPLER = UserFunction("sampler", ("rng", "n"), Status.FUNCTION_FAILED)


@dataclass(frozen=True, eq=False)
class Density:
    """f(x) >= 0 with int f = 1, smooth on the box [lower, upper] except at ``breaks``, and 0 outside.

    Parameters
    ----------
    pdf
        f: points (n, nx) in the box -> values (n,).
    lower, upper
        Corners of the box (nx,), nx = 1, 2 or 3.
    breaks
        In one dimension: points inside where f or a derivative jumps; quadrature stops there.
    sampler
        (rng, n) -> (n, nx) independent points of this density. None: quantiles in one dimension, else rejection.

    Raises
    ------
    FunctionFailed
        If pdf or sampler, now or later, raises or returns what it must not; the cause is what it raised.
    InvalidProblem
        If the integral is not 1 to 1e-10. In two and three dimensions it is that of 64 Gauss points per axis, so that a
        density that these do not resolve is refused, too; in one that which more than 100 000 panels would resolve.
    """

    pdf: Pdf
    lower: Floats
    upper: Floats
    breaks: tuple[float, ...] = ()
    sampler: Sampler | None = None

    def __post_init__(self) -> None:
        lower, upper = corners(self.lower, self.upper)
        checks.function("pdf", self.pdf, "a function of points (n, nx)")
        if self.sampler is not None:
            checks.function("sampler", self.sampler, "a function of (rng, n)")
        for name, value in (("lower", lower), ("upper", upper), ("breaks", breaks_within(self.breaks, lower, upper))):
            object.__setattr__(self, name, value)
        if self.nx == 1:
            edges, coefficients = self._resolved
            found = float(np.diff(edges) @ coefficients[:, 0])
        else:
            points, volumes = _gauss(self._pieces(), CHECK_NODES)
            found = float(self._values(points) @ volumes)
        if abs(found - 1.0) > MASS_TOLERANCE:
            raise InvalidProblem(f"pdf: its integral over the box is {found:.12g}: must be 1 to {MASS_TOLERANCE:g}")

    @classmethod
    def uniform(cls, lower: ArrayLike, upper: ArrayLike) -> Density:
        """f = 1 / volume on the box."""
        low, high = corners(lower, upper)
        shape = UniformShape(low, high)
        return cls(shape, low, high, sampler=shape.sample)

    @classmethod
    def normal(cls, mean: ArrayLike, deviation: ArrayLike) -> Density:
        """f = exp(-|L^-1 (x - mean)|^2 / 2) / ((2 pi)^(nx/2) det L), cut at 8.3 deviations on each axis.

        Parameters
        ----------
        mean
            (nx,), or a number.
        deviation
            > 0, of each component (nx,): they are independent; or the covariance L L^T (nx, nx).
        """
        centre = row("mean", mean, None)
        factor, deviations = factor_of(deviation, len(centre))
        low, high = centre - CUT * deviations, centre + CUT * deviations
        shape = NormalShape(centre, factor, low, high)
        return cls(shape, low, high, sampler=shape.sample)

    @classmethod
    def bump(cls, centre: ArrayLike, radius: ArrayLike) -> Density:
        """f = prod_k 315 / (256 r_k) (1 - s_k^2)^4, s_k = (x_k - centre_k) / r_k, on |s_k| <= 1: f is of class C^3.

        Parameters
        ----------
        centre
            (nx,), or a number.
        radius
            r > 0 of each axis (nx,), or one for all.
        """
        middle, given = row("centre", centre, None), row("radius", radius, None)
        if len(given) not in (1, len(middle)) or (given <= 0).any():
            raise InvalidProblem(f"radius = {checks.describe(given)}: must be > 0, one number or {len(middle)}")
        r = np.broadcast_to(given, middle.shape)
        return cls(BumpShape(middle, r), middle - r, middle + r)

    def __getstate__(self) -> dict[str, Any]:
        for name in ("pdf", "sampler"):
            try:
                pickle.dumps(getattr(self, name))
            except (pickle.PicklingError, AttributeError, TypeError) as error:
                raise pickle.PicklingError(
                    f"{name} = {checks.describe(getattr(self, name))}: a Density pickles if its pdf and sampler do; "
                    "give functions that are defined at the top of a module"
                ) from error
        return self.__dict__

    @property
    def nx(self) -> int:
        """Dimension of the space."""
        return len(self.lower)

    @cached_property
    def panels(self) -> Panels:
        """The density as a piecewise polynomial, to rounding; in one dimension."""
        self._needs_line("panels")
        return Panels(*self._resolved)

    @cached_property
    def _resolved(self) -> tuple[Floats, Floats]:
        return resolved(lambda x: self._values(x[:, None]), self._pieces()[0])

    def density(self, x: ArrayLike) -> Floats:
        """f at points (n, nx), 0 outside the box."""
        points = checks.shaped("x", x, (None, self.nx))
        values = np.zeros(len(points))
        inside = ((self.lower <= points) & (points <= self.upper)).all(axis=1)
        if inside.any():
            values[inside] = self._values(points[inside])
        return values

    def sample(self, rng: np.random.Generator, n: int) -> Floats:
        """Independent points (n, nx).

        Raises
        ------
        InvalidProblem
            If rng or n, at most 10^7, cannot be right, or rejection keeps too few of 2 * 10^8 points.
        FunctionFailed
            If sampler or pdf fails.
        """
        rng, n = checks.generator("rng", rng), checks.integer("n", n, least=1, most=MOST_POINTS)
        if self.sampler is not None:
            with np.errstate(all="ignore"):
                return SAMPLER.evaluated(self.sampler, rng, n, shape=(n, self.nx))
        return self.panels.quantile(rng.random(n))[:, None] if self.nx == 1 else self._rejected(rng, n)

    def quantiles(self, n: int) -> Floats:
        """Points (n, 1) of the probabilities (i - 1/2) / n, i = 1 ... n: of all n points those with the least W1.

        Raises
        ------
        InvalidProblem
            In more than one dimension, or if n is no integer from 1 to 10^7.
        """
        n = checks.integer("n", n, least=1, most=MOST_POINTS)
        self._needs_line("quantiles")
        return self.panels.quantile((np.arange(n) + 0.5) / n)[:, None]

    def nodes(self, n: int) -> tuple[Floats, Floats]:
        """Gauss-Legendre points (Q, nx), n for each axis and smooth piece, and weights (Q,) with f, which sum to 1.

        Raises
        ------
        InvalidProblem
            If n is no integer from 1 to 2048, Q would be more than 10^7, or f is 0 at all points.
        """
        n = checks.integer("n", n, least=1, most=MOST_NODES)
        count = (n * (len(self.breaks) + 1)) ** self.nx
        if count > MOST_POINTS:
            raise InvalidProblem(f"n = {n}: gives {count} Gauss points: must be at most {MOST_POINTS}")
        points, volumes = _gauss(self._pieces(), n)
        weights = volumes * self._values(points)
        total = weights.sum()
        if not total > 0.0:
            raise InvalidProblem(f"n = {n}: the density is 0 at all Gauss points: must be more")
        return points, weights / total

    def moments(self) -> tuple[Floats, Floats]:
        """Mean (nx,) and second moment int x x^T f (nx, nx), to rounding where the density is resolved."""
        pieces = self._pieces() if self.nx > 1 else [self.panels.edges]
        points, volumes = _gauss(pieces, CHECK_NODES if self.nx > 1 else 16)
        weights = volumes * self._values(points)
        weights /= weights.sum()
        return weights @ points, np.einsum("q,qi,qj->ij", weights, points, points, optimize=True)

    def _needs_line(self, what: str) -> None:
        if self.nx != 1:
            raise InvalidProblem(f"nx = {self.nx}: {what} need one dimension; use sample() or nodes()")

    def _pieces(self) -> list[Floats]:
        """For each axis the ends of the smooth pieces."""
        return [np.array([a, *self.breaks, b]) for a, b in zip(self.lower, self.upper, strict=True)]

    def _values(self, points: Floats) -> Floats:
        with np.errstate(all="ignore"):
            values = PDF.evaluated(self.pdf, points, shape=(len(points),))
        if (values < 0).any():
            where = int(np.flatnonzero(values < 0)[0])
            PDF.refuse(f"returned {values[where]} at x = {points[where]}: must be >= 0.")
        return values

    def _rejected(self, rng: np.random.Generator, n: int) -> Floats:
        """Points under the graph of f; where f is above the assumed bound, all begins anew with a higher one."""
        points, _ = _gauss(self._pieces(), CHECK_NODES)
        bound = HEADROOM * float(self._values(points).max())
        volume = float(np.prod(self.upper - self.lower))
        kept: list[Floats] = []
        for _ in range(MOST_ROUNDS):
            tries = min(MOST_TRIES, int(HEADROOM * (n - sum(map(len, kept))) * max(bound * volume, 1.0)) + 1)
            x = rng.uniform(self.lower, self.upper, (tries, self.nx))
            f = self._values(x)
            if f.max() > bound:
                kept, bound = [], HEADROOM * float(f.max())
            else:
                kept.append(x[rng.random(tries) * bound < f])
            if sum(map(len, kept)) >= n:
                return np.concatenate(kept)[:n]
        found = sum(map(len, kept))
        raise InvalidProblem(
            f"pdf: {MOST_ROUNDS} rounds of at most {MOST_TRIES} points gave {found} of {n} by rejection: must fill "
            "more of its box, or come with a sampler"
        )


def _gauss(pieces: list[Floats], n: int) -> tuple[Floats, Floats]:
    """Points (Q, nx) and volumes (Q,) of the product of composite Gauss-Legendre rules."""
    s, share = np.polynomial.legendre.leggauss(n)
    half = [np.diff(ends)[:, None] / 2 for ends in pieces]
    axes = [((ends[1:] + ends[:-1])[:, None] / 2 + h * s).ravel() for ends, h in zip(pieces, half, strict=True)]
    volume = np.array(1.0)
    for h in half:
        volume = np.multiply.outer(volume, (h * share).ravel())
    return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, len(pieces)), volume.ravel()
