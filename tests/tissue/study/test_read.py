"""The results of a study show themselves."""

import pickle

import pandas as pd
import pytest
from matplotlib.figure import Figure

import tissue.study.outcomes
from dincl.errors import InvalidProblem
from tests.tissue.study import figures_stand_in, stand_in
from tissue.study.plan import load_study
from tissue.study.read import Results
from tissue.study.run import carry_out


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    """Of figure10, with eight runs of each scenario."""
    home = tmp_path_factory.mktemp("studies")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(tissue.study.outcomes, "outcomes", figures_stand_in.outcomes)
        figures_stand_in.made(["figure10"], home)
    return Results(home / "figure10")


def test_it_says_what_it_is(results):
    text = "4 scenarios of 8 runs, complete"
    assert text in repr(results)
    assert text in results._repr_html_()
    assert "[BP]" in results._repr_html_()


def test_a_summary_counts_runs_and_failures(tmp_path, monkeypatch):
    monkeypatch.setattr(tissue.study.outcomes, "outcomes", stand_in.outcomes)
    study = load_study(stand_in.study_file(tmp_path))
    found = carry_out(study, tmp_path / "out").summary()
    assert found.to_dict("list") == {"scenario": ["[A]", "[A] no INM"], "runs": [300, 300], "failed": [6, 6]}


def test_of_what_is_not_stored_a_summary_has_zero_runs_and_the_others_say_so(tmp_path, monkeypatch):
    monkeypatch.setattr(tissue.study.outcomes, "outcomes", stand_in.outcomes)
    study = load_study(stand_in.study_file(tmp_path))
    found = carry_out(study, tmp_path / "out")
    for note in (tmp_path / "out").rglob("part-*.json"):
        note.unlink()
    assert found.summary()["runs"].tolist() == [0, 0]
    assert "not complete" in repr(found)
    with pytest.raises(InvalidProblem, match="nothing is stored yet"):
        found.to_frame()


def test_a_frame_has_the_cells_of_all_scenarios(results):
    whole = results.to_frame()
    assert list(whole) == ["scenario", *results.cells("[A]")]
    for name, table in whole.groupby("scenario"):
        pd.testing.assert_frame_equal(table.drop(columns="scenario").reset_index(drop=True), results.cells(name))
    assert len(whole) == 4 * 8


def test_a_plot_shows_the_ratios_of_a_scenario(results):
    panel = results.plot()
    assert panel.get_title(loc="left") == "[A], 8 runs"
    assert len(panel.figure.legends) == 1
    mine = Figure().subplots()
    assert results.plot(mine, scenario="[BP]") is mine
    (line,) = (line for line in mine.lines if line.get_label() == "basal extrusion")
    cells = results.cells("[BP]")
    wanted = [100 * (cells[name] < 0).mean() for name in ("ab_0h", "ab_24h", "ab_48h")]
    assert line.get_ydata() == pytest.approx(wanted)


def test_what_can_not_be_plotted_is_refused(results):
    with pytest.raises(InvalidProblem, match=r"scenario = '\[C\]': must be one of"):
        results.plot(scenario="[C]")


def test_results_pickle(results):
    again = pickle.loads(pickle.dumps(results))
    assert repr(again) == repr(results)
    pd.testing.assert_frame_equal(again.cells("[A]"), results.cells("[A]"))
