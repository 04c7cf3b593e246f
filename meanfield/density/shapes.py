"""Built-in densities and their samplers, as objects that pickle."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from dincl import checks
from dincl.errors import InvalidProblem

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class UniformShape:
    """Uniform density f = 1 / volume on the box between two corners (nx,)."""

    lower: Floats
    upper: Floats

    def __call__(self, x: Floats) -> Floats:
        """Evaluate f at points (n, nx) of the box."""
        return np.full(len(x), 1.0 / float(np.prod(self.upper - self.lower)))

    def sample(self, rng: np.random.Generator, n: int) -> Floats:
        """Draw independent points (n, nx)."""
        return rng.uniform(self.lower, self.upper, (n, len(self.lower)))


@dataclass(frozen=True, eq=False)
class NormalShape:
    """Normal density f = exp(-|L^-1 (x - centre)|^2 / 2) / ((2 pi)^(nx/2) det L), Cholesky factor L, cut at a box."""

    centre: Floats
    factor: Floats
    lower: Floats
    upper: Floats

    def __call__(self, x: Floats) -> Floats:
        """Evaluate f at points (n, nx) of the box."""
        inverse = np.linalg.inv(self.factor)
        scale = float(np.prod(np.diag(inverse))) / (2 * np.pi) ** (len(self.centre) / 2)
        values: Floats = scale * np.exp(-(((x - self.centre) @ inverse.T) ** 2).sum(axis=1) / 2)
        return values

    def sample(self, rng: np.random.Generator, n: int) -> Floats:
        """Draw independent points (n, nx)."""
        return np.clip(self.centre + rng.standard_normal((n, len(self.centre))) @ self.factor.T, self.lower, self.upper)


@dataclass(frozen=True, eq=False)
class BumpShape:
    """Density f = prod_k 315 / (256 r_k) (1 - s_k^2)^4, s_k = (x_k - centre_k) / r_k, for |s_k| <= 1."""

    centre: Floats
    radius: Floats

    def __call__(self, x: Floats) -> Floats:
        """Evaluate f at points (n, nx), 0 outside the box."""
        s = (x - self.centre) / self.radius
        values: Floats = np.prod(315 / (256 * self.radius) * np.maximum(1 - s * s, 0.0) ** 4, axis=1)
        return values


def row(name: str, value: ArrayLike, length: int | None) -> Floats:
    """Return numbers as an array of shape (length,), of any length for None; a single number becomes shape (1,)."""
    return checks.shaped(name, np.atleast_1d(checks.array(name, value)), (length,))


def cholesky_factor(deviation: ArrayLike, nx: int) -> tuple[Floats, Floats]:
    """Return the Cholesky factor (nx, nx) of a covariance, and the standard deviations (nx,).

    Raises
    ------
    InvalidProblem
        unless ``deviation`` is positive (nx,), or symmetric and positive definite (nx, nx).
    """
    numbers = checks.array("deviation", deviation)
    given = checks.shaped("deviation", numbers, (nx, nx)) if numbers.ndim == 2 else row("deviation", numbers, nx)
    if given.ndim == 1:
        if (given <= 0).any():
            raise InvalidProblem(f"deviation = {checks.describe(given)}: must be > 0")
        return np.diag(given), given
    try:
        factor: Floats = np.linalg.cholesky(given).astype(np.float64)
    except np.linalg.LinAlgError:
        factor = np.zeros((nx, nx))
    if not np.array_equal(given, given.T) or not factor.any():
        raise InvalidProblem(f"deviation = {checks.describe(given)}: must be symmetric and positive definite")
    return factor, np.sqrt(np.diag(given))
