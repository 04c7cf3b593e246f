"""The tutorial about an event of one's own: its notebook runs, and what its text says is so."""

from contextlib import chdir

import pytest

import tissue
from tests.pages import ROOT, play
from tissue.plugins import registry

PAGE = ROOT / "docs" / "tutorials" / "own_event.md"


@pytest.fixture(scope="module")
def found(tmp_path_factory):
    """What the page leaves; at the end nothing is registered."""
    folder = tmp_path_factory.mktemp("own_event")
    with chdir(folder):
        yield play(PAGE, folder)
    registry(tissue.EmtEvent).clear()
    registry(tissue.Observable).clear()


@pytest.mark.slow
def test_the_run_has_the_event_and_the_observable(found):
    run = found["run"]
    table = run.table().query("emt >= 0 and time_h == 12")
    assert set(table["events"]) <= {"B", "BSqueeze"}
    squeezed = table["events"] == "BSqueeze"
    assert squeezed.any()
    assert table.loc[squeezed, "hard_radius_um"].tolist() == pytest.approx([0.75] * squeezed.sum())
    lowest = run.table().groupby("time_h")["nucleus_y_um"].min()
    assert run.summary()["lowest_nucleus_um"].tolist() == pytest.approx(lowest.tolist())


@pytest.mark.slow
def test_the_study_has_them_too(found):
    results = found["results"]
    cells = results.cells("squeezing")
    assert ((cells["t_squeeze_h"] >= 2) & ((cells["t_squeeze_h"] <= 6) | (cells["t_squeeze_h"] == float("inf")))).all()
    assert "t_squeeze_h" not in results.cells("not")
    assert results.runs("not")["lowest_nucleus_um_12h"].notna().all()
