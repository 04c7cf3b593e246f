"""Failures of the mean-field solvers, provoked and mapped."""

import numpy as np
import pandas as pd
import pytest

from meanfield import State, solve_ode
from verification.site.store import shipped
from verification.thesis.chapter5 import cases, failures, maps


def test_every_failure_is_as_predicted():
    assert shipped(failures.NAME)["agrees"].all()


def test_a_wrong_prediction_is_seen():
    """A run that ends well, or at another place, does not agree."""
    motion = solve_ode(cases.model("linear"), State(X=[[1.0]], y=[1.0], v=[0.5]), [1.0], 1e-6)
    assert not failures.stopped(motion, 1.0).agrees
    model = cases.model("straight")
    fails = solve_ode(model, State(X=[[1.0]], y=[1.0], v=[-3.0]), np.linspace(0, 1, 200), 1e-8, throw=False)
    assert not failures.stopped(fails, 1.2 * float(fails.t[-1])).agrees
    assert failures.stopped(fails, 1.001 * float(fails.t[-1])).agrees


@pytest.mark.parametrize(("name", "right"), [(maps.STIFF, 1175 + 1175 + 1187), (maps.PUSHED, 3 * 583)])
def test_all_cells_away_from_a_limit_end_as_theory_says(name, right):
    found = maps.agreement(name, shipped(name))
    assert found["Cells"].sum() == found["As theory says"].sum() == right


@pytest.mark.parametrize("name", maps.MAPS)
def test_limits_are_drawn_where_cells_change(name):
    """On both sides of each curve, 20 % away from it in k0."""
    runs = maps.MAPS[name]
    curves = runs.result(shipped(name)).limits
    cell = runs.study(name).run
    for method, curve in curves.groupby("method"):
        at = curve[(curve["y"] > runs.y[1][2]) & (curve["y"] < runs.y[1][-3])].iloc[-1]
        key = {"method": method, runs.x[0]: at["x"]}
        low, high = (cell(key | {"k0": factor * at["y"]})[0]["outcome"] for factor in (0.8, 1.25))
        failed, fine = (high, low) if name == maps.STIFF else (low, high)
        assert failed in ("unstable", "refused")
        assert fine in ("converged", "inaccurate")


def test_limits_of_the_steps():
    assert maps.limit("RATTLE of order 2") == pytest.approx(2.0, abs=2e-3)
    assert maps.limit(maps.RK4) == pytest.approx(2 * np.sqrt(2), abs=2e-3)
    x = np.array([0.5, 2.5])  # the product of steps of order 4 stays in bounds where a single step would not
    assert maps.grows("RATTLE of order 2", x).tolist() == [False, True]
    assert maps.grows("RATTLE of order 4", x).tolist() == [False, False]


def test_map_counts_what_failed_elsewhere():
    outcomes = ["converged", "refused", "refused", "converged"]
    table = pd.DataFrame({"method": "ODE", "k0": 1.0, "speed": [0.1, 0.2, 50.0, 60.0], "outcome": outcomes})
    (found,) = maps.agreement(maps.PUSHED, table).to_dict("records")
    assert (found["Cells"], found["As theory says"]) == (4, 2)
