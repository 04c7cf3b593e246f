"""Views of a tissue in space: what is drawn, and what is refused."""

import sys

import numpy as np
import pytest
from PIL import Image

import tissue
from dincl import InvalidProblem
from dincl.extras import MissingLibrary
from tests.optional import need_rendering
from tests.tissue.space.in_space import SURFACES, of_surface
from tissue.pictures import scene
from tissue.pictures.view import pictures


@pytest.fixture
def rendering():
    need_rendering()


renders = pytest.mark.usefixtures("rendering")


@pytest.fixture(scope="module")
def run():
    return tissue.simulate(of_surface("plane", numerics__t_end="0.2 h", numerics__keep="0.1 h"), 1)


@pytest.mark.slow
@renders
@pytest.mark.parametrize("name", SURFACES)
def test_each_surface_is_drawn(name, tmp_path):
    run = tissue.simulate(of_surface(name, numerics__t_end="0.1 h", emt__cells=2, emt__b="0 h"), 1)
    run.view(tmp_path / "one.png")
    image = np.asarray(Image.open(tmp_path / "one.png"))
    drawn = (image[35:440] < 250).any(axis=2)
    for part in np.array_split(drawn, 3, axis=1):
        assert 0.02 < part.mean() < 0.98
    assert drawn.any(axis=0).mean() > 0.6  # of the columns


@pytest.mark.slow
@renders
def test_the_same_state_has_the_same_dots_and_a_moved_cell_others(run):
    (one,), (again,) = (list(pictures([run.final], run.parameters)) for _ in range(2))
    assert np.array_equal(one, again)
    cells = run.final.cells
    moved = run.final._replace(cells=cells._replace(y=np.where(cells.id == 3, cells.y + 1.5, cells.y)))
    (other,) = pictures([moved], run.parameters)
    assert not np.array_equal(one, other)


@pytest.mark.slow
@renders
@pytest.mark.parametrize("kind", ["gif", "webp"])
def test_a_movie_has_all_states(run, kind, tmp_path):
    run.view(tmp_path / f"all.{kind}")
    with Image.open(tmp_path / f"all.{kind}") as movie:
        assert movie.n_frames == len(run.frames) == 3
    run.view(tmp_path / f"some.{kind}", t=0.1)
    with Image.open(tmp_path / f"some.{kind}") as movie:
        assert movie.n_frames == 2


def test_what_is_refused(run, tmp_path, monkeypatch):
    with pytest.raises(InvalidProblem, match="must end in"):
        run.view(tmp_path / "one.svg")
    with pytest.raises(InvalidProblem, match="must be an output time"):
        run.view(tmp_path / "one.png", t=7.0)
    flat = tissue.simulate(tissue.preset("published").changed({"numerics.t_end": "0.05 h"}), 1)
    with pytest.raises(InvalidProblem, match="of a slice"):
        flat.view(tmp_path / "one.png")
    monkeypatch.setattr(scene, "find_library", lambda name: None)
    with pytest.raises(InvalidProblem, match="needs EGL"):
        run.view(tmp_path / "one.png")
    monkeypatch.undo()
    monkeypatch.setitem(sys.modules, "pyvista", None)
    monkeypatch.setattr(scene, "find_library", lambda name: "libEGL.so.1")
    monkeypatch.setattr("dincl.extras.find_spec", lambda name: None)
    with pytest.raises(MissingLibrary, match=r"needs pyvista.*\[views\]"):
        run.view(tmp_path / "one.png")
