"""The section [compare] of a study: factors, contrasts, messages, and the answers."""

from pathlib import Path

import numpy as np
import pyarrow as pa
import pytest
from typer.testing import CliRunner

import tissue
from dincl.errors import InvalidProblem
from tests.tissue.study.figures_stand_in import outcomes
from tissue.cli.app import app
from tissue.statistics.contrasts import ProportionContrast
from tissue.statistics.ratios import ratio_of_runs
from tissue.statistics.sequences import bounded
from tissue.study.answers import scenario_ratios
from tissue.study.comparing import _difference_so_far, planned_answers
from tissue.study.export import write_csv
from tissue.study.outcomes import Outcomes
from tissue.study.plan import Piece, load_study
from tissue.study.read import Results
from tissue.study.store import note

HEAD = """
title = "Does the time matter, and more inside?"
base = "thesis"
replicates = 40
seed = 3
[overrides.numerics]
keep = "24 h"
[overrides.emt]
cells = 5
"""
FACTORS = """
[factors.time]
late = { emt.a = "18 h" }
early = { emt.a = "6 h" }
[factors.shape]
line = {}
arc = { layer = { shape = "circle", perimeter = "400 um" } }
"""
COMPARE = """
[compare]
outcomes = ["basal", "controls_apical"]
measures = ["difference", "ratio"]
effect = "time"
by = "shape"
"""
INTERACTION = "(early - late, arc) - (early - late, line)"


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("tissue.study.outcomes.outcomes", outcomes)
    return tmp_path


def test_a_key_that_a_scenario_lacks_is_empty_in_tables():
    typed = '[scenarios.without]\n[scenarios.with]\ntypes.soft = { cells = 2, place = "scattered" }\n'
    tissue.run_study(write(f"{HEAD}{typed}"), "out")
    (path,) = (path for path in write_csv(Results("out")) if path.name == "parameters.csv")
    lines = path.read_text("utf-8").splitlines()
    assert "types.soft.cells,,2" in lines
    assert not any("nan" in line for line in lines)


def write(text, path="study.toml"):
    with open(path, "w", encoding="utf-8") as file:
        file.write(text)
    return path


def refused(text):
    with pytest.raises(InvalidProblem) as caught:
        load_study(write(text))
    first, *lines = str(caught.value).split("\n  ")
    return lines or [first.removeprefix("study.toml: ")]


def test_levels_are_crossed_into_scenarios():
    study = load_study(write(HEAD + FACTORS))
    assert list(study.scenarios) == ["late, line", "late, arc", "early, line", "early, arc"]
    changes = {"numerics.keep": "24 h", "emt.cells": 5, "emt.a": "6 h"}
    circle = {"layer.shape": "circle", "layer.perimeter": "400 um"}
    assert study.scenarios["early, arc"] == tissue.preset("thesis").changed({**changes, **circle})
    assert study.compare is None


def test_effect_and_by_are_simple_effects_and_their_interaction():
    compare = load_study(write(HEAD + FACTORS + COMPARE)).compare
    assert compare.contrasts == {
        "early - late, line": {"late, line": -1, "early, line": 1},
        "early - late, arc": {"late, arc": -1, "early, arc": 1},
        INTERACTION: {"late, arc": -1, "early, arc": 1, "late, line": 1, "early, line": -1},
    }
    assert compare.count == 9


def test_three_times_in_two_shapes_and_a_third_factor():
    times = FACTORS.replace("early =", 'middle = { emt.a = "12 h" }\nearly =')
    more = '[factors.inm]\nwith = { emt.inm = 1 }\nwithout = { emt.inm = 0 }\n[compare]\noutcomes = ["basal"]\n'
    compare = load_study(write(HEAD + times + more + 'effect = "time"\nby = "shape"\n')).compare
    assert len(compare.contrasts) == 6
    weights = compare.contrasts["(early - late, arc) - (early - late, line)"]
    assert set(weights.values()) == {0.5, -0.5}
    assert len(weights) == 8
    alone = load_study(write(HEAD + times + more + 'effect = "inm"\n')).compare
    assert set(alone.contrasts["without - with"].values()) == {1 / 6, -1 / 6}


