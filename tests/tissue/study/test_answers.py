"""What a study answers: means over runs, comparisons with their sentences, and what ``tissue summary`` says of them."""

import re

import numpy as np
import pandas as pd
import pyarrow as pa
import pytest
from typer.testing import CliRunner

import tissue
from dincl.errors import InvalidProblem
from tests.tissue.study.stand_in import COMPARE, FACTORS, HEAD, INTERACTION, random_outcomes, write
from tissue.cli.app import app
from tissue.study import answers
from tissue.study.answers import answer_table, scenario_means
from tissue.study.estimates import estimate, holm
from tissue.study.outcomes import Outcomes
from tissue.study.read import Results

FULL = HEAD + FACTORS + COMPARE


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("tissue.study.outcomes.outcomes", random_outcomes)


def said(folder="out"):
    done = CliRunner().invoke(app, ["summary", folder])
    assert (done.exit_code, done.stderr) == (0, "")
    return done.stdout


def shares(results, scenario, what="basal"):
    cells = results.cells(scenario)
    hits = {"basal": cells["ab_48h"] < 0, "apical": cells["ab_48h"] > 1, "below": cells["below_48h"]}[what]
    return hits.groupby(cells["replicate"]).mean().to_numpy()


def test_means_are_over_runs_of_the_shares_of_a_run():
    results = tissue.run_study(write(HEAD + FACTORS), "out")
    table = scenario_means(results).set_index(["scenario", "outcome"])
    assert len(table) == 4 * 5
    for scenario in results.study.scenarios:
        values = results.values(scenario, "basal")
        assert values.index.tolist() == list(range(40))
        assert values.tolist() == pytest.approx(shares(results, scenario).tolist())
        for what in ("basal", "apical", "below"):
            mean, row = estimate([1.0], [shares(results, scenario, what)], 1.0), table.loc[(scenario, what)]
            assert (row["runs"], row["value"]) == (40, pytest.approx(mean.value))
            assert (row["low"], row["high"]) == pytest.approx(mean.interval())
        runs = results.runs(scenario)
        controls = (runs["controls_apical_48h"] / runs["controls_48h"]).to_numpy()
        row = table.loc[(scenario, "controls_apical")]
        assert (row["low"], row["high"]) == pytest.approx(estimate([1.0], [controls], 0.15).interval())
    with pytest.raises(InvalidProblem, match=r"columns = \['hight_um_48h'\]: must be of"):
        results.values("late, arc", "hight_um")
    text = said()
    for row in table.itertuples():
        assert f"{100 * row.value:.1f} % [{100 * row.low:.1f}, {100 * row.high:.1f}]" in text


def test_answers_are_those_of_the_planned_comparisons_alone_and_corrected_together():
    results = tissue.run_study(write(FULL), "out")
    table = answer_table(results)
    assert len(table) == 9
    weights = results.study.compare.contrasts[INTERACTION]
    groups = [shares(results, name) for name in weights]
    for measure in ("difference", "ratio"):
        found = estimate(list(weights.values()), groups, 1.0, ratio=measure == "ratio")
        chosen = (table["question"] == INTERACTION) & (table["outcome"] == "basal") & (table["measure"] == measure)
        (row,) = table[chosen].to_dict("records")
        assert row["value"] == pytest.approx(found.effect)
        assert row["p"] >= found.p
        assert row["low"] <= found.interval()[0] < found.interval()[1] <= row["high"]
    null = np.where(table["measure"] == "ratio", 1.0, 0.0)
    assert (((table["low"] > null) | (table["high"] < null)) == (table["p"] < 0.05)).all()
    assert (table["answer"].isin(["larger", "smaller"]) == (table["p"] < 0.05)).all()
    assert (table.loc[table["needed"].notna(), "answer"] == "not shown").all()
    assert (table["runs"] == 40).all()
    text = said()
    assert "9 comparisons, p corrected for all of them (Holm), planned" in text
    assert all(finding in text for finding in table["finding"])


