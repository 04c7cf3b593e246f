"""Orders, speed against accuracy and references on problems that the library does not know; what is refused."""

import pickle

import numpy as np
import pandas as pd
import pytest

import dincl
import verification as v
from verification.instruments.method import as_methods

SLIDE = dincl.scenes.sliding_disc()
T = [1.0, 2.0, 3.0]
STEPS = [0.1 / 2**k for k in range(6)]
METHODS = {"PBD": dincl.PBD, "catch-up": lambda dt: dincl.CatchUp(dt, dincl.Daqp(tol=1e-12))}
BUDGET = v.CpuSeconds(5.0)
FOUR = dincl.scenes.four_disks()
WALL = dincl.Problem([[2.0, 1.0]], lambda t, x: -x, [dincl.HalfSpace((0, 1), radius=0.5)])


def exact(problem, dt, t):
    return SLIDE.exact(t)


@pytest.fixture(scope="module")
def chart():
    methods = [
        v.Method("PBD", "PBD", dincl.PBD),
        v.Method("own", "own", run=lambda problem, dt, t: dincl.solve(problem, dincl.PBD(dt), t=t).x),
        v.Method("exact", "own", run=exact),
        v.Method("broken", run=lambda problem, dt, t: np.full((len(t), 1, 2), np.nan)),
    ]
    return v.work_precision(SLIDE, methods, STEPS, T, SLIDE.exact, budget=BUDGET)


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
    found = v.order_study(FOUR, {"PBD": dincl.PBD}, [1.0, *STEPS], [1.0], v.reference(FOUR, 1e-11), errors="final")
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


# Speed against accuracy


def test_a_program_of_ones_own_stands_beside_the_schemes(chart):
    table = chart.table.set_index(["method", "setting"])
    for step in STEPS:
        assert table.loc[("own", step), "largest"] == table.loc[("PBD", step), "largest"]
        assert table.loc[("own", step), "drift_evaluations"] >= 3 / step
    assert set(table.loc["broken", "status"]) == {"NON_FINITE"}


def test_chart_names_the_cheapest_and_the_front(chart):
    assert chart.cheapest([1e-4, 1e-6])["cheapest"].tolist() == ["exact", "exact"]
    efficient = chart.front()
    assert efficient["method"].iloc[-1] == "exact"
    assert (np.diff(efficient["cpu_seconds"]) >= 0).all()
    assert (np.diff(efficient["accuracy"]) < 0).all()
    assert chart.costs([1e-2, 1e-6]).loc["PBD"].notna().tolist() == [True, False]
    assert chart.cheapest([1e-2], cost="steps")["cheapest"].tolist() == ["PBD"]  # nobody counts steps of the others


def test_a_result_says_in_a_line_what_it_found(chart):
    assert "  0.0001: exact" in repr(chart)
    own = v.Method("own", run=lambda problem, dt, t: SLIDE.exact(t) + 1.0)
    far = v.work_precision(SLIDE, [own], [0.1], T, SLIDE.exact, BUDGET)
    assert repr(far).endswith("not reached: 0.01, 0.001, 0.0001, 1e-06, 1e-08, 1e-10, 1e-12")
    rough = v.Known(np.array(T), SLIDE.exact(np.array(T)), np.full(3, 1e-5))
    near = v.work_precision(SLIDE, {"PBD": dincl.PBD}, [0.01], T, rough, BUDGET)
    assert repr(near).endswith("not resolved: 1e-06, 1e-08, 1e-10, 1e-12")


@pytest.mark.slow
def test_results_show_and_keep_themselves(chart, tmp_path):
    orders = v.order_study(SLIDE, METHODS, STEPS, T, SLIDE.exact)
    page = v.save([orders, chart, orders], tmp_path)
    assert page == tmp_path / "index.html"
    names = ("orders", "work_precision", "orders_2")
    files = {f"{name}.{suffix}" for name in names for suffix in ("csv", "parquet", "png")}
    assert {path.name for path in tmp_path.iterdir()} == {"index.html"} | files
    pd.testing.assert_frame_equal(pd.read_parquet(tmp_path / "work_precision.parquet"), chart.table)
    text = page.read_text("utf-8")
    assert text.count("<h2") == 3
    assert "http" not in text
    for result in (orders, chart):
        pd.testing.assert_frame_equal(pickle.loads(pickle.dumps(result)).table, result.table)
        assert result._repr_html_().count("<table") >= 1
        assert "<th>0</th>" not in result._repr_html_()
        axes = result.plot()
        assert result.plot(axes) is axes


# References


@pytest.mark.slow
def test_references_agree_within_what_they_state():
    events = v.reference(FOUR, 1e-11)(T)
    halved = v.reference(FOUR, 1e-5, lambda dt: dincl.MidpointCatchUp(dt, dincl.ProjectedCG(tol=1e-12)), dt=0.02)(T)
    assert events.error.max() <= 1e-11
    assert halved.error.max() <= 1e-5
    assert np.linalg.norm(events.x - halved.x, axis=-1).max() <= 1e-5
    assert (v.reference(SLIDE, 1e-11)(T).x == SLIDE.exact(np.array(T))).all()


