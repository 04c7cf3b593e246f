"""A run shows itself: picture, movie, table, a page in a notebook; and it pickles, also from a failure."""

import pickle
from base64 import b64decode
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from matplotlib.figure import Figure
from PIL import Image

from dincl.errors import InvalidProblem
from dincl.status import Status
from tests.tissue.stills import two_hours
from tissue.runs.run import RunFailed


@pytest.fixture(scope="module")
def run():
    return two_hours()


def title(panel):
    return panel.texts[0].get_text()


def failed(run):
    """The run with a last state that is not finite."""
    cells = run.final.cells
    lost = run.final._replace(cells=cells._replace(x=np.full(len(cells.x), np.nan)))
    return replace(run, frames=(*run.frames[:-1], lost), status=Status.NON_FINITE, detail="t = 2 h: <lost>.")


def test_a_plot_shows_the_last_state_and_has_a_legend(run):
    panel = run.plot()
    assert title(panel).startswith(f"t = 2 h · {len(run.final.cells.x)} cells")
    assert len(panel.figure.legends) == 1


def test_a_plot_goes_into_axes_of_the_user_and_leaves_the_others_alone(run):
    mine, other = Figure(figsize=(4.0, 4.0)).subplots(1, 2)
    assert run.plot(mine, t=0.5) is mine
    assert title(mine).startswith("t = 0.5 h")
    assert mine.collections[0].get_offsets().shape == (len(run.frames[1].cells.x), 2)
    assert other.has_data() is False
    assert not mine.figure.legends


def test_a_time_that_is_not_kept_is_refused_with_those_that_are(run):
    with pytest.raises(InvalidProblem, match=r"t = 0\.7 h: must be an output time: 0, 0\.5, 1, 1\.5, 2"):
        run.plot(t=0.7)


def test_of_a_failed_run_the_last_finite_state_is_shown(run, tmp_path):
    bad = failed(run)
    assert title(bad.plot()).startswith("t = 1.5 h")
    with pytest.raises(InvalidProblem, match="t = 2 h: must have finite coordinates"):
        bad.plot(t=2.0)
    bad.animate(tmp_path / "run.gif")
    with Image.open(tmp_path / "run.gif") as movie:
        assert movie.n_frames == 4


def test_a_page_says_how_it_ended_with_picture_and_summary(run):
    page = failed(run)._repr_html_()
    assert "Run(NON_FINITE, t = 2 h" in page
    assert "&lt;lost&gt;" in page
    assert b64decode(page.partition("base64,")[2].partition('"')[0]).startswith(b"RIFF")
    assert page.count("<tr>") == 4  # states below the head, which has a style


def test_a_run_pickles(run):
    again = pickle.loads(pickle.dumps(run))
    assert repr(again) == repr(run)
    assert again.parameters == run.parameters
    pd.testing.assert_frame_equal(again.table(), run.table())


def test_a_failure_pickles_with_its_run(run):
    again = pickle.loads(pickle.dumps(RunFailed(failed(run))))
    assert str(again) == str(RunFailed(failed(run)))
    assert again.run.status is Status.NON_FINITE
