"""The ready-made densities and their samplers, as objects that pickle."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class UniformShape:
    """f = 1 / volume on the box of two corners (nx,)."""

    lower: Floats
    upper: Floats

    def __call__(self, x: Floats) -> Floats:
        """The values at points (n, nx) of the box."""
        return np.full(len(x), 1.0 / float(np.prod(self.upper - self.lower)))

    def sample(self, rng: np.random.Generator, n: int) -> Floats:
        """Independent points (n, nx)."""
        return rng.uniform(self.lower, self.upper, (n, len(self.lower)))


@dataclass(frozen=True, eq=False)
class NormalShape:
    """f = exp(-|L^-1 (x - centre)|^2 / 2) / ((2 pi)^(nx/2) det L) with the Cholesky factor L, cut at a box."""

    centre: Floats
    factor: Floats
    lower: Floats
    upper: Floats

    def __call__(self, x: Floats) -> Floats:
        """The values at points (n, nx) of the box."""
        inverse = np.linalg.inv(self.factor)
        scale = float(np.prod(np.diag(inverse))) / (2 * np.pi) ** (len(self.centre) / 2)
        values: Floats = scale * np.exp(-(((x - self.centre) @ inverse.T) ** 2).sum(axis=1) / 2)
        return values

    def sample(self, rng: np.random.Generator, n: int) -> Floats:
        """Independent points (n, nx)."""
        return np.clip(self.centre + rng.standard_normal((n, len(self.centre))) @ self.factor.T, self.lower, self.upper)


@dataclass(frozen=True, eq=False)
class BumpShape:
    """f = prod_k 315 / (256 r_k) (1 - s_k^2)^4, s_k = (x_k - centre_k) / r_k, for |s_k| <= 1."""

    centre: Floats
    radius: Floats

    def __call__(self, x: Floats) -> Floats:
        """The values at points (n, nx), 0 outside."""
        s = (x - self.centre) / self.radius
        values: Floats = np.prod(315 / (256 * self.radius) * np.maximum(1 - s * s, 0.0) ** 4, axis=1)
        return values
