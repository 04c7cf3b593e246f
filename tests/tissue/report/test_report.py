"""The figures of a study, whatever its scenarios are called, and its page, which needs nothing else."""

import re
from html import escape
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from typer.testing import CliRunner

import tissue
from tests.tissue.space.in_space import of_surface
from tests.tissue.study.stand_in import COMPARE, FACTORS, HEAD, INTERACTION, random_outcomes
from tissue.cli.app import app
from tissue.frames.section import section
from tissue.pictures.charts import OUTCOMES, ratios_in_time
from tissue.pictures.sheet import webp
from tissue.report import page
from tissue.report.figures import effect_figure
from tissue.report.page import figures, write_figures, write_page
from tissue.study.answers import answer_table, scenario_means
from tissue.study.outcomes import outcomes as true_outcomes
from tissue.study.read import Results

NAMES = ("costs $5, or $6_{x}$", "<b> & 100 %", "a long name of a scenario in which nothing else is said " * 2)
MINE = """
title = "mine"
base = "published"
replicates = 12
seed = 1
{more}
[overrides.numerics]
keep = "24 h"
t_end = "48 h"
"""
TITLE = 'title = "Does the time matter, and more inside?"'


@pytest.fixture(autouse=True)
def quick(monkeypatch, tmp_path):
    """Random outcomes, in a folder of their own; small movies."""
    monkeypatch.setattr("tissue.study.outcomes.outcomes", random_outcomes)
    monkeypatch.setattr(page, "PICTURES", 2)
    monkeypatch.setattr(page, "DPI", 30)
    monkeypatch.chdir(tmp_path)


def of_scenarios(names, more="", cells=2):
    """Results of a study with these scenarios."""
    tables = "".join(f"[scenarios.'{name}']\nemt = {{ cells = {cells}, b = '12 h' }}\n" for name in names)
    Path("mine.toml").write_text(MINE.format(more=more) + tables, "utf-8")
    return tissue.run_study("mine.toml", "mine")


@pytest.fixture
def study():
    """A study with a plan; its title and a scenario have letters that HTML reads otherwise."""
    text = (HEAD + FACTORS + COMPARE).replace(TITLE, 'title = "<b>time</b> & shape"').replace("late =", '"<i>late" =')
    Path("study.toml").write_text(text.replace("replicates = 40", "replicates = 16"))
    return tissue.run_study("study.toml", "out")


def drawn(results, name):
    (one,) = (one for one in figures(results) if one.name == name)
    return one.draw()


@pytest.mark.slow
def test_every_figure_is_drawn_and_written(study):
    mine = of_scenarios(NAMES)
    for results, answers in ((study, 9), (mine, 0)):
        found = list(figures(results))
        names = [*(f"answer_{k}" for k in range(1, answers + 1)), "ratios"]
        assert [one.name for one in found] == names
        for one in found:
            figure = one.draw()
            assert webp(figure, 20).startswith(b"RIFF")
            figure.draw_without_rendering()
            boxes = [panel.get_tightbbox() for panel in figure.axes]
            assert all(box.x0 > -1 and box.x1 < figure.bbox.x1 + 1 for box in boxes)
    for kind, begins in (("png", b"\x89PNG"), ("svg", b"<?xml"), ("pdf", b"%PDF")):
        files = list(write_figures(mine, kind))
        assert files == [Path(f"mine/figures/{name}.{kind}") for name in names]
        assert all(file.read_bytes().startswith(begins) for file in files)


