"""The command for the figures: what it draws, what it says of what is missing, and how it ends."""

from pathlib import Path

import pytest
from typer.testing import CliRunner

from dincl.errors import InvalidProblem
from tests.tissue.study.figures_stand_in import caption, made, outcomes, written
from tissue.cli.app import app
from tissue.pictures.sheet import write
from tissue.study.figures import catalogue
from tissue.study.figures.catalogue import draw_all, found

NO_STATES = (
    "keeps no states of its runs; trajectories = [0] in the study file keeps those of the first run of each scenario"
)


@pytest.fixture
def quick(monkeypatch, tmp_path):
    """Studies that take no time, in a folder of their own; drawings of few dots, most of them in name only."""
    monkeypatch.setattr("tissue.study.outcomes.outcomes", outcomes)
    monkeypatch.setattr("tissue.pictures.charts.DPI", 30)
    monkeypatch.setattr("tissue.pictures.picture.DPI", 30)
    monkeypatch.chdir(tmp_path)
    return written(monkeypatch)


@pytest.mark.slow
def test_the_command_draws_what_it_can_and_says_what_the_others_need(quick, monkeypatch):
    monkeypatch.setattr(
        catalogue, "write", lambda figure, path: write(figure, path) if "figure12." in str(path) else None
    )
    made(["figure12", "figure12_published", "table5_7"], "results", trajectories=())
    Path("results/notes").mkdir()
    done = CliRunner().invoke(app, ["figures", "results"])
    assert (done.exit_code, done.stderr) == (0, "")
    lines = done.stdout.splitlines()
    studies, chapter = lines[:12], lines[12:]
    assert studies[0] == "results/figure12/figures/positions.png and .svg: positions of EMT cells against time"
    assert studies[3] == f"examples cannot be drawn: results/figure12 {NO_STATES}"
    assert chapter[0] == "results/figures/figure12.png and .svg: from results/figure12, results/figure12_published"
    assert chapter[1] == "figure13 is made after: tissue study figure10 --out results/figure10"
    commands = [f"tissue study {name} --out results/{name}" for name in ("table5_63", "table5_35")]
    assert f"figure20 is made after: {', '.join(commands)}" in chapter
    assert not [line for line in chapter if "figure10 " in line[:9] or "figure22" in line]  # of other studies
    files = {path.name: path.read_bytes() for path in Path("results/figures").iterdir()}
    assert set(files) == {"figure12.png", "figure12.svg"}
    assert ", published -->" in files["figure12.svg"].decode()
    assert all(data.startswith({"p": b"\x89PNG", "s": b"<?xml"}[name[-3]]) for name, data in files.items())


@pytest.mark.slow
def test_a_figure_of_the_published_model_alone_says_so(quick):
    made(["figure12_published"], "results", trajectories=())
    assert [figure.name for figure in draw_all("results") if figure.files][-1] == "figure12"
    assert caption(quick["figure12.svg"]).startswith("In the published model. Isolated EMT cell")


@pytest.mark.slow
def test_the_folder_of_one_study_whatever_its_name(quick):
    made(["figure10"], "results", trajectories=())
    Path("results/figure10").rename("results/mine")
    one = {figure.name: figure for figure in draw_all("results/mine")}
    assert [path.as_posix() for path in one["figure10"].files] == [
        f"results/mine/figures/figure10.{ending}" for ending in ("png", "svg")
    ]
    assert one["figure11"].message == f"cannot be drawn: results/mine {NO_STATES}"
    assert one["figure13"].message == "is made after: tissue study figure12 --out results/figure12"


@pytest.mark.slow
def test_a_study_that_is_not_complete_is_drawn_as_far_as_it_can(quick):
    made(["figure12"], "results", trajectories=(), runs=136)
    parts = sorted(Path("results/figure12").glob("parts/*5BS*/*"))
    assert len(parts) == 2
    told = []
    for path in parts[::-1]:
        path.unlink()
        told.append({figure.name: figure for figure in draw_all("results")})
    assert [figures["ratios"].message for figures in told] == ["ratios of extrusion against time, not complete yet"] * 2
    assert told[0]["figure12"].message == "from results/figure12"
    assert told[1]["figure12"].message.startswith(
        "cannot be drawn: results/figure12: nothing of the scenario '[S] no INM'"
    )
    assert "Not shown: '[S] no INM' is not stored yet." in caption(quick["at_end.svg"])


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
