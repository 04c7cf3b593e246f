"""The scenes are complete, piles are feasible, and exact solutions solve their inclusions."""

import itertools
import math
import pickle
from collections.abc import Callable
from typing import Any, NamedTuple

import mpmath
import numpy as np
import pytest

import dincl
from dincl import scenes
from dincl.scenes.discs import PAST_FIXED, PAST_OTHER
from dincl.scenes.line import STACK_RADII as RADII
from tests.dincl.catalog import SCENES

Gap = Callable[..., Any]
# Times at which intervals of the stack meet their left neighbours or the wall.
STACK_EVENTS = [0.195567, 0.401011, 0.701115, 0.900161, 1.099145, 1.297629]


class Case(NamedTuple):
    """An exact scene, formulated again: drift and gaps g(t, flat x) >= 0 with all digits, and when contacts change."""

    scene: scenes.Scene
    drift: Callable[[list[Any]], list[Any]]
    gaps: list[Gap]
    events: list[float]


CASES = [
    Case(
        scenes.sliding_disc(),
        lambda x: [0, -1],
        [lambda t, x, y: mpmath.hypot(x, y) - 1],
        [float(t) for t in PAST_FIXED.events()],
    ),
    Case(
        scenes.two_disks(),
        lambda x: [1, mpmath.mpf(-0.25), 0, 0],
        [lambda t, a, b, c, d: mpmath.hypot(a - c, b - d) - mpmath.mpf(1.25)],
        [float(t) for t in PAST_OTHER.events()],
    ),
    Case(
        scenes.stack(),
        lambda x: [-c for c in x],
        [lambda t, *x: x[0] - RADII[0]]
        + [lambda t, *x, i=i: x[i + 1] - x[i] - (RADII[i] + RADII[i + 1]) for i in range(len(RADII) - 1)],
        STACK_EVENTS,
    ),
    Case(scenes.step_inclusion(), lambda x: [-1], [lambda t, x: x], [math.sqrt(0.5)]),
    Case(
        scenes.sweeping_interval(),
        lambda x: [0],
        [lambda t, x: x - mpmath.sin(t), lambda t, x: mpmath.sin(t) + mpmath.mpf(0.5) - x],
        [math.asin(0.2)] + [math.pi * k / 6 for k in (3, 5, 9, 11, 15, 17, 21)],
    ),
]
exact_cases = pytest.mark.parametrize("case", CASES, ids=lambda case: case.scene.name)


def between(events: list[float]) -> list[float]:
    """Times that are no events: two in each interval, and one after all."""
    edges = [0.0, *events, events[-1] + 0.7]
    return [a + part * (b - a) for a, b in itertools.pairwise(edges) for part in (0.31, 0.83)]


@exact_cases
def test_exact_solution_starts_at_the_start_and_is_rounded_once(case: Case) -> None:
    exact = case.scene.exact
    assert np.array_equal(exact(0), case.scene.x0)
    times = between(case.events)
    assert exact(times).shape == (len(times), *case.scene.x0.shape)
    with mpmath.workdps(60):
        finer = np.array([exact.digits(t) for t in times])
    assert np.array_equal(exact(times), finer.astype(np.float64))
    coarser = np.array([exact.digits(t) for t in times])
    assert np.abs(finer - coarser).max() < 1e-26


@exact_cases
def test_exact_solution_is_feasible_and_has_the_velocity_of_the_inclusion(case: Case) -> None:
    """x' - F = sum lambda_k grad g_k with lambda >= 0, over the closed gaps, everywhere between the events."""
    pressed = 0
    with mpmath.workdps(60):
        step = mpmath.mpf(10) ** -15
        for t in map(mpmath.mpf, between(case.events)):
            place = list(case.scene.exact.digits(t).flat)
            assert min(gap(t, *place) for gap in case.gaps) > -1e-25
            velocity = (case.scene.exact.digits(t + step) - case.scene.exact.digits(t - step)).ravel() / (2 * step)
            reaction = mpmath.matrix(list(velocity - case.drift(place)))
            closed = [gap for gap in case.gaps if gap(t, *place) < 1e-25]
            if not closed:
                assert mpmath.norm(reaction) < 1e-15
                continue
            gradients = mpmath.matrix([gradient(gap, t, place) for gap in closed]).T
            multipliers = mpmath.lu_solve(gradients, reaction)
            assert mpmath.norm(gradients * multipliers - reaction) < 1e-15
            assert min(multipliers) > -1e-15
            pressed += max(multipliers) > 0.01
    assert pressed >= 2  # it is not all free fall