def test_ratios_against_time_have_their_bands_and_times_of_events_are_marked():
    results = of_scenarios(["alone"])
    table, (panel,) = ratios_in_time(results.cells("alone")), drawn(results, "ratios").axes
    for what, band in zip(OUTCOMES, panel.collections, strict=True):
        mine = table[table["what"] == what]
        (line,) = (line for line in panel.lines if line.get_color() == OUTCOMES[what][0])
        assert line.get_ydata() == pytest.approx(100 * mine["value"].to_numpy())
        edges = band.get_paths()[0].vertices[:, 1]
        assert {edges.min(), edges.max()} == {100 * mine["low"].min(), 100 * mine["high"].max()}
    runs = results.runs("alone")
    controls = [100 * runs[f"controls_apical_{t}h"].sum() / (50 * len(runs)) for t in (0, 24, 48)]
    assert panel.lines[3].get_ydata() == pytest.approx(controls)
    assert [(text.get_text(), text.xy[0]) for text in panel.texts] == [("[B]", 12.0)]


def test_the_picture_of_an_answer_has_the_groups_and_the_effect(study):
    table = answer_table(study)
    for row in table[table["question"] == INTERACTION.replace("late", "<i>late")].to_dict("records"):
        weights = study.study.compare.contrasts[row["question"]]
        left, right = effect_figure(study, row, weights).axes
        assert [label.get_text() for label in left.get_yticklabels()] == list(weights)
        scale = 1 if row["measure"] == "ratio" else 100
        marks = [line.get_xdata()[0] for line in right.lines if line.get_marker() == "o"]
        assert marks == pytest.approx([scale * row["value"]])
        assert right.get_xscale() == ("log" if row["measure"] == "ratio" else "linear")


@pytest.mark.parametrize("low", [0.0, 0.9])
def test_an_infinite_end_of_an_interval_goes_past_the_edge(study, low):
    """A ratio whose interval has no upper end was drawn as if its value were that end."""
    row = {"outcome": "basal", "measure": "ratio", "value": 1.05, "low": low, "high": np.inf}
    _, right = effect_figure(study, row, {"early, arc": 1.0, "early, line": -1.0}).axes
    left_edge, edge = right.get_xlim()
    ((start, end),) = right.collections[0].get_segments()[0][:, 0].reshape(1, 2)
    assert end > edge > 1.05
    assert (start < left_edge) == (low == 0)
    shown = [label.get_text() for label in right.get_xticklabels() if label.get_text()]
    assert "1" in shown
    assert len(shown) <= 12


def test_a_study_without_emt_cells_has_no_figures():
    assert list(figures(of_scenarios(["tissue alone"], cells=0))) == []


def test_a_movie_of_a_sheet_is_a_section_through_its_first_emt_cell(monkeypatch):
    """Of each state: there its nucleus is cut in the middle, and what is along z alone has moved."""
    shown = []
    parameters = of_surface("plane", numerics__t_end="0.2 h", numerics__keep="0.2 h", emt__cells=3, emt__b="0.1 h")
    Path("sheet.toml").write_text(parameters.as_toml(), "utf-8")
    Path("study.toml").write_text(
        'title = "s"\nbase = "sheet.toml"\nreplicates = 1\nseed = 1\n[scenarios.one]\n', "utf-8"
    )
    monkeypatch.setattr("tissue.study.outcomes.outcomes", true_outcomes)
    monkeypatch.setattr(
        page, "stills", lambda states, *_, **__: shown.extend(states) or [np.zeros((2, 3, 3), np.uint8)]
    )
    results = tissue.run_study("study.toml", "sheet")
    found = page._movie(results, "one")
    assert (found.run, found.ratio) == ("replicate 0", 1.5)
    run = tissue.simulate(parameters, int(results.runs("one")["seed"].iloc[0]))
    for state, frame in zip(shown, run.frames, strict=True):
        first = np.flatnonzero(state.cells.emt >= 0)[0]
        assert state.cells.z[first] == 0.0
        assert state.cells.id[first] in section(state).cells.id
        assert state.cells.az - state.cells.z == pytest.approx(frame.cells.az - frame.cells.z)
        assert (state.cells.x == frame.cells.x).all()


