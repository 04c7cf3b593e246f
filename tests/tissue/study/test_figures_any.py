"""The figures of any study: whatever its scenarios are called and how many there are, and why one is not drawn."""

import re
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from tests.tissue.study.figures_stand_in import caption, dots, expected, outcomes, written
from tissue.cli.app import app
from tissue.files.parameters import preset
from tissue.pictures.charts import OUTCOMES
from tissue.runs.simulate import simulate
from tissue.study.figures.catalogue import drawables
from tissue.study.figures.examples import frames
from tissue.study.figures.in_time import MOST
from tissue.study.figures.panels import MOST_COLUMNS
from tissue.study.run import run_study

MANY = 9
NAMES = ("costs $5, or $6_{x}$", "<b> & 100 %", "a long name of a scenario in which nothing else is said " * 2)
STUDY = """
title = "mine"
base = "published"
replicates = 12
seed = 1
{more}
[overrides.numerics]
keep = "24 h"
t_end = "48 h"
"""


def study(names, more="", cells=2):
    """Results of a study with these scenarios."""
    tables = "".join(f"[scenarios.'{name}']\nemt = {{ cells = {cells}, b = '12 h' }}\n" for name in names)
    Path("mine.toml").write_text(STUDY.format(more=more) + tables, "utf-8")
    return run_study("mine.toml", "mine")


def figure_of(results, name):
    (one,) = (one for one in drawables(results) if one.name == name)
    return one.draw()


@pytest.fixture(autouse=True)
def quick(monkeypatch, tmp_path):
    monkeypatch.setattr("tissue.study.outcomes.outcomes", outcomes)
    monkeypatch.chdir(tmp_path)
    return written(monkeypatch)


@pytest.mark.slow
def test_the_command_names_each_file_and_the_scenario_in_its_words():
    study(NAMES[:2], "trajectories = [0]")
    done = CliRunner().invoke(app, ["figures", "mine"])
    assert (done.exit_code, done.stderr) == (0, "")
    names = ["positions", "ratios", "at_end", "examples_1", "examples_2"]
    assert [line.split(" ")[0] for line in done.stdout.splitlines()] == [f"mine/figures/{name}.png" for name in names]
    assert [line.split("examples of ")[-1] for line in done.stdout.splitlines()[3:]] == list(NAMES[:2])
    assert {path.name for path in Path("mine/figures").iterdir()} == {
        f"{name}.{ending}" for name in names for ending in ("png", "svg")
    }


@pytest.mark.slow
def test_names_of_scenarios_are_written_as_they_are():
    texts = []
    results = study(NAMES)
    for name in ("positions", "ratios", "at_end"):
        figure = figure_of(results, name)
        figure.draw_without_rendering()
        texts += [panel.get_title("left") for panel in figure.axes]
        texts += [text.get_text() for text in figure.axes[0].get_yticklabels()]
    written = [re.sub(r"\s+", " ", text.replace(r"\$", "$")) for text in texts]
    assert all(name.strip() in written for name in NAMES)


def test_positions_are_the_median_of_all_cells_and_some_that_left():
    results = study(["alone"])
    cells, (panel,) = results.cells("alone"), figure_of(results, "positions").axes
    curves = cells[["ab_0h", "ab_24h", "ab_48h"]]
    median = next(line for line in panel.lines if line.get_color() == "black")
    assert median.get_ydata() == pytest.approx(curves.median().to_numpy())
    for side, beyond in (("basal", curves["ab_48h"] < 0), ("apical", curves["ab_48h"] > 1)):
        mine = [line.get_ydata() for line in panel.lines if line.get_color() == OUTCOMES[side][0]]
        drawn = [tuple(line) for line in mine if len(line) == len(curves.columns)]
        assert len(drawn) == min(MOST, beyond.sum()) > 0
        assert set(drawn) <= {tuple(row) for row in curves[beyond].to_numpy()}
        assert len(mine) == 2 * len(drawn)  # since when each is outside


def test_ratios_at_the_end_are_those_of_the_cells():
    results = study(NAMES)
    figure = figure_of(results, "at_end")
    for panel, what in zip(figure.axes, OUTCOMES, strict=True):
        (marks,) = dots(panel)
        wanted = [expected(results.cells(name), what) for name in NAMES]
        assert [numbers for _, *numbers, _ in marks] == [pytest.approx(one) for one in wanted]
        assert [height for height, *_ in marks] == [0, 1, 2]
    assert "n = 12 runs of each scenario" in caption(figure)


@pytest.mark.slow
def test_many_scenarios_have_a_panel_each_and_none_covers_another():
    results = study([f"number {k}" for k in range(MANY)])
    figure = figure_of(results, "positions")
    figure.draw_without_rendering()
    assert len(figure.axes) == MANY
    columns = {panel.get_subplotspec().colspan.start for panel in figure.axes}
    assert columns == set(range(MOST_COLUMNS))
    boxes = [panel.get_tightbbox() for panel in figure.axes]
    left = [box for box, panel in zip(boxes, figure.axes, strict=True) if panel.get_subplotspec().is_first_col()]
    assert all(above.y0 > below.y1 - 1 for above, below in pairwise(left))
    named = [panel for panel in figure.axes if panel.get_xlabel()]
    assert len(named) == MOST_COLUMNS  # one of them in the last row


def test_what_is_not_there_is_said_with_the_key_that_would_give_it():
    results = study(["tissue alone"], cells=0)
    Path("mine").rename("calm")
    done = CliRunner().invoke(app, ["figures", "calm"])
    assert done.exit_code == 0
    why = "'tissue alone' has no EMT cells; emt.cells, or an event of a type, gives some"
    names = [f"{name} cannot be drawn: calm: {why}" for name in ("positions", "ratios", "at_end")]
    assert done.stdout.splitlines()[:3] == names
    assert re.search(r"examples cannot be drawn: calm keeps no states .* trajectories = \[0\]", done.stdout)
    assert not Path("calm/figures").exists()
    assert results.study.trajectories == ()


def test_a_run_without_emt_cells_is_an_example_from_start_to_end(monkeypatch):
    run = simulate(preset("published").changed({"numerics.t_end": "2 h", "numerics.keep": "0.5 h"}), 0).table()
    monkeypatch.setattr("tissue.study.read.Results.trajectory", lambda *_: run)
    figure = {one.name: one for one in drawables(study(["tissue alone"], "trajectories = [0]", cells=0))}[
        "examples_1"
    ].draw()
    assert [panel.texts[0].get_text()[:9] for panel in figure.axes] == ["t = 0 h  ", "t = 1 h  ", "t = 2 h  "]
    assert caption(figure) == "tissue alone. Rows from above: replicate 0."


def test_an_example_of_a_curved_layer_has_its_heights():
    given = {"layer.shape": "circle", "layer.perimeter": "400 um", "numerics.t_end": "2 h", "numerics.keep": "2 h"}
    run = simulate(preset("published").changed(given), 0)
    (frame,) = frames(run.table(), [2.0], run.parameters)
    assert frame.curve.heights(frame.cells.ax, frame.cells.ay) == pytest.approx(
        run.final.curve.heights(run.final.cells.ax, run.final.cells.ay)
    )
    assert np.ptp(frame.cells.y) > 0
