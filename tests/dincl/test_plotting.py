"""Pictures hold what the problem says, at its scale and place; tables hold the kept states."""

import re

import matplotlib as mpl
import numpy as np
import pytest
from matplotlib.collections import PatchCollection
from matplotlib.figure import Figure
from matplotlib.patches import Circle, Polygon

import dincl
from dincl import scenes, shapes
from dincl.drawing import log_ticks
from tests.dincl.catalog import SCENES

mpl.use("Agg")


def axes(d=2):
    return Figure().add_subplot(**({"projection": "3d"} if d == 3 else {}))


def straight(t):
    return (t, 0.0)


def still(t, x):
    return 0 * x


def run(problem, t=(0.5, 1.0)):
    return dincl.solve(problem, dincl.PBD(0.05), t=t)


def discs(ax):
    """Boxes of the discs in the last collection: the state now."""
    last = [item for item in ax.collections if isinstance(item, PatchCollection)][-1]
    return np.array([[*path.get_extents().min, *path.get_extents().max] for path in last.get_paths()])


@pytest.mark.parametrize("scene", SCENES, ids=lambda scene: scene.name)
def test_every_scene_can_be_drawn(scene):
    ax = axes(scene.x0.shape[1])
    path = run(scene, t=scene.times[:1])
    assert path.plot(ax) is ax
    assert scene.title in ax.get_title(loc="left") + ax.get_title()
    assert ax.has_data()


def test_particles_are_to_scale():
    path = run(scenes.two_disks())
    boxes = discs(path.plot(axes()))
    np.testing.assert_allclose(boxes[:, 2:] - boxes[:, :2], 2 * np.array([[0.5, 0.5], [0.75, 0.75]]), rtol=1e-3)
    np.testing.assert_allclose((boxes[:, 2:] + boxes[:, :2]) / 2, path.final, atol=1e-3)


def test_radii_come_from_constraints():
    wall = dincl.Moving(dincl.HalfSpace((0, 1), -3.0, radius=[0.1, 0.2, 0.3]), straight)
    problem = dincl.Problem([[0, 0], [2, 0], [4, 0]], still, [dincl.NonOverlap(0.5, among=[1]), wall])
    np.testing.assert_array_equal(shapes.radii(problem), [0.1, 0.5, 0.3])
    np.testing.assert_array_equal(shapes.radii(dincl.Problem([[0.0]], still)), [0.0])


def test_moving_sets_are_where_they_are_now():
    sets = [
        dincl.Moving(dincl.OutsideBall((0, 0), 1.0), straight),
        dincl.HalfSpace((0, 1), -2.0, radius=0.25),
        dincl.InsideBall((0, 0), 9.0),
        dincl.Moving(dincl.HalfSpace((-1, 0), -5.0), straight),
    ]
    problem = dincl.Problem([[0.0, 3.0], [1.0, 3.0]], still, [*sets, dincl.MaxDistance([(0, 1)], 2.0)])
    ball, floor, container, wall, bonds = shapes.shapes_at(problem, 0.5)
    assert (ball.centre.tolist(), ball.radius, ball.inside) == ([0.5, 0.0], 0.75, False)
    assert (floor.normal.tolist(), floor.offset) == ([0.0, 1.0], -2.0)
    assert (container.radius, container.inside) == (9.25, True)
    assert wall.offset == -5.5  # x <= 5 became x <= 5.5
    assert bonds.pairs.tolist() == [[0, 1]]
    ax = run(problem).plot(axes())
    circles = [patch for patch in ax.patches if isinstance(patch, Circle)]
    assert [patch.center for patch in circles] == [(1.0, 0.0), (0.0, 0.0)]
    below = next(patch for patch in ax.patches if isinstance(patch, Polygon))
    assert below.get_path().contains_point((0.0, -2.5))
    assert not below.get_path().contains_point((0.0, -1.9))
    assert ax.get_xlim()[0] < -9.25


def test_ordered_chain_is_joined():
    problem = dincl.Problem([[0.0, 0], [1, 0], [2, 0]], still, [dincl.Ordered([2, 1, 0][::-1], 0)])
    (bonds,) = shapes.shapes_at(problem, 0.0)
    assert bonds.pairs.tolist() == [[0, 1], [1, 2]]


def test_own_constraint_is_drawn_by_its_zero_level():
    outside = dincl.Smooth(lambda x: [(x**2).sum() - 1], lambda x: 2 * x[None])
    (curve,) = shapes.shapes_at(dincl.Problem([[1.5, 0.0]], still, [dincl.Moving(outside, straight)]), 1.0)
    assert curve.g(np.array([1.0, 0.0])) == -1.0
    assert curve.g(np.array([2.0, 0.0])) == 0.0
    ax = run(dincl.Problem([[1.0, 0.0]], lambda t, x: x @ [[0, 1], [-1, 0]], [outside])).plot(axes())
    inside = [item for item in ax.collections if hasattr(item, "levels")]
    assert len(inside) == 2
    two = dincl.Problem([[1.5, 0.0], [3.0, 0.0]], still, [dincl.Smooth(lambda x: [x[0, 0]], lambda x: np.eye(4)[:1])])
    assert shapes.shapes_at(two, 0.0) == []


