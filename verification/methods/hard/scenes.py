"""Scenes in which contacts begin, end or depend on each other all at once, each with its exact solution.

``SCENES`` maps what is hard -> name -> a function that makes the scene. Lengths are of the size of a particle.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

import dincl
from dincl.drifts import constant

Floats = NDArray[np.float64]
Signal = Callable[[float], Any]
RIGHT = constant((1.0,))
HEXAGON = np.array([[0, 0], *([np.cos(a), np.sin(a)] for a in np.arange(6) * np.pi / 3)])


class HardScene(NamedTuple):
    """A problem, output times, the exact states there (K, N, d), and the kinds of its events if they are counted.

    ``tols`` are tolerances for schemes that state their error; ``bound`` is the error of ``exact``; both, as the errors
    of a run, count in units of ``size`` [length].
    """

    problem: dincl.Problem
    t: ArrayLike
    exact: ArrayLike
    kinds: str | None = None  # c for contact, r for release
    tols: tuple[float, ...] = (1e-4, 1e-10)
    bound: float = 0.0
    size: float = 1.0


def turned(x: Floats, angle: float) -> Floats:
    """Turn points (N, 2) about the origin."""
    c, s = np.cos(angle), np.sin(angle)
    found: Floats = x @ np.array([[c, s], [-s, c]])
    return found


def problem(x0: ArrayLike, drift: Any, *sets: Any, **more: Any) -> dincl.Problem:
    """Return a problem; a drift that is no function is a velocity."""
    return dincl.Problem(x0, drift if callable(drift) else constant(drift), sets, **more)


def wall(path: Signal, normal: Sequence[float] = (1.0,), radius: float = 0.0, **more: Any) -> dincl.Moving:
    """A wall on a path of numbers."""
    return dincl.Moving(dincl.HalfSpace(normal, 0.0, radius, **more), lambda t: path(t) * np.array(normal))


def thrown(d: int, radius: float) -> HardScene:
    """Two small discs at high speed meet in the middle of a run and stop."""
    e = np.eye(d)[0]
    made = problem([-0.5 * e, 0.47 * e], [e, -e], dincl.NonOverlap(radius))
    return HardScene(made, [1.0], [np.outer([-0.015 - radius, -0.015 + radius], e)], "c")


def wedge(angle: float) -> HardScene:
    """A point falls into a wedge and meets both walls at one instant."""
    walls = [dincl.HalfSpace((s * np.cos(angle), np.sin(angle))) for s in (1, -1)]
    return HardScene(problem([[0.0, 1.0]], (0.0, -1.0), *walls), [0.3, 3.0], [[[0.0, 0.7]], [[0.0, 0.0]]], "cc")


def passing(radius: float) -> HardScene:
    """The tangent of a far pair bars a half space: a long step would stop the disc before its partner."""
    start = [[0.0, 3 * radius], [0.5, 0.0]]
    made = problem(start, [[1.0, 0.0], [0.0, 0.0]], dincl.NonOverlap(radius))
    return HardScene(made, [1.0], [[[1.0, 3 * radius], [0.5, 0.0]]], "")


def grazing(height: float) -> HardScene:
    """Met at sin(a) = half left of the top, slid up with a' = -cos(a) for the time artanh(half), left at the top."""
    half = np.sqrt(max(0.0, 1 - (1 + height) ** 2))
    end = [2 + half - np.arctanh(half), max(1 + height, 1.0)]
    made = problem([[-2.0, 1 + height]], (1.0, 0.0), dincl.OutsideBall((0, 0), 1.0))
    return HardScene(made, [4.0], [[end]], "cr" if height < 0 else "")


def corner() -> HardScene:
    """A point slides down a floor inclined by 30 degrees until a wall, which leans over, takes it off the floor."""
    slope, normal = (np.array(v) for v in ([np.cos(np.pi / 6), -0.5], [0.5, np.cos(np.pi / 6)]))
    lean, drift, at = np.array([-np.cos(0.9), np.sin(0.9)]), slope - 0.3 * normal, 0.337 * slope
    made = problem([[0.0, 0.0]], drift, dincl.HalfSpace(normal), dincl.HalfSpace(lean, lean @ at))
    along = drift - (lean @ drift) * lean
    return HardScene(made, [0.3, 0.7, 1.0], [[0.3 * slope]] + [[at + (t - 0.337) * along] for t in (0.7, 1.0)])