def gradient(gap: Gap, t: Any, place: list[Any]) -> list[Any]:
    size = len(place)
    return [mpmath.diff(gap, (t, *place), tuple(int(k == i + 1) for k in range(size + 1))) for i in range(size)]


@exact_cases
def test_exact_solution_is_continuous(case: Case) -> None:
    """Across an event x moves by at most the greatest speed, which is below 20, times the time between."""
    for event in case.events:
        before, after = case.scene.exact([event - 1e-9, event + 1e-9])
        assert np.abs(after - before).max() < 20 * 2e-9


@exact_cases
@pytest.mark.parametrize("t", [-1e-9, math.nan, math.inf, [0.0, -1.0], "soon", None])
def test_exact_solution_refuses_times_that_are_none(case: Case, t: Any) -> None:
    with pytest.raises(dincl.InvalidProblem, match=r"^t\b"):
        case.scene.exact(t)


@exact_cases
def test_exact_solution_of_late_times(case: Case) -> None:
    late = case.scene.exact(1e9)
    assert np.isfinite(late).all()
    assert case.scene.violation(1e9, late) <= 1e-15 * max(1.0, np.abs(late).max())


@pytest.mark.parametrize("make", [scenes.pile, scenes.ball_pile])
@pytest.mark.parametrize("n", [1, 2, 3, 7, 1000, 100_000])
def test_piles_of_any_size_are_feasible_and_loose(make: Callable[[int], scenes.Scene], n: int) -> None:
    scene = make(n)
    assert scene.x0.shape == (n, scene.x0.shape[1])
    assert scene.violation(0.0, scene.x0) == 0
    assert 0.45 <= scene.radius.min() <= scene.radius.max() <= 0.55
    assert (np.diff(scene.x0[:, -1]) > -2).all()  # numbered from below
    floor, *walls = scene.constraints[1:]
    assert len(walls) == 2 * (scene.x0.shape[1] - 1)
    for wall, most in [(floor, 0.001), *((wall, 0.05) for wall in walls)] if n == 1000 else ():
        gap = scene.x0 @ wall.normal - wall.offset - wall.radii(len(scene.x0))
        assert 0 < gap.min() < most


def test_piles_are_functions_of_size_and_seed() -> None:
    state = np.random.get_state()[1].copy()  # noqa: NPY002 - it must not be touched
    assert np.array_equal(scenes.pile(50).x0, scenes.pile(50, seed=0).x0)
    assert not np.array_equal(scenes.pile(50, seed=1).x0, scenes.pile(50).x0)
    assert np.array_equal(np.random.get_state()[1], state)  # noqa: NPY002


@pytest.mark.parametrize(
    ("arguments", "message"),
    [((0,), "n = 0"), ((2.5,), "n = 2.5"), ((True,), "n = True"), ((10, -1), "seed = -1"), ((10, None), "seed = None")],
)
def test_piles_refuse_what_is_no_size(arguments: tuple[Any, ...], message: str) -> None:
    for make in (scenes.pile, scenes.ball_pile):
        with pytest.raises(dincl.InvalidProblem, match=message):
            make(*arguments)


@pytest.mark.parametrize("scene", SCENES, ids=lambda scene: scene.name)
def test_scene_is_complete_and_travels_to_other_processes(scene: scenes.Scene) -> None:
    assert scene.name in scenes.__all__
    assert scene.title
    assert scene.radius.shape == (len(scene.x0),)
    assert list(scene.times) == sorted(set(scene.times))
    copy = pickle.loads(pickle.dumps(scene))
    one, other = (dincl.solve(problem, dincl.PBD(dt=0.01), t=scene.times) for problem in (scene, copy))
    assert one.status is dincl.Status.SUCCESS
    assert np.array_equal(one.x, other.x)
    if scene.exact is not None:
        assert np.array_equal(copy.exact(scene.times), scene.exact(scene.times))


def test_catalogue_holds_every_scene() -> None:
    assert {scene.name for scene in SCENES} == set(scenes.__all__) - {"Exact", "Scene"}
