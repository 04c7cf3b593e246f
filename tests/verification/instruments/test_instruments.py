"""Orders, speed against accuracy, maps and references on problems that the library does not know."""

import pickle
from functools import partial

import numpy as np
import pandas as pd
import pytest

import dincl
import verification as v
from verification.instruments import measure
from verification.instruments.stability import StabilityRuns, judged_run

SLIDE = dincl.scenes.sliding_disc()
T = [1.0, 2.0, 3.0]
STEPS = [0.1 / 2**k for k in range(6)]
METHODS = {"PBD": dincl.PBD, "catch-up": lambda dt: dincl.CatchUp(dt, dincl.Daqp(tol=1e-12))}


def euler(problem, dt, t):
    """Explicit Euler steps of the drift, each followed by a push out of the floor of the slide."""
    return dincl.solve(problem, dincl.PBD(dt), t=t).x


@pytest.fixture(scope="module")
def chart():
    methods = [
        v.Method("PBD", "PBD", dincl.PBD),
        v.Method("own", "own", run=euler),
        v.Method("exact", "own", run=lambda problem, dt, t: SLIDE.exact(t)),
        v.Method("broken", run=lambda problem, dt, t: np.full((len(t), 1, 2), np.nan)),
        v.Method("raises", run=lambda problem, dt, t: 1 / 0),
    ]
    return v.work_precision(SLIDE, methods, STEPS, T, SLIDE.exact, budget=v.CpuSeconds(5.0))


# Orders


@pytest.mark.slow
def test_order_study_reads_the_orders_of_any_methods():
    found = v.order_study(SLIDE, METHODS, STEPS, T, v.reference(SLIDE, 1e-11))
    fits = found.fits.set_index(["method", "error"])
    for label in METHODS:
        assert fits.loc[(label, "largest"), "low"] < 1.1
        assert fits.loc[(label, "largest"), "high"] > 0.9
    assert len(found.table) == len(METHODS) * len(STEPS)
    assert set(found.table["role"]) <= {"used", "pre-asymptotic", "floor", "failed"}
    assert "PBD, largest: " in repr(found)
    path = dincl.solve(SLIDE, dincl.PBD(0.05), t=T)
    row = found.table[(found.table["method"] == "PBD") & (found.table["setting"] == 0.05)].iloc[0]
    assert row["largest"] == np.linalg.norm(path.x - SLIDE.exact(np.array(T)), axis=-1).max()


def test_failed_runs_are_rows_of_an_order_study():
    four = dincl.scenes.four_disks()
    found = v.order_study(four, {"PBD": dincl.PBD}, [1.0, *STEPS], [1.0], v.reference(four, 1e-11), errors="final")
    first = found.table.iloc[0]
    assert (first["status"], first["role"]) == ("COINCIDENT_CENTRES", "failed")
    assert found.summaries()["Runs without an error."]["setting"].tolist() == [1.0]
    assert found.fits["failed"].tolist() == [1]


def test_each_method_may_have_settings_of_its_own_and_errors_below_a_floor_enter_no_fit():
    settings = {"dt": STEPS, "catch-up": STEPS[:5]}
    found = v.order_study(SLIDE, METHODS, settings, T, SLIDE.exact, errors="final")
    assert found.table.groupby("method").size().to_dict() == {"PBD": len(STEPS), "catch-up": 5}
    floor = float(found.table[found.table["method"] == "PBD"]["final"].iloc[2])
    none = v.order_study(SLIDE, METHODS, settings, T, SLIDE.exact, errors="final", floor=floor)
    assert none.table["role"].tolist().count("floor") > found.table["role"].tolist().count("floor")
    assert none.fits["order"].tolist() == ["none", "none"]
    with pytest.raises(dincl.InvalidProblem, match="settings = "):
        v.order_study(SLIDE, METHODS, settings | {"catch-up": STEPS[:4]}, T, SLIDE.exact)


# Speed against accuracy