def turns(times: Sequence[float]) -> HardScene:
    """A particle is blown to and fro against a wall at 0."""
    made = problem([[0.2]], lambda t, x: [[(-1.0) ** np.searchsorted(times, t, "right")]], dincl.HalfSpace([1.0]))
    x = 0.2
    for k, length in enumerate(np.diff([0.0, *times, 1.5])):
        x = max(x + (-1.0) ** k * length, 0.0)
    return HardScene(made, [1.5], [[[x]]])


def stacked(d: float, n: int) -> HardScene:
    """Under 8 (t - 1/2)^3 (1 + d_i) from t = 1/2 on the faster ones push the others by parts of d."""
    t, z, weight = np.array([0.5, 0.75, 1.0]), np.arange(n)[:, None] + 0.5, 1 + d * np.arange(n)[::-1, None]
    made = problem(z, lambda t, x: 8 * (t - 0.5) ** 3 * weight, dincl.NonOverlap(0.5), dincl.HalfSpace([1.0], 0.0, 0.5))
    return HardScene(made, t, z + 2 * weight.mean() * np.maximum(t - 0.5, 0)[:, None, None] ** 4)


def squeezed(n: int, gap: float, way: float) -> HardScene:
    """A wall pushes n discs against another one, where they just fit, and stops at t = 1/2."""
    x0 = 0.5 + (1 + gap) * np.arange(n)[:, None]
    sets = dincl.HalfSpace([-1.0], -(x0[-1, 0] + 0.5 + gap), 0.5), wall(lambda t: way * min(1.0, 2 * t), radius=0.5)
    made = problem(x0, lambda t, x: 1 + 0.3 * np.cos(4 * t) - 0.2 * x, dincl.NonOverlap(0.5), *sets)
    return HardScene(made, [0.5, 0.75, 1.0], [way + 0.5 + np.arange(n)[:, None]] * 3, None, (1e-6,))


def let_go(low: float) -> HardScene:
    """A push that is negative for a moment, between the parts of a step at which it is looked at."""
    least = 1e-4
    made = problem([[0.0]], lambda t, x: np.full((1, 1), least - (t - low) ** 2), dincl.HalfSpace([1.0]))
    return HardScene(made, [low, 1.0], [[[2 / 3 * least**1.5]], [[0.0]]], "rc")


def there_and_back(way: float) -> HardScene:
    """A step that ends where it began, x = t (1 - t), meets a wall on the way and rests until t = 1/2."""
    made = problem([[0.0]], lambda t, x: np.full((1, 1), 1 - 2 * t), dincl.HalfSpace([-1.0], -way))
    return HardScene(made, [1.0], [[[way - 0.25]]], "cr")


def floor_that_jumps() -> HardScene:
    """Three discs on a floor that jumps to 0.3, then to -1; they fall together and land again."""
    floor = dincl.HalfSpace((1.0,), lambda t: 0.0 if t < 0.2 else 0.3 if t < 0.5 else -1.0, 0.5)
    z, t = 0.5 + np.arange(3.0)[:, None], [0.1, 0.3, 0.6, 1.0, 2.0]
    return HardScene(
        problem(z, (-2.0,), dincl.NonOverlap(0.5), floor), t, [z + low for low in (0.0, 0.3, 0.1, -0.7, -1.0)]
    )


def three_jumps() -> HardScene:
    """A point that slides on a floor leaves it, as a wall and a ball also jump away, until all come back."""
    gone: Signal = lambda t: 0.4 < t <= 1.2  # noqa: E731
    sets = [
        dincl.HalfSpace((0.0, 1.0), lambda t: -7.0 if gone(t) else 0.0),
        dincl.HalfSpace((-1.0, 0.0), lambda t: -7.0 if gone(t) else -0.5),
        dincl.InsideBall((0.0, 0.0), lambda t: 20.0 if gone(t) else 3.0),
    ]
    states = [[[0.45, 0.0]], [[0.5, 0.0]], [[0.6, -0.2]], [[1.3, -1.6]], [[0.5, 0.0]]]
    return HardScene(problem([[0.25, 0.0]], (1.0, -2.0), *sets), [0.2, 0.4, 0.5, 1.2, 1.3], states)


def pulse(width: float) -> HardScene:
    """A wall that strikes once, to 2, in a part of the run."""
    stroke = lambda t: 2.0 * np.exp(-(((t - 0.713) / width) ** 2))  # noqa: E731
    return HardScene(problem([[0.5]], (0.0,), wall(stroke)), [4.0], [[[2.0]]])


