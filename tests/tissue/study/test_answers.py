"""What ``tissue summary`` says of a study: the numbers of its tables, with their intervals."""

from pathlib import Path

import pandas as pd
import pytest
from typer.testing import CliRunner

import tissue
from tissue.cli.app import app
from tissue.statistics.comparisons import Difference
from tissue.statistics.proportions import corrected
from tissue.statistics.ratios import as_ratio, ratio
from tissue.study import answers

PLAN = """
title = "Does the order of events matter?"
base = "published"
replicates = 24
seed = 5

[overrides.numerics]
t_end = "8 h"
keep = "2 h"

[overrides.emt]
cells = 2
inm = 0

[scenarios."[A]"]
emt = { a = "2 h" }

[scenarios."[B]"]
emt = { b = "2 h" }

[scenarios."[AB]"]
emt = { a = "2 h", b = "4 h" }
"""


@pytest.fixture(scope="module")
def study(tmp_path_factory):
    folder = tmp_path_factory.mktemp("studies")
    (folder / "order.toml").write_text(PLAN)
    return tissue.run_study(folder / "order.toml", folder / "order")


def test_ratios_are_those_of_the_cells(study):
    table = answers.scenario_ratios(study).set_index(["scenario", "outcome"])
    assert set(table.index.get_level_values(0)) == set(study.study.scenarios)
    for scenario in study.study.scenarios:
        cells = study.cells(scenario)
        last = max(float(name[3:-1]) for name in cells if name.startswith("ab_"))
        above = cells[f"ab_{last:g}h"] > 1
        row = table.loc[(scenario, "apical")]
        assert (row["count"], row["of"]) == (above.sum(), len(cells))
        low, high = ratio(above, cells["replicate"]).interval()
        assert (row["low"], row["high"]) == (low, high)
        assert low <= row["value"] <= high


def test_scenarios_are_compared_in_pairs_and_corrected_together(study):
    ratios = answers.scenario_ratios(study)
    table = answers.scenario_differences(ratios, study.study.replicates)
    count = len(study.study.scenarios)
    pairs = count * (count - 1) // 2 if count <= answers.MOST_PAIRED else count - 1
    assert len(table) == 3 * pairs
    values = ratios.set_index(["scenario", "outcome"])["value"]
    for row in table.itertuples():
        assert row.difference == pytest.approx(values[row.first, row.outcome] - values[row.second, row.outcome])
        assert row.low <= row.difference <= row.high
        assert row.differ == (row.p < 0.05)
        assert not (row.differ and pd.notna(row.needed))
    rows = ratios.set_index(["scenario", "outcome"])
    ends = [[as_ratio(rows.loc[name, row.outcome]) for name in (row.first, row.second)] for row in table.itertuples()]
    alone = [Difference(*pair).p_value() for pair in ends]
    assert table["p"].tolist() == pytest.approx(corrected(pd.Series(alone)).tolist())
    assert (table["p"] >= alone).all()


def test_many_scenarios_are_compared_with_the_first_one(study, monkeypatch):
    monkeypatch.setattr(answers, "MOST_PAIRED", 1)
    table = answers.scenario_differences(answers.scenario_ratios(study), study.study.replicates)
    assert set(table["first"]) == {study.study.scenarios[0]}
    assert len(table) == 3 * (len(study.study.scenarios) - 1)


def test_the_keys_in_which_scenarios_differ_are_named(study):
    table = answers.scenario_changes(study).set_index("key")
    assert list(table) == list(study.study.scenarios)
    assert all(key.startswith("emt.") for key in table.index)
    assert (table.nunique(axis=1) > 1).all()


def test_the_command_prints_them(study):
    done = CliRunner().invoke(app, ["summary", str(study.folder)])
    assert (done.exit_code, done.stderr) == (0, "")
    assert done.stdout.startswith(study.study.title)
    for row in answers.scenario_ratios(study).itertuples():
        assert f"{100 * row.value:.1f} % [{100 * row.low:.1f}, {100 * row.high:.1f}]" in done.stdout
    for row in answers.control_shares(study).itertuples():
        assert f"{100 * row.mean:.1f} %" in done.stdout
    assert "(Holm)" in done.stdout


def test_a_folder_without_a_study_is_refused(tmp_path):
    done = CliRunner().invoke(app, ["summary", str(tmp_path)])
    assert done.exit_code == 2
    assert "must be the results of a study" in done.stderr
    assert not list(Path(tmp_path).iterdir())
