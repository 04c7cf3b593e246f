"""The studies of the mean-field chapter: what they compare with, and what they conclude from tables."""

import numpy as np
import pandas as pd
import pytest

from meanfield import Density, State, push_forward, solve_ode, w1
from meanfield.solvers.push_forward import origins
from verification.instruments.rates import IID, PAIR, QUANTILES
from verification.thesis.chapter5 import (
    agreement,
    cases,
    cost,
    drift,
    energy,
    exact,
    failures,
    flow_rates,
    grid_order,
    maps,
    provoked,
)
from verification.thesis.chapter5.sections import words

STEPS_OF_RATTLE = {2: (5, 10, 20, 40, 80)}

T = np.array([0.0, 1.0, 2.5])


@pytest.mark.parametrize("name", agreement.HARMONIC)
def test_the_closed_form_solves_the_equations_of_motion(name):
    """(5.6) with y'' by differences: m X'' = F1 - g_X lambda, y'' = F0 - <g_y lambda>, and g = const."""
    X, h, model = np.array([[0.7], [1.2], [1.3]]), 1e-3, cases.model(name)
    t = 0.8 + h * np.arange(-2, 3)
    path = exact.harmonic(name, X, t)
    weights = np.array([-1, 16, -30, 16, -1]) / (12 * h**2)
    bent_y, bent_X = weights @ path.y, np.einsum("k,kij->ij", weights, path.X)
    y, x, multiplier = path.y[2], path.X[2], path.multipliers[2]
    gX, gy = model.jacobians(x, y)
    assert np.abs(model.m * bent_X - model.F1(x) + gX[:, 0] * multiplier).max() < 1e-8
    assert np.abs(bent_y - model.F0(y) + (gy[:, 0] * multiplier).mean()).max() < 1e-8
    assert np.ptp(model.level(x, y) - model.level(X, [1.0])) == pytest.approx(0.0, abs=1e-15)
    assert path.v[2] == pytest.approx((path.y[3] - path.y[1]) / (2 * h), abs=1e-6)


def test_a_density_is_carried_as_its_points_are():
    model, law, y0, y = cases.model("wavy"), cases.law("wavy"), np.array([1.0]), np.array([1.6])
    moved = push_forward(model, law, y0, y)
    points = origins(model, law.quantiles(400), y0, y)  # forwards: from y0 to y
    assert np.abs(model.level(points, y) - model.level(law.quantiles(400), y0)).max() < 1e-14
    assert w1(points, moved) < 1.5e-3  # 400 quantiles of a law of width 1.2, stretched
    edges = np.linspace(0.2, 3.0, 30)
    found = exact.averages(model, law, y0, y, edges)
    assert found @ np.diff(edges) == pytest.approx(1.0, abs=1e-14)
    assert found == pytest.approx(np.diff(moved.panels.distribution(edges)) / np.diff(edges), abs=1e-12)


def test_a_carried_density_on_the_plane_is_a_density():
    low, high = np.asarray(grid_order.BOXES["element"])
    one = grid_order.Carried("element", np.array([1.2, 0.9, 0.2]), low, high)
    axes = [np.linspace(a, b, 161)[:-1] for a, b in zip(low, high, strict=True)]
    points = np.stack(np.meshgrid(*axes), axis=-1).reshape(-1, 2)
    assert one.density(points).sum() * np.prod((high - low) / 160) == pytest.approx(1.0, abs=1e-6)


def test_all_ways_find_the_reference_and_who_does_not_is_told():
    table = pd.DataFrame(
        [
            row
            for method in ("ode", "dae", "rattle2")
            for row in agreement._rows(
                {"model": "straight", "method": method}, dict.fromkeys(("ode", "dae"), range(3, 11)), STEPS_OF_RATTLE
            )
        ]
    )
    best = agreement.best(table).set_index("method")
    assert best["reached"].to_dict() == {"ode": True, "dae": True, "rattle2": False}
    assert 1e-6 < best["worst"]["rattle2"] < 1e-4
    assert best["setting"]["dae"] == 1e-10
    assert best["drift"].max() < 1e-12
    (order,) = agreement.orders(table).itertuples()
    assert order.slope == pytest.approx(2.0, abs=0.02)
    slopes = energy.slopes(table, table.iloc[:0]).set_index("method")["slope"]
    assert slopes["rattle2"].startswith("2.0")


def test_the_reference_knows_its_error():
    known = agreement.reference("wavy")
    assert 0 < max(known.error.values()) < 1e-11
    assert agreement.reference("straight").error["y"] < 1e-15