@pytest.mark.slow
def test_the_page_has_every_answer_with_its_picture_and_loads_nothing(study):
    done = CliRunner().invoke(app, ["page", "out"])
    assert (done.exit_code, done.stderr) == (0, "")
    assert done.stdout.startswith("out/page.html: ")
    text = Path("out/page.html").read_text("utf-8")
    outside = [one for one in re.findall(r"(?:src|href|srcset)=\"?([^\" >]+)", text) if not one.startswith("data:")]
    outside += [one for one in re.findall(r"url\(([^)]+)\)", text) if not one.startswith("data:")]
    assert outside == []
    assert "<script" not in text
    assert "<h1>&lt;b&gt;time&lt;/b&gt; &amp; shape</h1>" in text
    assert "<i>" not in text
    answers = text[text.index("<h2>Answers") : text.index("<h2>All scenarios")].split("<section")[1:]
    rows = answer_table(study)
    assert len(answers) == len(rows) == 9
    for part, row in zip(answers, rows.itertuples(), strict=True):
        assert escape(row.finding) in part
        assert part.count("<img ") == 1
        movies = 4 if row.question.startswith("(") else 2
        assert part.count('class="paper movie') == (movies if row.measure == "difference" else 0)
    assert text.count("background-image: url(data:image/webp;base64,") == 4  # each once
    for words in ("All parameters of early, arc", "numba", "9 comparisons, p corrected", "replicates = 16"):
        assert words in text


@pytest.mark.slow
def test_a_page_of_a_study_without_a_plan_or_without_runs(study, monkeypatch):
    monkeypatch.setattr(page, "_movie", lambda *_: None)
    Path("plain.toml").write_text(HEAD.replace("replicates = 40", "replicates = 8") + FACTORS)
    results = tissue.run_study("plain.toml", "plain")
    text = write_page(results).read_text("utf-8")
    assert "[compare] in the study file" in text
    for row in answer_table(results).itertuples():
        assert f"<td>{escape(row.finding)}</td>" in text
    share = scenario_means(results).iloc[0]
    assert f"<td>{100 * share['value']:.1f} % [{100 * share['low']:.1f}, {100 * share['high']:.1f}]</td>" in text
    assert not re.search(r"<td>-?0\.\d{3,}</td>", text)
    assert "class=answer" not in text.split("</style>")[1]

    def stopped(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr("tissue.study.outcomes.outcomes", stopped)
    for name in ("plain", "study"):
        with pytest.raises(KeyboardInterrupt):
            tissue.run_study(f"{name}.toml", f"none_{name}")
        text = write_page(Results(f"none_{name}")).read_text("utf-8")
        assert "0 are stored" in text
    assert "is stored yet" in text


def test_folders_that_can_not_be_used_are_refused():
    done = CliRunner().invoke(app, ["page", "nowhere"])
    assert (done.exit_code, done.stdout) == (2, "")
    assert "nowhere: must be the results of a study, or a folder with such folders in it" in done.stderr
    of_scenarios(["alone"])
    Path("mine/figures").write_text("a file", "utf-8")
    done = CliRunner().invoke(app, ["page", ".", "--figures", "png"])  # which has one study in it
    assert done.exit_code == 2
    assert "mine/figures: must be a folder that can be written to" in done.stderr


@pytest.mark.slow
def test_tables_as_csv_are_those_of_the_results(study):
    done = CliRunner().invoke(app, ["summary", "out", "--csv"])
    assert (done.exit_code, done.stderr) == (0, "")
    names = ["answers", "means", "parameters", "runs", "cells", "series"]
    assert done.stdout.splitlines()[-6:] == [f"out/csv/{name}.csv" for name in names]
    answers = pd.read_csv("out/csv/answers.csv")
    assert answers["value"].tolist() == pytest.approx(answer_table(study)["value"].tolist())
    cells = pd.read_csv("out/csv/cells.csv")
    every = pd.concat(map(study.cells, study.study.scenarios), ignore_index=True)
    pd.testing.assert_series_equal(cells["ab_48h"], every["ab_48h"], rtol=1e-12)
    assert len(pd.read_csv("out/csv/runs.csv")) == 64
