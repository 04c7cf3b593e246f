"""Movies: every state once, with the colours of all."""

import numpy as np
import pytest
from PIL import Image

from dincl.errors import InvalidProblem
from tests.tissue.stills import THESIS, coloured, pair, two_hours
from tissue.events.known import EVENTS
from tissue.frames.observables import PHASES
from tissue.pictures import movie as film
from tissue.pictures.emt import EMT_COLOURS
from tissue.pictures.picture import stills
from tissue.pictures.sheet import COLOURS


@pytest.fixture(scope="module")
def run():
    return two_hours()


@pytest.mark.slow
@pytest.mark.parametrize("ending", ["gif", "webp"])
def test_a_movie_shows_every_state_once(run, tmp_path, ending):
    path, seen = tmp_path / f"movie.{ending}", []
    film.movie(run.frames, run.parameters, path, seen.append)
    assert seen == [1, 2, 3, 4, 5]
    with Image.open(path) as movie:
        assert movie.format == ending.upper()
        assert movie.n_frames == 5
        assert movie.info["loop"] == 0  # for ever
        shown, durations = [], []
        for k in range(5):
            movie.seek(k)
            movie.load()
            shown.append(np.asarray(movie.convert("RGB")).astype(int))
            durations.append(movie.info["duration"])
    assert durations == [80] * 4 + [2000]
    for image, still in zip(shown, stills(run.frames, run.parameters), strict=True):
        assert np.abs(image - still).mean() < 2.5
        assert (image[:20, -20:] == 255).all()  # the paper stays white


def test_a_gif_knows_the_colours_of_all_states(tmp_path):
    frames = [pair("G1/S"), pair("G2", t=1.0), pair("mitosis", t=2.0)]
    film.movie(frames, THESIS, tmp_path / "movie.gif")
    with Image.open(tmp_path / "movie.gif") as movie:
        for k, phase in enumerate(PHASES):
            movie.seek(k)
            rows, _ = coloured(np.asarray(movie.convert("RGB")), COLOURS[phase], tolerance=6)
            assert len(rows) > 300


def test_a_gif_knows_the_colours_of_events_that_are_over(tmp_path):
    frames = [pair(), pair(t=1.0), pair(t=2.0)]
    for frame, events in zip(frames, ("A", "AB", "AC"), strict=True):
        frame.cells.emt[0], frame.cells.events[0] = 0, EVENTS.index(events)
    film.movie(frames, THESIS, tmp_path / "movie.gif")
    with Image.open(tmp_path / "movie.gif") as movie:
        for k, events in enumerate(("A", "AB", "AC")):
            movie.seek(k)
            rows, _ = coloured(np.asarray(movie.convert("RGB")), EMT_COLOURS[events], tolerance=6)
            assert len(rows) > 300


def test_a_movie_of_one_state(tmp_path):
    film.movie([pair()], THESIS, tmp_path / "one.gif")
    with Image.open(tmp_path / "one.gif") as movie:
        assert movie.n_frames == 1


@pytest.mark.parametrize(
    ("name", "frames", "message"),
    [
        ("x.mp4", [pair()], r"x\.mp4: must end in \.gif or \.webp"),
        ("x", [pair()], r"must end in"),
        ("x.gif", [], "frames is empty"),
        ("x.webp", [], "frames is empty"),
    ],
)
def test_a_movie_that_can_not_be_made_leaves_no_file(tmp_path, name, frames, message):
    with pytest.raises(InvalidProblem, match=message):
        film.movie(frames, THESIS, tmp_path / name)
    assert list(tmp_path.iterdir()) == []