def test_what_halved_steps_do_not_show_is_no_reference():
    with pytest.raises(RuntimeError, match="not reached by steps down to"):
        v.reference(FOUR, 1e-7, dincl.PBD, dt=0.5)([1.0])
    # Two walls are closer than the disc is wide from t = 0.5 on; all runs leave it on the same side.
    walls = [dincl.HalfSpace((side, 0), lambda t: t - 1, 0.5) for side in (1, -1)]
    jaw = dincl.Problem([[0.0, 0.0]], lambda t, x: 0 * x, walls)
    with pytest.raises(RuntimeError, match=r"states are .* outside of the set: it may be empty, or jump"):
        v.reference(jaw, 1e-6, scheme=dincl.PBD)([1.0, 2.0])
    # x' = cos(2 pi t) is at its start after 64 periods; steps of 4, 2 and 1 see the drift as 1.
    daily = dincl.Problem([[0.5]], lambda t, x: 0 * x + np.cos(2 * np.pi * t), [dincl.HalfSpace((1,), -10.0)])
    known = v.reference(daily, 1e-3, scheme=dincl.PBD, dt=4.0)([64.0])
    assert abs(known.x[0, 0, 0] - 0.5) <= known.error[0] > 0


@pytest.mark.parametrize(
    ("reference", "message"),
    [
        (lambda t: v.reference(WALL, 1e-9)([0.1, 0.2]), "times = .* must be among the times of the reference"),
        (lambda t: v.reference(WALL, 1e-9)([0.5]), "times = .* must be among the times of the reference"),
        (v.reference(WALL, 1e-9)([0.5, 0.9]), "must be among the times of the reference"),
        (lambda t: v.Known(t, np.ones((2, 1, 2)), np.full(2, np.nan)), "error = .* must be 2 finite numbers >= 0"),
        (lambda t: v.Known(t, np.ones((2, 1, 2)), np.full(2, -1e-9)), "error = .* must be 2 finite numbers >= 0"),
        (lambda t: v.Known(t, np.ones((2, 1, 2)), np.full(2, np.inf)), "error = .* must be 2 finite numbers >= 0"),
        (lambda t: v.Known(t, np.full((2, 1, 2), np.nan), np.zeros(2)), "must be a finite state for each of 2 times"),
        (lambda t: v.Known(t[::-1], np.ones((2, 1, 2)), np.zeros(2)), "must be increasing times"),
        (lambda t: np.full((2, 1, 2), np.nan), "reference = nan"),
        (lambda t: {}["k"], "reference = .* raised KeyError: 'k'"),
        (lambda t: None, "reference = None"),
        (np.zeros((3, 1, 2)), "reference of shape .*: must give one state for each of 2 times"),
        (lambda t: np.ones((2, 2)), r"reference of shape \(2, 2\): must have shape \(K, N, d\)"),
    ],
)
def test_a_reference_to_another_question_is_refused(reference, message):
    with pytest.raises(dincl.InvalidProblem, match=message):
        v.order_study(WALL, {"PBD": dincl.PBD}, STEPS, [0.5, 1.0], reference)


# What is refused, and what fails in its row alone


def own(problem, dt, t):
    """A program of one's own, which is no scheme."""


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"methods": {}}, "methods has no entry"),
        ({"methods": {"PBD": 3}}, r"methods\['PBD'\] = 3: must be a Method or a function"),
        ({"methods": [v.Method("a", scheme=dincl.PBD)] * 2}, r"two named \['a'\]"),
        ({"methods": [dincl.PBD]}, "methods holds .*: a list must hold Method; or map labels to functions"),
        ({"settings": [0.1, -1.0]}, "settings = .*: must be 1 or more different numbers > 0"),
        ({"settings": {"tol": [0.1]}}, "settings has no entry 'PBD' or 'dt'"),
        ({"t": [2.0, 1.0]}, "t = .*: must be one or more increasing times"),
        (
            {"errors": ("largest", "smallest")},
            "errors = .*: must be one or more of largest, final, overlap, stated",
        ),
        ({"budget": 2.0}, r"budget = 2.0: must be CpuSeconds\(...\) or DriftEvaluations"),
    ],
)
def test_bad_input_is_named(changes, message):
    given = {"problem": SLIDE, "methods": {"PBD": dincl.PBD}, "settings": [0.1], "t": T, "reference": SLIDE.exact}
    with pytest.raises(dincl.InvalidProblem, match=message):
        v.work_precision(**(given | {"budget": v.CpuSeconds(1.0)} | changes))


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: v.Method("both", scheme=dincl.PBD, run=own), "give scheme, a function setting -> Scheme, or run"),
        (lambda: v.order_study(SLIDE, METHODS, [0.1], T, SLIDE.exact), "settings = .*: must be 5 or more"),
        (
            lambda: v.order_study(SLIDE, METHODS, {"dt": STEPS, "catch-up": STEPS[:4]}, T, SLIDE.exact),
            "settings = .*: must be 5 or more",
        ),
        (lambda: v.reference(3, 1e-9), r"problem = 3: must be a dincl\.Problem"),
        (lambda: v.reference(SLIDE, 1e-9, dt=0.1), "dt = 0.1: is the first step of a scheme"),
        (lambda: v.save([3], "unused"), "results holds 3"),
    ],
)
def test_bad_arguments_of_others_are_named(call, message):
    with pytest.raises(dincl.InvalidProblem, match=message):
        call()