def tables(monkeypatch, values, compare="", paired=False):
    """Results whose scenarios have these numbers, one a run, by replicate."""
    head = HEAD.replace("= 40", "= 8").replace("seed = 3", f"seed = 3\npaired = {str(paired).lower()}")
    results = tissue.run_study(write(head + FACTORS + compare), "out")
    monkeypatch.setattr(Results, "values", lambda self, scenario, outcome: values[scenario])
    return results


@pytest.mark.parametrize("paired", [False, True])
def test_a_contrast_of_paired_scenarios_is_one_of_differences_of_each_replicate(monkeypatch, paired):
    rng, common = np.random.default_rng(2), np.random.default_rng(3).normal(50, 3, 40)
    names = {"late, line": 0.0, "late, arc": 1.0, "early, line": 2.0, "early, arc": 2.5}
    values = {name: pd.Series(common + more + rng.normal(0, 0.1, 40)) for name, more in names.items()}
    values["late, arc"] = values["late, arc"].drop([3, 5])  # runs that failed
    text = COMPARE.replace('["basal", "controls_apical"]', '["height_um"]')
    table = answer_table(tables(monkeypatch, values, text, paired)).set_index("question")
    row = table.loc["early - late, arc"]
    first, second = values["early, arc"], values["late, arc"]
    if paired:
        gaps = (first - second).dropna().to_numpy()
        known = estimate([1.0], [gaps])
    else:
        known = estimate([1.0, -1.0], [first.to_numpy(), second.to_numpy()])
    assert (row["value"], row["runs"]) == (pytest.approx(known.value), 38)
    assert (table["p"] < 1e-6).all() == paired


def hits(percent):
    return pd.Series(np.repeat((1.0, 0.0), (4 * percent, 400 - 4 * percent)))


ARC, BOTH, CHANGES = "early - late, arc", INTERACTION, "It is not shown that early changes basal extrusion"


@pytest.mark.parametrize(
    ("percents", "question", "measure", "sentence"),
    [
        ((20, 30, 20, 60), ARC, "difference", "early raises basal extrusion by 40.0 points [] in arc, against late"),
        ((20, 30, 60, 20), ARC, "difference", "early lowers basal extrusion by 40.0 points [] in arc, against late"),
        ((20, 30, 40, 41), ARC, "difference", f"{CHANGES} in arc, against late: +1.0 points []"),
        ((20, 30, 20, 60), ARC, "ratio", "early multiplies basal extrusion by 3.00 [] in arc, against late"),
        ((20, 30, 20, 60), BOTH, "difference", "raises basal extrusion by 30.0 points [] more in arc than in line"),
        ((20, 60, 20, 30), BOTH, "difference", "raises basal extrusion by 30.0 points [] less in arc than in line"),
        ((20, 30, 60, 20), BOTH, "difference", "lowers basal extrusion by 50.0 points [] more in arc than in line"),
        ((90, 10, 60, 20), BOTH, "difference", "lowers basal extrusion by 40.0 points [] less in arc than in line"),
        ((20, 30, 20, 60), BOTH, "ratio", "by a factor that is 2.00 [] times as large in arc as in line"),
        ((20, 30, 30, 40), BOTH, "difference", f"{CHANGES} more in arc than in line, against late: +0.0 points []"),
    ],
)  # fmt: skip
def test_headings_are_sentences(monkeypatch, percents, question, measure, sentence):
    names = ("late, line", "early, line", "late, arc", "early, arc")
    values = dict(zip(names, map(hits, percents), strict=True))
    table = answer_table(tables(monkeypatch, values, COMPARE)).set_index(["question", "measure", "outcome"])
    assert sentence in re.sub(r"\[.*?\]", "[]", table.loc[(question, measure, "basal"), "finding"])


def test_a_question_of_ones_own_is_its_heading(monkeypatch):
    asked = '[compare]\noutcomes = ["basal"]\n[compare.contrasts."Is it so?"]\n"late, arc" = 1\n"late, line" = -1\n'
    values = {"late, line": hits(20), "late, arc": hits(70)}
    (finding,) = answer_table(tables(monkeypatch, values, asked))["finding"]
    assert finding.startswith("Is it so? basal extrusion +50.0 points [+")


