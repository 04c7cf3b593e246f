"""References state an honest error; orders and infeasibilities come out of runs; failures stay rows."""

import numpy as np
import pandas as pd
import pytest

import dincl
from verification.instruments.error_norms import distance
from verification.instruments.measure import reached
from verification.thesis.chapter2 import convergence, infeasibility, large_steps, page
from verification.thesis.chapter2 import reference as event_driven
from verification.thesis.chapter2.extrapolation import extrapolate
from verification.thesis.chapter2.methods import COMPARED, METHODS, NamedMethod
from verification.thesis.chapter2.reference import EventReference
from verification.thesis.chapter2.runs import exact, scene

TOL = 1e-11
SLIDE = dincl.scenes.sliding_disc()
TIMES = np.arange(0.25, 3.01, 0.25)


def catch_up(h: float) -> np.ndarray:
    return dincl.solve(SLIDE, dincl.CatchUp(dt=h, projection=dincl.ClosedForm()), t=TIMES).x


@pytest.fixture(scope="module")
def references() -> dict[str, EventReference]:
    rows = pd.DataFrame([row for name in convergence.SCENES for row in event_driven.run({"scene": name})])
    return {name: event_driven.reference(rows, name) for name in convergence.SCENES}


@pytest.fixture(scope="module")
def table(references: dict[str, EventReference]) -> pd.DataFrame:
    run = convergence.ConvergenceRun(references)
    keys = [
        {"scene": name, "method": method, "dt": 0.1 / 2**k}
        for name in convergence.SCENES
        for method, steps in (("pbd", 6), ("linearised_clarabel", 5), ("penalty_10", 5))
        for k in range(steps)
    ]
    return pd.DataFrame([row for key in keys for row in run(key)])


def test_a_method_without_a_scheme_and_a_scene_without_a_solution_are_refused() -> None:
    assert METHODS["pbd"].make(0.1) == dincl.PBD(dt=0.1)
    with pytest.raises(dincl.InvalidProblem, match="method own: run = "):
        NamedMethod("own", run=lambda problem, dt, t: t, name="own").make(0.1)
    assert (exact(SLIDE, TIMES) == SLIDE.exact(TIMES)).all()
    with pytest.raises(dincl.InvalidProblem, match="scene pile: its exact solution is not known"):
        exact(dincl.scenes.pile(3), TIMES)


@pytest.mark.slow_with("0.0125", "0.0071", "0.004")
@pytest.mark.parametrize("h", [0.1, 0.07, 0.05, 0.043, 0.03, 0.0213, 0.0125, 0.0071, 0.004])
def test_stated_error_covers_the_true_one(h: float) -> None:
    found = extrapolate(TIMES, catch_up(h), catch_up(h / 2), catch_up(h / 4), TOL)
    true = distance(found.x, SLIDE.exact(TIMES))
    assert (true <= found.error).all(), np.c_[TIMES, true, found.error]
    assert found.error.max() < h


@pytest.mark.slow
def test_extrapolation_beats_the_finest_run_where_differences_halve() -> None:
    h = 0.0125
    found = extrapolate(TIMES, catch_up(h), catch_up(h / 2), catch_up(h / 4), TOL)
    sliding = (TIMES > 1) & (TIMES < 2.4)
    finest = distance(catch_up(h / 4), SLIDE.exact(TIMES))
    assert found.extrapolated[sliding].all()
    assert (distance(found.x, SLIDE.exact(TIMES))[sliding] < 0.2 * finest[sliding]).all()


def test_differences_that_do_not_halve_are_not_extrapolated() -> None:
    t, zero = np.array([1.0, 2.0, 3.0]), np.zeros((3, 1, 2))
    coarse, middle, fine = zero.copy(), zero.copy(), zero.copy()
    coarse[0], middle[0] = 0.3, 0.1  # halves: 0.2, then 0.1
    coarse[1], middle[1] = 0.11, 0.1  # jumps
    found = extrapolate(t, coarse, middle, fine, TOL)
    assert found.extrapolated.tolist() == [True, False, False]
    assert found.x[:, 0, 0] == pytest.approx([-0.1, 0.0, 0.0])
    estimates = 0.0, 0.1 * np.sqrt(2), 0.0
    assert found.error == pytest.approx([2 * max(estimates[max(k - 1, 0) : k + 2]) for k in range(3)])
    assert np.isnan(found.ratio[2])


@pytest.mark.slow
def test_order_one_of_pbd_on_both_scenes(table: pd.DataFrame) -> None:
    orders = convergence.orders(table)
    pbd = orders[orders["method"] == "pbd"]
    assert len(pbd) == 5
    assert ((pbd["slope"] - 1).abs() < 0.1).all(), pbd[["scene", "t", "order"]]
    assert (pbd["error"] < 0.05).all()
    assert (pbd["infeasibility"] > 1e-4).all()


