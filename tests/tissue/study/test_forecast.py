"""The forecast of a study: effects of the size it names are shown in four cases of five, and times add up."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from typer.testing import CliRunner

from tests.pages import ROOT
from tests.tissue.study.test_compare import COMPARE, FACTORS, HEAD, INTERACTION
from tissue.cli.app import app
from tissue.statistics.contrasts import Family, ProportionContrast, RatioContrast
from tissue.statistics.ratios import ratio
from tissue.study import forecast
from tissue.study.forecast import RunTime, duration, effective_cells, measured_costs, useful_workers, worker_numbers
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


@pytest.mark.slow
@pytest.mark.parametrize("kind", [ProportionContrast, RatioContrast])
def test_an_effect_of_this_size_is_shown_in_four_cases_of_five(kind, tmp_path, monkeypatch):
    """Cells of a run share a random share, by a beta distribution, so that they are correlated as is assumed."""
    monkeypatch.chdir(tmp_path)
    measure = "ratio" if kind is RatioContrast else "difference"
    own = COMPARE.replace('["basal", "controls_apical"]', '["basal"]').replace('"difference", "ratio"', f'"{measure}"')
    Path("study.toml").write_text((HEAD + FACTORS + own).replace("replicates = 40", "replicates = 200"))
    plan, table = forecast.forecast(load_study("study.toml"))
    least = table.set_index("question").loc["early - late, arc", "50 %"]
    near = 0.5 * np.sqrt(least) if measure == "ratio" else 0.5 + least / 2, 0.5
    shares = (0.5, near[0] / least if measure == "ratio" else near[0] - least, 0.5, near[0])
    rng, own_part, shown = np.random.default_rng(12), 1 / forecast.WITHIN_RUN - 1, []
    weights = [tuple(plan.contrasts[one].get(name, 0.0) for name in plan.scenarios) for one in plan.contrasts]
    by_name = dict(zip(("late, line", "late, arc", "early, line", "early, arc"), shares, strict=True))
    for _ in range(300):
        found = []
        for name in plan.scenarios:
            each = rng.beta(by_name[name] * own_part, (1 - by_name[name]) * own_part, 200)
            hits = rng.random((200, 5)) < each[:, None]
            found.append(ratio(pd.Series(hits.ravel()), pd.Series(np.repeat(np.arange(200), 5))))
        block = tuple(kind(one, tuple(found)) for one in weights)
        low, high = block[1].interval(Family((block,)).level_of_each)
        shown.append(not low <= block[1].null <= high)
    assert 0.7 < np.mean(shown) < 0.9


def test_cells_of_a_run_count_for_fewer(study):
    assert effective_cells(study, "late, arc") == pytest.approx(5 / 1.8)


def test_times_are_those_of_workers_that_take_piece_after_piece(study):
    costs = {name: RunTime(seconds, True) for name, seconds in zip(study.scenarios, (1.0, 1.0, 2.0, 4.0), strict=True)}
    assert duration(study, costs, 1) == 320
    assert duration(study, costs, 2) == 200  # 40 + 160, beside 40 + 80
    assert duration(study, costs, 8) == 160
    assert useful_workers(study) == 4
    assert worker_numbers(2, 20) == [1, 2, 8, 20]


def test_costs_are_measured_by_short_runs(study, monkeypatch):
    Path("study.toml").write_text((HEAD + FACTORS).replace('keep = "24 h"', 'keep = "1 h"\nt_end = "2 h"'))
    costs = measured_costs(load_study("study.toml"))
    assert all(one.seconds > 0 and one.whole for one in costs.values())
    monkeypatch.setattr(forecast, "LEAST", 0.0)
    monkeypatch.setattr(forecast, "PATIENCE", 0.0)
    assert not any(one.whole for one in measured_costs(load_study("study.toml")).values())


def test_the_command_says_it_and_makes_no_run(study, monkeypatch):
    monkeypatch.setattr(forecast, "measured_costs", lambda study: dict.fromkeys(study.scenarios, RunTime(0.5, True)))
    done = CliRunner().invoke(app, ["study", "study.toml", "--plan"])
    assert (done.exit_code, done.stderr) == (0, "")
    words = (
        "9 comparisons, planned",
        "count as 2.8 independent ones",
        "near 20 %",
        "in spreads",
        "this machine",
        "80 s",
    )
    assert [one for one in words if one not in done.stdout] == []
    assert not Path("out").exists()
    Path("study.toml").write_text(HEAD + FACTORS)
    assert "18 comparisons, all pairs" in CliRunner().invoke(app, ["study", "study.toml", "--plan"]).stdout


def test_a_study_without_a_folder_is_refused(study):
    done = CliRunner().invoke(app, ["study", "study.toml"])
    assert done.exit_code == 2
    assert done.stderr == "Error: --out is missing: must be the folder of the results, or --plan\n"