def test_errors_in_all_norms_come_from_one_run(chart):
    row = chart.table[(chart.table["method"] == "PBD") & (chart.table["setting"] == 0.1)].iloc[0]
    path = dincl.solve(SLIDE, dincl.PBD(0.1), t=T)
    error = np.linalg.norm(path.x - SLIDE.exact(path.t), axis=-1).max(axis=1)
    assert (row["largest"], row["final"]) == (error.max(), error[-1])
    assert row["overlap"] == path.violation().max()
    assert row["drift_evaluations"] == path.stats.drift_evaluations


def test_a_program_of_ones_own_stands_beside_the_schemes(chart):
    table = chart.table.set_index(["method", "setting"])
    for step in STEPS:
        assert table.loc[("own", step), "largest"] == table.loc[("PBD", step), "largest"]
        assert table.loc[("own", step), "drift_evaluations"] >= 3 / step
    assert set(table.loc["broken", "status"]) == {"NON_FINITE"}
    assert set(table.loc["raises", "status"]) == {"FAILED"}
    assert "ZeroDivisionError" in table.loc["raises", "detail"].iloc[0]


def test_chart_names_the_cheapest_of_all_and_of_each_family(chart):
    found = chart.cheapest([1e-4, 1e-6])
    assert found["cheapest"].tolist() == ["exact", "exact"]
    by_family = chart.families([1e-2, 1e-6]).set_index(["target", "family"])["method"]
    assert by_family[1e-2, "PBD"] == "PBD"
    assert by_family[1e-6, "own"] == "exact"
    efficient = chart.front()
    assert efficient["method"].iloc[-1] == "exact"
    assert (np.diff(efficient["cpu_seconds"]) >= 0).all()
    assert (np.diff(efficient["accuracy"]) < 0).all()
    wide = chart.costs([1e-2, 1e-6])
    assert wide.loc["PBD"].notna().tolist() == [True, False]
    assert chart.cheapest([1e-2], cost="steps")["cheapest"].tolist() == ["PBD"]  # nobody counts steps of the others


def test_budget_of_counted_work_is_the_same_every_time():
    runs = [
        v.work_precision(SLIDE, {"PBD": dincl.PBD}, STEPS, T, SLIDE.exact, v.DriftEvaluations(100)).table
        for _ in range(2)
    ]
    assert runs[0]["status"].tolist() == ["SUCCESS", "SUCCESS", "OUT_OF_BUDGET", "LEFT_OUT", "LEFT_OUT", "LEFT_OUT"]
    columns = [name for name in runs[0] if name not in ("cpu_seconds", "output_seconds", "spread", "disturbed")]
    pd.testing.assert_frame_equal(runs[0][columns], runs[1][columns])


def test_a_run_is_stopped_by_cpu_time_and_finer_ones_are_left_out():
    found = v.work_precision(SLIDE, {"PBD": dincl.PBD}, [1e-7, 1e-8], T, SLIDE.exact, v.CpuSeconds(0.01)).table
    assert found["status"].tolist() == ["OUT_OF_BUDGET", "LEFT_OUT"]
    assert found["largest"].isna().all()


def test_nothing_finer_is_tried_after_a_program_that_cannot_be_stopped(monkeypatch):
    times = iter([0.0, 9.0] * 4)  # of the run that is thrown away, and of the first one
    monkeypatch.setattr(measure.time, "process_time", lambda: next(times))
    own = v.Method("own", run=lambda problem, dt, t: SLIDE.exact(t))
    found = v.work_precision(None, [own], [0.1, 0.05], T, SLIDE.exact, v.CpuSeconds(1.0)).table
    assert found["status"].tolist() == ["SUCCESS", "LEFT_OUT"]


def test_waiting_for_the_processor_is_said(monkeypatch):
    cpu, wall = iter(np.arange(100.0)), iter(3 * np.arange(100.0))
    monkeypatch.setattr(measure.time, "process_time", lambda: next(cpu))
    monkeypatch.setattr(measure.time, "perf_counter", lambda: next(wall))
    own = v.Method("own", run=lambda problem, dt, t: SLIDE.exact(t))
    found = v.work_precision(SLIDE, [own], [0.1], T, SLIDE.exact, v.CpuSeconds(1e3))
    assert found.table["disturbed"].tolist() == [True]
    assert "1 of 1 measurements were disturbed" in next(iter(found.summaries()))


