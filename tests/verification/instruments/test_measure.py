"""Measurement of one method: its errors, what its time is, what ends it, what is left out."""

import sys
import time

import numba
import numpy as np
import pytest

import dincl
import verification as v
from dincl.compiled.functions import compiler_events
from dincl.extras import MissingLibrary
from verification.command import main
from verification.instruments import measure as measuring
from verification.instruments.budget import OutOfBudgetError, counted
from verification.instruments.error_norms import ErrorOf, checked_errors, reference_error
from verification.instruments.measure import measure
from verification.instruments.references import known_at

SLIDE, CORNER = dincl.scenes.sliding_disc(), dincl.scenes.ten_disks_corner()
T = [0.5, 1.0, 3.0]
STEPS = [0.1 / 2**k for k in range(5)]
BUDGET = v.CpuSeconds(5.0)
KNOWN = v.Known(np.array([1.0]), SLIDE.exact(np.array([1.0])), np.zeros(1))


def exact(problem, dt, t):
    return SLIDE.exact(t)


def chart(methods, settings=(0.1,), t=T, errors=("largest", "final", "overlap"), budget=BUDGET):
    return v.work_precision(SLIDE, methods, settings, t, SLIDE.exact, budget, errors)


# Errors


def test_norms_are_what_their_names_say():
    errors, shift = [0.3, 0.0, 0.6], np.array([[1.0, 0.0]])
    off = v.Method("off", run=lambda _, dt, t: SLIDE.exact(t) + np.interp(t, T, errors)[:, None, None] * shift)
    found = chart([off], errors=("largest", "final", 1.0)).table.iloc[0]
    assert found[["largest", "final", "t = 1"]].tolist() == pytest.approx([0.6, 0.6, 0.0], abs=1e-12)
    row = chart({"PBD": dincl.PBD}, errors={"end": 3.0, "overlap": "overlap", "all": "largest"}).table.iloc[0]
    path = dincl.solve(SLIDE, dincl.PBD(0.1), t=T)
    away = np.linalg.norm(path.x - SLIDE.exact(path.t), axis=-1).max(axis=1)
    assert (row["end"], row["all"], row["overlap"]) == (away[-1], away.max(), path.violation().max())
    assert row["drift_evaluations"] == path.stats.drift_evaluations


def test_a_quantity_has_its_own_error_and_that_of_its_reference():
    reference = v.Known(np.array(T), SLIDE.exact(np.array(T)), np.full(3, 1e-6))
    errors = {"height": lambda x: x[:, 1].max(), "both": lambda x: 3.0 * x[0], "largest": "largest"}
    found = v.work_precision(SLIDE, {"PBD": dincl.PBD}, [0.1], T, reference, BUDGET, errors)
    away = dincl.solve(SLIDE, dincl.PBD(0.1), t=T).x - reference.x
    assert found.table["height"].iloc[0] == pytest.approx(np.abs(away[:, 0, 1]).max(), rel=1e-12)
    assert found.table["both"].iloc[0] == pytest.approx(3.0 * np.abs(away).max(), rel=1e-12)
    for name, own in (("height", 1e-6), ("both", 3e-6), ("overlap", 0.0)):
        assert reference_error(found.table, name).iloc[0] == pytest.approx(own, rel=1e-6)
    assert "error of height" in found.plot(error="height").get_ylabel()
    orders = v.order_study(SLIDE, {"PBD": dincl.PBD}, STEPS, T, SLIDE.exact, lambda x: x[0, 0])
    assert orders.fits["error"].tolist() == ["quantity"]
    assert orders.fits["low"].iloc[0] < 1.05


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: ErrorOf("log", lambda _: np.nan).of_reference(known_at(SLIDE.exact, T)), "'log' gave nan for a state"),
        (lambda: checked_errors([None]), "errors = None: must be one or more of largest"),
        (lambda: checked_errors([exact, exact]), "different names"),
        (lambda: chart({"PBD": dincl.PBD}, errors=2.0), "must be among the times"),
        (lambda: chart({"PBD": dincl.PBD}, errors={"height": lambda x: x[7]}), "errors: 'height' raised IndexError"),
    ],
)
def test_bad_errors_are_named(call, message):
    with pytest.raises(dincl.InvalidProblem, match=message):
        call()


# Times and budgets


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
    monkeypatch.setattr(measuring, "_warm_up", lambda *_: None)
    monkeypatch.setattr(measuring.time, "process_time", lambda: clock[0])

    def run(problem, dt, t):
        seen.append((dt, len(t)))
        clock[0] += next(seconds[dt, len(t)])
        return SLIDE.exact(t)

    known = v.Known(np.array(T), SLIDE.exact(np.array(T)), np.zeros(3))
    rows = measure(None, v.Method("own", run=run), (0.1, 0.05, 0.025), known, ("final",), None)
    first = [(0.1, 3), (0.05, 3), (0.025, 3), (0.1, 1), (0.05, 1), (0.025, 1)]
    assert seen == first + 2 * [(0.1, 3), (0.1, 1), (0.025, 3), (0.025, 1)]
    assert [row["repeats"] for row in rows] == [3, 1, 3]
    assert [row["cpu_seconds"] for row in rows] == pytest.approx([0.05, 1.5, 0.2])
    assert [row["output_seconds"] for row in rows] == pytest.approx([0.06, 0.5, 0.0])
    assert rows[0]["spread"] == pytest.approx(2.0)


