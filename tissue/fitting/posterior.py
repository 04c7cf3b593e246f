"""What data say about parameters: the posterior of a fit on weighted points, by the emulator of its design."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.special import softmax
from scipy.stats import qmc

from tissue.fitting.emulator import Emulator
from tissue.state.cells import Floats

POINTS, CHUNK = 2**13, 1024
# The box of points is drawn together this often, around those whose log density is at most so far below the largest.
ZOOMS, DEEP, MARGIN = 5, 9.0, 0.05
# Fewer points than ENOUGH that have weight are replaced, at most so often, by draws from Student's t about them.
ENOUGH, AGAIN, FREEDOM = 400, 12, 5
LEVEL = 0.95
ENDS = (1 - LEVEL) / 2, 0.5, (1 + LEVEL) / 2


class Posterior(NamedTuple):
    """Weighted points: the parameters are uniform in [-1, 1]^d before the data, z ~ N(M(u), covariance + errors^2)."""

    u: Floats  # (n, d)
    weights: Floats  # (n,), of sum 1
    misfits: Floats  # r' covariance^-1 r of each point, the square of a distance from the data

    @property
    def effective(self) -> float:
        """The number of points of equal weight that are worth as much."""
        return float(1 / np.square(self.weights).sum())

    def quantiles(self) -> Floats:
        """Return the ends of the 95 % intervals and the medians of the parameters, (d, 3)."""
        found = []
        for line in self.u.T:
            order = np.argsort(line)
            below = np.cumsum(self.weights[order]) - self.weights[order] / 2
            found.append(np.interp(ENDS, below, line[order]))
        return np.array(found)

    def correlations(self) -> Floats:
        """Return the correlations of the parameters, (d, d)."""
        away = self.u - self.weights @ self.u
        covariance = (self.weights[:, None] * away).T @ away
        s = np.sqrt(np.maximum(np.diagonal(covariance), 1e-300))  # 0 of a single point
        return np.asarray(covariance / (s[:, None] * s))

    def drawn(self, number: int, seed: int = 0) -> Floats:
        """Return points of equal weight, (number, d)."""
        return self.u[np.random.default_rng(seed).choice(len(self.u), number, p=self.weights)]


def posterior(emulator: Emulator, values: Floats, errors: Floats, tissues: int) -> Posterior:
    """Compute the posterior of the parameters from values with standard errors, means of so many tissues.

    The points are those of Sobol's sequence in a box, which is drawn together around those that have weight. Where few
    have, as of six parameters that are all identified, they are drawn again about these (population Monte Carlo).
    """
    d = emulator.points.shape[1]
    unit = qmc.Sobol(d, seed=0).random(POINTS if d < 3 else 4 * POINTS)
    low, high = -np.ones(d), np.ones(d)
    for zoom in range(ZOOMS):
        u = low + (high - low) * unit
        density, misfits = _densities(emulator, u, values, errors, tissues)
        seen = u[density >= density.max() - DEEP - d]
        margin = MARGIN * (high - low)
        box = np.maximum(seen.min(axis=0) - margin, -1), np.minimum(seen.max(axis=0) + margin, 1)
        if zoom == ZOOMS - 1 or np.prod((box[1] - box[0]) / (high - low)) > 0.8:
            break
        low, high = box
    logs, rng = density, np.random.default_rng(0)
    found = _weighted(u, logs, misfits)
    for _ in range(AGAIN):
        if found.effective >= ENOUGH:
            break
        u, log_drawn = _about(u, logs, len(unit), rng)
        density, misfits = _densities(emulator, u, values, errors, tissues)
        logs = density - log_drawn
        found = _weighted(u, logs, misfits)
    return found


def _weighted(u: Floats, logs: Floats, misfits: Floats) -> Posterior:
    weights = np.exp(logs - logs.max())
    return Posterior(u, weights / weights.sum(), misfits)


def _about(u: Floats, logs: Floats, number: int, rng: np.random.Generator) -> tuple[Floats, Floats]:
    """Draw about weighted points, and return those in [-1, 1]^d with the logarithms of their density.

    The weights are made more equal, by a power, until there are enough to tell a covariance.
    """
    d, weights = u.shape[1], softmax(logs)
    while 1 / np.square(weights).sum() < min(20 * d, len(u) / 2):
        logs = (logs - logs.max()) / 2
        weights = softmax(logs)
    middle = weights @ u
    away = u - middle
    root = np.linalg.cholesky((weights[:, None] * away).T @ away + 1e-16 * np.eye(d))
    z = rng.normal(size=(number, d)) / np.sqrt(rng.chisquare(FREEDOM, (number, 1)) / FREEDOM)
    u = middle + z @ root.T
    inside = (np.abs(u) <= 1).all(axis=1)
    return u[inside], -(FREEDOM + d) / 2 * np.log1p(np.square(z[inside]).sum(axis=1) / FREEDOM)


def _densities(emulator: Emulator, u: Floats, values: Floats, errors: Floats, tissues: int) -> tuple[Floats, Floats]:
    """Return log densities, but for a constant, and the misfits at points."""
    density, misfits = np.empty(len(u)), np.empty(len(u))
    for begin in range(0, len(u), CHUNK):
        some = slice(begin, begin + CHUNK)
        covariance = emulator.covariance(u[some], tissues) + np.diag(np.square(errors))
        root = np.linalg.cholesky(covariance)
        off = np.linalg.solve(root, (values - emulator.mean.at(u[some]))[:, :, None])[:, :, 0]
        misfits[some] = np.square(off).sum(axis=1)
        density[some] = -misfits[some] / 2 - np.log(np.diagonal(root, axis1=1, axis2=2)).sum(axis=1)
    return density, misfits
