"""The scenes are complete, and show what they are there to show."""

import pickle
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import dincl
from dincl import scenes
from tests.dincl.catalog import SCENES


def contacts(scene: scenes.Scene, t: float) -> tuple[np.ndarray, np.ndarray]:
    """Speeds of the discs, (N,), and sliding speeds of the pairs that touch, (pairs,), at time t."""
    h = 0.02
    earlier, x = dincl.solve(scene, dincl.PBD(dt=1e-3), t=[t - h, t]).x
    velocity = (x - earlier) / h
    rows = scene.constraints[0].select(x, 1e-3)
    arrows = rows.arrows(x)
    normal = arrows / np.linalg.norm(arrows, axis=1)[:, None]
    relative = velocity[rows.i] - velocity[rows.j]
    sliding = relative - (relative * normal).sum(axis=1)[:, None] * normal
    return np.linalg.norm(velocity, axis=1), np.linalg.norm(sliding, axis=1)


def test_four_disks_slide_and_then_balance() -> None:
    scene = scenes.four_disks()
    speed, sliding = contacts(scene, 1.0)
    assert (sliding > 0.3).sum() >= 2
    speed, sliding = contacts(scene, 2.0)
    assert len(sliding) == 5
    assert sliding.max() < 1e-3
    assert np.ptp(speed) < 1e-3  # they move as one body,
    assert speed.min() > 0.05  # not yet at rest


def test_ten_disks_fall_then_slide_then_rest() -> None:
    scene = scenes.ten_disks_corner()
    speed, sliding = contacts(scene, 1.0)
    assert (speed > 1 - 1e-9).sum() == 4
    assert (sliding > 0.3).sum() >= 2
    speed, sliding = contacts(scene, 2.0)
    assert (speed < 0.01).sum() == 6
    assert (sliding > 0.3).sum() == 3
    speed, sliding = contacts(scene, 3.0)
    assert (speed < 0.01).sum() >= 8


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