def test_waiting_for_the_processor_is_said(monkeypatch):
    cpu, wall = iter(np.arange(100.0)), iter(3 * np.arange(100.0))
    monkeypatch.setattr(measuring.time, "process_time", lambda: next(cpu))
    monkeypatch.setattr(measuring.time, "perf_counter", lambda: next(wall))
    found = chart([v.Method("own", run=exact)], budget=v.CpuSeconds(1e3))
    assert found.table["disturbed"].tolist() == [True]
    assert "1 of 1 measurements were disturbed" in next(iter(found.summaries()))


def test_nothing_finer_is_tried_after_a_run_beyond_the_budget(monkeypatch):
    counts = [chart({"PBD": dincl.PBD}, STEPS, budget=v.DriftEvaluations(100)).table for _ in range(2)]
    assert counts[0]["status"].tolist() == ["SUCCESS", "SUCCESS", "OUT_OF_BUDGET", "LEFT_OUT", "LEFT_OUT"]
    counted_work = counts[0].columns.difference(["cpu_seconds", "output_seconds", "spread", "disturbed"])
    assert counts[0][counted_work].equals(counts[1][counted_work])
    stopped = chart({"PBD": dincl.PBD}, [1e-7, 1e-8], budget=v.CpuSeconds(0.01)).table
    assert stopped["status"].tolist() == ["OUT_OF_BUDGET", "LEFT_OUT"]
    assert stopped["largest"].isna().all()
    times = iter([0.0, 9.0] * 4)  # of the run that is thrown away, and of the first one, which cannot be stopped
    monkeypatch.setattr(measuring.time, "process_time", lambda: next(times))
    found = v.work_precision(None, [v.Method("own", run=exact)], [0.1, 0.05], T, SLIDE.exact, v.CpuSeconds(1.0)).table
    assert found["status"].tolist() == ["SUCCESS", "LEFT_OUT"]


@numba.njit
def falling(t, x):
    out = np.zeros_like(x)
    out[:, 1] = -1.0
    return out


SCHEMES = {
    "linearised": lambda: dincl.LinearisedCatchUp(1e-3, dincl.ActiveSet(1e-12)),
    "catch-up": lambda: dincl.CatchUp(1e-3, dincl.ActiveSet(1e-12)),
    "midpoint": lambda: dincl.MidpointCatchUp(1e-3, dincl.ActiveSet(1e-9)),
    "events": lambda: dincl.EventDriven(1e-12),
}
DRIFTS = {"ready-made": CORNER.drift, "numba": falling, "Python": lambda t, x: falling(t, np.array(x))}


