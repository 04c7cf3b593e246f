"""Problems that are hard for a method that goes from event to event, each made from its seed alone.

Their drifts and walls are smooth between known times, so that a reference can be put together from smooth parts: a run
that is compared with it has to find these times by itself.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

import dincl
from verification.methods.hard.scenes import HardScene

Floats = NDArray[np.float64]
Random = np.random.Generator
Signal = Callable[[float], float]
# Places (N, d), the sets for a length and a path, the steady part of the drift and the one that a signal drives.
Family = tuple[Any, Callable[[float, Signal], list[Any]], tuple[Callable[[Floats], Any], Callable[[Floats], Any]]]


@dataclass(frozen=True)
class Pieces:
    """A function of time with the values of ``parts[k]`` from ``breaks[k - 1]`` to ``breaks[k]``."""

    breaks: tuple[float, ...]
    parts: tuple[Signal, ...]

    def __call__(self, t: float) -> float:
        return self.parts[int(np.searchsorted(self.breaks, t, side="right"))](t)

    def after(self, t: float) -> Signal:
        """The part that holds from t on, continued over all times."""
        return self.parts[int(np.searchsorted(self.breaks, t, side="right"))]


@dataclass(frozen=True)
class HardProblem:
    """A problem; ``build(x0, signal, path, start)`` makes it, or a part of it."""

    words: str
    x0: Floats
    build: Callable[..., dincl.Problem]
    signal: Pieces
    path: Pieces
    end: float
    scale: float
    tol: float

    @property
    def problem(self) -> dincl.Problem:
        """The problem as a user would state it."""
        return self.build(self.x0, self.signal, self.path)

    def solved_in_parts(self, times: Sequence[float], tol: float) -> tuple[Floats, float]:
        """States at ``times`` (K,) from smooth parts, with a bound of the sum of their stated errors, or inf."""
        breaks = sorted({b for b in (*self.signal.breaks, *self.path.breaks) if 0 < b < self.end})
        found: list[Floats] = []
        x, error, start = self.x0, 0.0, 0.0
        for stop in (*breaks, self.end):
            kept = [t for t in times if start < t < stop]
            for path in (self.path.after(start), self.path):  # at its end a smooth part may leave no room
                problem = self.build(x, self.signal.after(start), path, start)
                run = dincl.solve(problem, dincl.EventDriven(tol), np.array([*kept, stop]) - start, throw=False)
                if run.status:
                    break
            else:
                return np.zeros(0), np.inf
            found += list(run.x[:-1])
            x, error, start = run.final, error + float(np.asarray(run.error).max()), stop
            found += [x] if stop in times else []
        return np.array(found), error


def hard_problem(seed: int) -> HardProblem:
    """One of eleven families, five kinds of drift, lengths over six decades, tolerances of 1e-3 to 1e-10."""
    rng = np.random.default_rng(seed)
    family = str(rng.choice(list(FAMILIES)))
    kind = str(rng.choice(list(SIGNALS)))
    scale = 10.0 ** rng.uniform(-3, 3)
    end = float(rng.choice([0.7, 1.0, 2.0]))
    tol = 10.0 ** rng.uniform(-10, -3) * scale
    signal, path = SIGNALS[kind](rng, end), Pieces((), (lambda t: 0.0,))
    if family == "squeezing walls":
        path = _stopping(rng, end)
    x0, sets, field = FAMILIES[family](rng)
    steady, driven = field

    def build(x0: Floats, signal: Signal, path: Signal, start: float = 0.0) -> dincl.Problem:
        def drift(t: float, x: Floats) -> Any:
            y = x / scale
            return scale * (steady(y) + signal(start + t) * driven(y))

        return dincl.Problem(x0, drift, sets(scale, lambda t: path(start + t)))

    words = f"seed {seed}: {family}, {kind}, N = {len(x0)}, scale {scale:.2g}, tol {tol / scale:.2g} of it"
    return HardProblem(words, scale * x0, build, signal, path, end, scale, tol)


# Kinds of drift -----------------------------------------------------------------------------------------------------


def _held(value: float) -> Signal:
    return lambda t: value


def _constant(rng: Random, end: float) -> Pieces:
    return Pieces((), (lambda t: 1.0,))


def _jumping(rng: Random, end: float) -> Pieces:
    after = rng.uniform(-2, 1)
    return Pieces((end * rng.uniform(0.05, 0.95),), (lambda t: 1.0, lambda t: after))


def _square(rng: Random, end: float) -> Pieces:
    count = int(rng.integers(2, 9))
    first, period = rng.uniform(0, 1), end / count
    breaks = tuple(float((first + k) * period) for k in range(count))
    return Pieces(breaks, tuple(_held((-1.0) ** k) for k in range(count + 1)))


def _cosine(rng: Random, end: float) -> Pieces:
    rate, phase = rng.uniform(1, 12), rng.uniform(0, 6)
    return Pieces((), (lambda t: float(np.cos(rate * t + phase)),))


def _ramp(rng: Random, end: float) -> Pieces:
    a, slope = end * rng.uniform(0.1, 0.9), rng.uniform(-4, 4)
    return Pieces((a,), (lambda t: 0.5, lambda t: 0.5 + slope * (t - a)))


SIGNALS = {"constant": _constant, "jumping": _jumping, "square": _square, "cosine": _cosine, "ramp": _ramp}


# Families -----------------------------------------------------------------------------------------------------------


def _turn(y: Floats) -> Any:
    return y[:, ::-1] * np.array([1.0, -1.0])


def _hexagonal(rng: Random) -> Family:
    rings = int(rng.integers(1, 3))
    cells = [(i + 0.5 * j, np.sqrt(0.75) * j) for i in range(-4, 5) for j in range(-4, 5)]
    x0 = np.array([c for c in cells if np.hypot(*c) <= rings + 1e-9])
    weights, spin = 1 + rng.choice([0, 1e-9, 1e-3, 0.5]) * rng.random((len(x0), 1)), rng.uniform(-1, 1)
    return x0, lambda s, p: [dincl.NonOverlap(0.5 * s)], (lambda y: spin * _turn(y), lambda y: -weights * y)


def _simultaneous(rng: Random) -> Family:
    n, far = int(rng.integers(3, 9)), rng.uniform(1.5, 3)
    angles = 2 * np.pi * np.arange(n) / n
    x0 = far * np.column_stack((np.cos(angles), np.sin(angles))) / min(1, 2 * np.sin(np.pi / n))
    speed = rng.uniform(1, 4)
    return (
        x0,
        lambda s, p: [dincl.NonOverlap(0.5 * s)],
        (lambda y: -0.3 * y, lambda y: -speed * y / np.linalg.norm(y, axis=1, keepdims=True).clip(1e-3)),
    )


def _grazing(rng: Random) -> Family:
    height = 1 + rng.choice([-1, 1]) * 10.0 ** rng.uniform(-12, -2)
    x0 = np.array([[-1.2, height], [1.2, -height]])
    way = np.array([[1.0, 0.0], [-1.0, 0.0]]) * rng.uniform(1, 3)
    return x0, lambda s, p: [dincl.OutsideBall((0, 0), s)], (lambda y: 0 * y, lambda y: way + 0 * y)


def _wedge(rng: Random) -> Family:
    angle, n = rng.uniform(0.1, 1.4), int(rng.integers(1, 5))
    normals = [(np.sin(angle), np.cos(angle)), (-np.sin(angle), np.cos(angle))]
    radius = 10.0 ** rng.uniform(-1.5, -0.3, n)
    x0 = np.column_stack((rng.uniform(-0.3, 0.3, n), 4 + 1.2 * np.arange(n)))
    way = np.array([rng.normal(), -3.0])

    def sets(s: float, p: Signal) -> list[Any]:
        return [dincl.NonOverlap(radius * s), *(dincl.HalfSpace(normal, 0.0, radius * s) for normal in normals)]

    return x0, sets, (lambda y: -0.2 * y, lambda y: way + 0 * y)


def _sliding(rng: Random) -> Family:
    n = int(rng.integers(2, 6))
    x0 = np.column_stack((1.1 * np.arange(n), np.full(n, 0.5)))
    way = np.column_stack((rng.normal(size=n), -rng.random(n)))
    place = (1.1 * n + 0.6, 0.4)

    def sets(s: float, p: Signal) -> list[Any]:
        obstacle = dincl.OutsideBall((place[0] * s, place[1] * s), 0.6 * s)
        return [dincl.NonOverlap(0.5 * s), dincl.HalfSpace((0, 1), 0.0, 0.5 * s), obstacle]

    return x0, sets, (lambda y: np.array([0.5, 0.0]) - 0.1 * y, lambda y: 2 * way + 0 * y)


def _stiff(rng: Random) -> Family:
    k, n = 10.0 ** rng.uniform(1, 2.3), int(rng.integers(2, 5))
    x0 = np.column_stack((1.05 * np.arange(n), 0.1 * rng.normal(size=n)))
    place = rng.normal(size=2)
    return x0, lambda s, p: [dincl.NonOverlap(0.5 * s)], (lambda y: -k * y, lambda y: 0.3 * k * place + 0 * y)


def _chain(rng: Random) -> Family:
    n = int(rng.integers(3, 8))
    x0 = np.column_stack((0.9 * np.arange(n), 0.3 * rng.normal(size=n)))
    links = [(i, i + 1) for i in range(n - 1)]
    doubled = [*links, *links[: n // 2], *((i, i + 2) for i in range(n - 2))]
    length = np.array([np.linalg.norm(x0[i] - x0[j]) * rng.uniform(1, 1.2) for i, j in doubled])
    length[len(links) : len(links) + n // 2] = length[: n // 2]
    way = 2 * rng.normal(size=(n, 2))
    return x0, lambda s, p: [dincl.MaxDistance(doubled, length * s)], (lambda y: -0.3 * y, lambda y: way + 0 * y)


def _squeezed(rng: Random) -> Family:
    n, gap = int(rng.integers(1, 5)), rng.choice([0.05, 0.2, 0.5])
    x0 = (0.5 + (1 + gap) * np.arange(n))[:, None]
    width, spare = x0[-1, 0] + 0.5 + gap, float(rng.choice([0.0, 0.0, 0.1, 0.5]))
    depth = max(gap * n - spare * gap, 0.0)
    speed = rng.normal(size=(n, 1))

    def sets(s: float, p: Signal) -> list[Any]:
        left = dincl.Moving(dincl.HalfSpace([1.0], 0.0, 0.5 * s), lambda t: [s * depth * p(t)])
        return [dincl.NonOverlap(0.5 * s), dincl.HalfSpace([-1.0], -width * s, 0.5 * s), left]

    return x0, sets, (lambda y: -0.2 * y, lambda y: speed + 0 * y)


def _stopping(rng: Random, end: float) -> Pieces:
    """From 0 to 1, and at rest from then on."""
    stop, kind = end * rng.uniform(0.3, 0.9), rng.random() < 0.5
    return Pieces((stop,), ((lambda t: t / stop) if kind else (lambda t: (t / stop) ** 2), lambda t: 1.0))


def _releases(rng: Random) -> Family:
    n, power = int(rng.integers(2, 7)), int(rng.choice([1, 3]))
    x0 = (np.arange(n) + 0.5)[:, None]
    spread = 1 + 10.0 ** rng.uniform(-11, -1) * rng.normal(size=(n, 1))
    rate = rng.uniform(-2, 2) * spread

    def sets(s: float, p: Signal) -> list[Any]:
        return [dincl.NonOverlap(0.5 * s), dincl.HalfSpace([1.0], 0.0, 0.5 * s)]

    return x0, sets, (lambda y: 0 * y, lambda y: rate * (1 + 0 * y) ** power)


def _room(rng: Random) -> Family:
    n, d = int(rng.integers(2, 9)), 2
    radius = 10.0 ** rng.uniform(-2, -0.4, n) if rng.random() < 0.5 else rng.uniform(0.3, 0.5, n)
    places: list[Floats] = []
    size = 1.1 * np.sqrt(n)
    while len(places) < n:
        place = size * rng.uniform(-1, 1, d)
        if all(np.linalg.norm(place - q) > radius[len(places)] + r for q, r in zip(places, radius, strict=False)):
            places.append(place)
        size *= 1.01
    x0 = np.array(places)
    normals = rng.normal(size=(3, d))
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    offsets = [(x0 @ normal - radius).min() - 0.2 * rng.random() for normal in normals]
    way, weights = 2 * rng.normal(size=(n, d)), rng.uniform(0.5, 1.5, (n, 1))

    def sets(s: float, p: Signal) -> list[Any]:
        walls = [dincl.HalfSpace(a, b * s, radius * s) for a, b in zip(normals, offsets, strict=True)]
        return [dincl.NonOverlap(radius * s), *walls]

    return x0, sets, (lambda y: -weights * y, lambda y: way + _turn(y))


def _slow_release(rng: Random) -> Family:
    """Pressed together by a force that falls through zero slowly: relative speeds far below the largest one."""
    n = int(rng.integers(2, 6))
    x0 = (np.arange(n) + 0.5)[:, None]
    small = 10.0 ** rng.uniform(-11, -6) * np.arange(n)[::-1, None]
    return (
        x0,
        lambda s, p: [dincl.NonOverlap(0.5 * s), dincl.HalfSpace([1.0], 0.0, 0.5 * s)],
        (lambda y: 0.2 + small + 0 * y, lambda y: 1 + small + 0 * y),
    )


FAMILIES = {
    "hexagonal": _hexagonal,
    "simultaneous": _simultaneous,
    "grazing": _grazing,
    "wedge": _wedge,
    "sliding": _sliding,
    "stiff": _stiff,
    "chain": _chain,
    "squeezing walls": _squeezed,
    "releases": _releases,
    "slow release": _slow_release,
    "room": _room,
}


def drawn(seed: int) -> HardScene:
    """Return ``hard_problem`` at eight times, with its solution in parts; InvalidProblem if none is exact enough."""
    hard = hard_problem(seed)
    t = np.linspace(0, hard.end, 9)[1:]
    for tol in (1e-12 * hard.scale, min(1e-2 * hard.tol, 1e-8 * hard.scale)):
        exact, bound = hard.solved_in_parts(t.tolist(), tol)
        if np.isfinite(bound):
            return HardScene(hard.problem, t, exact, None, (hard.tol / hard.scale,), bound / hard.scale, hard.scale)
    raise dincl.InvalidProblem(f"{hard.words}: no solution in parts")
