"""Contacts, releases, jumps and pulses at times that no equal steps know, for schemes that state an error.

Each case has an exact solution. The stated error is at least the true one and at most the one asked for.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
import pytest
from scipy.optimize import brentq

import dincl
from dincl import scenes
from dincl.drifts import constant
from tests.dincl.hard_problems import hard_problem
from tests.dincl.random_scenes import random_scene
from tests.dincl.test_schemes import EXACT

RIGHT = constant((1.0,))
HEXAGON = np.array([[0, 0], *([np.cos(a), np.sin(a)] for a in np.arange(6) * np.pi / 3)])


def farthest(x, y):
    return np.sqrt(((x - y) ** 2).sum(axis=-1)).max(axis=-1)


def turned(x, angle):
    c, s = np.cos(angle), np.sin(angle)
    return x @ np.array([[c, s], [-s, c]])


def problem(x0, drift, *sets):
    return dincl.Problem(x0, drift if callable(drift) else constant(drift), sets)


def wall(path, normal=(1.0,), radius=0.0):
    """A wall on a path of numbers."""
    return dincl.Moving(dincl.HalfSpace(normal, 0.0, radius), lambda t: path(t) * np.array(normal))


class Case(NamedTuple):
    """A problem, output times, the exact states there (K, N, d), and the kinds of its events if they are counted."""

    problem: dincl.Problem
    t: list[float]
    exact: object
    kinds: str | None = None  # c for contact, r for release
    tols: tuple[float, ...] = (1e-4, 1e-10)


def thrown(d, radius):
    e = np.eye(d)[0]
    made = problem([-0.5 * e, 0.47 * e], [e, -e], dincl.NonOverlap(radius))
    return Case(made, [1.0], [np.outer([-0.015 - radius, -0.015 + radius], e)], "c")


def wedge(angle):
    walls = [dincl.HalfSpace((s * np.cos(angle), np.sin(angle))) for s in (1, -1)]
    return Case(problem([[0.0, 1.0]], (0.0, -1.0), *walls), [0.3, 3.0], [[[0.0, 0.7]], [[0.0, 0.0]]], "cc")


def passing(radius):
    """The tangent of a far pair bars a half space: a long step would stop the disc before its partner."""
    start = [[0.0, 3 * radius], [0.5, 0.0]]
    made = problem(start, [[1.0, 0.0], [0.0, 0.0]], dincl.NonOverlap(radius))
    return Case(made, [1.0], [[[1.0, 3 * radius], [0.5, 0.0]]], "")


def grazing(height):
    """Met at sin(a) = half left of the top, slid up with a' = -cos(a) for the time artanh(half), left at the top."""
    half = np.sqrt(max(0.0, 1 - (1 + height) ** 2))
    end = [2 + half - np.arctanh(half), max(1 + height, 1.0)]
    made = problem([[-2.0, 1 + height]], (1.0, 0.0), dincl.OutsideBall((0, 0), 1.0))
    return Case(made, [4.0], [[end]], "cr" if height < 0 else "")


def corner():
    """A point slides down a floor inclined by 30 degrees until a wall, which leans over, takes it off the floor."""
    slope, normal = (np.array(v) for v in ([np.cos(np.pi / 6), -0.5], [0.5, np.cos(np.pi / 6)]))
    lean, drift, at = np.array([-np.cos(0.9), np.sin(0.9)]), slope - 0.3 * normal, 0.337 * slope
    made = problem([[0.0, 0.0]], drift, dincl.HalfSpace(normal), dincl.HalfSpace(lean, lean @ at))
    along = drift - (lean @ drift) * lean
    return Case(made, [0.3, 0.7, 1.0], [[0.3 * slope]] + [[at + (t - 0.337) * along] for t in (0.7, 1.0)])


def turns(times):
    """A particle is blown to and fro against a wall at 0."""
    made = problem([[0.2]], lambda t, x: [[(-1.0) ** np.searchsorted(times, t, "right")]], dincl.HalfSpace([1.0]))
    x = 0.2
    for k, length in enumerate(np.diff([0.0, *times, 1.5])):
        x = max(x + (-1.0) ** k * length, 0.0)
    return Case(made, [1.5], [[[x]]])


def stacked(d, n):
    """Under 8 (t - 1/2)^3 (1 + d_i) from t = 1/2 on the faster ones push the others by parts of d."""
    t, z, weight = np.array([0.5, 0.75, 1.0]), np.arange(n)[:, None] + 0.5, 1 + d * np.arange(n)[::-1, None]
    made = problem(z, lambda t, x: 8 * (t - 0.5) ** 3 * weight, dincl.NonOverlap(0.5), dincl.HalfSpace([1.0], 0.0, 0.5))
    return Case(made, t, z + 2 * weight.mean() * np.maximum(t - 0.5, 0)[:, None, None] ** 4)


