"""The figures of a study, whatever its scenarios are called, and its page, which needs nothing else."""

import re
from html import escape
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from typer.testing import CliRunner

import tissue
from tests.browser import WIDTHS, fits, launched, visit
from tests.tissue.space.in_space import of_surface
from tests.tissue.study.figures_stand_in import COMPARE, FACTORS, HEAD, INTERACTION, outcomes
from tissue.cli.app import app
from tissue.files.parameters import preset
from tissue.frames.observables import phases
from tissue.frames.section import cut_of, section
from tissue.pictures.charts import NARROW, OUTCOMES, WIDTH, ratios_in_time
from tissue.pictures.picture import drawing
from tissue.pictures.sheet import webp
from tissue.report import page
from tissue.report.effects import effect_figure
from tissue.report.examples import frames
from tissue.report.page import figures, write_page
from tissue.runs.simulate import simulate
from tissue.study.answers import answer_table, scenario_means
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
    monkeypatch.setattr("tissue.study.outcomes.outcomes", outcomes)
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


def drawn(results, name, width=WIDTH):
    (one,) = (one for one in figures(results) if one.name == name)
    return one.draw(width)


@pytest.mark.slow
def test_every_figure_is_drawn_wide_and_narrow_and_written(study):
    mine = of_scenarios(NAMES, "trajectories = [0, 1]")
    for results, answers in ((study, 9), (mine, 0)):
        found = list(figures(results))
        examples = [f"examples_{k}" for k in range(1, 4)] if results is mine else []
        names = [*(f"answer_{k}" for k in range(1, answers + 1)), "positions", "ratios", "at_end", *examples]
        assert [one.name for one in found] == names
        for one in found:
            for width in (WIDTH, NARROW):
                figure = one.draw(width)
                assert webp(figure, 20).startswith(b"RIFF")
                figure.draw_without_rendering()
                boxes = [panel.get_tightbbox() for panel in figure.axes]
                assert all(box.x0 > -1 and box.x1 < figure.bbox.x1 + 1 for box in boxes)
    for kind, begins in (("png", b"\x89PNG"), ("svg", b"<?xml"), ("pdf", b"%PDF")):
        done = CliRunner().invoke(app, ["page", "mine", "--figures", kind])
        assert (done.exit_code, done.stderr) == (0, "")
        files = [Path(line) for line in done.stdout.splitlines()[1:]]
        assert files == [Path(f"mine/figures/{name}.{kind}") for name in names]
        assert all(file.read_bytes().startswith(begins) for file in files)


def test_positions_are_the_median_of_all_cells():
    results = of_scenarios(["alone"])
    cells, (panel,) = results.cells("alone"), drawn(results, "positions").axes
    median = next(line for line in panel.lines if line.get_color() == "black")
    assert median.get_ydata() == pytest.approx(cells[["ab_0h", "ab_24h", "ab_48h"]].median().to_numpy())


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


def test_ratios_at_the_end_are_those_of_the_tables_and_names_are_written_as_they_are():
    results = of_scenarios(NAMES)
    figure, table = drawn(results, "at_end"), scenario_means(results).set_index("outcome")
    figure.draw_without_rendering()
    for panel, what in zip(figure.axes, OUTCOMES, strict=True):
        marks, _, (whiskers,) = panel.containers[0].lines
        rows = table.loc[what]
        assert marks.get_xdata() == pytest.approx(100 * rows["value"].to_numpy())
        ends = np.array([segment[:, 0] for segment in whiskers.get_segments()])
        assert ends == pytest.approx(100 * rows[["low", "high"]].to_numpy())
    labels = [re.sub(r"\s+", " ", text.get_text().replace(r"\$", "$")) for text in figure.axes[0].get_yticklabels()]
    assert labels == [name.strip() for name in NAMES]


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


def test_a_study_without_emt_cells_has_examples_alone(monkeypatch):
    run = simulate(preset("published").changed({"numerics.t_end": "2 h", "numerics.keep": "0.5 h"}), 0).table()
    monkeypatch.setattr("tissue.study.read.Results.trajectory", lambda *_: run)
    (one,) = figures(of_scenarios(["tissue alone"], "trajectories = [0]", cells=0))
    assert (one.name, one.title, one.caption) == ("examples_1", "tissue alone", "Replicate 0.")
    assert [panel.texts[0].get_text()[:8] for panel in one.draw(WIDTH).axes] == ["t = 0 h ", "t = 1 h ", "t = 2 h "]


