"""Random scenes: discs and balls in five layouts, with sets at rest and in motion, and drifts of six kinds."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

import dincl

Array = NDArray[np.float64]
Random = np.random.Generator
# Positions (n, d) [length], radii (n,), velocities without contacts (n, d) [length / time].
Layout = tuple[Array, Array, Array]
MOST_PARTICLES, FEW = 300, 60
# Exponents of the error that is asked for [length], and bounds of the end of a run [time].
ERRORS, ENDS = (-5.0, -1.5), (0.5, 3.0)
# Radii grow to at most this multiple of the first ones; closed sets leave at least so much room.
GROWN = 1.05
# Beside the seed of a scene, so that its numbers are not those that others draw with the same seed.
STREAM = 62


@dataclass(frozen=True)
class RandomScene:
    """A problem with its output times, the error that is asked for, its least radius, and the names of its parts."""

    problem: dincl.Problem
    t: Array
    error: float
    radius: float
    layout: str
    sets: str
    drift: str


def scene(seed: int) -> RandomScene:
    """Draw the scene of a seed."""
    rng = np.random.default_rng([seed, STREAM])
    layout, drift = str(rng.choice(list(LAYOUTS))), str(rng.choice(list(DRIFTS)))
    parts = Parts(rng, *LAYOUTS[layout](rng, int(rng.choice([1, 2, 2, 2, 3, 3]))))
    if rng.random() < 0.4:
        outer = [rng.choice(list(CLOSED))]
    elif layout == "tube":
        outer = ["channel", rng.choice(list(PUSHING))]
    else:
        outer = [*rng.permutation(list(OPEN | PUSHING))[: rng.integers(1, 3)]]
    names = sorted(str(name) for name in (*outer, *rng.permutation(list(EXTRA))[: rng.integers(0, 2)]))
    sets = [one for name in names for one in SETS[name](parts)]
    if "growing" not in names:
        sets.append(dincl.NonOverlap(parts.radii))
    problem = dincl.Problem(parts.x, DRIFTS[drift](parts), sets)
    t = rng.uniform(*ENDS) * np.cumsum(rng.dirichlet(np.full(rng.integers(2, 7), 3.0)))
    error, radius = float(10 ** rng.uniform(*ERRORS)), float(parts.radii.min())
    return RandomScene(problem, t, error, radius, layout, ", ".join(names), drift)


class Parts:
    """A layout to draw sets and drifts for: ``low`` and ``high`` (d,) enclose all particles."""

    def __init__(self, rng: Random, x: Array, radii: Array, flow: Array) -> None:
        self.rng, self.x, self.radii, self.flow, self.d = rng, x, radii, flow, x.shape[1]
        self.low, self.high = (x - radii[:, None]).min(axis=0), (x + radii[:, None]).max(axis=0)
        self.centre, sides = (self.low + self.high) / 2, self.high - self.low
        self.long, self.thick = float(sides.max()), float(sides.min())
        self.goal = self.centre + 0.3 * rng.uniform(-1.0, 1.0, self.d) * sides
        self.rate = float(rng.uniform(1.0, 4.0))
        # The first axis, and the vertical one.
        self.across, self.up = np.eye(self.d)[0], np.eye(self.d)[-1]

    def wall(self, normal: Array, room: float) -> dincl.HalfSpace:
        """Return a wall at a distance ``room`` from the nearest particle, with a unit normal."""
        return dincl.HalfSpace(normal, float((self.x @ normal - self.radii).min() - room), self.radii)


# Layouts. The largest radius is at most 0.5.


def _radii(rng: Random, most: int) -> Array:
    """Draw radii of one particle to ``most``: equal, of two sizes, or in a ratio of up to three."""
    n = round(float(np.exp(rng.uniform(0.0, np.log(most)))))
    kinds = (np.full(n, 0.5), rng.choice([0.25, 0.5], n), rng.uniform(0.5 / rng.uniform(1.0, 3.0), 0.5, n))
    return kinds[rng.integers(3)]


def _placed(rng: Random, d: int, radii: Array) -> Array:
    """Place spheres in a cube one after the other, the largest first, where there is room."""
    part = rng.uniform(0.1, (0.55, 0.4, 0.25)[d - 1])
    side = ((radii**d).sum() * (2, np.pi, 4 / 3 * np.pi)[d - 1] / part) ** (1 / d) + 2 * radii.max()
    order, x = np.argsort(-radii), np.empty((len(radii), d))
    for k, i in enumerate(order):
        x[i] = rng.uniform(radii[i], side - radii[i], d)
        while (np.linalg.norm(x[order[:k]] - x[i], axis=1) < 1.001 * (radii[order[:k]] + radii[i])).any():
            x[i] = rng.uniform(radii[i], side - radii[i], d)
    return x


def _falling(rng: Random, n: int, d: int) -> Array:
    falling: Array = rng.uniform(-0.3, 0.3, (n, d)) - np.eye(d)[-1]
    return falling


def scattered(rng: Random, d: int) -> Layout:
    """Scatter falling particles."""
    radii = _radii(rng, MOST_PARTICLES)
    return _placed(rng, d, radii), radii, _falling(rng, len(radii), d)


def pile(rng: Random, d: int) -> Layout:
    """Stack rows of a hexagonal lattice, or layers of it, with gaps of up to 0.15 diameters."""
    radii, gap = _radii(rng, MOST_PARTICLES), rng.uniform(0.002, 0.15)
    n = len(radii)
    wide = n if d == 1 else int(np.ceil(rng.uniform(0.7, 1.5) * n ** (1 / d)))
    deep = wide if d == 3 else 1
    i, j, k = np.arange(n) % wide, np.arange(n) // wide % deep, np.arange(n) // (wide * deep)
    if d == 3:
        lattice = [i + (j + k) % 2 / 2, np.sqrt(3) / 2 * (j + k % 2 / 3), np.sqrt(2 / 3) * k]
    else:
        lattice = [i + k % 2 / 2, np.sqrt(3) / 2 * k][:d]
    shifts = 0.45 * gap * rng.uniform(-1.0, 1.0, (n, d)) / np.sqrt(d)
    return (1 + gap) * np.column_stack(lattice) + shifts, radii, _falling(rng, n, d)


def tube(rng: Random, d: int) -> Layout:
    """Line up particles of different speeds along the first axis, each a little aside."""
    radii = _radii(rng, FEW)
    along = np.cumsum(radii + np.append(0.0, radii[:-1]) + rng.uniform(0.0, 0.5, len(radii)))
    x = np.column_stack((along, 0.3 * rng.uniform(-1.0, 1.0, (len(radii), d - 1)) * radii[:, None]))
    flow = rng.uniform(-0.5, 1.5, (len(radii), 1)) * np.eye(d)[0]
    return x, radii, flow + rng.uniform(-0.1, 0.1, x.shape)


def clouds(rng: Random, d: int) -> Layout:
    """Drive two clouds into each other."""
    parts = [_radii(rng, MOST_PARTICLES // 2) for _ in range(2)]
    x, along = [_placed(rng, d, radii) for radii in parts], np.eye(d)[0]
    x[1] += (x[0][:, 0].max() + 0.5 + rng.uniform(0.0, 0.2)) * along
    speeds = np.repeat(rng.uniform(0.5, 1.5, 2) * (1, -1), [len(one) for one in x])
    flow = speeds[:, None] * along + rng.uniform(-0.5, 0.5, (len(speeds), d))
    return np.concatenate(x), np.concatenate(parts), flow


def fast(rng: Random, d: int) -> Layout:
    """Aim small particles at each other in pairs, at speeds of 1 to 3; some fly on and touch others."""
    pairs = round(float(np.exp(rng.uniform(0.0, np.log(20)))))
    radii = 10 ** rng.uniform(-3.0, -1.3) * rng.uniform(0.4, 1.0, 2 * pairs)
    way = rng.normal(size=(pairs, d))
    way *= 0.15 / np.linalg.norm(way, axis=1, keepdims=True)
    middle = _placed(rng, d, np.full(pairs, 0.2))
    x = np.concatenate((middle - way, middle + way))
    target = np.concatenate((middle, middle)) + 0.4 * rng.uniform(-1.0, 1.0, x.shape) * radii[:, None]
    return x, radii, rng.uniform(1.0, 3.0, (2 * pairs, 1)) * (target - x) / 0.15


# Sets. Open ones leave a way out; in closed ones all particles have room, also ``GROWN`` times as large.


def floor(of: Parts) -> list[Any]:
    """Put a floor below, which may tilt to and fro; on the line it goes up and down."""
    wall, angle = of.wall(of.up, 0.2 * of.rng.uniform()), of.rng.uniform(-0.5, 0.5) / of.long
    turn = angle if of.d == 2 else angle * np.eye(3)[1]
    up_and_down: Any = lambda t: 0.1 * np.sin(of.rate * t) * of.up  # noqa: E731
    tilt = dincl.RigidMotion(lambda t: turn * np.sin(of.rate * t), centre=of.centre)
    return [wall if of.rng.random() < 0.5 else dincl.Moving(wall, up_and_down if of.d == 1 else tilt)]


def wedge(of: Parts) -> list[Any]:
    """Stand the particles in a wedge that opens upwards."""
    angle = of.rng.uniform(0.1, 1.2) if of.d > 1 else np.pi / 2
    normals = (side * np.cos(angle) * of.across + np.sin(angle) * of.up for side in (1, -1))
    return [of.wall(normal, of.rng.uniform(0.0, 0.3)) for normal in normals]


def obstacle(of: Parts) -> list[Any]:
    """Put a ball below the particles."""
    size = of.rng.uniform(0.1, 0.5) * of.thick
    centre = of.goal - (of.goal[-1] - of.low[-1] + size + 0.02) * of.up
    return [dincl.OutsideBall(centre, size + of.radii)]


def rod(of: Parts) -> list[Any]:
    """Drive a ball through the particles, from the side."""
    size, way = of.rng.uniform(0.05, 0.3) * of.thick, of.rng.uniform(0.2, 1.0) * of.across
    start = of.goal - (of.goal[0] - of.low[0] + size + 0.02) * of.across
    return [dincl.OutsideBall(lambda t: start + t * way, size + of.radii)]


def piston(of: Parts) -> list[Any]:
    """Push the particles aside by a wall."""
    way = of.rng.uniform(0.05, 0.5) * of.across
    return [dincl.Moving(of.wall(of.across, 0.1), lambda t: t * way)]


def shaker(of: Parts) -> list[Any]:
    """Hit the particles from below, again and again: the speed of the wall jumps."""
    height = of.rng.uniform(0.05, 0.2)
    low = of.wall(of.up, height + 0.05).offset
    return [dincl.HalfSpace(of.up, lambda t: low + height * np.abs(np.sin(of.rate * t)), of.radii)]


def channel(of: Parts) -> list[Any]:
    """Guide the particles along the first axis by walls at the sides."""
    room = of.rng.uniform(0.0, 0.3)
    return [of.wall(sign * axis, room) for axis in np.eye(of.d)[1:] for sign in (1, -1)]


def box(of: Parts) -> list[Any]:
    """Enclose the particles by walls at rest, or by walls that are shaken or, in the plane and in space, turned."""
    room = (GROWN - 1) * of.long + of.rng.uniform(0.0, 0.3)
    walls = [of.wall(sign * axis, room) for axis in np.eye(of.d) for sign in (1, -1)]
    turn = 0.6 * of.rate / of.long * (1 if of.d == 2 else np.array([0.2, 0.4, 0.9]))
    turned = dincl.RigidMotion(lambda t: t * turn, centre=of.centre)
    shaken: Any = lambda t: 0.2 * np.sin(of.rate * t) * of.across  # noqa: E731
    kind = of.rng.integers(2 if of.d == 1 else 3)
    return walls if kind == 0 else [dincl.Moving(wall, shaken if kind == 1 else turned) for wall in walls]


def container(of: Parts) -> list[Any]:
    """Enclose the particles by a ball that contracts and widens."""
    far = GROWN * float((np.linalg.norm(of.x - of.centre, axis=1) + of.radii).max())
    room = of.rng.uniform(0.0, 0.3)
    return [dincl.InsideBall(of.centre, lambda t: far + room * np.cos(of.rate * t) ** 2 - of.radii)]


def ellipse(of: Parts) -> list[Any]:
    """Keep the centres of a few particles in an ellipsoid, which is given by its function; of many, in a ball."""
    if len(of.x) > FEW:
        return container(of)
    axes = of.high - of.low + 0.2
    axes *= GROWN * max(np.linalg.norm((of.x - of.centre) / axes, axis=1).max(), 0.3)
    each, centre = np.eye(len(of.x))[:, :, None], of.centre
    return [
        dincl.Smooth(lambda x: 1 - (((x - centre) / axes) ** 2).sum(1), lambda x: -2 * each * (x - centre) / axes**2)
    ]


def thread(of: Parts) -> list[Any]:
    """Tie up to 12 neighbours to a thread."""
    if len(of.x) == 1:
        return []
    chain, rest = [0], set(range(1, len(of.x)))
    while rest and len(chain) < 12:
        chain.append(min(rest, key=lambda i: float(np.linalg.norm(of.x[i] - of.x[chain[-1]]))))
        rest.remove(chain[-1])
    pairs = np.column_stack((chain[:-1], chain[1:]))
    lengths = of.rng.uniform(1.0, 1.2) * np.linalg.norm(of.x[pairs[:, 0]] - of.x[pairs[:, 1]], axis=1)
    return [dincl.MaxDistance(pairs, lengths)]


def ordered(of: Parts) -> list[Any]:
    """Keep the order of up to 8 particles along the first axis."""
    chain = of.rng.permutation(len(of.x))[:8]
    return [dincl.Ordered(chain[np.argsort(of.x[chain, 0])], 0)] if len(chain) > 1 else []


def growing(of: Parts) -> list[Any]:
    """Let the radii grow, ``GROWN`` times at most until the longest run ends."""
    rate = (GROWN - 1) * of.rng.uniform(0.2, 1.0) / ENDS[1]
    return [dincl.NonOverlap(lambda t: of.radii * (1 + rate * t))]


# Drifts, around the flow of the layout.


def constant(of: Parts) -> Any:
    """Flow."""
    return dincl.drifts.constant(of.flow)


def affine(of: Parts) -> Any:
    """Attract to a point, at a rate of each particle, and turn about it in the plane."""
    pull = dincl.drifts.attraction(of.goal, of.rng.uniform(0.2, 1.0, len(of.x))) + dincl.drifts.constant(0.5 * of.flow)
    return pull + dincl.drifts.swirl(of.goal, of.rng.uniform(-1.0, 1.0)) if of.d == 2 else pull


def waves(of: Parts) -> Any:
    """Flow in waves of time and space."""
    return lambda t, x: (1 + 0.5 * np.cos(of.rate * t)) * of.flow + 0.4 * np.sin(x[:, ::-1] + of.rate * t)


def kinked(of: Parts) -> Any:
    """Begin to flow, and attract at a bounded speed: functions with kinks."""
    pull: Any = lambda t, x: np.abs(np.sin(of.rate * t)) * np.clip(of.goal - x, -0.5, 0.5)  # noqa: E731
    return lambda t, x: min(of.rate * t, 1.0) * of.flow + pull(t, x)


def square_waves(of: Parts) -> Any:
    """Flow forwards and backwards, and jump from side to side."""
    side: Any = lambda t: 0.4 * np.sign(np.sin(1.3 * of.rate * t)) * of.across  # noqa: E731
    return lambda t, x: (1.0 if of.rate * t % 2.0 < 1.4 else -0.4) * of.flow + side(t)


def belts(of: Parts) -> Any:
    """Slow down behind a plane: a jump in space."""
    way = of.flow.mean(axis=0)
    return lambda t, x: of.flow * np.where((x - of.goal) @ way < 0.0, 1.0, 0.4)[:, None]


def _by_name(*functions: Callable[..., Any]) -> dict[str, Callable[..., Any]]:
    return {one.__name__.replace("_", " "): one for one in functions}


LAYOUTS = _by_name(scattered, pile, tube, clouds, fast)
OPEN, PUSHING = _by_name(floor, wedge, obstacle, shaker), _by_name(rod, piston)
CLOSED, EXTRA = _by_name(box, container, ellipse), _by_name(thread, ordered, growing)
SETS = OPEN | PUSHING | CLOSED | EXTRA | _by_name(channel)
DRIFTS = _by_name(constant, affine, waves, kinked, square_waves, belts)