@pytest.mark.parametrize("drift", DRIFTS)
@pytest.mark.parametrize("name", SCHEMES)
def test_a_run_in_machine_code_is_stopped_by_its_count_of_evaluations(name, drift):
    problem = dincl.Problem(CORNER.x0, DRIFTS[drift], CORNER.constraints)
    watched, whole = counted(problem, None)
    path = dincl.solve(watched, SCHEMES[name](), t=[1.0, 2.0])
    assert whole.evaluations == path.stats.drift_evaluations
    watched, part = counted(problem, v.DriftEvaluations(whole.evaluations // 4))
    with pytest.raises(OutOfBudgetError):
        dincl.solve(watched, SCHEMES[name](), t=[1.0, 2.0], throw=False)
    assert whole.evaluations // 4 < part.evaluations < whole.evaluations


@pytest.mark.slow_with("events")
@pytest.mark.parametrize(
    ("scheme", "setting", "scene"),
    [
        (lambda dt: dincl.CatchUp(dt, dincl.ActiveSet(1e-12)), 1e-8, CORNER),
        (dincl.EventDriven, 1e-12, dincl.scenes.pile(200)),
    ],
    ids=["catch-up", "events"],
)
def test_a_compiled_run_is_stopped_by_cpu_time(scheme, setting, scene):
    """The first one would take many minutes, the other one ten seconds."""
    known = v.Known(np.array([1.0, 2.0]), np.zeros((2, *scene.x0.shape)), np.zeros(2))
    rows = measure(scene, v.Method("compiled", scheme=scheme), (setting,), known, ("final",), v.CpuSeconds(0.05))
    assert [row["status"] for row in rows] == ["OUT_OF_BUDGET"]


# Making and loading machine code belongs to no method


def fresh():
    """A function that is compiled when it is called first."""
    return numba.njit(lambda a: a + 1.0)


def test_a_timed_run_that_compiles_is_made_again():
    seen, coarse, fine, function = [], fresh(), fresh(), fresh()
    for made in (True, False):
        with compiler_events() as events:
            function(1.0)
        assert bool(events) == made

    def run(problem, dt, t):
        seen.append(dt)
        (coarse if dt == 0.1 else fine)(1.0)
        return SLIDE.exact(t)

    rows = measure(SLIDE, v.Method("own", run=run), (0.1, 0.05), KNOWN, ("final",), None, repeats=0)
    assert seen == [0.1, 0.1, 0.1, 0.05, 0.05]  # two to warm up; then the finer setting compiles in its timed run
    assert [row["repeats"] for row in rows] == [1, 1]


@pytest.mark.slow
def test_a_program_that_compiles_in_every_run_is_measured_all_the_same():
    method = v.Method("own", run=lambda problem, dt, t: SLIDE.exact(t) * fresh()(0.0))
    rows = measure(SLIDE, method, (0.1,), KNOWN, ("final",), None, repeats=0)
    assert (rows[0]["status"], rows[0]["repeats"]) == ("SUCCESS", 1)


def test_compiling_spends_no_budget():
    budget, calls, function = v.CpuSeconds(0.05), [], fresh()

    def slow_once(t, x):
        """As slow as compiling may be, in the first run of the finer step only."""
        calls.append(t)
        if len(calls) == 21:  # after two runs of ten steps
            function(1.0)
            began = time.process_time()
            while time.process_time() - began < 2 * budget.limit():
                pass
        return -x

    problem = dincl.Problem([[1.0]], slow_once, [dincl.HalfSpace(normal=(1,))])
    known = v.Known(np.ones(1), np.exp(-1.0) * np.ones((1, 1, 1)), np.zeros(1))
    rows = measure(problem, v.Method("PBD", scheme=dincl.PBD), (0.1, 0.05), known, ("final",), budget, repeats=0)
    assert [row["status"] for row in rows] == ["SUCCESS", "SUCCESS"]
    assert len(calls) > 40


# A method whose library is missing is left out


WHY = "Clarabel needs clarabel, not installed here; in a clone: pip install '.[yardsticks]'"


def missing(problem, setting, t):
    import no_such_library  # noqa: F401


def test_what_is_left_out_is_said_and_the_others_are_measured(monkeypatch):
    monkeypatch.setitem(sys.modules, "clarabel", None)
    methods = [
        v.Method("PBD", scheme=dincl.PBD),
        v.Method("Clarabel", scheme=lambda dt: dincl.LinearisedCatchUp(dt, dincl.Clarabel(1e-9))),
        v.Method("own", run=missing),
    ]
    why = {"Clarabel": WHY, "own": "No module named 'no_such_library'"}
    found, orders = chart(methods, STEPS), v.order_study(SLIDE, methods, STEPS, T, SLIDE.exact)
    for result in (found, orders):
        rows = result.table.set_index("method")
        assert set(rows.loc["PBD", "status"]) == {"SUCCESS"}
        for name, detail in why.items():
            assert set(rows.loc[name, "status"]) == {"LEFT_OUT"}
            assert set(rows.loc[name, "detail"]) == {detail}
            assert f"left out: {name}: {detail}" in repr(result)
        result.plot()
    said = found.summaries()["Methods that were left out or refused."]
    assert said.to_numpy().tolist() == [list(pair) for pair in why.items()]
    assert found.cheapest([1e-2])["cheapest"].tolist() == ["PBD"]
    fits = orders.fits.set_index(["method", "error"])
    assert fits.loc[("PBD", "largest"), "low"] < 1.1
    assert fits.loc[("Clarabel", "largest"), ["order", "failed", "verdict"]].tolist() == ["left out", 0, WHY]
    alone = chart(methods[:1])
    assert "left out" not in repr(alone)
    assert len(alone.summaries()) == 3
    with pytest.raises(MissingLibrary, match="needs clarabel"):
        v.stability_map(SLIDE, lambda dt, tol: dincl.CatchUp(dt, dincl.Clarabel(tol)), ("dt", [0.1]), ("tol", [1e-9]))


@pytest.mark.parametrize("command", ["report", "claims", "stability"])
def test_what_one_source_says_needs_all(command, monkeypatch, capsys):
    monkeypatch.setitem(sys.modules, "clarabel", None)
    monkeypatch.setattr(sys, "argv", ["verification", command])
    with pytest.raises(SystemExit) as end:
        main()
    message = f"Error: verification {command} needs clarabel, not installed here; in a clone: pip install '.[thesis]'\n"
    assert (end.value.code, capsys.readouterr().err) == (2, message)