def test_brief_runs_are_repeated_in_turn_and_the_shortest_without_output_counts(monkeypatch):
    seen, clock = [], [0.0]
    seconds = {
        (0.1, 3): iter([0.15, 0.11, 0.12]),
        (0.05, 3): iter([2.0]),
        (0.025, 3): iter([0.1, 0.2, 0.3]),
        (0.1, 1): iter([0.05, 0.1, 0.4]),
        (0.05, 1): iter([1.5]),
        (0.025, 1): iter([0.2, 0.2, 0.2]),
    }
    monkeypatch.setattr(measure, "_warm_up", lambda *_: None)
    monkeypatch.setattr(measure.time, "process_time", lambda: clock[0])

    def run(problem, dt, t):
        seen.append((dt, len(t)))
        clock[0] += next(seconds[dt, len(t)])
        return SLIDE.exact(t)

    known = v.Known(np.array(T), SLIDE.exact(np.array(T)), np.zeros(3))
    rows = measure.measure(None, v.Method("own", run=run), (0.1, 0.05, 0.025), known, ("final",), None)
    first = [(0.1, 3), (0.05, 3), (0.025, 3), (0.1, 1), (0.05, 1), (0.025, 1)]
    assert seen == first + 2 * [(0.1, 3), (0.1, 1), (0.025, 3), (0.025, 1)]
    assert [row["repeats"] for row in rows] == [3, 1, 3]
    assert [row["cpu_seconds"] for row in rows] == pytest.approx([0.05, 1.5, 0.2])
    assert [row["output_seconds"] for row in rows] == pytest.approx([0.06, 0.5, 0.0])
    assert rows[0]["spread"] == pytest.approx(2.0)


def test_methods_are_left_out_of_what_they_are_not_made_for():
    small = v.Method("small", scheme=dincl.PBD, most_unknowns=1)
    found = v.work_precision(SLIDE, [small], [0.1], T, SLIDE.exact, v.CpuSeconds(1.0)).table
    assert found["status"].tolist() == ["LEFT_OUT"]
    assert "2" in found["detail"].iloc[0]


# Maps


def test_map_finds_the_limit_of_a_penalty():
    walls = [dincl.HalfSpace(normal=(1,)), dincl.HalfSpace(normal=(-1,), offset=-1.0)]
    between = dincl.Problem([[0.5]], lambda t, x: -np.ones_like(x), walls)
    found = v.stability_map(between, dincl.Penalty, x=("dt", [0.01, 0.05]), y=("strength", [10.0, 1000.0]))
    outcomes = found.table.set_index(["dt", "strength"])["outcome"]
    assert outcomes[0.01, 10.0] == "bounded"
    assert outcomes[0.05, 1000.0] == "unstable"
    assert "unstable" in repr(found)


def test_the_one_argument_of_a_method_may_have_any_name():
    def drawn(rate):
        return dincl.Problem([[1.0]], lambda t, x: -rate * x)

    found = v.stability_map(drawn, lambda h: dincl.PBD(h, sweeps=1), ("dt", [0.1, 3.0]), ("rate", [1.0]), t=[30.0])
    assert found.table.set_index("dt")["outcome"].to_dict() == {0.1: "bounded", 3.0: "unstable"}


def test_a_parameter_of_a_map_may_belong_to_the_problem():
    def pulled(speed):
        return dincl.Problem([[1.0]], lambda t, x: -speed * np.ones_like(x), [dincl.HalfSpace(normal=(1,))])

    def exact(problem):
        return lambda t: np.zeros((len(t), 1, 1))

    found = v.stability_map(pulled, dincl.PBD, ("dt", [0.1]), ("speed", [0.5, 4.0]), t=[1.0], reference=exact)
    assert found.table["outcome"].tolist() == ["inaccurate", "converged"]


def test_the_error_in_a_map_is_the_largest_of_all_times():
    falling = dincl.Problem([[1.0]], lambda t, x: -np.ones_like(x))
    errors = np.array([0.25, 1.0, 0.5])
    found = v.stability_map(
        falling,
        dincl.PBD,
        ("dt", [0.1]),
        ("dt", [0.1]),
        t=[0.5, 1.0, 1.5],
        reference=lambda problem: lambda t: 1.0 - t[:, None, None] + errors[:, None, None],
    )
    assert found.table["error"].tolist() == [pytest.approx(1.0)]