def test_linearised_catch_up_is_feasible_and_a_soft_penalty_does_not_converge(table: pd.DataFrame) -> None:
    linearised = table[table["method"] == "linearised_clarabel"]
    assert linearised["infeasibility"].max() < 1e-9
    orders = convergence.orders(table)
    assert (orders[orders["method"] == "penalty_10"]["slope"].abs() < 0.5).all()


def test_failed_run_is_a_row_for_each_time(references: dict[str, EventReference]) -> None:
    rows = pd.DataFrame(convergence.ConvergenceRun(references)({"scene": "four_disks", "method": "pbd", "dt": 1.0}))
    assert rows["t"].tolist() == [1.0, 2.0]
    assert rows["status"].unique().tolist() == ["COINCIDENT_CENTRES"]
    assert rows["error"].isna().any()
    assert rows["detail"].str.contains("Particle").all()


def test_states_that_were_not_reached_are_nan() -> None:
    problem = scene("four_disks")
    path = dincl.solve(problem, dincl.PBD(dt=0.1), t=[0.5, 1.0])
    states = reached(path, np.array([0.5, 0.75, 1.0]))
    assert np.isfinite(states[[0, 2]]).all()
    assert np.isnan(states[1]).all()


def test_studies_name_each_run_once(references: dict[str, EventReference]) -> None:
    for study in (
        convergence.study(references, page.COMPARED),
        infeasibility.scan(references, infeasibility.FULL),
    ):
        names = [tuple(run[name] for name in study.key) for run in study.runs]
        assert len(set(names)) == len(names)
    runs = convergence.study(references, page.COMPARED).runs
    for name in convergence.SCENES:
        for method in COMPARED:
            assert sum(run["scene"] == name and run["method"] == method.name for run in runs) >= 8


def test_methods_have_looks_of_their_own() -> None:
    assert len({method.colour for method in METHODS.values()}) == len(METHODS)
    assert len({method.marker for method in METHODS.values()}) == len(METHODS)


def scanned(errors: list[float], largest: list[float]) -> pd.DataFrame:
    row = {"scene": "s", "dt": 0.1, "status": "SUCCESS", "mean": 0.0}
    strengths = [1.0, 2.0, 4.0, 8.0]
    runs = [
        row | {"exponent": 2, "strength": s, "error": e, "largest": i}
        for s, e, i in zip(strengths, errors, largest, strict=True)
    ]
    return pd.DataFrame([row | {"exponent": 0, "strength": 0.0, "error": 0.1, "largest": 0.1}, *runs])


def test_best_strength_and_the_width_of_the_optimum() -> None:
    best = infeasibility.best_strengths(scanned([0.1, 0.1, 0.1, 0.1], [0.9, 0.3, 0.2, 0.41])).iloc[0]
    assert (best["strength"], best["largest"], best["pbd_largest"]) == (4.0, 0.2, 0.1)
    assert best["width"] == 2.0


def test_discs_thrown_apart_do_not_win() -> None:
    best = infeasibility.best_strengths(scanned([0.1, 0.5, 0.51, np.nan], [0.9, 0.3, 0.0, 0.0])).iloc[0]
    assert best["strength"] == 2.0
    assert best["least_error"] == 0.1


def test_no_fair_strength_leaves_pbd_alone() -> None:
    thrown = scanned([9.0, 9.0, 7.0, np.nan], [0.9, 0.3, 0.0, 0.0])
    best = infeasibility.best_strengths(thrown).iloc[0]
    assert np.isnan([best["strength"], best["largest"], best["width"]]).all()
    assert best["pbd_largest"] == 0.1
    assert [run["exponent"] for run in infeasibility.curves(thrown, infeasibility.FULL).runs] == [0]


def test_scan_and_curve_see_the_same_overlap(references: dict[str, EventReference]) -> None:
    key = {"scene": "ten_disks_corner", "dt": 0.05, "exponent": 0, "strength": 0.0}
    row = infeasibility.Scan(references)(key)[0]
    curve = pd.DataFrame(infeasibility.curve(key))
    assert len(curve) == 61
    assert row["largest"] == curve["infeasibility"].max() > 0.1
    assert row["mean"] == pytest.approx(curve["infeasibility"].mean())
    assert 0.0 < row["error"] < 0.5


@pytest.mark.parametrize(("method", "stable"), [("pbd", True), ("penalty_10", True), ("penalty_1000", False)])
def test_large_steps_throw_discs_with_a_strong_penalty_only(method: str, stable: bool) -> None:
    row = large_steps.extent({"scene": "ten_disks_corner", "method": method, "dt": 0.1})[0]
    assert row["stable"] is stable
    assert (row["growth"] <= large_steps.FAR) is stable