def test_without_a_plan_all_pairs_are_compared(monkeypatch):
    results = tissue.run_study(write(HEAD + FACTORS), "out")
    table = answer_table(results)
    assert len(table) == 3 * 6
    means = scenario_means(results).set_index(["scenario", "outcome"])["value"]
    for row in table.itertuples():
        later, first = row.question.split(" - ")
        assert row.value == pytest.approx(means[later, row.outcome] - means[first, row.outcome])
    groups = [[shares(results, name, row.outcome) for name in row.question.split(" - ")] for row in table.itertuples()]
    alone = [float(estimate([1.0, -1.0], pair, 1.0).p) for pair in groups]
    assert table["p"].tolist() == pytest.approx(holm(alone)[0].tolist())
    assert "not planned: all pairs of scenarios" in said()
    assert answers.scenario_changes(results)["key"].tolist() == ["emt.a", "layer.shape", "layer.perimeter"]
    monkeypatch.setattr("tissue.study.plan.MOST_PAIRED", 3)
    assert answer_table(results)["question"].str.endswith(" - late, line").all()


def test_what_was_changed_after_runs_were_there_is_remarked(monkeypatch):
    tissue.run_study(write(FULL), "out")
    assert "were" not in said().partition("Answers")[2].partition("\n")[0]
    results = tissue.run_study(write(FULL.replace("replicates = 40", "replicates = 48")), "out")
    assert (answer_table(results)["runs"] == 48).all()
    assert "runs were added after others were there" in said()
    monkeypatch.setattr("tissue.study.outcomes.outcomes", None)  # no run is made
    other = FULL.replace("replicates = 40", "replicates = 48").replace('"controls_apical"', '"below"')
    assert set(answer_table(tissue.run_study(write(other), "out"))["outcome"]) == {"basal", "below"}
    assert "the comparisons were changed when there were runs" in said()


def test_a_study_in_progress_is_answered_by_what_is_there(monkeypatch):
    def all_but_the_last(parameters, *rest):
        if parameters.emt.a.high < 10 and parameters.layer.shape == "circle":
            raise KeyboardInterrupt
        return random_outcomes(parameters, *rest)

    monkeypatch.setattr("tissue.study.outcomes.outcomes", all_but_the_last)
    for text in (COMPARE, ""):
        with pytest.raises(KeyboardInterrupt):
            tissue.run_study(write(HEAD + FACTORS + text), "out")
        table = answer_table(Results("out"))
        if text:
            of_arc = table["question"].str.contains("arc")
            assert (table.loc[of_arc, "finding"].str.endswith("'early, arc' is stored yet")).all()
            assert (table.loc[of_arc, "answer"] == "no answer").all()
            assert set(table.loc[~of_arc, "runs"]) == {40}
        else:
            assert len(table) == 9  # three pairs of scenarios, three outcomes
        assert "runs are missing" in said()


def test_a_scenario_whose_runs_all_failed_hides_no_other(monkeypatch):
    def failing(parameters, replicates, *rest):
        cells, runs = random_outcomes(parameters, replicates, *rest)
        table, every = runs.to_pandas(), parameters.layer.shape == "circle"
        table["status"] = np.where(every | (table["replicate"] < 3), "LUMEN_CLOSED", "SUCCESS")
        sound = set(table.loc[table["status"] == "SUCCESS", "replicate"])
        kept = [replicate in sound for replicate in cells["replicate"].to_pylist()]
        return Outcomes(cells.filter(kept), pa.Table.from_pandas(table, preserve_index=False))

    monkeypatch.setattr("tissue.study.outcomes.outcomes", failing)
    results = tissue.run_study(write(FULL), "out")
    table = answer_table(results).set_index(["question", "measure", "outcome"])
    assert table.loc["early - late, line", "difference", "basal"]["runs"] == 37
    reason = table.loc["early - late, arc", "difference", "basal"]["finding"]
    assert reason == "No answer to early - late, arc: all 40 runs of 'late, arc' failed: LUMEN_CLOSED"
    text = said()
    assert reason in text
    assert "37 of 40" in text
    CliRunner().invoke(app, ["summary", "out", "--csv"])
    assert len(pd.read_csv("out/csv/answers.csv")) == 9