def test_plane_in_a_box():
    wall = shapes.Wall(np.array([1.0, 1.0, 1.0]) / np.sqrt(3), 0.0)
    corners = wall.cut(np.full(3, -1.0), np.full(3, 1.0))
    assert corners.shape == (6, 3)
    np.testing.assert_allclose(np.linalg.norm(np.diff(corners, axis=0), axis=1), np.sqrt(2))
    assert wall._replace(offset=9.0).cut(np.full(3, -1.0), np.full(3, 1.0)).shape == (0, 3)


def test_on_a_line_places_are_drawn_over_time():
    path = dincl.solve(scenes.sweeping_interval(), dincl.PBD(0.05), t=np.linspace(0, 10, 50))
    (line,) = path.plot(axes()).lines
    np.testing.assert_array_equal(line.get_xdata(), path.t)
    np.testing.assert_array_equal(line.get_ydata(), path.x[:, 0, 0])


def test_new_figure():
    from matplotlib import pyplot as plt

    ax = run(scenes.four_disks()).plot()
    assert ax.figure in map(plt.figure, plt.get_fignums())
    plt.close(ax.figure)


def test_too_many_dimensions():
    path = run(dincl.Problem(np.zeros((1, 4)), still))
    with pytest.raises(dincl.InvalidProblem, match="d = 4"):
        path.plot()
    assert path._repr_html_().startswith("<p>Trajectory(SUCCESS")
    assert list(path.to_frame()) == ["t", "particle", "x0", "x1", "x2", "x3"]


def test_movie(tmp_path):
    from PIL import Image

    file = run(scenes.two_disks()).animate(tmp_path / "film.gif", frames=3, fps=10)
    with Image.open(file) as film:
        assert film.n_frames == 3
        assert film.info["duration"] == 100


@pytest.mark.parametrize(
    ("name", "options", "message"),
    [
        ("film.avi", {}, "must end in .gif or .mp4"),
        ("film.gif", {"frames": 1}, "frames = 1"),
        ("film.gif", {"fps": 0}, "fps = 0"),
    ],
)
def test_movie_that_cannot_be(name, options, message, tmp_path):
    with pytest.raises(dincl.InvalidProblem, match=re.escape(message)):
        run(scenes.two_disks()).animate(tmp_path / name, **options)
    assert list(tmp_path.iterdir()) == []


def test_movie_without_the_program(tmp_path, monkeypatch):
    monkeypatch.setattr("matplotlib.animation.FFMpegWriter.isAvailable", lambda: False)
    with pytest.raises(dincl.InvalidProblem, match="ffmpeg"):
        run(scenes.two_disks()).animate(tmp_path / "film.mp4")


def test_table():
    path = run(scenes.two_disks())
    table = path.to_frame()
    assert list(table) == ["t", "particle", "x", "y", "radius"]
    np.testing.assert_array_equal(table[["x", "y"]].to_numpy().reshape(path.x.shape), path.x)
    assert table["t"].tolist() == [0.5, 0.5, 1.0, 1.0]
    assert table["particle"].tolist() == [0, 1, 0, 1]
    assert table["radius"].tolist() == [0.5, 0.75, 0.5, 0.75]


def test_notebook_shows_picture_and_failure():
    problem = dincl.Problem([[1.0]], lambda t, x: x**3)
    path = dincl.solve(problem, dincl.PBD(0.5), t=[9.0], throw=False)
    text = path._repr_html_()
    assert 'src="data:image/png;base64,' in text
    assert "DRIFT_FAILED" in text
    assert "smaller dt" in text


@pytest.mark.parametrize(
    ("low", "high", "shown"),
    [
        (1e-6, 2e-1, [f"$10^{{{k}}}$" for k in range(-6, 0)]),
        (0.006, 0.1, ["0.01", "0.03", "0.1"]),
        (0.5, 30.0, ["1", "3", "10", "30"]),
        (3.0, 29.0, ["5", "10", "20"]),
        (0.2, 1.0, ["0.2", "0.4", "0.6", "0.8", "1"]),
        (2.1, 4.9, ["3", "4"]),
    ],
)
def test_logarithmic_axes_have_few_ticks_and_plain_numbers_where_they_are_short(low, high, shown):
    ax = axes()
    for ends in ((1.0, 2.0), (1.0, 1e6), (low, high)):  # ticks follow limits that change
        ax.set(xscale="log", xlim=ends, yticks=[0.3, 0.7])
        log_ticks(ax)
    ax.figure.draw_without_rendering()
    inside = [tick.label1.get_text() for tick in ax.xaxis.get_major_ticks() if low <= tick.get_loc() <= high]
    assert [text.replace(r"\mathdefault{", "").replace("}}", "}") for text in inside] == shown
    assert ax.xaxis.get_minorticklocs().size == 0
    assert ax.get_yticks().tolist() == [0.3, 0.7]
