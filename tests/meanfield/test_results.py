"""Results of all solvers: one line, table, HTML, figure and pickling."""

from __future__ import annotations

import pickle
from dataclasses import fields
from typing import Any

import matplotlib as mpl
import numpy as np
import pytest

import meanfield as mf
from meanfield import plotting
from meanfield.solvers.result import SolverResult, spread_indices
from tests.meanfield.models import EVERY, MODELS, start

mpl.use("Agg")
T = [0.0, 0.5, 1.0]
FIBRE = mf.WavyFibre(m=0.5, k0=1.0, y_rest=1.5, k1=0.5)
CLOSED = mf.StraightFibre(m=0.5, k0=1.0, y_rest=1.5, k1=0.5)
ELEMENT = mf.TissueElement(m=1.0, k0=1.0, y_rest=(1.2, 1.0, 0.1), k1=0.5)
LINE = mf.Density.bump(1.0, 0.6)
PLANE = mf.Density.bump([0.6, 0.4], 0.4)
BOX = ([1.0, 1.1, 0.1], [0.3, -0.2, 0.1])
BLOCK = mf.Model(
    g=lambda X, y: X / y, W0=lambda y: (y[0] - 1) ** 2 + (y[1] - 1) ** 2 + (y[2] - 1) ** 2, W1=lambda X: 0 * X[0],
    nx=3, ny=3,
)  # fmt: skip


def few(density: mf.Density, y: Any, v: Any) -> mf.State:
    return mf.State(X=density.sample(np.random.default_rng(1), 6), y=y, v=v)


RESULTS = {
    "Motion": lambda: mf.solve_dae(FIBRE, few(LINE, [1.0], [0.5]), T, 1e-8),
    "Motion, plane": lambda: mf.solve_rattle(ELEMENT, few(PLANE, *BOX), T, 0.1, 2),
    "Motion, space": lambda: mf.solve_ode(
        BLOCK, mf.State(X=[[0.5, 0.4, 0.3], [0.2, 0.1, 0.3]], y=[1.0, 1.1, 1.2], v=[0.1, 0.0, 0.2]), T, 1e-8
    ),
    "Flow": lambda: mf.solve_characteristics(FIBRE, LINE, [1.0], [0.5], T, 1e-6),
    "Flow, plane": lambda: mf.solve_characteristics(ELEMENT, PLANE, *BOX, T, 1e-4),
    "GridMotion": lambda: mf.solve_pde(FIBRE, LINE, [1.0], [0.5], T, 40),
    "GridMotion, plane": lambda: mf.solve_pde(ELEMENT, PLANE, *BOX, T, 16),
    "MomentMotion": lambda: mf.solve_moments(CLOSED, mf.Moments(*LINE.moments()), [1.0], [0.5], T, 1e-8),
}


@pytest.fixture(scope="module", params=RESULTS)
def result(request: pytest.FixtureRequest) -> SolverResult:
    made: SolverResult = RESULTS[request.param]()
    return made


@pytest.fixture(autouse=True)
def _closed_figures():
    yield
    from matplotlib import pyplot

    pyplot.close("all")


@pytest.mark.slow_with("Flow, plane", "GridMotion, plane")
def test_one_line_says_kind_status_times_and_size(result):
    line = repr(result)
    assert line.startswith(f"{type(result).__name__}(SUCCESS, 3 output times to t = 1, ")
    assert f"ny = {result.y.shape[1]}" in line
    assert len(line) < 100


def test_table_has_a_row_for_each_time(result):
    table = result.to_frame()
    ny = result.y.shape[1]
    assert list(table.columns[: 2 * ny + 2]) == [
        "t", *(f"y{k + 1}" for k in range(ny)), *(f"v{k + 1}" for k in range(ny)), "energy"
    ]  # fmt: skip
    np.testing.assert_array_equal(table["t"], T)
    np.testing.assert_array_equal(table[f"y{ny}"], result.y[:, -1])
    np.testing.assert_array_equal(table["energy"], result.energy())
    assert table.notna().all().all()