def squeezed(n, gap, way):
    """A wall pushes n discs against another one, where they just fit, and stops at t = 1/2."""
    x0 = 0.5 + (1 + gap) * np.arange(n)[:, None]
    sets = dincl.HalfSpace([-1.0], -(x0[-1, 0] + 0.5 + gap), 0.5), wall(lambda t: way * min(1.0, 2 * t), radius=0.5)
    made = problem(x0, lambda t, x: 1 + 0.3 * np.cos(4 * t) - 0.2 * x, dincl.NonOverlap(0.5), *sets)
    return Case(made, [0.5, 0.75, 1.0], [way + 0.5 + np.arange(n)[:, None]] * 3, None, (1e-6,))


def let_go(low):
    """A push that is negative for a moment, between the parts of a step at which it is looked at."""
    least = 1e-4
    made = problem([[0.0]], lambda t, x: np.full((1, 1), least - (t - low) ** 2), dincl.HalfSpace([1.0]))
    return Case(made, [low, 1.0], [[[2 / 3 * least**1.5]], [[0.0]]], "rc")


def there_and_back(way):
    """A step that ends where it began, x = t (1 - t), meets a wall on the way and rests until t = 1/2."""
    made = problem([[0.0]], lambda t, x: np.full((1, 1), 1 - 2 * t), dincl.HalfSpace([-1.0], -way))
    return Case(made, [1.0], [[[way - 0.25]]], "cr")


def floor_that_jumps():
    """Three discs on a floor that jumps to 0.3, then to -1; they fall together and land again."""
    floor = dincl.HalfSpace((1.0,), lambda t: 0.0 if t < 0.2 else 0.3 if t < 0.5 else -1.0, 0.5)
    z, t = 0.5 + np.arange(3.0)[:, None], [0.1, 0.3, 0.6, 1.0, 2.0]
    return Case(problem(z, (-2.0,), dincl.NonOverlap(0.5), floor), t, [z + low for low in (0.0, 0.3, 0.1, -0.7, -1.0)])


def three_jumps():
    """A point that slides on a floor leaves it, as a wall and a ball also jump away, until all come back."""
    gone = lambda t: 0.4 < t <= 1.2  # noqa: E731
    sets = [
        dincl.HalfSpace((0.0, 1.0), lambda t: -7.0 if gone(t) else 0.0),
        dincl.HalfSpace((-1.0, 0.0), lambda t: -7.0 if gone(t) else -0.5),
        dincl.InsideBall((0.0, 0.0), lambda t: 20.0 if gone(t) else 3.0),
    ]
    states = [[[0.45, 0.0]], [[0.5, 0.0]], [[0.6, -0.2]], [[1.3, -1.6]], [[0.5, 0.0]]]
    return Case(problem([[0.25, 0.0]], (1.0, -2.0), *sets), [0.2, 0.4, 0.5, 1.2, 1.3], states)


def pulse(width):
    """A wall that strikes once, to 2, in a part of the run."""
    stroke = lambda t: 2.0 * np.exp(-(((t - 0.713) / width) ** 2))  # noqa: E731
    return Case(problem([[0.5]], (0.0,), wall(stroke)), [4.0], [[[2.0]]])


def gust(width):
    """A pulse of the drift of area 1."""
    strength = lambda t: np.exp(-(((t - 0.713) / width) ** 2)) / width / np.sqrt(np.pi)  # noqa: E731
    return Case(problem([[0.5]], lambda t, x: 0 * x + strength(t)), [2.0], [[[1.5]]])


def shaker():
    return Case(problem([[0.5, 0.0]], (0.0, 0.0), wall(lambda t: 0.6 * np.sin(t), (1, 0))), [100.0], [[[0.6, 0.0]]])


def flying_ball():
    ball = dincl.OutsideBall(lambda t: (-1.0 + 5.0 * t,), 0.01)
    return Case(problem([[0.0]], (0.0,), ball), [1.0], [[[4.01]]], "c")


def bead():
    """It falls inside of an ellipse and comes to rest where the normal (x/2, 2y) is the drift (1, 0.3)."""
    inside = dincl.Smooth(lambda x: 1 - x[:, 0] ** 2 / 4 - x[:, 1] ** 2)
    return Case(problem([[0.1, 0.2]], (1.0, 0.3), inside), [60.0], [np.array([[2.0, 0.15]]) / np.sqrt(1.0225)], "c")


