"""The forecast of a study: effects of the size it names are shown in four cases of five, and times add up."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from typer.testing import CliRunner

from tests.pages import ROOT
from tests.tissue.study.figures_stand_in import COMPARE, FACTORS, HEAD, INTERACTION
from tissue.cli import forecast
from tissue.cli.app import app
from tissue.study.estimates import estimate
from tissue.study.plan import load_study


@pytest.fixture
def study(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("study.toml").write_text(HEAD + FACTORS + COMPARE)
    return load_study("study.toml")


def test_the_assumed_correlation_is_that_of_nine_kept_ratios_of_ten():
    kept = pd.read_parquet(ROOT / "verification" / "data" / "emt_ratios.parquet")
    groups = kept[(kept["of"] > 1.5 * kept["runs"]) & kept["value"].between(0.005, 0.995)]
    cells = groups["of"] / groups["runs"]
    found = (groups["of"] / groups["effective"] - 1) / (cells - 1)
    assert found.quantile(0.9) == pytest.approx(forecast.WITHIN_RUN, abs=0.03)
    assert found.quantile(0.5) < 0.015


def test_effects_shrink_with_the_root_of_the_runs(study, monkeypatch):
    _, small = forecast.forecast(study)
    Path("study.toml").write_text((HEAD + FACTORS + COMPARE).replace("replicates = 40", "replicates = 160"))
    plan, large = forecast.forecast(load_study("study.toml"))
    assert len(large) == plan.count == 9
    rows = large["measure"] == "difference"
    for column in ("5 %", "20 %", "50 %", "spreads"):
        halves = (large.loc[rows, column] / small.loc[rows, column]).dropna()
        assert halves.to_numpy() == pytest.approx(np.full(3, 0.5), rel=0.04)
    basal = large[rows & (large["outcome"] == "basal")].set_index("question")["50 %"]
    assert basal[INTERACTION] == pytest.approx(np.sqrt(2) * basal["early - late, arc"])
    assert large.loc[large["outcome"] == "controls_apical", "50 %"].isna().all()


def test_the_power_of_pairs_is_that_of_their_differences(study):
    """One sample of n differences, whose spread is sqrt(2) that of a run where pairs do not correlate."""
    text = (HEAD + FACTORS + COMPARE).replace("seed = 3", "seed = 3\npaired = true").replace('"basal"', '"height_um"')
    Path("study.toml").write_text(text.replace("replicates = 40", "replicates = 8"))
    _, table = forecast.forecast(load_study("study.toml"))
    least = table[table["outcome"] == "height_um"].set_index("question")["spreads"]
    rng = np.random.default_rng(13)
    gaps = rng.normal(least["early - late, arc"], np.sqrt(2), (8, 4000))
    shown = estimate([1.0], [gaps]).p < 0.05 / 6
    assert np.mean(shown) == pytest.approx(0.8, abs=0.03)
    assert least[INTERACTION] == pytest.approx(np.sqrt(2) * least["early - late, arc"])
    said = CliRunner().invoke(app, ["study", "study.toml", "--plan"]).stdout
    assert "no correlation of runs with the same random numbers: if it is r, the least effects are sqrt(1 - r)" in said


@pytest.mark.parametrize("measure", ["difference", "ratio"])
def test_an_effect_of_this_size_is_shown_in_four_cases_of_five(measure, tmp_path, monkeypatch):
    """Cells of a run share a random share, by a beta distribution, so that they are correlated as is assumed."""
    monkeypatch.chdir(tmp_path)
    own = COMPARE.replace('["basal", "controls_apical"]', '["basal"]').replace('"difference", "ratio"', f'"{measure}"')
    Path("study.toml").write_text((HEAD + FACTORS + own).replace("replicates = 40", "replicates = 200"))
    _, table = forecast.forecast(load_study("study.toml"))
    least = table.set_index("question").loc["early - late, arc", "50 %"]
    high = 0.5 * np.sqrt(least) if measure == "ratio" else 0.5 + least / 2
    rates = (high, high / least if measure == "ratio" else high - least)
    rng, own_part = np.random.default_rng(12), 1 / forecast.WITHIN_RUN - 1
    groups = [rng.binomial(5, rng.beta(p * own_part, (1 - p) * own_part, (200, 1000))) / 5 for p in rates]
    shown = estimate([1.0, -1.0], groups, 1.0, ratio=measure == "ratio").p < 0.05 / 3
    assert 0.76 < np.mean(shown) < 0.84


def test_the_command_says_it_and_makes_no_run(study):
    done = CliRunner().invoke(app, ["study", "study.toml", "--plan"])
    assert (done.exit_code, done.stderr) == (0, "")
    words = (
        "9 comparisons, planned",
        "a correlation of 0.2",
        "near 20 %",
        "in spreads",
    )
    assert [one for one in words if one not in done.stdout] == []
    assert not Path("out").exists()
    Path("study.toml").write_text(HEAD + FACTORS)
    assert "18 comparisons, all pairs" in CliRunner().invoke(app, ["study", "study.toml", "--plan"]).stdout


def test_an_effect_beyond_all_shares_is_none(study):
    """Two runs of each show no difference of 100 points."""
    text = (HEAD + FACTORS + COMPARE).replace("replicates = 40", "replicates = 2")
    Path("study.toml").write_text(text)
    _, table = forecast.forecast(load_study("study.toml"))
    assert np.isinf(table.loc[table["outcome"] == "basal", "50 %"]).all()
    assert "none" in forecast.forecast_text(load_study("study.toml"))


def test_a_study_without_a_folder_is_refused(study):
    done = CliRunner().invoke(app, ["study", "study.toml"])
    assert done.exit_code == 2
    assert done.stderr == "Error: --out is missing: must be the folder of the results, or --plan\n"