def test_table_has_the_measures_of_each_kind():
    motion, grid, moments = (RESULTS[name]() for name in ("Motion", "GridMotion", "MomentMotion"))
    np.testing.assert_array_equal(motion.to_frame()["constraint_drift"], motion.constraint_drift())
    np.testing.assert_array_equal(grid.to_frame()["mass"], grid.mass())
    spread = np.sqrt(moments.second[:, 0, 0] - moments.mean[:, 0] ** 2)
    np.testing.assert_allclose(moments.to_frame()["deviation1"], spread, rtol=1e-14)


def test_html_contains_line_and_table(result):
    page = result._repr_html_()
    assert repr(result) in page
    assert "<td>0.50000000</td>" in page or "<td>0.5</td>" in page


@pytest.mark.slow_with("Motion", "Flow, plane")
def test_figure_shows_y_v_and_what_should_stay_zero(result):
    axes = result.plot()
    lines = {line.get_label(): line for line in axes.lines}
    first = "$y$" if result.y.shape[1] == 1 else "$y_1$"
    np.testing.assert_array_equal(lines[first].get_xydata(), np.column_stack([result.t, result.y[:, 0]]))
    assert len(axes.lines) == 2 * result.y.shape[1]
    _, proofs, *pictures = axes.figure.axes
    texts = [line.get_label() for line in proofs.lines] + [text.get_text() for text in proofs.texts]
    assert any("change of energy" in text for text in texts)
    nx = 1 if isinstance(result, mf.GridMotion) else result.model.nx
    assert bool(pictures) == (nx < 3)
    axes.figure.canvas.draw()


def test_given_axes_take_y_and_v_alone(result):
    from matplotlib import pyplot

    figure, axes = pyplot.subplots()
    assert result.plot(axes) is axes
    assert figure.axes == [axes]


def test_picture_has_the_particles_on_the_zero_level():
    """Test that the thick line g = 0 runs through the path of a particle at level 0."""
    X = np.array([[1.0]])
    y = X[0] + 0.5 * np.sin(X[0])
    motion = mf.solve_dae(FIBRE, mf.State(X=X, y=y, v=[0.3]), np.linspace(0, 1, 5), 1e-9)
    picture = motion.plot().figure.axes[2]
    thick = [c for c in picture.collections if np.ravel(c.get_linewidths())[0] == 2.0]
    assert len(thick) == 1
    corners = np.concatenate([path.vertices for path in thick[0].get_paths()])
    for state, place in zip(motion.y[:, 0], motion.X[:, 0, 0], strict=True):
        assert abs(np.interp(state, corners[:, 0], corners[:, 1]) - place) < 1e-3


@pytest.mark.parametrize("name", ["Motion", "Motion, plane"])
def test_levels_in_the_picture_are_those_of_g(name, monkeypatch):
    """Test the level lines on the plane of y and X for nx = 1, and of both coordinates at the last y for nx = 2."""
    drawn: list[Any] = []
    monkeypatch.setattr(plotting, "draw_levels", lambda *given: drawn.append(given))
    motion: Any = RESULTS[name]()
    paths = motion.plot().figure.axes[2].lines
    (_, (right, up), levels, _), flat = drawn[0], motion.model.nx == 1
    for k, path in enumerate(paths):
        across = motion.y[:, 0] if flat else motion.X[:, k, 0]
        np.testing.assert_array_equal(path.get_xydata(), np.column_stack((across, motion.X[:, k, -1])))
        for axis, values in zip((right, up), path.get_data(), strict=True):
            assert axis[0] < values.min() <= values.max() < axis[-1]
    assert len(paths) == motion.X.shape[1]
    for i, j in ((3, 70), (40, 12)):
        place, y = ([up[i]], [right[j]]) if flat else ([right[j], up[i]], motion.y[-1])
        expected = motion.model.level([place], y)[0]
        np.testing.assert_allclose([level[i, j] for level in levels], expected, rtol=1e-14)


