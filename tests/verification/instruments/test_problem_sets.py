"""Speed against accuracy on several problems: profiles, means and failures from the charts of each."""

import pickle

import numpy as np
import pandas as pd
import pytest

import dincl
import verification as v
from verification.instruments.chart import WorkPrecision
from verification.instruments.speed_accuracy import WorkPrecisionRuns

SLIDE, STACK = dincl.scenes.sliding_disc(), dincl.scenes.stack()
METHODS = {"PBD": dincl.PBD, "catch-up": lambda dt: dincl.CatchUp(dt, dincl.ActiveSet(tol=1e-12))}
STEPS = [0.1, 0.05, 0.025]
BUDGET = v.DriftEvaluations(10**4)


def chart(**costs):
    """Make a chart in which each method reaches 1e-4 at this cost, or not at all."""
    rows = [
        {"method": name, "setting": 0.1, "status": "SUCCESS", "largest": 1e-5 if cost else 1.0, "reference_error": 0.0}
        | {"cpu_seconds": cost or 8.0, "output_seconds": 0.0, "spread": 1.0, "disturbed": False}
        for name, cost in costs.items()
    ]
    return WorkPrecision(
        pd.DataFrame(rows), ("largest",), v.CpuSeconds(9.0), {name: {"family": name} for name in costs}
    )


FOUND = v.WorkPrecisionSet(
    {"one": chart(A=1.0, B=2.0), "two": chart(A=3.0, B=1.0), "three": chart(A=2.0, B=None), "four": chart(A=1, B=4.0)}
)


def test_profiles_are_shares_of_problems_within_a_ratio_of_the_best():
    profile = FOUND.profile(1e-4).set_index(["method", "ratio"])["share"]
    assert profile["A"].to_dict() == {1.0: 0.75, 3.0: 1.0}
    assert profile["B"].to_dict() == {1.0: 0.25, 2.0: 0.5, 4.0: 0.75}
    axes = FOUND.plot(target=1e-4)
    assert {line.get_label() for line in axes.lines} == {"A", "B"}


def test_costs_within_the_spread_of_repeats_are_the_best_and_each_problem_has_its_own_error():
    close = v.WorkPrecisionSet({"tie": chart(A=1.0, B=1.2), "apart": chart(A=1.0, B=1.3), "nobody": chart(A=None)})
    assert close.ratios().loc["tie"].tolist() == [1.0, 1.0]
    assert close.ratios().loc["apart"].tolist() == pytest.approx([1.0, 1.3])
    assert close.ratios().loc["nobody"].isna().all()
    profile = close.profile().set_index(["method", "ratio"])["share"]
    assert profile["A"].to_dict() == {1.0: pytest.approx(2 / 3)}
    assert profile["B"].to_dict() == {1.0: pytest.approx(1 / 3), 1.3: pytest.approx(2 / 3)}
    own = close.costs({"tie": 1e-4, "apart": 1e-6, "nobody": 1e-4})
    assert own.notna().any(axis=1).tolist() == [True, False, False]


def test_means_are_shifted_and_failures_cost_as_much_as_the_most_expensive_run():
    means = FOUND.means(1e-4).set_index("method")
    best = np.array([1.0, 1.0, 2.0, 1.0])  # with the median 1, the shift
    assert means.loc["A", "mean"] == pytest.approx(np.prod([2.0, 4.0, 3.0, 2.0]) ** 0.25 - np.median(best))
    assert means.loc["B", "mean"] == pytest.approx(np.prod([3.0, 2.0, 9.0, 5.0]) ** 0.25 - np.median(best))
    assert means["failed"].to_dict() == {"A": 0, "B": 1}
    assert means["ratio"].min() == 1.0


@pytest.mark.slow
def test_a_list_of_problems_gives_a_chart_each_and_their_averages(tmp_path):
    references = [SLIDE.exact, STACK.exact]
    found = v.work_precision([SLIDE, STACK], METHODS, STEPS, [1.0, 2.0], references, BUDGET)
    assert list(found.charts) == [SLIDE.title, STACK.title]
    assert len(found.table) == 2 * len(METHODS) * len(STEPS)
    alone = v.work_precision(STACK, METHODS, STEPS, [1.0, 2.0], STACK.exact, BUDGET)
    cost = "drift_evaluations"
    costs = found.costs(0.2, cost=cost).loc[STACK.title]
    pd.testing.assert_series_equal(costs, alone.costs([0.2], cost=cost)[0.2], check_names=False)
    assert costs.notna().any()
    assert "WorkPrecisionSet of 2 problems" in repr(pickle.loads(pickle.dumps(found)))
    assert (v.save([found], tmp_path).parent / "work_precision_set.parquet").exists()
    named = v.work_precision(
        {"slide": SLIDE}, METHODS, STEPS, {"slide": [1.0, 2.0]}, {"slide": SLIDE.exact}, BUDGET, "final"
    )
    assert named.charts["slide"].errors == ("final",)


def test_each_problem_needs_its_reference():
    with pytest.raises(dincl.InvalidProblem, match=r"reference = .*: must have one entry for each problem"):
        v.work_precision([SLIDE, STACK], METHODS, STEPS, [1.0], SLIDE.exact, BUDGET)
    with pytest.raises(dincl.InvalidProblem, match="problem is an empty list"):
        v.work_precision([], METHODS, STEPS, [1.0], [], BUDGET)


def test_a_ladder_ends_at_an_error_that_is_enough_and_runs_say_the_error_that_they_state():
    methods = [v.Method("adaptive", scheme=dincl.AdaptiveCatchUp, setting="tol"), v.Method("Auto", scheme=dincl.Auto)]
    errors = ("largest", "stated")
    runs = WorkPrecisionRuns(STACK, methods, [1e-1, 1e-2, 1e-3, 1e-4], [1.0], STACK.exact, BUDGET, errors, enough=1e-2)
    rows = runs.study().rows()
    for _, mine in rows.groupby("method"):
        tried = mine[mine["status"] != "LEFT_OUT"]
        assert (tried["largest"].iloc[:-1] > 1e-2).all()
        assert tried["largest"].iloc[-1] <= 1e-2
    auto = rows[(rows["method"] == "Auto") & (rows["status"] == "SUCCESS")]
    assert (auto["largest"] <= auto["stated"]).all()
    assert (auto["stated"] <= auto["setting"]).all()