def judged(dt, strength):
    return v.Outcome.UNSTABLE if dt * strength > 2 else v.Outcome.CONVERGED


def at_rest(problem):
    return problem.x0


def test_several_methods_have_a_panel_each_with_the_limits_that_theory_predicts():
    walls = [dincl.HalfSpace(normal=(side,)) for side in (1, -1)]
    found = v.stability_map(
        dincl.Problem([[0.0]], lambda t, x: -np.ones_like(x), walls),
        {"springs": dincl.Penalty, "as printed": partial(dincl.Penalty, exponent=1)},
        x=("dt", [0.001, 0.01, 0.1], "step dt [time]"),
        y=("strength", [10.0, 100.0, 1000.0]),
        t=lambda dt: 100 * dt + dt * np.arange(3),
        reference=at_rest,
        accurate=1.0,
        feasible=1.0,
        limits=[v.Limit("dt k = 2", lambda dt: 2 / dt, ["springs"]), v.Limit("load", 1.0)],
    )
    table, curves = found.table, found.limits
    springs = table[table["method"] == "springs"]
    assert ((springs["outcome"] == "unstable") == (springs["dt"] * springs["strength"] > 2)).all()
    assert curves.groupby("label")["method"].unique().map(list).to_dict() == {
        "dt k = 2": ["springs"],
        "load": ["springs", "as printed"],
    }
    mine = curves[curves["label"] == "dt k = 2"]
    assert mine["x"].iloc[[0, -1]].to_numpy() == pytest.approx([1e-3 / 10**0.5, 0.1 * 10**0.5])
    assert (mine["x"] * mine["y"]).to_numpy() == pytest.approx(2.0)
    first = found.plot()
    assert [panel.get_title(loc="left") for panel in first.figure.axes] == ["springs", "as printed"]
    assert [line.get_label() for line in first.lines] == ["dt k = 2", "load"]
    assert found.plot(method="as printed").get_xlabel() == "step dt [time]"
    assert pickle.loads(pickle.dumps(found)).summaries().keys() == found.summaries().keys()


def test_runs_that_judge_themselves_may_be_several():
    runs = StabilityRuns(None, {"a": judged, "b": judged}, ("dt", [0.1, 1.0]), ("strength", [1.0, 10.0]))
    found = runs.result(runs.study().rows())
    assert found.table["method"].tolist() == ["a"] * 4 + ["b"] * 4
    assert found.table["outcome"].tolist() == ["converged", "converged", "converged", "unstable"] * 2
    runs.result(found.table.iloc[:3]).plot()  # a cell without a run is white


def test_a_judged_run_tells_falling_from_flying_and_takes_the_largest_error():
    free = dincl.Problem([[0.0]], lambda t, x: -np.ones_like(x))
    assert judged_run(free, dincl.PBD(dt=0.5), [50.0], [[0.0]])["outcome"] == "inaccurate"
    flying = judged_run(dincl.Problem([[1.0]], lambda t, x: x), dincl.PBD(dt=0.5), [50.0], [[1.0]])
    assert flying["outcome"] == "unstable"
    assert flying["growth"] == pytest.approx(1.5**100 / 51, rel=1e-12)  # over the free path 1 + 50
    wall = dincl.Problem([[1.0]], lambda t, x: -np.ones_like(x), [dincl.HalfSpace(normal=(1,))])
    states = {"converged": [[[0.5]], [[0.0]]], "inaccurate": [[[0.5]], [[0.75]]]}
    for outcome, exact in states.items():
        assert judged_run(wall, dincl.PBD(dt=0.25), [0.5, 2.0], exact)["outcome"] == outcome
    assert judged_run(wall, dincl.PBD(dt=0.25), [2.0])["outcome"] == "bounded"
    assert judged_run(wall, dincl.PBD(dt=0.25), [0.25], reach=0.1)["outcome"] == "unstable"


# References


