"""Random scenes: up to some hundred discs or balls, walls, threads, sets that move, smooth and rough drifts."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

import dincl

Array = NDArray[np.float64]
MOST_PARTICLES = 300
# Exponents of the error that is asked for, and bounds of the end of a run [time].
ERRORS, ENDS = (-5.0, -1.5), (0.5, 2.0)
# Distances of grid points, in diameters of the largest disc.
SPACINGS = (1.02, 1.6)


@dataclass
class SceneParts:
    """Parts of a scene while it is drawn: positions ``x`` (n, d), radii (n,), random numbers."""

    x: Array
    radii: Array
    spacing: float
    rng: np.random.Generator
    constraints: list[Any] = field(default_factory=list)

    @property
    def low(self) -> Array:
        """The lowest coordinates that a particle covers, (d,)."""
        low: Array = (self.x - self.radii[:, None]).min(axis=0)
        return low

    @property
    def high(self) -> Array:
        """The highest coordinates that a particle covers, (d,)."""
        high: Array = (self.x + self.radii[:, None]).max(axis=0)
        return high

    def axis(self, k: int) -> Array:
        """Return the unit vector of axis k; -1 is the vertical."""
        unit: Array = np.eye(self.x.shape[1])[k]
        return unit


@dataclass(frozen=True)
class RandomScene:
    """A problem with its output times, the error that is asked for [length], and names of its sets and drift."""

    problem: dincl.Problem
    t: Array
    error: float
    sets: str
    drift: str


def scene(seed: int) -> RandomScene:
    """Draw the scene of a seed."""
    rng = np.random.default_rng(seed)
    parts = _particles(rng)
    if len(parts.x) > 1:
        parts.constraints.append(dincl.NonOverlap(parts.radii))
    names = [str(name) for name in rng.permutation(list(SETS))[: rng.integers(1, 4)]]
    for name in names:
        SETS[name](parts)
    drift = str(rng.choice(list(DRIFTS)))
    problem = dincl.Problem(parts.x, DRIFTS[drift](parts), parts.constraints)
    t = rng.uniform(*ENDS) * np.linspace(0.0, 1.0, rng.integers(2, 7))[1:]
    return RandomScene(problem, t, float(10 ** rng.uniform(*ERRORS)), " ".join(sorted(names)), drift)


def _particles(rng: np.random.Generator) -> SceneParts:
    """Draw the particles: a shuffled grid with some room, in the plane (three of four scenes) or in space."""
    d = int(rng.choice([2, 2, 2, 3]))
    n = round(float(np.exp(rng.uniform(0.0, np.log(MOST_PARTICLES)))))
    side = int(np.ceil(n ** (1 / d) - 1e-9))
    radii = rng.uniform(0.35, 0.5, n) if rng.random() < 0.5 else np.full(n, 0.5)
    spacing = rng.uniform(*SPACINGS)
    grid = np.stack(np.unravel_index(rng.permutation(side**d)[:n], (side,) * d), axis=1)
    x = spacing * grid + 0.45 * (spacing - 1) * rng.uniform(-1.0, 1.0, (n, d))
    return SceneParts(x, radii, float(spacing), rng)


def _floor(parts: SceneParts) -> None:
    up = parts.axis(-1)
    parts.constraints.append(dincl.HalfSpace(up, float(parts.low[-1] - parts.rng.uniform(0.0, 0.3)), parts.radii))


def _corner(parts: SceneParts) -> None:
    _floor(parts)
    wall = float(parts.low[0] - parts.rng.uniform(0.0, 0.3))
    parts.constraints.append(dincl.HalfSpace(parts.axis(0), wall, parts.radii))


def _container(parts: SceneParts) -> None:
    centre = parts.x.mean(axis=0)
    farthest = np.linalg.norm(parts.x - centre, axis=1).max()
    parts.constraints.append(dincl.InsideBall(centre, float(farthest + parts.rng.uniform(0.02, 0.5))))


def _moving_wall(parts: SceneParts) -> None:
    speed, direction = parts.rng.uniform(0.05, 0.4), parts.axis(0)
    wall = dincl.HalfSpace(-direction, -float(parts.high[0] + 0.1), parts.radii)
    parts.constraints.append(dincl.Moving(wall, lambda t: -speed * np.sin(t) * direction))


def _growing(parts: SceneParts) -> None:
    if len(parts.x) > 1:
        rate, radii = parts.rng.uniform(0.02, 0.1) * (parts.spacing - 1), parts.radii
        parts.constraints[0] = dincl.NonOverlap(lambda t: radii * (1 + rate * t))


def _thread(parts: SceneParts) -> None:
    if len(parts.x) > 2:
        order = np.argsort(parts.x[:, 0])[: min(len(parts.x), int(parts.rng.integers(2, 7)))]
        pairs = np.column_stack((order[:-1], order[1:]))
        apart = np.linalg.norm(parts.x[pairs[:, 0]] - parts.x[pairs[:, 1]], axis=1)
        parts.constraints.append(dincl.MaxDistance(pairs, apart + parts.rng.uniform(0.0, 0.2)))


def _obstacle(parts: SceneParts) -> None:
    centre = parts.low - 2.0
    nearest = np.linalg.norm(parts.x - centre, axis=1).min()
    parts.constraints.append(dincl.OutsideBall(centre, float(nearest - parts.rng.uniform(0.05, 0.5))))


def _goal(parts: SceneParts) -> Array:
    """Draw a point below the centre, inside of what the particles cover."""
    size = np.ptp(parts.x, axis=0).max() if len(parts.x) > 1 else 1.0
    goal: Array = parts.x.mean(axis=0) - 0.5 * size * parts.rng.uniform() * parts.axis(-1)
    return goal


def _attraction(parts: SceneParts) -> Any:
    return dincl.drifts.attraction(tuple(_goal(parts)))


def _gravity(parts: SceneParts) -> Any:
    return dincl.drifts.constant(-parts.axis(-1) + parts.rng.uniform(-0.3, 0.3, parts.x.shape))


def _swirl(parts: SceneParts) -> Any:
    goal, turn = _goal(parts), -0.8 * np.eye(parts.x.shape[1])
    turn[0, 1], turn[1, 0] = -1.0, 1.0
    return lambda t, x: (x - goal) @ turn.T


def _rough(parts: SceneParts) -> Any:
    goal, sideways = _goal(parts), parts.axis(0)
    return lambda t, x: -0.5 * np.sign(np.sin(5 * t)) * sideways - 0.5 * np.clip(x - goal, -1.0, 1.0)


def _waves(parts: SceneParts) -> Any:
    goal = _goal(parts)
    return lambda t, x: -(1 + 0.5 * np.cos(3 * t)) * (x - goal)


SETS: Mapping[str, Callable[[SceneParts], None]] = {
    "floor": _floor,
    "corner": _corner,
    "container": _container,
    "moving wall": _moving_wall,
    "growing": _growing,
    "thread": _thread,
    "obstacle": _obstacle,
}
DRIFTS: Mapping[str, Callable[[SceneParts], Any]] = {
    "attraction": _attraction,
    "gravity": _gravity,
    "swirl": _swirl,
    "rough": _rough,
    "waves": _waves,
}