def gust(width: float) -> HardScene:
    """A pulse of the drift of area 1."""
    strength: Signal = lambda t: np.exp(-(((t - 0.713) / width) ** 2)) / width / np.sqrt(np.pi)  # noqa: E731
    return HardScene(problem([[0.5]], lambda t, x: 0 * x + strength(t)), [2.0], [[[1.5]]])


def shaker() -> HardScene:
    """A wall that swings to and fro sixteen times carries a point to its farthest place."""
    return HardScene(
        problem([[0.5, 0.0]], (0.0, 0.0), wall(lambda t: 0.6 * np.sin(t), (1, 0))), [100.0], [[[0.6, 0.0]]]
    )


def flying_ball() -> HardScene:
    """A ball flies five hundred of its radii and takes a point along."""
    ball = dincl.OutsideBall(lambda t: (-1.0 + 5.0 * t,), 0.01)
    return HardScene(problem([[0.0]], (0.0,), ball), [1.0], [[[4.01]]], "c")


def bead() -> HardScene:
    """It falls inside of an ellipse and comes to rest where the normal (x/2, 2y) is the drift (1, 0.3)."""
    inside = dincl.Smooth(lambda x: 1 - x[:, 0] ** 2 / 4 - x[:, 1] ** 2)
    return HardScene(
        problem([[0.1, 0.2]], (1.0, 0.3), inside), [60.0], [np.array([[2.0, 0.15]]) / np.sqrt(1.0225)], "c"
    )


# With mobilities, rods, and boxes that repeat

MOBILITY = np.array([1.0, 0.25, 2.0, 0.5, 4.0])


def meeting(*turns: int) -> HardScene:
    """Five discs of unequal mobility meet at t = 1/4, and go on as one: v = sum F / sum 1/b. A box may repeat them."""
    force = np.array([6.0, 4.0, 0.0, -3.0, -2.0])
    shift, box = (20.0 * np.array(turns), {"box": (20.0,)}) if turns else (np.zeros(5), {})
    at, speed = np.arange(5) + shift, force.sum() / (1 / MOBILITY).sum()
    x0, drift = (at - MOBILITY * force / 4)[:, None], force[:, None]
    made = problem(x0, drift, dincl.NonOverlap(0.5), mobility=MOBILITY, **box)
    return HardScene(made, [0.2, 1.0], [x0 + 0.2 * MOBILITY[:, None] * drift, (at + 0.75 * speed)[:, None]], "cccc")


def seam(height: float) -> HardScene:
    """``grazing`` with a fixed disc for the ball, which the other one meets across the seam of the box."""
    half = np.sqrt(max(0.0, 1 - (1 + height) ** 2))
    end = [7 + half - np.arctanh(half), max(1 + height, 1.0)]
    more = {"mobility": [0.0, 1.0], "box": (5.0, 5.0)}
    made = problem([[0.0, 0.0], [3.0, 1 + height]], (1.0, 0.0), dincl.NonOverlap(0.5), **more)
    return HardScene(made, [4.0], [[[0.0, 0.0], end]], "cr" if height < 0 else "")


def frame() -> HardScene:
    """A square of six rods, one more than hold it, lands flat on a floor, slides, and is lifted at t = 0.8."""
    x0 = np.array([[0.0, 0.4], [1.0, 0.4], [1.0, 1.4], [0.0, 1.4]])
    pairs = [(i, j) for j in range(4) for i in range(j)]
    rods = dincl.Distance(pairs, [float(np.linalg.norm(x0[i] - x0[j])) for i, j in pairs])
    force = lambda t, x: np.array([0.5, -0.5 if t < 0.8 else 0.5]) / MOBILITY[:4, None] + 0 * x  # noqa: E731
    made = problem(x0, force, rods, dincl.HalfSpace((0.0, 1.0)), mobility=2 * MOBILITY[:4])
    t = [0.3, 0.8, 1.0]
    return HardScene(made, t, [x0 + np.array(move) for move in ([0.3, -0.3], [0.8, -0.4], [1.0, -0.2])], None)


def pendulum() -> HardScene:
    """A rod turns about a fixed point, phi' = -sin(phi) / 2; its end grazes one wall, and another one stops it."""
    x0 = np.array([[1.0, 2.0], [1 + np.sin(2.0), 2 - np.cos(2.0)]])
    walls = [dincl.HalfSpace((s, 0.0), s * (1 + x), particles=[1]) for s, x in ((-1.0, 1.0), (1.0, np.sin(0.5)))]
    made = problem(x0, (0.0, -1.0), dincl.Distance([(0, 1)], 1.0), *walls, mobility=[0.0, 0.5])
    t = np.array([0.5, 2.0, 5.0])
    angle = np.maximum(2 * np.arctan(np.tan(1.0) * np.exp(-t / 2)), 0.5)
    return HardScene(made, t, [[x0[0], [1 + np.sin(a), 2 - np.cos(a)]] for a in angle])