def test_contrasts_of_named_scenarios():
    own = '[scenarios.x]\nemt.a = "6 h"\n[scenarios.y]\nemt.b = "6 h"\n[compare]\noutcomes = ["below"]\n'
    compare = load_study(write(f'{HEAD}{own}[compare.contrasts."Is x lower?"]\nx = 1\ny = -1\n')).compare
    assert compare.contrasts == {"Is x lower?": {"x": 1, "y": -1}}
    assert compare.correction == "simultaneous"


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('"basal", ', '"bassal", ', "compare.outcomes = ['bassal', 'controls_apical']: must be a list of some of"),
        ('outcomes = ["basal", "controls_apical"]', "", "compare.outcomes is missing: must be a list of some of"),
        ('"ratio"', '"odds"', "compare.measures = ['difference', 'odds']: must be a list of some of difference, ratio"),
        ('effect = "time"', 'effect = "tme"', "compare.effect = 'tme': must be one of the factors: time, shape"),
        ('by = "shape"', 'by = "time"', "compare.by = 'time': must be one of the factors: shape"),
        ('effect = "time"\nby = "shape"', "", "compare.effect is missing: must be given, or contrasts; the factors"),
        ('by = "shape"', 'bye = "shape"', "compare.bye = 'shape': unknown key; the nearest known one is compare.by"),
        ('by = "shape"', 'correction = "none"', "compare.correction = 'none': must be one of simultaneous, holm"),
        ('by = "shape"', 'contrasts = 3', "compare.contrasts = 3: must be a table of weights of scenarios for each"),
        ('by = "shape"', 'contrasts.q = { "late, arc" = 1, "late, line" = -2 }', "compare.contrasts.'q' = {'late, "),
        ('by = "shape"', 'contrasts.q = { "late, arc" = 1, "lat" = -1 }', "compare.contrasts.'q'.'lat' = -1: must be"),
    ],
)  # fmt: skip
def test_what_is_wrong_is_said_in_one_message(old, new, message):
    assert old in COMPARE
    (line,) = refused(HEAD + FACTORS + COMPARE.replace(old, new))
    assert line.startswith(message)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (FACTORS.replace("arc = ", "#"), "factors = {'time': "),
        (FACTORS.replace("line = {}", 'line = { emt.a = "9 h" }'), "factors time and shape both set emt.a: must set "),
        ("", "scenarios is missing: must be at least one table"),
        (FACTORS + "[compare]\n", "compare = {}: must be a table: outcomes, and the factor effect, or contrasts"),
    ],
)
def test_factors_that_are_none(text, message):
    assert refused(HEAD + text)[0].startswith(message)


def test_answers_are_those_of_the_planned_comparisons_alone():
    results = tissue.run_study(write(HEAD + FACTORS + COMPARE), "out")
    table = planned_answers(results)
    assert len(table) == 9
    found = scenario_ratios(results).set_index(["outcome", "scenario"])["value"]["basal"]
    row = table[(table["question"] == INTERACTION) & (table["measure"] == "difference")].iloc[0]
    expected = (found["early, arc"] - found["late, arc"]) - (found["early, line"] - found["late, line"])
    assert row["value"] == pytest.approx(expected)
    shown = (table["low"] > 0) | (table["high"] < 0)
    ratio = table["measure"] == "ratio"
    shown[ratio] = (table["low"] > 1) | (table["high"] < 1)
    assert (table["answer"].isin(["larger", "smaller"]) == shown).all()
    assert (table.loc[table["needed"].notna(), "answer"] == "not shown").all()
    assert (table["runs"] == 40).all()
    first, second = (
        ratio_of_runs(runs["controls_apical_48h"], runs["controls_48h"])
        for runs in map(results.runs, ("early, arc", "late, arc"))
    )
    controls = table[(table["outcome"] == "controls_apical") & (table["question"] == "early - late, arc")].iloc[0]
    assert controls["value"] == pytest.approx(first.value - second.value)
    low, high = ProportionContrast((1.0, -1.0), (first, second)).interval()
    assert controls["low"] < low < high < controls["high"]


def test_other_comparisons_change_no_run(monkeypatch):
    tissue.run_study(write(HEAD + FACTORS), "out")
    monkeypatch.setattr("tissue.study.outcomes.outcomes", None)
    assert planned_answers(Results("out")).empty
    results = tissue.run_study(write(HEAD + FACTORS + COMPARE.replace('"controls_apical"', '"below"')), "out")
    assert set(planned_answers(results)["outcome"]) == {"basal", "below"}


@pytest.mark.slow
def test_comparisons_that_were_changed_later_are_said_to_be():
    def said():
        return CliRunner().invoke(app, ["summary", "out"]).stdout

    write(HEAD + FACTORS + COMPARE)
    tissue.run_study("study.toml", "out")
    tissue.run_study("study.toml", "out")
    assert not Results("out").replanned
    assert "changed" not in said()
    write(HEAD + FACTORS + COMPARE.replace('"basal"', '"below"'))
    tissue.run_study("study.toml", "out")
    write(HEAD + FACTORS + COMPARE)
    assert tissue.run_study("study.toml", "out").replanned
    assert "they were changed when there were runs" in said()


@pytest.mark.slow
def test_runs_behind_a_gap_do_not_count():
    results = tissue.run_study(write((HEAD + FACTORS + COMPARE).replace("replicates = 40", "replicates = 136")), "out")
    note(Path("out"), Piece("late, arc", 0, 128)).unlink()
    assert not results.as_planned
    table = planned_answers(results).set_index(["question", "outcome", "measure"])["runs"]
    assert table["early - late, arc", "basal", "difference"] == 0
    assert table["early - late, line", "basal", "difference"] == 136