@pytest.mark.slow
def test_references_agree_within_what_they_state():
    four = dincl.scenes.four_disks()
    events = v.reference(four, 1e-11)(T)
    halved = v.reference(four, 1e-5, lambda dt: dincl.MidpointCatchUp(dt, dincl.ProjectedCG(tol=1e-12)), dt=0.02)(T)
    assert events.error.max() <= 1e-11
    assert halved.error.max() <= 1e-5
    assert np.linalg.norm(events.x - halved.x, axis=-1).max() <= 1e-5
    assert (v.reference(SLIDE, 1e-11)(T).x == SLIDE.exact(np.array(T))).all()


def test_a_tolerance_that_steps_do_not_reach_is_said():
    with pytest.raises(RuntimeError, match="not reached by steps down to"):
        v.reference(dincl.scenes.four_disks(), 1e-7, dincl.PBD, dt=0.5)([1.0])


def test_runs_that_agree_outside_of_the_set_are_no_reference():
    """Two walls are closer than the disc is wide from t = 0.5 on; all runs leave it on the same side."""
    walls = [dincl.HalfSpace((side, 0), lambda t: t - 1, 0.5) for side in (1, -1)]
    jaw = dincl.Problem([[0.0, 0.0]], lambda t, x: 0 * x, walls)
    with pytest.raises(RuntimeError, match=r"states are .* outside of the set: it may be empty, or jump"):
        v.reference(jaw, 1e-6, scheme=dincl.PBD)([1.0, 2.0])


def test_steps_that_are_multiples_of_a_period_are_no_reference():
    """x' = cos(2 pi t) is at its start after 64 periods; steps of 4, 2 and 1 see the drift as 1."""
    daily = dincl.Problem([[0.5]], lambda t, x: 0 * x + np.cos(2 * np.pi * t), [dincl.HalfSpace((1,), -10.0)])
    known = v.reference(daily, 1e-3, scheme=dincl.PBD, dt=4.0)([64.0])
    assert abs(known.x[0, 0, 0] - 0.5) <= known.error[0] > 0


# Results


@pytest.mark.slow
def test_results_show_and_keep_themselves(chart, tmp_path):
    orders = v.order_study(SLIDE, METHODS, STEPS, T, SLIDE.exact)
    both = v.save([orders, chart, orders], tmp_path)
    assert both == tmp_path / "index.html"
    names = {path.name for path in tmp_path.iterdir()}
    assert names == {"index.html"} | {
        f"{name}.{suffix}" for name in ("orders", "work_precision", "orders_2") for suffix in ("csv", "parquet", "png")
    }
    pd.testing.assert_frame_equal(pd.read_parquet(tmp_path / "work_precision.parquet"), chart.table)
    page = both.read_text("utf-8")
    assert page.count("<h2") == 3
    assert "http" not in page
    for result in (orders, chart):
        again = pickle.loads(pickle.dumps(result))
        pd.testing.assert_frame_equal(again.table, result.table)
        assert result._repr_html_().count("<table") >= 1
        axes = result.plot()
        assert result.plot(axes) is axes


def test_a_result_says_in_a_line_what_it_found(chart):
    text = repr(chart)
    assert "  0.0001: exact" in text
    own = v.Method("own", run=lambda problem, dt, t: SLIDE.exact(t) + 1.0)
    far = v.work_precision(SLIDE, [own], [0.1], T, SLIDE.exact, v.CpuSeconds(1.0))
    assert repr(far).endswith("not reached: 0.01, 0.001, 0.0001, 1e-06, 1e-08, 1e-10, 1e-12")
    rough = v.Known(np.array(T), SLIDE.exact(np.array(T)), np.full(3, 1e-5))
    near = v.work_precision(SLIDE, {"PBD": dincl.PBD}, [0.01], T, rough, v.CpuSeconds(1.0))
    assert repr(near).endswith("not resolved: 1e-06, 1e-08, 1e-10, 1e-12")
    falling = dincl.Problem([[1.0]], lambda t, x: -np.ones_like(x), [dincl.HalfSpace(normal=(1,))])
    named = v.stability_map(falling, partial(dincl.PBD), ("dt", [0.1]), ("dt", [0.1]))
    assert named.title == "Stability"
