"""An emulator of what runs give: mean and covariance of the outputs as functions of the parameters.

    y(u) ~ N(M(u), S(u) C S(u)),  M polynomials, S = diag exp(quadratic / 2), C one matrix of correlations

The parameters u lie in [-1, 1]^d; the basis are products of Legendre polynomials, orthonormal for uniform u. So the
squares of their coefficients are the parts of the variance of M (polynomial chaos), which ``sensitivity`` adds up.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from typing import NamedTuple

import numpy as np
from numpy.polynomial.legendre import legvander
from scipy.special import digamma

from dincl.errors import InvalidProblem
from tissue.state.cells import Floats, Integers

MOST_DEGREE, OF_SPREAD = 6, 2
# Points for each term of a polynomial, at least.
POINTS_A_TERM = 2.0
# Variances between runs below this part of the variance between points are rounding.
LEAST_SPREAD = 1e-4
# Part of the square of a mean below which its variance between points is rounding.
ROUNDING = 1e-24
BOOTSTRAPS = 200


class Polynomial(NamedTuple):
    """Weighted least squares of columns: of products of Legendre polynomials of these degrees (terms, d)."""

    degrees: Integers
    coefficients: Floats  # (terms, columns)
    inverse: Floats  # (F' W F)^-1
    left_out: Floats  # residual of each point by the fit without it (points, columns)
    errors: Floats  # covariance of the residuals of a point of weight 1 (columns, columns)

    def at(self, u: Floats) -> Floats:
        """Return the values at points u (n, d)."""
        values: Floats = features(u, self.degrees) @ self.coefficients
        return values

    def leverage(self, u: Floats) -> Floats:
        """Return f' (F' W F)^-1 f: the variance of the values over that of the residuals."""
        f = features(u, self.degrees)
        found: Floats = np.einsum("ni,ij,nj->n", f, self.inverse, f)
        return found


def degrees_up_to(d: int, total: int) -> Integers:
    """List the degrees of all products up to a total degree (terms, d), that of the constant first."""
    every = [one for one in product(range(total + 1), repeat=d) if sum(one) <= total]
    return np.array(sorted(every, key=lambda one: (sum(one), one)), np.int64)


def features(u: Floats, degrees: Integers) -> Floats:
    """Evaluate the basis at points u (n, d), (n, terms)."""
    most = int(degrees.max(initial=0))
    lines = legvander(np.asarray(u), most) * np.sqrt(2 * np.arange(most + 1) + 1)  # (n, d, most + 1)
    axes = np.arange(degrees.shape[1])
    products: Floats = np.prod(lines[:, axes, degrees], axis=2)
    return products


def least_squares(u: Floats, y: Floats, weights: Floats, degrees: Integers) -> Polynomial:
    """Fit the columns of y (points, columns)."""
    f, root = features(u, degrees), np.sqrt(weights)[:, None]
    inverse: Floats = np.linalg.pinv((root * f).T @ (root * f)).astype(np.float64)
    coefficients = inverse @ (f.T @ (weights[:, None] * y))
    residuals, leverage = y - f @ coefficients, weights * np.einsum("ni,ij,nj->n", f, inverse, f)
    freedom = max(1, len(u) - len(degrees))
    errors = (root * residuals).T @ (root * residuals) / freedom
    left_out = residuals / np.maximum(1 - leverage, 1e-9)[:, None]
    return Polynomial(degrees, coefficients, inverse, left_out, errors)


@dataclass(frozen=True)
class Emulator:
    """Mean and covariance of the outputs; made by ``emulate``.

    Attributes
    ----------
    points
        Those of the design with two sound runs or more, (P, d) in [-1, 1].
    mean
        M, of the degree whose errors at points that are left out are least.
    spread
        The logarithms of the variances of runs.
    correlation
        C.
    lack
        Covariance of what M misses beside the scatter of the runs that it is made from.
    between
        Mean variance of runs of one point, by output.
    """

    points: Floats
    weights: Floats
    averages: Floats  # over the runs of each point
    mean: Polynomial
    spread: Polynomial
    correlation: Floats
    lack: Floats
    between: Floats

    def deviations(self, u: Floats) -> Floats:
        """Return the standard deviations of runs at points u, (n, outputs)."""
        return np.exp(self.spread.at(u) / 2)

    def covariance(self, u: Floats, tissues: int) -> Floats:
        """Return the covariance of the mean of so many tissues about M at points u, with what M itself may be off."""
        s = self.deviations(u)
        runs: Floats = s[:, :, None] * (self.correlation / tissues) * s[:, None, :]
        return runs + self.lack + self.mean.leverage(u)[:, None, None] * self.mean.errors

    def calibration(self) -> float:
        """Return the share of the points, left out one by one, and outputs in the 95 % intervals of the others."""
        runs = self.deviations(self.points) ** 2 / self.weights[:, None]
        own = self.mean.leverage(self.points)
        own = own / np.maximum(1 - self.weights * own, 1e-9)  # of the fit without the point
        variance = runs + np.diagonal(self.lack) + own[:, None] * np.diagonal(self.mean.errors)
        return float((np.abs(self.mean.left_out) <= 1.96 * np.sqrt(variance)).mean())

    def sensitivity(self, seed: int = 0) -> Floats:
        """Return Sobol's first-order and total indices of M with 95 % intervals, (d, outputs, 2, 3): value, low, high.

        Intervals are percentiles over designs whose points are drawn again, with the degrees kept: they have the
        scatter of the runs and the choice of the points. Source: Sudret (2008), for indices from polynomial chaos.
        """
        rng, n = np.random.default_rng(seed), len(self.points)
        draws = [rng.integers(n, size=n) for _ in range(BOOTSTRAPS)]
        found = np.array([self._indices(np.arange(n)), *map(self._indices, draws)])
        low, high = np.percentile(found[1:], (2.5, 97.5), axis=0)
        return np.stack((found[0], np.minimum(low, found[0]), np.maximum(high, found[0])), axis=-1)

    def _indices(self, chosen: Integers) -> Floats:
        """Return the indices from some of the points, (d, outputs, 2)."""
        degrees = self.mean.degrees
        fit = least_squares(self.points[chosen], self.averages[chosen], self.weights[chosen], degrees)
        parts = np.square(fit.coefficients[1:])
        total, acting = parts.sum(axis=0), degrees[1:] > 0
        total[total <= ROUNDING * np.square(fit.coefficients[0])] = np.inf  # of an output that never changes
        alone = acting & (acting.sum(axis=1, keepdims=True) == 1)
        shares: Floats = np.stack([alone.T @ parts, acting.T @ parts], axis=-1) / total[:, None]
        return shares


def emulate(u: Floats, runs: Sequence[Floats]) -> Emulator:
    """Make the emulator of a design.

    Parameters
    ----------
    u
        Its points in [-1, 1], (P, d).
    runs
        The outputs of the sound runs of each point, each (runs, outputs).

    Raises
    ------
    InvalidProblem
        If there are too few points with two sound runs or more.
    """
    kept = np.array([len(one) > 1 for one in runs])
    points, several = u[kept], [one for one in runs if len(one) > 1]
    d = u.shape[1]
    least = round(POINTS_A_TERM * len(degrees_up_to(d, OF_SPREAD)))
    if len(points) < least:
        raise InvalidProblem(f"{len(points)} points have two sound runs or more: must be at least {least}")
    weights = np.array([float(len(one)) for one in several])
    averages = np.array([one.mean(axis=0) for one in several])
    sizes = (degrees_up_to(d, total) for total in range(1, MOST_DEGREE + 1))
    fits = [least_squares(points, averages, weights, one) for one in sizes if POINTS_A_TERM * len(one) <= len(points)]
    scale = np.maximum(averages.var(axis=0), 1e-300)
    mean = min(fits, key=lambda one: np.log(1e-12 + np.square(one.left_out).mean(axis=0) / scale).mean())
    # E log of a sample variance of n runs lies below the logarithm of the variance.
    variances = np.maximum([one.var(axis=0, ddof=1) for one in several], LEAST_SPREAD * scale)
    freedom = weights[:, None] - 1
    logs = np.log(variances) - digamma(freedom / 2) + np.log(freedom / 2)
    spread = least_squares(points, logs, weights - 1, degrees_up_to(d, OF_SPREAD))
    s = np.exp(spread.at(points) / 2)
    each = zip(several, averages, s, weights, strict=True)
    scaled = [(one - mid) / sd * np.sqrt(n / (n - 1)) for one, mid, sd, n in each]
    with np.errstate(invalid="ignore", divide="ignore"):
        correlation = np.corrcoef(np.concatenate(scaled).T).reshape(len(scale), -1)
    correlation = np.where(np.isfinite(correlation), correlation, np.eye(len(scale)))
    between = (s[:, :, None] * correlation * s[:, None, :]).mean(axis=0)
    lack = _not_negative((mean.errors - between) / weights.mean())
    return Emulator(points, weights, averages, mean, spread, correlation, lack, np.diagonal(between).copy())


def _not_negative(matrix: Floats) -> Floats:
    """Return the nearest covariance matrix."""
    values, vectors = np.linalg.eigh((matrix + matrix.T) / 2)
    nearest: Floats = (vectors * np.maximum(values, 0)) @ vectors.T
    return nearest