def test_reduced_runs_only_where_a_reduction_holds():
    few = agreement.AgreementForm(agreement.FULL.digits, STEPS_OF_RATTLE, rattled=("straight",))
    runs, complete = ({tuple(run.values()) for run in agreement.study(one).runs} for one in (few, agreement.FULL))
    assert ("element", "reduced") in runs
    assert ("wavy", "reduced") not in runs
    assert ("interacting", "rattle2") not in runs
    assert ("interacting", "rattle2") in complete


def test_a_trend_is_told_from_a_swing():
    t = np.linspace(0, 20 * energy.PERIOD, 101)
    swing = 1e-4 * np.sin(17.0 * t)
    rows = [{"method": "rattle2", "setting": 0.1, "t": a, "change": b} for a, b in zip(t, swing, strict=True)]
    rows += [{"method": "ode", "setting": 1e-5, "t": a, "change": b + 1e-5 * a} for a, b in zip(t, swing, strict=True)]
    found = energy.trends(pd.DataFrame(rows)).set_index("method")
    assert found["drifts"].to_dict() == {"ode": True, "rattle2": False}
    assert found["slope"]["ode"] == pytest.approx(1e-5 * energy.PERIOD, rel=0.1)


@pytest.mark.slow
def test_quantiles_find_the_limit_fast():
    """The uniform law is stretched, and its quantiles are 1.2/(4 N) away in the mean; <X^2> has an error ~ 1/N^2."""
    key = {"model": "uniform", "start": QUANTILES}
    rows = [flow_rates.rows_of(key | {"N": n})[0] for n in (100, 200, 400)]
    table = pd.DataFrame(rows)
    fitted = flow_rates.fitted(flow_rates.averaged(table)).set_index("quantity")
    assert fitted["exponent"]["error_y"] == pytest.approx(-2.0, abs=0.01)
    assert fitted["exponent"]["end_w1"] == pytest.approx(-1.0, abs=0.01)
    stretch = float(flow_rates.limit("uniform").y[0, 0])
    assert table["start_w1"].to_numpy() == pytest.approx(0.3 / table["N"].to_numpy(), rel=1e-9)
    assert table["end_w1"].to_numpy() == pytest.approx(0.3 * stretch / table["N"].to_numpy(), rel=1e-3)


@pytest.mark.slow
def test_kept_flow_is_what_the_study_makes(monkeypatch):
    """The first repeats at small N, of each model and kind of start."""
    monkeypatch.setattr(flow_rates, "REPEATS", ({100: 2}, {30: 2}))
    kept = pd.read_parquet(flow_rates.FILE).set_index(["model", "start", "N", "repeat"])
    for key in ({"model": "wavy", "start": IID, "N": 100}, {"model": "element", "start": PAIR, "N": 30}):
        for row in flow_rates.rows_of(key):
            found = kept.loc[row["model"], row["start"], row["N"], row["repeat"]]
            for quantity in flow_rates.QUANTITIES:
                assert found[quantity] == pytest.approx(row[quantity], rel=1e-5, abs=1e-8)


def test_the_limit_of_the_straight_fibre_is_the_closed_form():
    second = float(cases.law("uniform").moments()[1][0, 0])
    true = exact.harmonic("straight", np.array([[np.sqrt(second)]]), flow_rates.T).y
    assert flow_rates.limit("uniform").y == pytest.approx(true, abs=1e-11)


def test_random_starts_have_repeats_of_their_own(monkeypatch):
    monkeypatch.setattr(flow_rates, "REPEATS", ({50: 4}, {}))
    table = pd.DataFrame(flow_rates.rows_of({"model": "uniform", "start": IID, "N": 50}))
    assert table["start_w1"].nunique() == 4
    again = pd.DataFrame(flow_rates.rows_of({"model": "uniform", "start": IID, "N": 50}))
    pd.testing.assert_frame_equal(table, again)
    means = flow_rates.averaged(table).set_index("quantity")
    assert means["mean"]["start_w1"] == pytest.approx(table["start_w1"].mean())


@pytest.mark.slow
def test_orders_in_the_grid_tell_jumps_from_smooth():
    keys = [{"model": name, "cells": n} for n in (30, 38, 48, 60, 75) for name in ("straight", "uniform")]
    orders = grid_order.orders(pd.DataFrame([row for key in keys for row in grid_order._row(key)])).set_index("model")
    assert orders["slope_error_w1"]["straight"] > 1.7
    assert orders["slope_error_f"]["uniform"] < 1.2
    assert (orders["least"] >= 0).all()
    assert orders["mass"].max() < 1e-14