def test_a_run_that_failed_at_once_has_a_table_and_a_figure():
    model = mf.StraightFibre(m=0.5, k0=1.0, y_rest=-5.0, k1=0.0)
    motion = mf.solve_ode(model, mf.State(X=[[0.5]], y=[0.1], v=[-2.0]), [5.0], 1e-8, throw=False)
    assert not motion.status
    assert len(motion.t) == 0
    assert repr(motion).startswith(f"Motion({motion.status.name}, 0 output times, N = 1")
    assert motion.status.value in motion._repr_html_()
    assert len(motion.plot().figure.axes) == 2


def test_results_pickle(result):
    again = pickle.loads(pickle.dumps(result))
    assert type(again) is type(result)
    for field in fields(result):
        value = getattr(result, field.name)
        if field.name != "model":
            np.testing.assert_equal(getattr(again, field.name), value)
    np.testing.assert_array_equal(again.energy(), result.energy())


@pytest.mark.parametrize("name", EVERY)
def test_a_pickled_model_gives_the_same_bits(name):
    model, at = MODELS[name], start(name, 4)
    again = pickle.loads(pickle.dumps(model))
    one, two = (mf.solve_ode(m, at, [0.2], 1e-8) for m in (model, again))
    for part in ("y", "X", "multipliers"):
        np.testing.assert_array_equal(getattr(one, part), getattr(two, part))
    assert mf.reduce(again).positions is mf.reduce(model).positions
    assert pickle.loads(pickle.dumps(mf.reduce(model))).obstacle == mf.reduce(model).obstacle


def test_a_pickled_model_keeps_its_interaction():
    model = mf.Model(g=lambda X, y: X - y, W0=lambda y: y**2, W1=lambda X: X**2, V=lambda r: r**2 / 2, m=0.7)
    again = pickle.loads(pickle.dumps(model))
    assert again.m == 0.7
    assert again.pair_energy([[0.5]])[0] == 0.125
    assert pickle.loads(pickle.dumps(FIBRE)).V is None


@pytest.mark.parametrize(
    "density", [mf.Density.uniform(0.0, 1.0), mf.Density.normal([0.0, 1.0], [1.0, 2.0]), LINE, PLANE]
)
def test_densities_pickle(density):
    again = pickle.loads(pickle.dumps(density))
    one, two = (law.sample(np.random.default_rng(0), 20) for law in (density, again))
    np.testing.assert_array_equal(one, two)
    np.testing.assert_array_equal(again.density(one), density.density(one))


def test_a_density_of_a_lambda_names_the_function_that_does_not_pickle():
    density = mf.Density(lambda x: np.full(len(x), 0.5), 0.0, 2.0)
    with pytest.raises(pickle.PicklingError, match=r"pdf = <function.*give functions that are defined at the top"):
        pickle.dumps(density)


def test_a_failure_pickles_with_its_result():
    model = mf.StraightFibre(m=0.5, k0=1.0, y_rest=-5.0, k1=0.0)
    with pytest.raises(mf.SolveFailed) as caught:
        mf.solve_ode(model, mf.State(X=[[0.5]], y=[0.1], v=[-2.0]), [0.01, 5.0], 1e-8)
    again = pickle.loads(pickle.dumps(caught.value))
    assert str(again) == str(caught.value)
    assert again.status is mf.Status.SINGULAR
    np.testing.assert_array_equal(again.result.y, caught.value.result.y)


@pytest.mark.parametrize(
    ("count", "most", "expected"), [(3, 4, [0, 1, 2]), (4, 4, [0, 1, 2, 3]), (41, 4, [0, 13, 27, 40])]
)
def test_spread_indices_contain_the_first_and_the_last(count, most, expected):
    assert spread_indices(count, most) == expected