def test_what_was_not_planned_is_valid_at_any_time():
    write(HEAD + FACTORS + COMPARE.replace('measures = ["difference", "ratio"]', ""))
    tissue.run_study("study.toml", "out")
    write((HEAD + FACTORS + COMPARE).replace("replicates = 40", "replicates = 48"))
    results = tissue.run_study("study.toml", "out")
    table = planned_answers(results)
    assert table["p"].isna().all()
    assert set(table["answer"]) <= {"open", "larger, decided", "smaller, decided"}
    one = table[(table["question"] == "early - late, arc") & (table["measure"] == "difference")].iloc[0]
    hits = [results.cells(name).assign(hit=lambda cells: cells["ab_48h"] < 0) for name in ("early, arc", "late, arc")]
    first, second = (cells.groupby("replicate")["hit"].mean().to_numpy() for cells in hits)
    assert (one["low"], one["high"]) == bounded(first - second, -1, 1, 1 - 0.05 / 9)
    assert one["runs"] == 48
    one = table[(table["question"] == "early - late, arc") & (table["outcome"] == "controls_apical")].iloc[0]
    runs = map(results.runs, ("early, arc", "late, arc"))
    first, second = (one["controls_apical_48h"] / one["controls_48h"] for one in runs)
    assert (one["low"], one["high"]) == bounded((first - second).to_numpy(), -1, 1, 1 - 0.05 / 9)


@pytest.mark.slow
def test_a_study_in_progress_is_answered_by_what_is_there(monkeypatch):
    def all_but_the_last(parameters, *rest):
        if parameters.emt.a.high.value < 10 and parameters.layer.shape == "circle":
            raise KeyboardInterrupt
        return outcomes(parameters, *rest)

    monkeypatch.setattr("tissue.study.outcomes.outcomes", all_but_the_last)
    for text in (COMPARE, ""):
        with pytest.raises(KeyboardInterrupt):
            tissue.run_study(write(HEAD + FACTORS + text), "out")
        table = planned_answers(Results("out")).set_index(["question", "measure"])
        assert (table["answer"] == "open").all()
        if text:
            assert set(table.loc["early - late, arc", "runs"]) == {0}
            assert set(table.loc["early - late, line", "runs"]) == {40}
        else:
            assert len(table) == 9  # three pairs of scenarios, three outcomes
        done = CliRunner().invoke(app, ["summary", "out"])
        assert "valid at any time" in done.stdout
        assert "differ" not in done.stdout
        assert done.exit_code == 0


def test_the_summary_has_the_answers_and_no_other_comparison():
    tissue.run_study(write(HEAD + FACTORS + COMPARE), "out")
    done = CliRunner().invoke(app, ["summary", "out"])
    assert (done.exit_code, done.stderr) == (0, "")
    assert "Answers: 9 planned comparisons, 95 % for all together (simultaneous)" in done.stdout
    assert INTERACTION in done.stdout
    assert "against each other" not in done.stdout


def test_a_scenario_whose_runs_all_failed_hides_no_other(monkeypatch):
    def failing(parameters, replicates, *rest):
        cells, runs, tables = outcomes(parameters, replicates, *rest)
        table, every = runs.to_pandas(), parameters.layer.shape == "circle"
        table["status"] = np.where(every | (table["replicate"] < 3), "LUMEN_CLOSED", "SUCCESS")
        kept = [
            replicate in set(table.loc[table["status"] == "SUCCESS", "replicate"])
            for replicate in cells["replicate"].to_pylist()
        ]
        return Outcomes(cells.filter(kept), pa.Table.from_pandas(table, preserve_index=False), tables)

    monkeypatch.setattr("tissue.study.outcomes.outcomes", failing)
    results = tissue.run_study(write(HEAD + FACTORS + COMPARE), "out")
    reason = "all 40 runs of 'late, arc' failed: LUMEN_CLOSED"
    with pytest.raises(InvalidProblem, match=reason):
        planned_answers(results)
    done = CliRunner().invoke(app, ["summary", "out"])
    assert (done.exit_code, done.stderr) == (0, "")
    assert f"No answers: {reason}" in done.stdout
    assert "of 185; of the runs that did not fail: 37 of 40" in done.stdout
    write_csv(results)
    assert not Path("out/csv/answers.csv").exists()


def test_numbers_without_spread_decide_nothing():
    values = {"a": np.full(20, 1.0), "b": np.full(20, 0.0)}
    low, high, _, answer = _difference_so_far({"a": 1.0, "b": -1.0}, values, "height_um", 0.95)[1:5]
    assert (low, high, answer) == (-np.inf, np.inf, "open")


def test_one_run_has_no_spread():
    write((HEAD + FACTORS + COMPARE).replace("replicates = 40", "replicates = 1"))
    with pytest.raises(InvalidProblem, match="must have two runs that did not fail, to compare controls_apical"):
        planned_answers(tissue.run_study("study.toml", "out"))
