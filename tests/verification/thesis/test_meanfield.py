"""The mean-field chapter: its studies conclude what the tables that ship say, from parts that are right."""

import numpy as np
import pandas as pd
import pytest

from meanfield import State, solve_ode
from verification.instruments.rates import IID, QUANTILES
from verification.site.store import shipped
from verification.thesis.chapter5 import cases, cost, failures, rates, stability_constant
from verification.thesis.chapter5.instant import general_instant, kinetic, potential


def test_the_rig_under_the_checks_moves_on_the_constraint_and_keeps_the_energy() -> None:
    at, h = general_instant(), 1e-3

    def after(t: float) -> tuple[float, float]:
        X, y = at.X + t * at.U + t**2 / 2 * at.A, at.y + t * at.v + t**2 / 2 * at.a
        off = np.abs(at.system.g(X, y) - at.system.g(at.X, at.y)).max()
        U, v = at.U + t * at.A, at.v + t * at.a
        return float(off), kinetic(at.system, U, v) + float(potential(at.system, X, y))

    (off, energy), (_, before) = after(h), after(-h)
    assert off < 10 * h**3
    assert abs(energy - before) / (2 * h) < 1e-5


@pytest.mark.parametrize("name", ["straight", "linear"])
def test_the_closed_form_solves_the_equations_of_motion(name: str) -> None:
    """(5.6) with y'' by differences: m X'' = F1 - g_X lambda, y'' = F0 - <g_y lambda>, and g = const."""
    X, h, model = np.array([[0.7], [1.2], [1.3]]), 1e-3, cases.model(name)
    path = cases.harmonic(name, X, 0.8 + h * np.arange(-2, 3))
    weights = np.array([-1, 16, -30, 16, -1]) / (12 * h**2)
    bent_y, bent_X = weights @ path.y, np.einsum("k,kij->ij", weights, path.X)
    y, x, multiplier = path.y[2], path.X[2], path.multipliers[2]
    gX, gy = model.jacobians(x, y)
    assert np.abs(model.m * bent_X - model.F1(x) + gX[:, 0] * multiplier).max() < 1e-8
    assert np.abs(bent_y - model.F0(y) + (gy[:, 0] * multiplier).mean()).max() < 1e-8
    assert np.ptp(model.level(x, y) - model.level(X, [1.0])) == pytest.approx(0.0, abs=1e-15)
    assert path.v[2] == pytest.approx((path.y[3] - path.y[1]) / (2 * h), abs=1e-6)


def test_every_failure_is_as_predicted_and_a_wrong_prediction_is_seen() -> None:
    assert shipped(failures.NAME)["agrees"].all()
    motion = solve_ode(cases.model("linear"), State(X=[[1.0]], y=[1.0], v=[0.5]), [1.0], 1e-6)
    assert not failures.stopped(motion, 1.0).agrees  # a run that ends well
    model = cases.model("straight")
    fails = solve_ode(model, State(X=[[1.0]], y=[1.0], v=[-3.0]), np.linspace(0, 1, 200), 1e-8, throw=False)
    assert not failures.stopped(fails, 1.2 * float(fails.t[-1])).agrees
    assert failures.stopped(fails, 1.001 * float(fails.t[-1])).agrees


def test_powers_are_compared_with_those_of_theory() -> None:
    table = rates.fits(rates.results(shipped(rates.NAME)))
    on_line = table[table["start"] == IID]
    assert (on_line["agrees"] == "yes").all()
    assert len(on_line) == 7
    assert (table.loc[(table["quantity"] == "error_y") & (table["start"] == QUANTILES), "agrees"] == "—").all()
    assert (table.loc[(table["quantity"] == "error_y") & (table["start"] != QUANTILES), "agrees"] == "yes").all()
    at_once = table[table["case"].isin(["Unit interval, quantiles", "Unit square"])].set_index("case")
    assert at_once.loc["Unit interval, quantiles", "slope"] == pytest.approx(-1, abs=1e-12)
    assert at_once.loc["Unit interval, quantiles", "agrees"] == "yes"
    assert at_once.loc["Unit square", "low"] > -0.5  # slower than without the logarithm
    second = float(cases.law("uniform").moments()[1][0, 0])
    true = cases.harmonic("straight", np.array([[np.sqrt(second)]]), np.array([rates.T])).y
    assert rates.runs()["uniform StraightFibre, quantiles"].limit[0].y == pytest.approx(true, abs=1e-11)


def test_the_constant_of_stability_is_measured() -> None:
    rows = [row for kind in ("y0", "all") for row in stability_constant._rows({"model": "wavy", "kind": kind}, 2)]
    table = pd.DataFrame(rows)
    assert (table.loc[table["t"] == 0, "ratio"] == 1).all()
    (found,) = stability_constant.summary(table).itertuples()
    assert 1.2 < found.largest < 3.0
    assert found.pairs == 4
    grown = stability_constant.summary(table.assign(ratio=np.exp(0.5 * table["t"])))
    assert grown[["rate", "largest", "at"]].iloc[0].tolist() == pytest.approx([0.5, np.exp(4.0), 8.0])


def test_the_cheapest_levels_of_the_model() -> None:
    table = shipped(cost.NAME)
    assert set(table["setting"]) == {one for some in cost.SETTINGS.values() for one in some}
    charts = cost.results(table)
    won = {name: chart.cheapest(cost.TARGETS)["cheapest"].tolist() for name, chart in charts.items()}
    assert won == {"StraightFibre": ["Moments"] * 3, "WavyFibre": ["Characteristics"] * 3}