CASES: dict[str, Callable[[], Case]] = {
    **{f"thrown in {d}-D, radius {r}": lambda d=d, r=r: thrown(d, r) for d in (1, 2, 3) for r in (0.1, 1e-4)},
    **{f"wedge {a}": lambda a=a: wedge(a) for a in (0.1, 1e-3, 1e-6)},
    **{f"passing {r}": lambda r=r: passing(r) for r in (1e-2, 1e-4)},
    **{f"grazing {h}": lambda h=h: grazing(h) for h in (1e-9, 0.0, -1e-13, -1e-6, -1e-2)},
    **{f"stacked {n}, {d}": lambda n=n, d=d: stacked(d, n) for n in (2, 5) for d in (1e-8, 1e-12)},
    **{f"squeezed {n}": lambda n=n, g=g: squeezed(n, g, n * g) for n, g in ((2, 0.5), (3, 0.1))},
    **{f"let go {low}": lambda low=low: let_go(low) for low in (0.3, 0.63)},
    **{f"there and back {way}": lambda way=way: there_and_back(way) for way in (0.2, 0.249)},
    **{f"pulse {width}": lambda width=width: pulse(width) for width in (0.05, 0.01)},
    "corner": corner,
    "turns": lambda: turns([0.31, 0.77, 1.23]),
    "one turn": lambda: turns([0.7137]),
    "floor that jumps": floor_that_jumps,
    "three jumps": three_jumps,
    "gust": lambda: gust(0.03),
    "shaker": shaker,
    "flying ball": flying_ball,
    "bead": bead,
    "kink": lambda: Case(problem([[0.2]], (0.0,), wall(lambda t: 1 - abs(t - 1))), [0.5, 3.0], [[[0.5]], [[1.0]]]),
    "with a wall": lambda: Case(
        problem([[0.0]], lambda t, x: np.full((1, 1), 1 - 3 * max(0.0, t - 0.5) ** 2), wall(lambda t: t)),
        [0.5, 1.0],
        [[[0.5]], [[1.0]]],
        "",
    ),
    "pressed, then blown": lambda: Case(
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
    "turning lattice": lambda: Case(
        problem(HEXAGON, lambda t, x: turned(x, np.pi / 2) - x, dincl.NonOverlap(0.5)),
        [3.0],
        [turned(HEXAGON, 3.0)],
        "",
    ),
    "opening lattice": lambda: Case(
        problem(HEXAGON, lambda t, x: (t - 1) * x, dincl.NonOverlap(0.5)),
        [1.0, 2.0],
        [HEXAGON, HEXAGON * np.exp(0.5)],
        "r" * 12,
    ),
    "closing lattice": lambda: Case(
        problem(2 * HEXAGON, lambda t, x: -x, dincl.NonOverlap(0.5)),
        [0.5, 3.0],
        [2 * np.exp(-0.5) * HEXAGON, HEXAGON],
        "c" * 12,
    ),
}


@pytest.mark.slow_with("shaker", "pulse", "jumps", "flying", "kink", "with a wall", "squeezed")
@pytest.mark.parametrize("name", CASES)
def test_cases_with_exact_solutions(name):
    """By event-driven runs at two tolerances, with their events."""
    case = CASES[name]()
    for tol in case.tols:
        path = dincl.solve(case.problem, dincl.EventDriven(tol), case.t)
        assert (farthest(path.x, np.array(case.exact)) <= path.error).all()
        assert path.error.max() <= tol
        assert path.violation().max() <= 1e-11
        assert [event.t for event in path.events] == sorted(event.t for event in path.events)
        if case.kinds is not None:
            assert "".join(event.kind[0] for event in path.events) == case.kinds


@pytest.mark.slow_with("shaker", "jumps", "kink", "with a wall", "squeezed")
@pytest.mark.parametrize("name", CASES)
def test_cases_by_adaptive_steps(name):
    """A run may give up, as near a point where drift and contact force balance, but SUCCESS is right."""
    case = CASES[name]()
    path = dincl.solve(case.problem, dincl.Auto(1e-3), case.t)
    assert farthest(path.x, np.array(case.exact)).max() <= path.error.max() <= 1e-3
    path = dincl.solve(case.problem, dincl.AdaptiveCatchUp(1e-4), case.t, throw=False)
    assert path.status or name == "bead"
    assert not path.status or farthest(path.x, np.array(case.exact)).max() <= 1e-3


@pytest.mark.slow_with("sweeping_interval", "drum", "closing_walls", "growing_discs")
@pytest.mark.parametrize("scene", EXACT, ids=lambda scene: scene.name)
def test_scenes_with_exact_solutions(scene, rng):
    times = np.linspace(0, scene.times[-1], 9)
    for tol in (1e-3, 1e-12):
        path = dincl.solve(scene, dincl.EventDriven(tol), times)
        assert (farthest(path.x, scene.exact(times)) <= path.error).all()
        assert path.error.max() <= tol
    between = np.sort(rng.uniform(0, scene.times[-1], 40))
    assert farthest(path(between), scene.exact(between)).max() <= 1e-11
    assert max(map(scene.violation, between, path(between))) <= 1e-13


@pytest.mark.slow_with("drum", "closing_walls", "growing_discs")
@pytest.mark.parametrize("error", [1e-2, 1e-4])
@pytest.mark.parametrize("scene", EXACT, ids=lambda scene: scene.name)
def test_scenes_by_adaptive_steps(scene, error):
    times = np.linspace(0, scene.times[-1], 9)
    adaptive = dincl.solve(scene, dincl.AdaptiveCatchUp(error), times)
    assert farthest(adaptive.x, scene.exact(times)).max() < 3 * error
    path, again = (dincl.solve(scene, dincl.Auto(error), times) for _ in range(2))
    assert np.array_equal(again.x, path.x)
    assert (again.scheme, again.stats) == (path.scheme, path.stats)
    assert farthest(path.x, scene.exact(times)).max() <= path.error.max() <= error


def test_times_of_events_are_those_of_closed_forms():
    """A push that vanishes linearly leaves its time known to a threshold only; the path does not feel that."""
    fall = problem([[1.0, 1.0]], lambda t, x: -x - (0.0, 1.0), dincl.HalfSpace((0, 1), 0.5))
    (event,) = dincl.solve(fall, dincl.EventDriven(1e-10), [1.0]).events
    assert event[1:] == ("contact", 0, "particle 0")
    assert event.t == pytest.approx(np.log(4 / 3), abs=1e-11)
    events = dincl.solve(scenes.two_disks(), dincl.EventDriven(1e-12), [4.0]).events
    assert [event[1:] for event in events] == [(kind, 0, "particle 1 and 0") for kind in ("contact", "release")]
    # The difference of the centres falls along a until it is 5/4 long; on the disc tan(angle / 2) grows exponentially.
    start, a = np.array([-2.1, 0.9]), np.array([1.0, -0.25])
    touches = brentq(lambda t: np.hypot(*(start + t * a)) - 1.25, 0.0, 1.8)
    side = start + touches * a
    offset = abs(side @ (a[1], -a[0])) / np.hypot(*a)
    leaves = touches - 1.25 / np.hypot(*a) * np.log(offset / (1.25 + np.sqrt(1.25**2 - offset**2)))
    assert [event.t for event in events] == pytest.approx([touches, leaves], abs=1e-8)
    for speed, drift, gap in (
        (0.5, lambda t, x: -x, lambda t: np.exp(-t) - 0.5 * t),
        (-0.3, lambda t, x: np.full((1, 1), -3 * np.exp(t)), lambda t: 1 - 3 * np.expm1(t) + 0.3 * t),
    ):
        (event,) = dincl.solve(
            problem([[1.0]], drift, wall(lambda t, s=speed: s * t)), dincl.EventDriven(1e-7), [1.0]
        ).events
        assert event.t == pytest.approx(brentq(gap, 0.0, 1.0, xtol=1e-15), abs=1e-11)


def jump(before, after, at=0.6):
    return lambda t: before if t <= at else after


APART, TOGETHER = constant([[-1.0], [1.0]]), constant([[1.0], [-1.0]])
# At t = 0.75, after a jump at 0.6 of a set in whose contact a point rests, or onto a point.
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


@pytest.mark.parametrize("name", JUMPS)
def test_a_set_that_jumps(name):
    x0, drift, one, exact = JUMPS[name]
    path = dincl.solve(problem(x0, drift, one), dincl.EventDriven(1e-7), [0.3, 0.6, 0.75])
    assert np.abs(path.final.ravel() - exact).max() <= 1e-12
    assert path.violation().max() <= 1e-12
    if exact[0] in (0.65, -0.25) or (len(exact) == 2 and exact[1] == 0.95):
        assert [(event.kind, round(event.t, 12)) for event in path.events][-1] == ("release", 0.6)
    for scheme, most in ((dincl.PBD(1e-3), 2e-3), (dincl.AdaptiveCatchUp(1e-4), 1e-3), (dincl.Auto(1e-3), 1e-3)):
        assert np.abs(dincl.solve(path.problem, scheme, [0.3, 0.6, 0.75]).x - path.x).max() <= most


@pytest.mark.parametrize("at", [0.6, 0.75, 1.0 / 3.0])
def test_the_function_says_on_which_side_the_time_of_a_jump_lies(at):
    for onto in (False, True):
        after = -0.2 if onto else -9.0
        for function, jumped in (
            (lambda t, after=after: -0.25 if t <= at else after, False),
            (lambda t, after=after: -0.25 if t < at else after, True),
        ):
            path = dincl.solve(
                problem([[0.0]], RIGHT, dincl.HalfSpace((-1.0,), function)), dincl.EventDriven(1e-8), [at, 2 * at]
            )
            assert path.x[0, 0, 0] == pytest.approx(0.2 if onto and jumped else 0.25, abs=1e-12)
            assert path.final[0, 0] == pytest.approx(0.2 if onto else 0.25 + at, abs=1e-12)


@pytest.mark.parametrize(("times", "width"), [([1.005, 2.0], 1e-6), ([1.0, 1.01, 2.0], 0.01), ([1.0, 1.01, 2.0], 1e-4)])
def test_output_times_in_or_beside_a_pulse_show_it(times, width):
    """A drift of size 1/width for a time of this width, and a wall that strikes then."""
    start = 1.0 if times[0] != 1.005 else 1.005 - width / 2
    stop = start + width
    right = np.exp(-2) + np.exp(start - 2) * np.expm1(stop - start) / width
    path = dincl.solve(problem([[1.0]], lambda t, x: -x + (start < t < stop) / width), dincl.EventDriven(1e-8), times)
    assert abs(path.final[0, 0] - right) <= path.error[-1]
    stroke = dincl.HalfSpace((1.0,), lambda t: 2.0 if start < t < stop else 0.0)
    path = dincl.solve(problem([[1.0]], (0.0,), stroke), dincl.EventDriven(1e-8), times)
    assert abs(path.final[0, 0] - 2.0) <= path.error[-1]


# What is not reached is said ----------------------------------------------------------------------------------------


def held_by_a_ball(radius):
    """A chain whose first bead is in a ball, and whose last one is pulled: it is taut after a while."""
    x0 = np.column_stack([0.9 * np.arange(3), [0.0, 0.08, 0.09]])
    sets = dincl.MaxDistance([(0, 1), (1, 2)], 1.0), dincl.InsideBall((0, 0), [radius, 1e3, 1e3])
    return problem(x0, [[0.0, 0.0], [0.0, 0.0], [1.0, 0.0]], *sets)


def noisy():
    rng = np.random.default_rng(0)
    return problem([[0.0, 1.0]], lambda t, x: rng.normal(size=(1, 2)), dincl.HalfSpace((0, 1)))


def events(tol, *made):
    return problem(*made), dincl.EventDriven(tol)


SAWTOOTH = dincl.HalfSpace((1.0,), lambda t: abs((1000 * t) % 1 - 0.5))
HUM, RIGHT_WALL = dincl.HalfSpace([1.0], lambda t: 0.1 * np.sin(1e5 * t)), dincl.HalfSpace((-1.0,), -1.0)
RADII_OF_ANOTHER_SHAPE = dincl.NonOverlap(lambda t: 0.5 if t <= 0.3 else [0.5, 0.5])
# How a run to t = 2 ends, and what it says.
NOT_REACHED = {
    "below rounding": (
        lambda: (scenes.ten_disks_corner(), dincl.EventDriven(1e-18)),
        "NOT_CONVERGED",
        "estimated error",
    ),
    "sawtooth": (
        lambda: events(1e-6, [[2.0]], (0.0,), SAWTOOTH),
        "NOT_CONVERGED",
        "constraints[0] (HalfSpace) changes",
    ),
    "hum": (lambda: (problem([[0.05]], (-1.0,), HUM), dincl.Auto(1e-3)), "NOT_CONVERGED", "changes too often"),
    "crushed": (lambda: events(1e-9, [[0.5]], (0.0,), wall(lambda t: t), RIGHT_WALL), "INFEASIBLE", "t = 1"),
    "jumped past": (
        lambda: events(1e-9, [[0.5]], (0.0,), dincl.HalfSpace((1.0,), jump(0.0, 2.0)), RIGHT_WALL),
        "INFEASIBLE",
        "t = 0.6",
    ),
    "single precision": (
        lambda: events(1e-10, [[0.3]], lambda t, x: (-x).astype(np.float32)),
        "TOO_MANY_STEPS",
        "after t",
    ),
    "chatter": (lambda: events(1e-10, [[0.3]], lambda t, x: -np.sign(x) + 0.3), "TOO_MANY_STEPS", "after t = 0"),
    "stiff": (
        lambda: events(1e-6, [[1.0]], lambda t, x: -1e7 * (x - np.cos(t))),
        "TOO_MANY_STEPS",
        "the drift is stiff",
    ),
    "curved": (lambda: (held_by_a_ball(1e-6), dincl.EventDriven(1e-6)), "TOO_MANY_STEPS", "a set so curved"),
    "blow-up": (lambda: events(1e-9, [[1.0]], lambda t, x: x * x), "NOT_CONVERGED", "integrator stopped"),
    "coincident": (
        lambda: events(1e-9, [[1.0, 1.0]] * 2, lambda t, x: -x, dincl.NonOverlap(1e-12)),
        "COINCIDENT_CENTRES",
        "at the start",
    ),
    "shape": (lambda: events(1e-6, [[0.0], [2.0]], TOGETHER, RADII_OF_ANOTHER_SHAPE), "CONSTRAINT_FAILED", "shape"),
    "noise": (lambda: (noisy(), dincl.Auto(1e-9)), None, ""),
    "no step": (
        lambda: (problem([[0.5]], lambda t, x: np.sin(1e9 * t) + 0 * x), dincl.AdaptiveCatchUp(1e-7)),
        None,
        "",
    ),
}


@pytest.mark.slow_with("single", "chatter", "stiff", "noise", "no step")
@pytest.mark.parametrize("name", NOT_REACHED)
def test_what_is_not_reached_is_said(name):
    make, status, said = NOT_REACHED[name]
    made, scheme = make()
    path = dincl.solve(made, scheme, [2.0], throw=False)
    assert not path.status
    assert status is None or path.status.name == status
    assert path.detail
    assert said in path.detail
    assert path.error is None or path.error[-1] > vars(scheme).get("tol", vars(scheme).get("error"))
    assert np.isfinite(path.x).all()


def test_what_pulls_too_little_to_let_go_is_in_the_stated_error():
    """Behind a particle as fast as this one, so small a pull is taken for zero, for half of the run."""
    pull, rate = 3e-12, 60.0
    drift = lambda t, x: np.array([[pull - np.exp(-rate * t)], [4.0]])  # noqa: E731
    path = dincl.solve(problem([[0.0], [1.0]], drift, dincl.HalfSpace([1.0])), dincl.EventDriven(1e-11), [1.0])
    begin = -np.log(pull) / rate
    exact = pull * (1.0 - begin) - (pull - np.exp(-rate)) / rate
    assert 1e-12 < exact <= path.error[0] + path.final[0, 0] <= 10 * exact


def test_a_start_that_violates_within_its_tolerance_is_put_right():
    path = dincl.solve(
        problem([[0.0], [1 - 5e-10]], (0.0,), dincl.NonOverlap(0.5)), dincl.EventDriven(1e-11), [0.0, 1.0]
    )
    assert path.violation().max() <= 1e-13
    assert np.abs(path.final - [[-2.5e-10], [1 - 2.5e-10]]).max() <= 1e-14


@pytest.mark.slow
def test_adaptive_steps_against_events():
    """Discs pushed together in a row and a corner, radii of many sizes, a stiff drift, an empty set."""
    pushed = [[0.5], [2.0], [3.5], [5.0], [6.5], [9.0]], [[-0.2]] * 5 + [[-3.0]], dincl.NonOverlap(0.5)
    square = dincl.HalfSpace((1, 0), 0.0, 0.5), dincl.HalfSpace((0, 1), 0.0, 0.5)
    turn = 2 * np.pi * np.arange(7) / 7
    ring = 1e-2 * np.column_stack((np.cos(turn), np.sin(turn)))
    for made, times in (
        (problem(*pushed, dincl.HalfSpace([1.0], 0.0, 0.5)), [3.0, 4.0, 9.0]),
        (problem([[0.6, 0.6], [0.6, 1.7], [1.7, 0.6]], (-1.3, -1.2), dincl.NonOverlap(0.5), *square), [1.0, 8.0]),
        (problem(ring, lambda t, x: -x, dincl.NonOverlap(3 * np.logspace(-9, -3, 7))), [1.0, 5.0]),
        (problem([[0.9]], lambda t, x: -100 * (x - np.cos(t)), dincl.HalfSpace((1.0,), 0.2)), [0.5, 1.0, 2.0]),
    ):
        exact, path = (dincl.solve(made, one, times) for one in (dincl.EventDriven(1e-9), dincl.Auto(1e-3)))
        assert farthest(path.x, exact.x).max() <= path.error.max() <= 1e-3
    jaw = problem([[0.0]], (0.0,), *(dincl.HalfSpace((side,), lambda t: t - 1, 0.5) for side in (1, -1)))
    path = dincl.solve(jaw, dincl.Auto(1e-3), [0.25, 1.0], throw=False)
    assert path.status is dincl.Status.INFEASIBLE
    assert path.t == pytest.approx([0.25, 0.5], abs=0.05)


def test_auto_takes_events_where_they_need_less_work_and_serves_more_particles_than_they_do():
    for error, scheme in ((1e-7, dincl.EventDriven), (1e-3, dincl.AdaptiveCatchUp)):
        path = dincl.solve(scenes.four_disks(), dincl.Auto(error), [1.0, 2.0])
        assert isinstance(path.scheme, scheme)
        assert (
            path.stats.drift_evaluations
            > dincl.solve(scenes.four_disks(), path.scheme, [1.0, 2.0]).stats.drift_evaluations
        )
    many = problem(2.0 * np.arange(1200.0)[:, None], (-1.0,), dincl.HalfSpace([1.0]))
    assert np.abs(dincl.solve(many, dincl.Auto(1e-6), [0.5]).final - np.maximum(many.x0 - 0.5, 0.0)).max() <= 1e-6
    with pytest.raises(dincl.InvalidProblem, match="1200 particles: serves at most"):
        dincl.solve(many, dincl.EventDriven(1e-6), [0.5])


# Random scenes ------------------------------------------------------------------------------------------------------

TIMES = np.linspace(0, 1, 5)
FEW = [pytest.param(range(10), id="few")]
MANY = [pytest.param(range(k, k + 50), marks=pytest.mark.xslow) for k in range(0, 1000, 50)]
# In these a moving set leaves no place at all.
EMPTY = {3, 460, 518, 547, 617, 733, 836, 859}


@pytest.mark.slow
@pytest.mark.parametrize("seeds", [*FEW, *MANY])
def test_random_runs_are_feasible_at_rest_on_their_contacts_and_as_close_as_they_say(seeds):
    for scene, seed in ((random_scene(seed), seed) for seed in seeds):
        path = dincl.solve(scene.problem, dincl.EventDriven(1e-9), TIMES, throw=False)
        assert np.isfinite(path.x).all(), scene.words
        assert bool(path.status) == (seed not in EMPTY), (scene.words, path.detail)
        if not path.status:
            continue
        between = np.linspace(0, TIMES[-1], 41)
        assert max(map(scene.problem.violation, between, path(between))) <= 1e-10, scene.words
        assert path.normal_cone_residual().max() <= 1e-7, scene.words
        fine = dincl.solve(scene.problem, dincl.EventDriven(1e-11), TIMES, throw=False)
        assert (farthest(path.x, fine.x) <= path.error + fine.error).all(), scene.words


@pytest.mark.parametrize("seeds", [*FEW, *MANY])
@pytest.mark.parametrize("scheme", [dincl.CatchUp, dincl.LinearisedCatchUp, dincl.MidpointCatchUp])
def test_random_runs_of_catch_up_end_as_with_another_library(scheme, seeds):
    for scene in map(random_scene, seeds):
        run, other = (
            dincl.solve(scene.problem, scheme(1 / 32, projection(1e-10)), TIMES, throw=False)
            for projection in (dincl.ActiveSet, dincl.Daqp)
        )
        assert run.status is other.status, (scene.words, run.detail, other.detail)
        assert np.array_equal(run.t, other.t), scene.words
        assert farthest(run.x, other.x).max() <= 1e-8, scene.words
        if run.status and scheme is dincl.CatchUp:
            assert run.violation().max() <= 3e-9, scene.words
            assert run.normal_cone_residual()[1:].max() <= 1e-7, scene.words


@pytest.mark.slow
@pytest.mark.parametrize("seed", [13, 81, 1, 2])
def test_catch_up_converges_to_events(seed):
    """It shares neither the steps nor the search for events; contacts keep the error from being c dt exactly."""
    scene = random_scene(seed)
    path = dincl.solve(scene.problem, dincl.EventDriven(1e-10), TIMES)
    steps = (1 / 64, 1 / 256, 1 / 1024)
    runs = [dincl.solve(scene.problem, dincl.LinearisedCatchUp(h, dincl.ActiveSet(1e-11)), TIMES) for h in steps]
    coarse, middle, fine = (farthest(run.x, path.x).max() for run in runs)
    assert fine < middle / 2 < coarse / 4


@pytest.mark.slow
def test_many_discs():
    """Sparse factors, steps that end by their dense output: finer runs see the same events, catch-up converges."""
    scene, t = scenes.pile(150), [0.1, 0.2]
    coarse, fine = (dincl.solve(scene, dincl.EventDriven(tol), t) for tol in (1e-6, 1e-10))
    assert (farthest(coarse.x, fine.x) <= coarse.error).all()
    assert [event[1:] for event in coarse.events] == [event[1:] for event in fine.events]
    assert len(fine.events) > 100
    assert fine.violation().max() <= 1e-13
    assert fine.normal_cone_residual().max() <= 1e-10
    runs = [dincl.solve(scene, dincl.MidpointCatchUp(h, dincl.ActiveSet(1e-12)), t) for h in (1 / 250, 1 / 1000)]
    first, second = (farthest(run.x, fine.x).max() for run in runs)
    assert second < min(first / 3, 1e-4)
    steps = np.arange(-6, 7)
    places = np.array([(a + b / 2, b * np.sqrt(3) / 2) for a in steps for b in steps if abs(a + b) <= 6])
    opens = problem(places, lambda t, x: (t - 1) * x, dincl.NonOverlap(0.5))
    path = dincl.solve(opens, dincl.EventDriven(1e-8), [1.0, 2.0])
    assert farthest(path.final, places * np.exp(0.5)) <= path.error[-1]
    assert [event.kind for event in path.events] == ["release"] * 342


@pytest.mark.slow
def test_random_walls_that_jump_agree_with_short_steps():
    for seed in range(4):
        rng = np.random.default_rng(seed)
        n, d = int(rng.integers(2, 5)), int(rng.integers(1, 3))
        breaks, first = np.sort(rng.uniform(0.1, 0.9, int(rng.integers(1, 4)))), np.eye(d)[0]
        x0 = 0.8 * np.arange(n)[:, None] * first + 0.3 + rng.uniform(-0.05, 0.05, (n, d))

        def numbers(start, low, high, breaks=breaks, rng=rng, side="right" if seed % 2 else "left"):
            values = np.append(start, rng.uniform(low, high, len(breaks)))
            return lambda t: values[int(np.searchsorted(breaks, t, side=side))]

        ways, rate, end = numbers(1.0, -2.0, 2.0), rng.normal(size=(n, d)), x0[-1, 0]
        sets = [
            dincl.HalfSpace(first, numbers(0.0, -1.0, 0.6)),
            dincl.HalfSpace(-first, numbers(-end - 0.2, -end - 0.5, 0.1 - end)),
            dincl.NonOverlap(0.25),
            dincl.InsideBall(x0.mean(axis=0), numbers(3.0, 1.5, 4.0)),
        ]
        made = problem(x0, lambda t, x, rate=rate, ways=ways: rate * ways(t) - 0.5 * x, *sets)
        path = dincl.solve(made, dincl.EventDriven(1e-8), [1.0])
        steps = [dincl.solve(made, dincl.CatchUp(dt, dincl.ActiveSet(1e-11)), [1.0]).final for dt in (4e-3, 2e-3)]
        assert np.abs(path.final - steps[1]).max() <= 3 * np.abs(steps[1] - steps[0]).max() + 5e-3, seed
        assert path.violation().max() <= 1e-11


# Hard problems ------------------------------------------------------------------------------------------------------


def states_with_bound(seed):
    """The worst error of a run over what it states, and of how many a reference was there."""
    hard = hard_problem(seed)
    t = np.linspace(0, hard.end, 9)[1:]
    path = dincl.solve(hard.problem, dincl.EventDriven(hard.tol), t, throw=False)
    for tol in (1e-12 * hard.scale, min(1e-2 * hard.tol, 1e-8 * hard.scale)):
        exact, bound = hard.solved_in_parts(t, tol)
        if np.isfinite(bound):
            break
    if not path.status or not np.isfinite(bound):
        return 0.0, False
    return float((farthest(path.x, exact) / (path.error + 2 * bound)).max()), True


# Some in which the stated error was too small, and others; without one whose first part ends where two walls leave no
# room, so that rounding decides whether the parts have a solution.
CHOSEN = (89, 1342, 1672, 2395, 3014, *range(8), *range(9, 21))
LONG = [pytest.param(range(k, k + 500), marks=pytest.mark.xslow) for k in range(0, 10_000, 500)]


@pytest.mark.slow
@pytest.mark.parametrize("seeds", [CHOSEN, *LONG], ids=lambda seeds: f"{seeds[0]} to {seeds[-1]}")
def test_no_run_is_farther_from_the_solution_than_it_states(seeds):
    found = [states_with_bound(seed) for seed in seeds]
    assert sum(known for _, known in found) >= 0.95 * len(found)
    assert {seed: ratio for seed, (ratio, _) in zip(seeds, found, strict=True) if ratio > 1} == {}