def struck(first: float) -> HardScene:
    """A wall strikes a row of unequal mobility once, to 2; it is a wall for the first disc alone."""
    stroke = wall(lambda t: 2.0 * np.exp(-(((t - 0.713) / 0.05) ** 2)), radius=0.5, particles=[0])
    made = problem([[first], [1.7], [2.8]], (0.0,), dincl.NonOverlap(0.5), stroke, mobility=MOBILITY[:3])
    return HardScene(made, [4.0], [[[2.5], [3.5], [4.5]]])


def ring() -> HardScene:
    """Four discs fill a line that repeats: each pushes the next one, and the last one the first."""
    force, x0 = np.array([[2.0], [-1.0], [0.5], [0.0]]), np.arange(4.0)[:, None]
    made = problem(x0, force, dincl.NonOverlap(0.5), mobility=MOBILITY[:4], box=(4.0,))
    return HardScene(made, [1.0], [x0 + force.sum() / (1 / MOBILITY[:4]).sum()])


# Sets that jump


def jump(before: Any, after: Any) -> Signal:
    """Return a function of time that jumps at 0.6."""
    return lambda t: before if t <= 0.6 else after


def jumped(x0: ArrayLike, drift: Any, one: Any, exact: Sequence[float]) -> HardScene:
    """Return a scene whose set jumps at 0.6 in whose contact a point rests, or onto a point, and its end at 0.75."""
    return HardScene(problem(x0, drift, one), [0.75], np.reshape(exact, (1, -1, 1)), None, (1e-7,))


APART, TOGETHER = constant([[-1.0], [1.0]]), constant([[1.0], [-1.0]])
JUMPS = {
    "ball grows": ([[0.0]], RIGHT, dincl.InsideBall((0.0,), jump(0.5, 90.0)), [0.65]),
    "obstacle shrinks": ([[0.0]], RIGHT, dincl.OutsideBall((1.5,), jump(1.0, 0.1)), [0.65]),
    "obstacle moves": ([[0.0]], RIGHT, dincl.OutsideBall(jump((1.5,), (9.0,)), 1.0), [0.65]),
    "discs shrink": ([[0.0], [1.2]], TOGETHER, dincl.NonOverlap(jump([0.5, 0.5], [0.1, 0.5])), [0.25, 0.95]),
    "longer thread": ([[0.0], [0.8]], APART, dincl.MaxDistance([(0, 1)], jump(1.0, 50.0)), [-0.25, 1.05]),
    "smaller radius at a wall": ([[0.0]], RIGHT, dincl.HalfSpace((-1.0,), -0.7, jump(0.2, 0.0)), [0.65]),
    "wall goes": ([[0.0]], RIGHT, dincl.HalfSpace((-1.0,), jump(-0.5, -100.5)), [0.65]),
    "path of a wall": ([[0.0]], RIGHT, dincl.Moving(dincl.HalfSpace((-1.0,), -0.5), jump((0.0,), (3.0,))), [0.65]),
    "function": ([[0.0]], RIGHT, dincl.Smooth(lambda t, x: jump(0.5, 100.0)(t) - x[:, 0]), [0.65]),
    "ball shrinks": ([[0.0]], RIGHT, dincl.InsideBall((0.0,), jump(9.0, 0.25)), [0.25]),
    "obstacle grows": ([[0.0]], RIGHT, dincl.OutsideBall((1.5,), jump(0.1, 1.25)), [0.25]),
    "discs grow": ([[0.0], [1.2]], constant((0.0,)), dincl.NonOverlap(jump(0.5, 1.0)), [-0.4, 1.6]),
    "shorter thread": ([[0.0], [0.8]], APART, dincl.MaxDistance([(0, 1)], jump(9.0, 0.4)), [0.2, 0.6]),
    "larger radius at a wall": ([[0.0]], RIGHT, dincl.HalfSpace((-1.0,), -2.0, jump(0.2, 1.75)), [0.25]),
    "wall catches up": ([[0.0]], RIGHT, dincl.HalfSpace((1.0,), jump(-5.0, 2.0)), [2.15]),
    "path onto it": ([[0.0]], RIGHT, dincl.Moving(dincl.HalfSpace((-1.0,), -5.0), jump((0.0,), (-4.5,))), [0.5]),
    "function onto it": ([[0.0]], RIGHT, dincl.Smooth(lambda t, x: jump(5.0, 0.25)(t) - x[:, 0]), [0.25]),
}

