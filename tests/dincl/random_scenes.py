"""Random scenes of every kind of set and drift, each made from its seed alone: what a run must not lose."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

import dincl
from tests.dincl.own_constraints import InEllipse, InEllipseByRows


class RandomScene(NamedTuple):
    """A problem, and how its parts are called."""

    problem: dincl.Problem
    words: str


def random_scene(seed: int) -> RandomScene:
    """1 to 30 particles in 1 to 3 dimensions, some in contact at the start, among one to four kinds of sets."""
    rng = np.random.default_rng(seed)
    d = int(rng.integers(1, 4))
    n = int(rng.integers(1, 31)) if rng.random() < 0.5 else int(rng.integers(1, 9))
    radius = rng.uniform(0.3, 0.6, n) if rng.random() < 0.8 else np.full(n, 0.5)
    x0 = _places(rng, radius, d)
    kind = str(rng.choice(list(DRIFTS)))
    names = rng.choice(list(SETS), size=int(rng.integers(1, 5)), replace=False)
    sets = [one for name in sorted(names) for one in SETS[name](rng, x0, radius)]
    problem = dincl.Problem(x0, DRIFTS[kind](rng, n, d), sets)
    return RandomScene(problem, f"seed {seed}: {n} in R^{d}, {kind}, {', '.join(sorted(names))}")


def _places(rng: np.random.Generator, radius: np.ndarray, d: int) -> np.ndarray:
    """Discs one by one where there is room, every third one against another."""
    places, size = [], 1.1 * len(radius) ** (1 / d)
    while len(places) < len(radius):
        k = len(places)
        place = size * rng.uniform(-1, 1, d)
        if k and rng.random() < 0.33:
            j, way = int(rng.integers(k)), rng.normal(size=d)
            place = places[j] + (radius[k] + radius[j]) * way / np.linalg.norm(way)
        if all(np.linalg.norm(place - other) >= radius[k] + radius[j] - 1e-15 for j, other in enumerate(places)):
            places.append(place)
        size *= 1.01
    return np.array(places)


def _drawn(rng, n, d):
    weights = rng.uniform(0.5, 1.5, n)[:, None]
    return lambda t, x: -weights * x


def _stirred(rng, n, d):
    turn = rng.normal(size=(d, d))
    turn = turn - turn.T - 0.5 * np.eye(d)
    return lambda t, x: x @ turn


def _shaken(rng, n, d):
    direction, rate = rng.normal(size=(n, d)), rng.uniform(2, 8)
    return lambda t, x: np.sin(rate * t) * direction - 0.5 * x


def _constant(rng, n, d):
    direction = rng.normal(size=d) + (rng.normal(size=(n, d)) if rng.random() < 0.5 else 0.0)
    return lambda t, x: np.zeros_like(x) + direction


DRIFTS: dict[str, Callable] = {"drawn": _drawn, "stirred": _stirred, "shaken": _shaken, "constant": _constant}


def _discs(rng, x0, radius):
    if rng.random() < 0.7:
        return [dincl.NonOverlap(radius)]
    among = rng.permutation(len(x0))[: max(1, len(x0) // 2)]
    return [dincl.NonOverlap(radius[among], among=among)]


def _wall(rng, x0, radius, least=0.0):
    normal = rng.normal(size=x0.shape[1])
    normal /= np.linalg.norm(normal)
    kept = radius if rng.random() < 0.5 else np.zeros(len(x0))
    slack = least + (rng.uniform(0, 0.5) if rng.random() < 0.7 else 0.0)
    return dincl.HalfSpace(normal, (x0 @ normal - kept).min() - slack, kept)


def _walls(rng, x0, radius):
    return [_wall(rng, x0, radius) for _ in range(int(rng.integers(1, 4)))]


def _moving(rng, x0, radius):
    way, rate = rng.normal(size=x0.shape[1]), rng.uniform(1, 6)
    return [dincl.Moving(_wall(rng, x0, radius), lambda t: np.sin(rate * t) * way)]


def _links(rng, x0, radius):
    count = len(x0)
    if count < 2:
        return []
    pairs = [(k, k + 1) for k in range(count - 1)]
    pairs += [tuple(rng.choice(count, 2, replace=False)) for _ in range(count // 4)]
    apart = np.array([np.linalg.norm(x0[i] - x0[j]) for i, j in pairs])
    return [dincl.MaxDistance(pairs, apart * rng.choice([1.0, 1.05, 1.3], len(pairs)))]


def _chain(rng, x0, radius):
    axis = int(rng.integers(x0.shape[1]))
    chain = np.argsort(x0[:, axis])[:: int(rng.integers(1, 3))]
    return [dincl.Ordered(chain, axis)]


def _container(rng, x0, radius):
    return [dincl.InsideBall(np.zeros(x0.shape[1]), np.linalg.norm(x0, axis=1).max() * rng.choice([1.0, 1.2]) + 1e-3)]


def _obstacle(rng, x0, radius):
    for _ in range(100):
        centre = np.abs(x0).max() * rng.uniform(-1, 1, x0.shape[1])
        room = np.linalg.norm(x0 - centre, axis=1) - 0.3 * radius
        if room.min() > 0.1:
            return [dincl.OutsideBall(centre, 0.3 * radius + room.min() * rng.choice([0.7, 1.0 - 1e-12]))]
    return []


def _axes(rng, x0):
    axes = rng.uniform(0.7, 1.3, x0.shape[1])
    return axes * np.sqrt(((x0 / axes) ** 2).sum(axis=1).max()) * rng.choice([1.0 + 1e-12, 1.1]) + 1e-3


def _smooth(rng, x0, radius):
    own = InEllipse(tuple(_axes(rng, x0)))
    return [dincl.Smooth(own.values, own.jacobian)]


def _own(rng, x0, radius):
    return [InEllipseByRows(tuple(_axes(rng, x0)))]


def _moving_own(rng, x0, radius):
    way, rate = 0.3 * rng.normal(size=x0.shape[1]), rng.uniform(1, 4)
    return [dincl.Moving(InEllipseByRows(tuple(_axes(rng, x0))), lambda t: np.sin(rate * t) * way)]


SETS: dict[str, Callable] = {
    "discs": _discs,
    "walls": _walls,
    "moving wall": _moving,
    "links": _links,
    "chain": _chain,
    "container": _container,
    "obstacle": _obstacle,
    "smooth": _smooth,
    "own rows": _own,
    "moving own rows": _moving_own,
}
