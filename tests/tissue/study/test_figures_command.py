"""The command for the figures: what it draws, what it says of what is missing, and how it ends."""

from pathlib import Path

import pytest
from typer.testing import CliRunner

from dincl.errors import InvalidProblem
from tests.tissue.study.figures_stand_in import made, outcomes
from tissue.cli.app import app
from tissue.study.figures.catalogue import FIGURES, draw_all, found


@pytest.fixture
def quick(monkeypatch, tmp_path):
    """Studies that take no time, in a folder of their own; drawings of few dots."""
    monkeypatch.setattr("tissue.study.outcomes.outcomes", outcomes)
    monkeypatch.setattr("tissue.study.figures.style.DPI", 30)
    monkeypatch.setattr("tissue.pictures.picture.DPI", 30)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_the_command_draws_what_it_can_and_says_what_the_others_need(quick):
    made(["figure12", "figure12_published", "table5_7"], "results", trajectories=())
    Path("results/notes").mkdir()
    done = CliRunner().invoke(app, ["figures", "results"])
    assert (done.exit_code, done.stderr) == (0, "")
    lines = done.stdout.splitlines()
    assert len(lines) == len(FIGURES) + 1
    assert lines[2] == "results/figures/figure12.png and .svg, from results/figure12"
    assert lines[13] == "results/figures/figure12_published.png and .svg, from results/figure12_published"
    assert lines[0] == "figure10 is made after: tissue study figure10 --out results/figure10"
    commands = [f"tissue study {name} --out results/{name}" for name in ("table5_63", "table5_35")]
    assert lines[10] == f"figure20 is made after: {', '.join(commands)}"
    files = {path.name: path.read_bytes() for path in Path("results/figures").iterdir()}
    assert set(files) == {f"figure12{kind}.{ending}" for kind in ("", "_published") for ending in ("png", "svg")}
    texts = [files[f"figure12{kind}.svg"].decode() for kind in ("", "_published")]
    assert ["<!-- In the published model. Isolated EMT cell" in text for text in texts] == [False, True]
    assert all(data.startswith({"p": b"\x89PNG", "s": b"<?xml"}[name[-3]]) for name, data in files.items())


def test_the_folder_of_one_study_whatever_its_name(quick):
    made(["figure10"], "results", trajectories=())
    Path("results/figure10").rename("results/mine")
    one = {figure.name: figure for figure in draw_all("results/mine")}
    assert [path.as_posix() for path in one["figure10"].files] == [
        f"results/mine/figures/figure10.{ending}" for ending in ("png", "svg")
    ]
    assert (
        one["figure11"].told == "cannot be drawn: results/mine: has no trajectories: the study file must ask for some"
    )
    assert one["figure13"].told == "is made after: tissue study figure12 --out results/figure12"


def test_a_study_that_is_not_complete_is_drawn_as_far_as_it_can(quick):
    made(["figure12"], "results", trajectories=(), runs=136)
    parts = sorted(Path("results/figure12").glob("parts/*5BS*/*"))
    assert len(parts) == 2
    told = []
    for path in parts[::-1]:
        path.unlink()
        told.append({figure.name: figure.told for figure in draw_all("results")}["figure12"])
    assert told[0] == "results/figure12, not complete yet"
    assert told[1].startswith("cannot be drawn: results/figure12: nothing of the scenario '[S] no INM'")


def test_folders_that_can_not_be_used_are_refused(quick):
    done = CliRunner().invoke(app, ["figures", "nowhere"])
    assert (done.exit_code, done.stdout) == (2, "")
    assert "nowhere: must be the results of a study, or a folder with such folders in it" in done.stderr
    for home in ("one", "two"):
        made(["figure12"], home, trajectories=())
    Path("two/figure12").rename("one/again")
    with pytest.raises(InvalidProblem, match="one/again and one/figure12: must be one of these, both are of figure12"):
        found("one")
    Path("one/again/figures").write_text("a file", "utf-8")
    done = CliRunner().invoke(app, ["figures", "one/again"])
    assert done.exit_code == 2
    assert "one/again/figures: must be a folder that can be written to" in done.stderr