# What is hard -> name -> scene.
SCENES: dict[str, dict[str, Callable[[], HardScene]]] = {
    "many contacts at one instant": {
        "wedge 0.1": partial(wedge, 0.1),
        "closing lattice": lambda: HardScene(
            problem(2 * HEXAGON, lambda t, x: -x, dincl.NonOverlap(0.5)),
            [0.5, 3.0],
            [2 * np.exp(-0.5) * HEXAGON, HEXAGON],
            "c" * 12,
        ),
        "meeting": meeting,
        "meeting in a box": partial(meeting, 0, 1, -2, 0, 3),
    },
    "narrow wedges": {f"wedge {a:g}": partial(wedge, a) for a in (1e-3, 1e-6)},
    "grazing": {
        **{f"grazing {h}": partial(grazing, h) for h in (1e-9, 0.0, -1e-13, -1e-6, -1e-2)},
        **{f"across a seam {h}": partial(seam, h) for h in (1e-9, -1e-6)},
        **{f"passing {r}": partial(passing, r) for r in (1e-2, 1e-4)},
        **{f"there and back {way}": partial(there_and_back, way) for way in (0.2, 0.249)},
        "pendulum": pendulum,
        "bead": bead,
    },
    "redundant packings": {
        **{f"stacked {n}, {d}": partial(stacked, d, n) for n in (2, 5) for d in (1e-8, 1e-12)},
        **{f"squeezed {n}": partial(squeezed, n, g, n * g) for n, g in ((2, 0.5), (3, 0.1))},
        "turning lattice": lambda: HardScene(
            problem(HEXAGON, lambda t, x: turned(x, np.pi / 2) - x, dincl.NonOverlap(0.5)),
            [3.0],
            [turned(HEXAGON, 3.0)],
            "",
        ),
        "frame of rods": frame,
        "full ring": ring,
    },
    "release at contact": {
        "opening lattice": lambda: HardScene(
            problem(HEXAGON, lambda t, x: (t - 1) * x, dincl.NonOverlap(0.5)),
            [1.0, 2.0],
            [HEXAGON, HEXAGON * np.exp(0.5)],
            "r" * 12,
        ),
        "pressed, then blown": lambda: HardScene(
            problem(
                [[0.5], [1.5]],
                lambda t, x: (-1.0 if t < 0.3 else 1.0) * np.array([[1.0], [2.0]]),
                dincl.NonOverlap(0.5),
                dincl.HalfSpace([1.0], 0.0, 0.5),
            ),
            [0.3, 1.0],
            [[[0.5], [1.5]], [[1.2], [2.9]]],
            "rr",
        ),
        "with a wall": lambda: HardScene(
            problem([[0.0]], lambda t, x: np.full((1, 1), 1 - 3 * max(0.0, t - 0.5) ** 2), wall(lambda t: t)),
            [0.5, 1.0],
            [[[0.5]], [[1.0]]],
            "",
        ),
        **{f"let go {low}": partial(let_go, low) for low in (0.3, 0.63)},
        "corner": corner,
        "turns": partial(turns, [0.31, 0.77, 1.23]),
        "one turn": partial(turns, [0.7137]),
    },
    "sets that jump": {
        "floor that jumps": floor_that_jumps,
        "three jumps": three_jumps,
        **{f"jump: {name}": partial(jumped, *one) for name, one in JUMPS.items()},
    },
    "strokes and pulses": {
        **{f"pulse {width}": partial(pulse, width) for width in (0.05, 0.01)},
        "struck row": partial(struck, 0.6),
        "struck at rest": partial(struck, 0.5),
        "gust": partial(gust, 0.03),
        "shaker": shaker,
        "flying ball": flying_ball,
        "kink": lambda: HardScene(
            problem([[0.2]], (0.0,), wall(lambda t: 1 - abs(t - 1))), [0.5, 3.0], [[[0.5]], [[1.0]]]
        ),
        **{f"thrown in {d}-D, radius {r}": partial(thrown, d, r) for d in (1, 2, 3) for r in (0.1, 1e-4)},
    },
}
