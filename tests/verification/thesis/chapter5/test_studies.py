"""The studies of the mean-field chapter: what they compare with, what they conclude, and that what ships is theirs."""

import numpy as np
import pandas as pd
import pytest

from dincl.study.table import run_names
from meanfield import Density, push_forward, w1
from meanfield.solvers.characteristics import origins
from tests.executors import Here
from verification.site.agreement import compare_studies
from verification.site.context import Context
from verification.site.store import shipped
from verification.thesis.chapter5 import agreement, cases, cost, energy, exact, grid_order, page
from verification.thesis.chapter5.page import STUDIES


@pytest.mark.parametrize("name", STUDIES)
def test_all_runs_of_the_complete_study_ship(name):
    study, rows = STUDIES[name](), shipped(name)
    assert study.name == name
    assert set(run_names(rows, study.key)) == set(map(study.name_of, study.runs))


@pytest.mark.slow
def test_the_smallest_forms_are_shown_and_agree_with_what_ships(tmp_path):
    made = Context(tmp_path, False, Here(), STUDIES, smallest=True)
    page.run(made)
    page.show(made)
    for name, study in STUDIES.items():
        found = compare_studies(made.tables[name], shipped(name), study(), study().by)
        assert found.rows == len(made.tables[name]) > 0, name
        assert not found.apart, (name, found.worst)


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


def test_all_formulations_give_one_motion():
    rows = shipped(agreement.NAME)
    best = agreement.best(rows)
    worst = best[list(agreement.COMPARED)].max(axis=1)
    assert (worst < 1e-9).all()
    assert best["drift"].max() < 1e-12


def test_the_reference_knows_its_error():
    assert 0 < agreement.reference("wavy")[1].max() < 1e-11
    assert agreement.reference("straight")[1].max() < 1e-15


def test_a_trend_is_told_from_a_swing():
    t = np.linspace(0, 20 * energy.PERIOD, 101)
    swing = 1e-4 * np.sin(17.0 * t)
    rows = [{"method": "dae", "setting": 0.1, "t": a, "change": b} for a, b in zip(t, swing, strict=True)]
    rows += [{"method": "ode", "setting": 1e-5, "t": a, "change": b + 1e-5 * a} for a, b in zip(t, swing, strict=True)]
    found = energy.trends(pd.DataFrame(rows)).set_index("method")
    assert found["drifts"].to_dict() == {"ode": True, "dae": False}
    assert found["slope"]["ode"] == pytest.approx(1e-5 * energy.PERIOD, rel=0.1)


def test_the_energy_drifts_by_the_tolerance():
    found = energy.trends(shipped(energy.LONG)).set_index(["method", "setting"])
    assert found["drifts"].all()
    assert found["largest"]["ODE (DOP853)", 1e-8] < 1e-2 * found["largest"]["ODE (DOP853)", 1e-5]


def test_orders_in_the_grid_tell_jumps_from_smooth():
    found = grid_order.runs().result(shipped(grid_order.NAME))
    slopes = found.fits.set_index(["method", "error"])["slope"]
    for name in ("StraightFibre", "WavyFibre"):
        assert slopes[name, "f"] > 1.8
    assert slopes["uniform StraightFibre", "f"] < 1
    assert slopes["uniform StraightFibre", "W1"] == pytest.approx(1.4, abs=0.05)
    assert (found.table["least"] >= 0).all()
    assert found.table["mass"].max() < 1e-14


def test_the_cheapest_levels_of_the_model():
    won = {
        name: chart.cheapest(cost.TARGETS)["cheapest"].tolist()
        for name, chart in cost.results(shipped(cost.NAME)).items()
    }
    assert won == {
        "StraightFibre": ["Moments"] * 3,
        "WavyFibre": ["Characteristics"] * 3,
    }


def test_streams_are_independent():
    one, two, three = (cases.stream(*key).random() for key in (("start", 1, 2), ("start", 2, 1), ("pairs", 1, 2)))
    assert len({one, two, three}) == 3
    assert cases.stream("start", 1, 2).random() == one


def test_the_starts_are_regular():
    for name in cases.CASES:
        start = cases.few(name, 3)
        assert np.isfinite(cases.model(name).phi(start.X, start.y)).all()
    assert isinstance(cases.law("cube"), Density)