@pytest.mark.parametrize(
    ("method", "detail"),
    [
        ({"scheme": lambda dt: None}, "'a' made None of the setting 0.1: must make a dincl.Scheme"),
        ({"scheme": lambda dt: dincl.PBD}, "must make a dincl.Scheme"),
        ({"scheme": own}, "is called with (setting): missing a required argument: 'dt'; a program is"),
        ({"run": lambda *_: None}, "'a' returned None: must return an array of real states"),
        ({"run": lambda *_: np.zeros(3)}, "'a' returned shape (3,): must return (3, 1, 2)"),
        ({"run": lambda *_: np.full((3, 1, 2), 1j)}, "must return an array of real states"),
        ({"run": lambda problem, dt: None}, "is called with (problem, setting, t): too many positional"),
    ],
)
def test_a_method_that_makes_something_else_is_refused(method, detail):
    chart = v.work_precision(SLIDE, [v.Method("a", **method)], [0.1], T, SLIDE.exact, v.CpuSeconds(1.0))
    assert chart.table["status"].tolist() == ["REFUSED"]
    assert detail in chart.table["detail"].iloc[0]
    assert detail in repr(chart)
    if "scheme" in method and method["scheme"] is not own:
        cells = v.stability_map(WALL, method["scheme"], ("dt", [0.1]), ("dt", [0.1]), [1.0]).table
        assert cells["outcome"].tolist() == ["refused"]
        assert "must make a dincl.Scheme" in cells["detail"][0]
    assert [one.label for one in as_methods(METHODS)] == list(METHODS)


class Mute(RuntimeError):
    def __str__(self):
        raise RuntimeError("no words")


def raising(error):
    def run(*_):
        raise error

    return run


KINDS = (KeyError, TypeError, OSError, AssertionError, ValueError, MemoryError, type("OwnError", (Exception,), {}))
ERRORS = [(kind("k"), f"{kind.__name__}: {kind('k')}") for kind in KINDS]
ERRORS += [(Mute(), "Mute: an error without a message"), (ValueError("\ud800"), "ValueError: \\ud800")]


@pytest.mark.parametrize(("error", "words"), ERRORS, ids=lambda one: type(one).__name__)
def test_a_method_that_raises_is_a_row_and_the_others_keep_theirs(error, words):
    """Test programs, functions that make schemes, and schemes, in all four instruments."""
    known = v.reference(WALL, tol=1e-9)([0.5, 1.0])

    class Broken(dincl.Scheme):
        def run(self, *_):
            raise error

    good = v.Method("good", scheme=dincl.PBD)
    bad = [
        v.Method("program", run=raising(error)),
        v.Method("maker", scheme=raising(error)),
        v.Method("scheme", scheme=lambda dt: Broken()),
    ]
    for result in (
        v.order_study(WALL, [good, *bad], STEPS[:5], [0.5, 1.0], known),
        v.work_precision(WALL, [good, *bad], STEPS[:5], [0.5, 1.0], known, v.CpuSeconds(1.0)),
    ):
        status = result.table.groupby("method")["status"].agg(set)
        assert status.to_dict() == {"good": {"SUCCESS"}} | {one.label: {"FAILED"} for one in bad}
        assert set(result.table.loc[result.table["status"] == "FAILED", "detail"]) == {words}
    advice = v.recommend(WALL, 1e-2, [0.5, 1.0], [good, *bad])
    assert advice.best == "good"
    assert all(words in why for why in advice.table.set_index("method").loc[[one.label for one in bad], "why"])
    for problem, method in ((lambda q: WALL, bad[1].scheme), (lambda q: WALL, bad[2].scheme), (raising(error), own)):
        axes = (("dt", [0.1]), ("dt", [0.1])) if method is own else (("h", [0.1]), ("q", [1.0]))
        cells = v.stability_map(problem, dincl.PBD if method is own else method, *axes, [1.0]).table
        assert cells[["outcome", "status", "detail"]].to_numpy().tolist() == [["refused", "FAILED", words]]


@pytest.mark.parametrize("stop", [KeyboardInterrupt, SystemExit])
def test_what_means_to_stop_a_study_stops_it(stop):
    with pytest.raises(stop):
        v.order_study(WALL, [v.Method("a", run=raising(stop()))], STEPS, [1.0], v.reference(WALL, tol=1e-9))
    with pytest.raises(stop):
        v.stability_map(WALL, raising(stop()), ("h", [0.1]), ("h", [0.1]), [1.0])
