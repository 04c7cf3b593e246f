"""Random scenes, the rules for choosing a method, and what is counted of ``Auto``."""

import numpy as np
import pandas as pd
import pytest

import dincl
from dincl.schemes.pilots import candidates
from dincl.study import read_sealed
from verification.beyond.decisions import profile, promise, study, tree
from verification.beyond.decisions.scenes import DRIFTS, SETS, scene
from verification.page.kept import STUDIES

QUICK, SLOW = "quick", "slow"


def test_scenes_come_again_and_are_of_all_kinds() -> None:
    made = [scene(seed) for seed in study.FULL.seeds]
    np.testing.assert_array_equal(made[3].problem.x0, scene(study.FULL.seeds[3]).problem.x0)
    assert {one.drift for one in made} == set(DRIFTS)
    assert {name for one in made for name in SETS if name in one.sets} == set(SETS)
    assert max(len(one.problem.x0) for one in made) > 200
    assert {one.problem.x0.shape[1] for one in made} == {2, 3}


def ladder(seed: int, particles: int, errors: dict[str, list[float]], asked: float = 1e-3) -> list[dict[str, object]]:
    """Return runs with halved steps and doubled times; ``slow`` costs ten times as much."""
    about = {"seed": seed, "particles": particles, "dimension": 2, "sets": "floor", "drift": "gravity", "asked": asked}
    return [
        about | {"method": name, "setting": 0.5**k, "error": error, "seconds": 2.0**k * (10 if name == SLOW else 1)}
        for name, found in errors.items()
        for k, error in enumerate(found)
    ]


def test_a_method_reaches_an_error_where_all_finer_runs_have_it() -> None:
    lucky = ladder(0, 3, {QUICK: [1.0, 1e-4, 0.1, 1e-4, 1e-5], SLOW: [1e-4, 1e-4, 1e-4]})
    (row,) = tree.costs(pd.DataFrame(lucky)).to_dict("records")
    assert (row["target"], row[QUICK], row[SLOW]) == (1e-3, 8.0, 10.0)
    assert tree.costs(pd.DataFrame(ladder(0, 3, {QUICK: [1e-4, 1.0]}))).empty


def many(count: int) -> pd.DataFrame:
    """Return scenes with 1 to 100 particles, of which ``quick`` serves those with at most 10."""
    rows = []
    for seed in range(count):
        n = int(np.geomspace(1, 100, count)[seed])
        errors = {QUICK: [1e-6] if n <= 10 else [1.0], SLOW: [1e-6]}
        rows += ladder(seed, n, errors)
    return pd.DataFrame(rows)


def test_the_tree_finds_the_rule_that_there_is() -> None:
    rows = tree.costs(many(80))
    made = tree.fit(rows)
    assert {(rule.conditions, rule.method) for rule in made.rules.values()} == {
        (("particles: at most 10",), QUICK),
        (("particles: more than 10",), SLOW),
    }
    told = tree.tried(made, rows)
    assert list(told["share"]) == [1.0, 1.0, 1.0]
    assert told["of"].iloc[-1] == 80
    few = int((rows["particles"] <= 10).sum())
    usual = tree.alone(rows).set_index("method")
    assert (usual.loc[QUICK, "count"], usual.loc[QUICK, "failed"]) == (few, 80 - few)
    assert (usual.loc[SLOW, "count"], usual.loc[SLOW, "failed"]) == (80 - few, 0)


def test_costs_are_divided_by_three_kinds_of_best_runs() -> None:
    rows = ladder(0, 3, {QUICK: [1.0, 1e-4, 0.1, 1e-4]})
    auto = {**rows[0], "status": "SUCCESS", "stated": 1e-3, "took": "PBD", "error": 5e-4}
    rows += [auto | {"method": study.AUTO, "seconds": 12.0}, auto | {"method": study.ALONE + QUICK, "seconds": 10.0}]
    (judged,) = promise.judged(pd.DataFrame(rows)).to_dict("records")
    assert [judged[name] for name in ("error", "lucky", "sure", "known")] == [0.5, 6.0, 1.5, 1.2]
    kept = promise.kept(pd.DataFrame([judged]))
    assert list(kept["count"]) == [1, 0, 1, 1]


