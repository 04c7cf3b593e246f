"""Who is cheapest at which error: on one problem, on several by profiles and means, and before any run is made."""

import math

import numpy as np
import pandas as pd
import pytest

import dincl
import verification as v
from verification.instruments.cheapest import cost_of, costs, front, rank, runs_of
from verification.instruments.speed_accuracy import WorkPrecisionRuns


def measured(errors, seconds, reference_error=0.0, method="A", **columns):
    count = len(errors)
    return pd.DataFrame(
        {
            "method": method,
            "setting": 0.1 / 2.0 ** np.arange(count),
            "status": ["SUCCESS"] * count,
            "largest": errors,
            "cpu_seconds": seconds,
            "spread": 1.0,
            "reference_error": reference_error,
        }
        | columns
    )


def ranked(*tables, targets=(1e-2,), certain=math.inf, cost="cpu_seconds"):
    return rank(costs(pd.concat(tables), targets, "largest", cost), certain)


POWER = np.array([1e-1, 3e-3, 2e-5])
COSTS = {
    "a power law between runs": (
        measured(POWER, 0.5 * POWER**-0.7).sample(frac=1, random_state=1),
        {target: 0.5 * target**-0.7 for target in (5e-2, 1e-3, 1e-4, 2e-5)},
    ),
    "nothing is extrapolated": (measured([1e-1, 1e-3], [1.0, 3.0]), {9e-4: math.inf, 0.5: 1.0}),
    "no runs": (measured([], []), {0.5: math.inf}),
    "two runs reach it": (measured([1e-9, 1e-9], [5.0, 4.0]), {1e-2: 4.0}),
    "small by chance": (measured([1e-1, 1e-5, 1e-2, 1e-4], [1.0, 2.0, 4.0, 8.0]), {1e-3: math.sqrt(4.0 * 8.0)}),
    # Large steps may be dear, and disturbed; a finer run that is cheaper has the error, too.
    "no more than a finer one": (
        measured([1e-1, 1e-3, 1e-4, 1e-5], [4.0, 3.0, 1.0, 2.0]),
        {1e-2: 1.0, 1e-3: 1.0, 5e-4: 1.0, 1e-4: 1.0, 1e-5: 2.0},
    ),
    "below the reference": (measured([1e-1, 1e-7], [1.0, 2.0], 1e-3), {1.9e-3: math.inf, 2e-3: 2.0}),
    "failed runs": (
        measured([1e-1, np.nan, 1e-3], [1.0, 0.1, 4.0], status=["SUCCESS", "NON_FINITE", "SUCCESS"]),
        {1e-2: 2.0},
    ),
}


@pytest.mark.parametrize("name", COSTS)
def test_cost_of_an_error(name):
    table, expected = COSTS[name]
    found = {target: cost_of(runs_of(table, "largest", "cpu_seconds"), target).value for target in expected}
    assert found == pytest.approx(expected)


def test_ranking_and_front():
    a, b = measured([1e-1, 1e-3], [1.0, 4.0]), measured([1e-3, 1e-6], [6.0, 7.0], method="B")
    found = ranked(b, a, targets=(1e-8, 1e-2, 1e-6))
    assert found["target"].tolist() == [1e-2, 1e-6, 1e-8]
    assert found["cheapest"].tolist() == ["A", "B", "not reached"]
    assert found["cost"].tolist()[:2] == pytest.approx([2.0, 7.0])
    assert found["next"].tolist() == ["B", "", ""]
    assert found["ratio"].iloc[0] == pytest.approx(3.0)
    best = front(pd.concat([a, measured([1e-2, 1e-2], [2.0, 5.0], method="B")]), "largest", "cpu_seconds")
    assert best["cpu_seconds"].tolist() == [1.0, 2.0, 4.0]
    assert best["method"].tolist() == ["A", "B", "A"]


