"""Pictures hold what the problem says, at its scale and place."""

import matplotlib as mpl
import numpy as np
import pytest
from matplotlib.collections import PatchCollection
from matplotlib.figure import Figure
from matplotlib.patches import Circle, Polygon

import dincl
from dincl import scenes, shapes
from tests.dincl.catalog import SCENES

mpl.use("Agg")
WALLS = [dincl.HalfSpace(n, offset) for n, offset in (((1, 0), 0), ((-1, 0), -3), ((0, 1), 0), ((0, -1), -4))]
FAR = [dincl.HalfSpace((0, 1), -9.0), dincl.HalfSpace((1, 0), -30.0), dincl.HalfSpace((-1, 0), -30.0)]


def axes():
    return Figure().add_subplot()


def straight(t):
    return (t, 0.0)


def still(t, x):
    return 0 * x


def run(problem, t=(0.5, 1.0)):
    return dincl.solve(problem, dincl.PBD(0.05), t=t)


@pytest.mark.parametrize("scene", [one for one in SCENES if one.x0.shape[1] < 3], ids=lambda scene: scene.name)
def test_every_scene_is_drawn_to_scale(scene):
    path = run(scene, t=scene.times[:1])
    ax = path.plot(axes())
    assert ax.has_data()
    assert scene.title in ax.get_title(loc="left") + ax.get_title()
    drawn = [item for item in ax.collections if isinstance(item, PatchCollection)]
    if scene.x0.shape[1] == 2:
        boxes = [one.get_extents() for one in drawn[-1].get_paths()]  # the last state
        radius = shapes.radii(scene, path.t[-1])
        ends = path.final[radius > 0], radius[radius > 0][:, None]
        np.testing.assert_allclose([box.min for box in boxes], ends[0] - ends[1], atol=1e-3)
        np.testing.assert_allclose([box.max for box in boxes], ends[0] + ends[1], atol=1e-3)
    else:
        np.testing.assert_array_equal(ax.lines[0].get_ydata()[-1], path.final[0, 0])


def test_moving_sets_are_where_they_are_now():
    sets = [
        dincl.Moving(dincl.OutsideBall((0, 0), 1.0), straight),
        dincl.HalfSpace((0, 1), -2.0, radius=0.25),
        dincl.InsideBall((0, 0), 9.0),
        dincl.Moving(dincl.HalfSpace((-1, 0), -5.0), straight),
        dincl.Ordered([1, 0], 0),
    ]
    problem = dincl.Problem([[1.0, 3.0], [0.0, 3.0]], still, [*sets, dincl.MaxDistance([(0, 1)], 2.0)])
    ball, floor, container, wall, chain, bonds = shapes.shapes_at(problem, 0.5)
    assert (ball.centre.tolist(), ball.radius, ball.inside) == ([0.5, 0.0], 0.75, False)
    assert (floor.normal.tolist(), floor.offset) == ([0.0, 1.0], -2.0)
    assert (container.radius, container.inside, wall.offset) == (9.25, True, -5.5)
    assert (chain.pairs.tolist(), bonds.pairs.tolist()) == ([[1, 0]], [[0, 1]])
    ax = run(problem).plot(axes())
    assert [patch.center for patch in ax.patches if isinstance(patch, Circle)] == [(1.0, 0.0), (0.0, 0.0)]
    below = next(patch for patch in ax.patches if isinstance(patch, Polygon)).get_path()
    assert [below.contains_point((0.0, y)) for y in (-2.5, -1.9)] == [True, False]
    assert ax.get_xlim()[0] < -9.25


def test_your_own_set_for_one_particle_is_a_contour():
    outside = dincl.Smooth(lambda x: [(x**2).sum() - 1], lambda x: 2 * x[None])
    (curve,) = shapes.shapes_at(dincl.Problem([[1.5, 0.0]], still, [dincl.Moving(outside, straight)]), 1.0)
    assert [curve.g(np.array([x, 0.0])) for x in (1.0, 2.0)] == [-1.0, 0.0]
    ax = run(dincl.Problem([[1.0, 0.0]], lambda t, x: x @ [[0, 1], [-1, 0]], [outside])).plot(axes())
    assert sum(hasattr(item, "levels") for item in ax.collections) == 2
    two = dincl.Problem([[1.5, 0.0], [3.0, 0.0]], still, [dincl.Smooth(lambda x: [x[0, 0]], lambda x: np.eye(4)[:1])])
    assert shapes.shapes_at(two, 0.0) == []


@pytest.mark.parametrize(
    ("sets", "low", "high"),
    [
        (WALLS, (-0.06, -0.06), (3.06, 4.06)),
        (FAR, (-0.11, 0.49), (0.51, 1.11)),  # as without walls
        ([dincl.HalfSpace((0, 1), lambda t: -0.5 * t)], (-0.11, -0.56), (0.51, 0.86)),  # at both times
    ],
)
def test_a_picture_shows_near_walls_and_boxes(sets, low, high):
    problem = dincl.Problem([[0.2, 0.8]], still, sets)
    np.testing.assert_allclose(shapes.region(problem, problem.x0[None], (0.0, 1.0)), (low, high), atol=0.3)


def test_new_figures_and_notebooks():
    from matplotlib import pyplot as plt

    ax = run(scenes.two_disks()).plot()
    assert ax.figure in map(plt.figure, plt.get_fignums())
    plt.close(ax.figure)
    failed = dincl.solve(dincl.Problem([[1.0]], lambda t, x: x**3), dincl.PBD(0.5), t=[9.0], throw=False)
    for text in ('src="data:image/png;base64,', "DRIFT_FAILED", "smaller dt"):
        assert text in failed._repr_html_()


def test_space_has_no_pictures():
    path = run(dincl.Problem(np.zeros((1, 3)), still))
    with pytest.raises(dincl.InvalidProblem, match="d = 3"):
        path.plot()
    assert path._repr_html_().startswith("<p>Trajectory(SUCCESS")


def test_particles_have_the_radii_of_their_sets():
    wall = dincl.Moving(dincl.HalfSpace((0, 1), -3.0, radius=[0.1, 0.2, 0.3]), straight)
    problem = dincl.Problem([[0, 0], [2, 0], [4, 0]], still, [dincl.NonOverlap(0.5, among=[1]), wall])
    assert shapes.radii(problem).tolist() == [0.1, 0.5, 0.3]
