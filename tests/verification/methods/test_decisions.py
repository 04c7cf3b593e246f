"""Random scenes, and what is counted of the methods and of ``Auto`` on them."""

import numpy as np
import pandas as pd
import pytest

import dincl
from verification.methods.decisions import study
from verification.methods.decisions.scenes import DRIFTS, LAYOUTS, SETS, scene
from verification.site.store import shipped

PBD, EVENTS, MIDPOINT, ADAPTIVE = "PBD", "event-driven", "midpoint catch-up", "adaptive catch-up"


def test_scenes_come_again_and_are_of_all_kinds() -> None:
    """Each start is feasible, or ``Problem`` would refuse it."""
    made = [scene(seed) for seed in study.SEEDS[:70]]
    np.testing.assert_array_equal(made[3].problem.x0, scene(study.SEEDS[3]).problem.x0)
    assert {one.drift for one in made} == set(DRIFTS)
    assert {one.layout for one in made} == set(LAYOUTS)
    assert {name for one in made for name in one.sets.split(", ")} == set(SETS)
    assert max(len(one.problem.x0) for one in made) > 200
    assert {one.problem.x0.shape[1] for one in made} == {1, 2, 3}
    assert all((np.diff(one.t) > 0).all() for one in made)


# Of few particles: together they have all layouts and drifts, and nearly all kinds of sets in each dimension.
SMALL = "1 2 6 17 22 33 43 44 60 68 71 72 73 82 84 100 101 104 106 121 122 125 127 130 137 145 148 154 188 190 191 196"


@pytest.mark.slow
@pytest.mark.parametrize("seed", [int(seed) for seed in SMALL.split()])
def test_small_scenes_are_those_of_the_table_that_ships(seed: int) -> None:
    """The coarsest run by PBD is as far from the solution, here by events, as it says."""
    table, given = shipped("decisions").query(f"seed == {seed} and method == 'PBD'"), scene(seed)
    kept = table.loc[table["setting"].idxmax()]
    exact = dincl.solve(given.problem, dincl.EventDriven(1e-2 * given.error), given.t)
    run = dincl.solve(given.problem, dincl.PBD(kept["setting"]), given.t)
    largest = np.linalg.norm(run.x - exact.x, axis=-1).max()
    assert largest == pytest.approx(kept["largest"], abs=0.01 * given.error)


def row(seed: int, method: str, error: float, seconds: float, **others: object) -> dict[str, object]:
    """Return a run on a scene that asks for an error of 1e-3."""
    about = {"seed": seed, "asked": 1e-3, "reference_error": 1e-6, "setting": 0.1, "status": "SUCCESS"}
    about |= {"stated": np.nan, "drift_evaluations": 7.0, "spread": np.nan}
    return about | {"method": method, "largest": error, "cpu_seconds": seconds} | others


def test_the_promise_of_auto_is_judged_against_what_is_true() -> None:
    """A right run, one whose stated error is too small, one that is wrong, and one that fails."""
    rows = [row(seed, MIDPOINT, 1e-4, 2.0) for seed in range(4)]
    rows += [row(seed, ADAPTIVE, 1e-4, 4.0) for seed in range(4)]
    rows += [row(seed, PBD, 1e-2, 0.1) for seed in range(4)]
    rows.append(row(0, study.AUTO, 5e-4, 6.0, stated=4.995e-4))  # within the error of the reference
    rows.append(row(1, study.AUTO, 5e-4, 8.0, stated=4.9e-4))
    rows.append(row(2, study.AUTO, 5e-3, 12.0, stated=5e-4))
    rows.append(row(3, study.AUTO, np.nan, 1.0, status="NOT_CONVERGED"))
    rows.append(row(4, "", np.nan, np.nan, status=study.NO_REFERENCE))
    kept = study.promise(pd.DataFrame(rows))
    assert kept[["count", "of"]].to_numpy().tolist() == [[2, 4], [2, 3], [1, 3], [1, 3]]
    assert (kept["low"] < kept["share"]).all()
    assert (kept["share"] < kept["high"]).all()
    costs = study.costs_of_auto(pd.DataFrame(rows))
    assert costs["scenes"].tolist() == [3, 3, 3]
    assert costs["median"].tolist() == [4.0, 4.0, 2.0]
    assert costs["most"].tolist() == pytest.approx([5.6, 5.6, 2.8])


def test_a_profile_counts_who_is_the_cheapest_who_ties_and_who_fails() -> None:
    """PBD alone the cheapest, a tie, a scene that only the event-driven scheme solves, and one that nobody does."""
    rows = []
    for seed, seconds in enumerate([(1.0, 2.0, np.inf), (1.0, 1.2, 3.0), (np.inf, np.inf, 1.0), 3 * (np.inf,)]):
        for name, cost in zip((PBD, MIDPOINT, EVENTS), seconds, strict=True):
            rows.append(row(seed, name, 1e-4 if np.isfinite(cost) else 1.0, min(cost, 9.0)))
    rows.append(row(4, "", np.nan, np.nan, status=study.NO_REFERENCE))
    found = study.shares(pd.DataFrame(rows)).set_index(["cost", "error", "method"]).sort_index()
    mine = found.loc["CPU time", "10⁻⁴ to 10⁻³"]
    assert (mine["scenes"] == 4).all()
    assert mine.loc[PBD, ["alone", "1", "reached"]].tolist() == [0.25, 0.5, 0.5]
    assert mine.loc[MIDPOINT, ["alone", "1", "2"]].tolist() == [0, 0.25, 0.5]
    assert mine.loc[EVENTS, ["alone", "1", "10"]].tolist() == [0.25, 0.25, 0.5]
    assert mine.loc[ADAPTIVE, "reached"] == 0
    counted = found.loc["evaluations of the drift", "10⁻⁴ to 10⁻³"]
    assert (counted["1"] == counted["reached"]).all()
    assert found.loc["CPU time", "10⁻⁵ to 10⁻⁴"]["scenes"].tolist() == [0, 0, 0, 0, 0]


@pytest.mark.slow
def test_a_scene_is_run_by_all_methods() -> None:
    rows = pd.DataFrame(study.run_scene({"seed": 2}, smallest=False))
    assert set(rows["method"]) == {*study.LOOKS, study.AUTO}
    assert set(rows) == set(shipped("decisions"))
    auto = rows[rows["method"] == study.AUTO].iloc[0]
    assert auto["largest"] <= auto["stated"] <= auto["asked"]
    for _, runs in rows[rows["method"] != study.AUTO].groupby("method"):
        assert runs["largest"].iloc[-1] <= auto["asked"] or runs["status"].iloc[-1] != "SUCCESS"
        assert (runs["setting"].diff().dropna() < 0).all()


def test_auto_keeps_the_error_on_the_kept_scenes() -> None:
    right, _, stated, beyond = study.promise(shipped("decisions")).itertuples()
    assert right.of >= 0.9 * len(study.SEEDS)
    assert right.share >= study.WANTED["right"]
    assert stated.share >= study.WANTED["stated"]
    assert beyond.count == 0