@pytest.mark.parametrize(
    ("ratio", "spread", "word"), [(1.2, 1.0, "tie"), (1.3, 1.0, "A"), (1.3, 1.4, "tie"), (1.5, 1.4, "A")]
)
def test_costs_closer_than_the_spread_are_a_tie(ratio, spread, word):
    found = ranked(measured([1e-3], [1.0]), measured([1e-3], [ratio], method="B", spread=spread)).iloc[0]
    assert found["cheapest"] == word
    assert found["tied"] == ("A; B" if word == "tie" else "A")
    assert found["next"] == ("" if word == "tie" else "B")


def test_words_in_place_of_a_method():
    steps = [measured([1e-3], [1.0], method=method, steps=count) for method, count in (("A", 100), ("B", 101))]
    assert ranked(*steps, cost="steps")["cheapest"].tolist() == ["A"]  # counted work has no spread
    near = measured([1e-1, 1e-3], [0.01, 4.0])
    assert ranked(near, certain=3.9)["cheapest"].tolist() == ["at the limit"]
    assert ranked(near, certain=4.0)["cheapest"].tolist() == ["A"]
    rough = measured([1e-1, 1e-9], [1.0, 2.0], reference_error=1e-5)
    assert ranked(rough, targets=(1e-4, 1e-6))["cheapest"].tolist() == ["A", "not resolved"]


# Several problems


def chart(**prices):
    """Make a chart in which each method reaches 1e-4 at this cost, or not at all."""
    rows = [
        measured([1e-5 if price else 1.0], [price or 8.0], method=name, output_seconds=0.0, disturbed=False)
        for name, price in prices.items()
    ]
    families = {name: {"family": name} for name in prices}
    return v.WorkPrecision(pd.concat(rows, ignore_index=True), ("largest",), v.CpuSeconds(9.0), families)


FOUND = v.WorkPrecisionSet(
    {"one": chart(A=1.0, B=2.0), "two": chart(A=3.0, B=1.0), "three": chart(A=2.0, B=None), "four": chart(A=1, B=4.0)}
)


def test_profiles_are_shares_of_problems_within_a_ratio_of_the_best():
    profile = FOUND.profile(1e-4).set_index(["method", "ratio"])["share"]
    assert profile["A"].to_dict() == {1.0: 0.75, 3.0: 1.0}
    assert profile["B"].to_dict() == {1.0: 0.25, 2.0: 0.5, 4.0: 0.75}
    assert {line.get_label() for line in FOUND.plot(target=1e-4).lines} == {"A", "B"}
    assert "WorkPrecisionSet of 4 problems" in repr(FOUND)
    assert len(FOUND.table) == 8


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


def test_a_ladder_ends_at_an_error_that_is_enough_and_runs_say_the_error_that_they_state():
    stack, budget = dincl.scenes.stack(), v.DriftEvaluations(10**4)
    methods = [v.Method("adaptive", scheme=dincl.AdaptiveCatchUp, setting="tol"), v.Method("Auto", scheme=dincl.Auto)]
    given = (stack, methods, [1e-1, 1e-2, 1e-3, 1e-4], [1.0], stack.exact, budget, ("largest", "stated"))
    rows = WorkPrecisionRuns(*given, enough=1e-2).study().rows()
    for _, mine in rows.groupby("method"):
        tried = mine[mine["status"] != "LEFT_OUT"]
        assert (tried["largest"].iloc[:-1] > 1e-2).all()
        assert tried["largest"].iloc[-1] <= 1e-2
    auto = rows[(rows["method"] == "Auto") & (rows["status"] == "SUCCESS")]
    assert (auto["largest"] <= auto["stated"]).all()
    assert (auto["stated"] <= auto["setting"]).all()


# Recommendations

T = [1.0, 2.0]
BUILT_IN = {"midpoint catch-up", "adaptive catch-up", "linearised catch-up", "PBD", "event-driven"}


def largest_error(scene, scheme):
    states, exact = (dincl.solve(scene, one, t=T).x for one in (scheme, dincl.EventDriven(1e-11)))
    return np.linalg.norm(states - exact, axis=-1).max()