@pytest.mark.parametrize(
    "changes",
    [
        {"layer.shape": "circle", "layer.perimeter": "400 um", "numerics.t_end": "2 h", "numerics.keep": "2 h"},
        {"numerics.keep": "6 h", "numerics.t_end": "12 h", "emt.cells": 3, "emt.a": "6 h"},
    ],
)
def test_states_come_back_from_their_table(changes):
    run = simulate(preset("thesis").changed(changes), 2)
    (frame,), final = frames(run.table(), [run.final.t], run.parameters), run.final
    for name in ("x", "y", "ax", "ay", "bx", "by", "radius", "birth", "cycle", "id", "emt", "events"):
        assert getattr(frame.cells, name) == pytest.approx(getattr(final.cells, name))
    assert all((one == other).all() for one, other in zip(frame.layers, final.layers, strict=True))
    assert (phases(frame, run.parameters.numbers()) == phases(final, run.parameters.numbers())).all()
    heights = [state.curve.heights(state.cells.ax, state.cells.ay) for state in (frame, final)]
    assert heights[0] == pytest.approx(heights[1])


def test_a_sheet_from_its_table_is_drawn_as_its_run_is():
    """The same cells, height and title; the apical line goes once through the period."""
    run = simulate(of_surface("plane", numerics__t_end="0.2 h", numerics__keep="0.2 h"), 2)
    (frame,) = frames(run.table(), [run.final.t], run.parameters)
    shown = [drawing([one], run.parameters).axes[0] for one in (frame, run.final)]
    assert shown[0].texts[0].get_text() == shown[1].texts[0].get_text()
    assert len(section(frame).cells.x) == len(section(run.final).cells.x)
    period = run.final.sheets.surface.period_x
    for one in (frame, run.final):
        assert np.abs(np.diff(cut_of(one)[..., 0])).sum() == pytest.approx(period, rel=0.05)


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
        assert part.count("<picture>") == 1
        movies = 4 if row.question.startswith("(") else 2
        assert part.count('class="paper movie') == (movies if row.measure == "difference" else 0)
    assert text.count("background-image: url(data:image/webp;base64,") == 4  # each once
    for words in ("All parameters of early, arc", "numba", "9 comparisons, p corrected", "replicates = 16"):
        assert words in text


@pytest.mark.slow
def test_a_browser_shows_the_page_on_a_desk_and_on_a_telephone_at_night(study, tmp_path):
    path = write_page(study, tmp_path / "page.html")
    with launched() as browser:
        for width, scheme, inches in zip(WIDTHS, ("light", "dark"), (WIDTH, NARROW), strict=True):
            with visit(browser, path, width, offline=True, color_scheme=scheme) as shown:
                fits(shown)
                assert shown.locator("section.answer").count() == 9
                box = shown.locator(".movie0").first.bounding_box()
                assert box["width"] > 100
                assert box["height"] > 30
                image = shown.locator("h3:has-text('Positions') + figure img")
                assert image.evaluate("e => e.naturalWidth") == pytest.approx(page.DPI * inches, abs=1)


@pytest.mark.slow
def test_a_page_of_a_study_without_a_plan_or_without_runs(study, monkeypatch, tmp_path):
    monkeypatch.setattr(page, "_movie", lambda *_: None)
    Path("plain.toml").write_text(HEAD.replace("replicates = 40", "replicates = 8") + FACTORS)
    results = tissue.run_study("plain.toml", "plain")
    text = write_page(results, tmp_path / "plain.html").read_text("utf-8")
    assert "[compare] in the study file" in text
    for row in answer_table(results).itertuples():
        assert f"<td>{escape(row.finding)}</td>" in text
    share = scenario_means(results).iloc[0]
    assert f"<td>{100 * share['value']:.1f} % [{100 * share['low']:.1f}, {100 * share['high']:.1f}]</td>" in text
    assert not re.search(r"<td>-?0\.\d{3,}</td>", text)
    with launched() as browser, visit(browser, tmp_path / "plain.html", WIDTHS[1]) as shown:
        cell = shown.locator("td:has-text('arc')").first.bounding_box()
        assert cell["x"] + cell["width"] < WIDTHS[1]
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
    names = ["answers", "means", "parameters", "runs", "cells"]
    assert done.stdout.splitlines()[-5:] == [f"out/csv/{name}.csv" for name in names]
    answers = pd.read_csv("out/csv/answers.csv")
    assert answers["value"].tolist() == pytest.approx(answer_table(study)["value"].tolist())
    cells = pd.read_csv("out/csv/cells.csv")
    pd.testing.assert_series_equal(cells["ab_48h"], study.to_frame()["ab_48h"], rtol=1e-12)
    assert len(pd.read_csv("out/csv/runs.csv")) == 64
