"""The page of a study, which needs nothing else, and its tables as CSV."""

import re
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from typer.testing import CliRunner

import tissue
from tests.browser import WIDTHS, fits, launched, visit
from tests.tissue.study.figures_stand_in import outcomes
from tests.tissue.study.test_compare import COMPARE, FACTORS, HEAD, INTERACTION
from tissue.cli.app import app
from tissue.pictures.sheet import png
from tissue.study.comparing import planned_answers
from tissue.study.figures import page
from tissue.study.figures.catalogue import drawables
from tissue.study.figures.effects import effect_figure, groups
from tissue.study.figures.page import write_page
from tissue.study.read import Results

TITLE = 'title = "Does the time matter, and more inside?"'


@pytest.fixture
def study(tmp_path, monkeypatch):
    """A study with random outcomes; its title and a scenario have letters that HTML reads otherwise."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("tissue.study.outcomes.outcomes", outcomes)
    monkeypatch.setattr(page, "PICTURES", 2)
    monkeypatch.setattr(page, "PIXELS", 120)
    text = (HEAD + FACTORS + COMPARE).replace(TITLE, 'title = "<b>time</b> & shape"').replace("late =", '"<i>late" =')
    Path("study.toml").write_text(text.replace("replicates = 40", "replicates = 16"))
    return tissue.run_study("study.toml", "out")


@pytest.mark.slow
def test_the_page_has_every_answer_with_its_picture_and_loads_nothing(study):
    done = CliRunner().invoke(app, ["page", "out"])
    assert (done.exit_code, done.stderr) == (0, "")
    assert done.stdout.startswith("out/page.html: ")
    text = Path("out/page.html").read_text("utf-8")
    outside = [one for one in re.findall(r"(?:src|href)=\"?([^\" >]+)", text) if not one.startswith("data:")]
    outside += [one for one in re.findall(r"url\(([^)]+)\)", text) if not one.startswith("data:")]
    assert outside == []
    assert "<script" not in text
    assert "<h1>&lt;b&gt;time&lt;/b&gt; &amp; shape</h1>" in text
    assert "<i>" not in text
    answers = text[text.index("<h2>Answers") : text.index("<h2>All scenarios")].split("<section")[1:]
    rows = planned_answers(study)
    assert len(answers) == len(rows) == 9
    for part, row in zip(answers, rows.itertuples(), strict=True):
        assert row.answer in part
        assert part.count("data:image/png") == 1
        movies = 4 if row.question.startswith("(") else 2
        assert part.count('class="movie') == (movies if row.measure == "difference" else 0)
    assert text.count("data:image/webp;base64,") == 4  # each once
    for words in ("All parameters of early, arc", "numba", "runs of each scenario, as planned", "replicates = 16"):
        assert words in text


@pytest.mark.slow
def test_a_browser_shows_the_page_on_a_desk_and_on_a_telephone(study, tmp_path):
    path = write_page(study, tmp_path / "page.html")
    with launched() as browser:
        for width in WIDTHS:
            with visit(browser, path, width, offline=True) as shown:
                fits(shown)
                assert shown.locator("section.answer").count() == 9
                box = shown.locator(".movie0").first.bounding_box()
                assert box["width"] > 100
                assert box["height"] > 30


@pytest.mark.slow
def test_a_page_of_a_study_without_a_plan_or_without_runs(study, monkeypatch, tmp_path):
    monkeypatch.setattr(page, "_movie", lambda *_: None)
    Path("plain.toml").write_text(HEAD.replace("replicates = 40", "replicates = 8") + FACTORS)
    text = write_page(tissue.run_study("plain.toml", "plain"), tmp_path / "plain.html").read_text("utf-8")
    assert "[compare] in the study file" in text
    assert "class=answer" not in text.split("</style>")[1]

    def stopped(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr("tissue.study.outcomes.outcomes", stopped)
    for name in ("plain", "study"):
        with pytest.raises(KeyboardInterrupt):
            tissue.run_study(f"{name}.toml", f"none_{name}")
        text = write_page(Results(f"none_{name}")).read_text("utf-8")
        assert "0 are stored" in text
    assert "no run yet" in text


@pytest.mark.slow
def test_the_picture_has_the_groups_and_the_effect(study):
    table = planned_answers(study)
    for row in table[table["question"] == INTERACTION.replace("late", "<i>late")].to_dict("records"):
        weights = study.study.compare.contrasts[row["question"]]
        figure = effect_figure(study, row, weights)
        left, right = figure.axes
        assert [label.get_text() for label in left.get_yticklabels()] == list(weights)
        scale = 1 if row["measure"] == "ratio" else 100
        drawn = [line.get_xdata()[0] for line in right.lines if line.get_marker() == "o"]
        assert drawn == pytest.approx([scale * row["value"]])
        assert right.get_xscale() == ("log" if row["measure"] == "ratio" else "linear")
        assert png(figure).startswith(b"\x89PNG")
    found = groups(study, "basal", {"early, arc": 1.0})
    assert (found["low"] <= found["value"]).all()
    assert (found["value"] <= found["high"]).all()


@pytest.mark.slow
@pytest.mark.parametrize("low", [0.0, 0.9])
def test_an_infinite_end_of_an_interval_goes_past_the_edge(study, low):
    """A ratio whose interval has no upper end was drawn as if its value were that end."""
    row = {"outcome": "basal", "measure": "ratio", "value": 1.05, "low": low, "high": np.inf}
    _, right = effect_figure(study, row, {"early, arc": 1.0, "late, line": -1.0}).axes
    left_edge, edge = right.get_xlim()
    ((start, end),) = right.collections[0].get_segments()[0][:, 0].reshape(1, 2)
    assert end > edge > 1.05
    assert (start < left_edge) == (low == 0)
    shown = [label.get_text() for label in right.get_xticklabels() if label.get_text()]
    assert "1" in shown
    assert len(shown) <= 12


def test_the_figures_of_a_study_begin_with_its_answers(study):
    found = list(drawables(study))
    assert [one.name for one in found[:9]] == [f"answer_{k}" for k in range(1, 10)]
    assert found[2].caption == f"{INTERACTION.replace('late', '<i>late')}: basal extrusion, difference"
    assert len(found[2].draw().axes) == 2


@pytest.mark.slow
def test_tables_as_csv_are_those_of_the_results(study):
    done = CliRunner().invoke(app, ["summary", "out", "--csv"])
    assert (done.exit_code, done.stderr) == (0, "")
    names = ["answers", "ratios", "controls", "parameters", "runs", "cells"]
    assert done.stdout.splitlines()[-6:] == [f"out/csv/{name}.csv" for name in names]
    answers = pd.read_csv("out/csv/answers.csv")
    assert answers["value"].tolist() == pytest.approx(planned_answers(study)["value"].tolist())
    cells = pd.read_csv("out/csv/cells.csv")
    pd.testing.assert_series_equal(cells["ab_48h"], study.to_frame()["ab_48h"], rtol=1e-12)
    assert len(pd.read_csv("out/csv/runs.csv")) == 64