@pytest.mark.slow
def test_a_scene_is_run_by_all_methods() -> None:
    rows = pd.DataFrame(study.run({"seed": 1004}))
    assert set(rows["method"]) == {
        *("midpoint catch-up", "linearised catch-up", "PBD", "event-driven", study.AUTO),
        *(name for name in rows["method"] if name.startswith(study.ALONE)),
    }
    auto = rows[rows["method"] == study.AUTO].iloc[0]
    assert auto["error"] <= auto["stated"] <= auto["asked"]
    for _, runs in rows[~rows["method"].str.startswith((study.AUTO, study.ALONE))].groupby("method"):
        assert runs["error"].iloc[-1] <= auto["asked"]


@pytest.mark.slow
def test_auto_keeps_the_error_on_the_kept_scenes() -> None:
    table = pd.read_parquet(STUDIES / "decisions.parquet")
    assert table["seed"].nunique() == len(study.FULL.seeds)
    kept = promise.kept(promise.judged(table)).iloc[0]
    assert kept["share"] >= promise.WANTED
    judged = promise.judged(table)
    assert len(judged) > 0.8 * len(study.FULL.seeds)


def test_a_profile_counts_who_is_the_cheapest_who_ties_and_who_fails() -> None:
    """Three scenes: PBD alone the cheapest, a tie, and one that only the event-driven scheme solves."""
    rows = []
    for seed, seconds in enumerate([(1.0, 2.0, np.inf), (1.0, 1.2, 3.0), (np.inf, np.inf, 1.0)]):
        about = {"seed": seed, "asked": 5e-4, "setting": 0.1, "status": "SUCCESS"}
        for name, cost in zip(("PBD", "midpoint catch-up", "event-driven"), seconds, strict=True):
            error = 1e-4 if np.isfinite(cost) else 1.0
            rows.append(about | {"method": name, "error": error, "seconds": min(cost, 9.0), "drift_evaluations": 7.0})
    rows += [about | {"seed": 3, "method": study.NO_REFERENCE, "error": np.nan, "seconds": np.nan}]
    found = profile.shares(pd.DataFrame(rows)).set_index(["cost", "error", "method"]).sort_index()
    mine = found.loc["CPU time", "10⁻⁴ to 10⁻³"]
    assert (mine["scenes"] == 3).all()
    assert mine.loc["PBD", ["alone", "1.25", "reached"]].tolist() == pytest.approx([1 / 3, 2 / 3, 2 / 3])
    assert mine.loc["midpoint catch-up", ["alone", "1.25", "2"]].tolist() == pytest.approx([0, 1 / 3, 2 / 3])
    assert mine.loc["event-driven", ["alone", "1.25", "10"]].tolist() == pytest.approx([1 / 3, 1 / 3, 2 / 3])
    assert mine.loc["linearised catch-up", "reached"] == 0
    counted = found.loc["evaluations of the drift", "10⁻⁴ to 10⁻³"]
    assert (counted["1.25"] == counted["reached"]).all()
    assert found.loc["CPU time", "10⁻⁵ to 10⁻⁴"]["scenes"].tolist() == [0, 0, 0, 0]


@pytest.mark.slow
def test_work_is_counted_on_the_kept_scenes() -> None:
    """Evaluations of the drift of all runs that were counted; two runs again."""
    table = read_sealed(STUDIES / "decisions.parquet")
    mine = table["method"].isin(profile.LOOKS)
    assert table.loc[mine, "drift_evaluations"].notna().all()
    given = scene(1004)
    for row in table[mine & (table["seed"] == 1004)].groupby("method").head(1).itertuples():
        method = next(one for one in candidates(given.problem, given.error) if one.label == row.method)
        made = dincl.solve(given.problem, method.make(row.setting), t=given.t)
        assert made.stats.drift_evaluations == row.drift_evaluations