@pytest.mark.parametrize(
    ("scene", "error"), [(dincl.scenes.four_disks(), 1e-4), (dincl.scenes.pile(12), 1e-3)], ids=["few", "pile"]
)
def test_settings_of_the_built_in_methods_have_the_error(scene, error):
    found = v.recommend(scene, error, T)
    rows, projection = found.table.set_index("method"), dincl.ActiveSet(1e-3 * error)
    assert set(rows.index) == BUILT_IN
    assert (rows["why"] == "").all()
    assert (rows["cpu_seconds"] > 0).all()
    assert rows["cpu_seconds"].is_monotonic_increasing
    assert ((rows["low"] <= rows["error"]) & (rows["error"] <= rows["high"])).all()
    schemes = {
        "PBD": dincl.PBD,
        "linearised catch-up": lambda dt: dincl.LinearisedCatchUp(dt, projection),
        "midpoint catch-up": lambda dt: dincl.MidpointCatchUp(dt, projection),
        "adaptive catch-up": dincl.AdaptiveCatchUp,
        "event-driven": dincl.EventDriven,
    }
    for label, row in rows.iterrows():
        off = largest_error(scene, schemes[label](row["setting"]))
        assert row["low"] <= off <= min(row["high"], error)
    assert found.best == rows.index[0]
    assert found.best in repr(found)
    assert len(found.plot().patches) == len(rows)


def test_methods_of_the_user_and_why_one_is_out():
    scene = dincl.scenes.ten_disks_corner()
    exact = dincl.solve(scene, dincl.EventDriven(1e-11), t=T)
    methods = [
        v.Method("PBD", scheme=dincl.PBD),
        v.Method("too strong", scheme=lambda dt: dincl.Penalty(dt, strength=1e9)),
        v.Method("slow", scheme=lambda dt: dincl.PBD(dt / 1e6)),
        v.Method("refused", scheme=lambda dt: dincl.PBD(-dt)),
        v.Method("program", run=lambda problem, dt, t: exact.x + 0.1 * dt),
    ]
    table = v.recommend(scene, 1e-2, T, methods).table.set_index("method")
    assert set(table.index) == {method.label for method in methods}
    assert table.loc[["PBD", "program"], "why"].tolist() == ["", ""]
    assert not np.isfinite(table.loc[["too strong", "slow", "refused"], "cpu_seconds"]).any()
    assert "takes more than" in table.loc["slow", "why"]
    assert "dt = -" in table.loc["refused", "why"]
    assert table.loc["program", "setting"] <= 0.1
    assert v.recommend(scene, 1e-2, T, methods[2:4]).best == ""


@pytest.mark.slow
def test_an_error_that_no_short_run_has_is_extrapolated():
    scene, scheme = dincl.scenes.four_disks(), lambda dt: dincl.LinearisedCatchUp(dt, dincl.ActiveSet(1e-10))
    row = v.recommend(scene, 1e-6, T, {"linearised": scheme}).table.iloc[0]
    path = dincl.solve(scene, scheme(row["setting"]), t=T)
    assert path.stats.drift_evaluations > row["drift_evaluations"]
    assert row["low"] <= largest_error(scene, scheme(row["setting"])) <= min(row["high"], 1e-6)


def test_without_a_reference_all_methods_are_out_and_bad_input_is_named():
    late = dincl.Problem([[0.0, 0.0]], lambda t, x: -x if t < 0.5 else np.full_like(x, np.nan), [])
    found = v.recommend(late, 1e-3, [1.0])
    assert found.best == ""
    assert set(found.table["method"]) == BUILT_IN
    assert found.table["why"].str.startswith("there is no reference: Auto ended ").all()
    assert "none" in repr(found)
    for problem, error, t, message in (
        (3, 1e-3, [1.0], r"must be a dincl\.Problem"),
        (late, 1e-3, [1.0, 0.5], "t = "),
        (late, -1, [1.0], "error = -1"),
    ):
        with pytest.raises(dincl.InvalidProblem, match=message):
            v.recommend(problem, error, t)