def test_costs_are_measured_until_they_are_enough():
    rows = cost._rows(cost.SETTINGS, 0.0, 1, {"model": "straight", "method": "moments"})
    assert len(rows) == 1  # the first one takes more than nothing
    assert rows[0]["error"] < 1e-3
    assert rows[0]["unknowns"] == 4
    table = pd.DataFrame(
        [
            {"model": "straight", "method": "ode", "seconds": s, "error": e, "unknowns": 6}
            for s, e in ((3.0, 1e-2), (2.0, 1e-4), (4.0, 1e-7))
        ]
    )
    (found,) = cost.seconds_to(table, (1e-3, 1e-6, 1e-9)).to_dict("records")
    assert (found["0.001"], found["1e-06"]) == (2.0, 4.0)
    assert np.isnan(found["1e-09"])


@pytest.mark.slow
def test_a_right_hand_side_is_compared_with_its_twin():
    (row,) = cost._side(1000, {"model": "wavy"})
    assert row["off"] < 1e-12
    assert row["reading"] > 1
    assert np.isnan(row["pairs"])


@pytest.mark.parametrize("case", ["level-dae", "flat-ode", "fold-rattle2", "kernel-log|r|"])
def test_failures_are_found(case):
    (row,) = failures._row({"case": case})
    assert row["agrees"], row


def test_a_wrong_prediction_is_seen():
    """A run that ends well, or at another place, does not agree."""
    motion = solve_ode(cases.model("linear"), State(X=[[1.0]], y=[1.0], v=[0.5]), [1.0], 1e-6)
    assert not provoked.stopped(motion, 1.0).agrees
    model = cases.model("straight")
    fails = solve_ode(model, State(X=[[1.0]], y=[1.0], v=[-3.0]), np.linspace(0, 1, 200), 1e-8, throw=False)
    assert not provoked.stopped(fails, 1.2 * float(fails.t[-1])).agrees
    assert provoked.stopped(fails, 1.001 * float(fails.t[-1])).agrees


def test_drift_grows_only_without_stabilisation():
    rows = [row for method in ("naive_rk4", "rattle2") for row in drift._rows(25.0, {"method": method})]
    found = drift.growth(pd.DataFrame(rows)).set_index("method")
    kept = found.loc[drift.TITLES["rattle2"]]
    assert kept["power_g"] == "—"
    assert kept["end_g"] < 1e-14
    lost = found.loc[drift.TITLES["naive_rk4"]]
    assert lost["end_g"] > 1e-6
    assert float(lost["power_g"].split()[0]) > 0.7


def test_streams_are_independent():
    one, two, three = (cases.stream(*key).random() for key in (("rates", 1, 2), ("rates", 2, 1), ("pairs", 1, 2)))
    assert len({one, two, three}) == 3
    assert cases.stream("rates", 1, 2).random() == one


def test_the_starts_are_regular():
    for name in cases.CASES:
        start = cases.few(name, 3).complete(cases.model(name), 1e-12)
        assert np.isfinite(start.U).all()
    assert isinstance(cases.law("cube"), Density)


def test_words():
    table = pd.DataFrame({"model": ["straight"], "method": ["dae"], "N": [3]})
    assert words.named(table, {"model": "Model", "method": "M"}).iloc[0].tolist() == ["StraightFibre", "DAE (IDAS)"]


@pytest.mark.parametrize("plane", maps.PLANES, ids=lambda plane: plane.name)
def test_maps_have_their_limits_where_theory_says(plane):
    """On both sides of the limit at one height, 10 % away from it."""
    heights = np.array([plane.y.values[15]])
    for method in plane.methods:
        (line,) = (line for line in plane.lines if method in line.methods)
        at = float(line.x(heights)[0])
        failed = [plane.cell(method, factor * at, float(heights[0]))["outcome"] for factor in (0.9, 1.1)]
        assert failed[0] in ("converged", "inaccurate")
        assert failed[1] in ("unstable", "refused")


def test_limits_of_the_steps():
    assert maps.limit("rattle2") == pytest.approx(2.0, abs=2e-3)
    assert maps.limit("rk4") == pytest.approx(2 * np.sqrt(2), abs=2e-3)
    x = np.array([0.5, 2.5])  # the product of steps of order 4 stays in bounds where a single step would not
    assert maps.grows("rattle2", x).tolist() == [False, True]
    assert maps.grows("rattle4", x).tolist() == [False, False]


def test_map_counts_what_failed_elsewhere():
    plane = maps.PLANES[1]
    outcomes = ["converged", "refused", "refused", "converged"]
    table = pd.DataFrame({"method": "ode", "y": 1.0, "x": [0.1, 0.2, 50.0, 60.0], "outcome": outcomes})
    (found,) = maps.agreement(table, plane).itertuples()
    assert (found.cells, found.right) == (4, 2)
