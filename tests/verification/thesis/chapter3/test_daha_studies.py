"""The studies of DAHA, of judged steps and of a frozen tissue, each against a small computation."""

import numpy as np
import pandas as pd
import pytest

from tests.tissue.states import cells, layers, numbers
from tissue.model.energy import energy
from tissue.runs.simulate import simulate
from verification.site.store import shipped
from verification.thesis.chapter3 import accuracy, daha
from verification.thesis.chapter3.frozen import Frozen, begun, floored
from verification.thesis.quasi_steady.run import simulate_quasi_steady

KEY = {"case": daha.TERMINATING, "seed": 3}


@pytest.fixture(scope="module")
def rows():
    return pd.DataFrame(daha.grown(KEY, end=1.0))


@pytest.fixture(scope="module")
def steps():
    return pd.DataFrame(accuracy.judged({"seed": 0, "t": 1.0}))


def test_the_steps_are_those_of_the_quasi_steady_run(rows):
    chosen = daha.parameters_of(daha.TERMINATING, 1.0)
    run = simulate_quasi_steady(chosen, 3)
    assert rows.loc[rows["kind"] == "step", "iterations"].tolist() == run.iterations.tolist()
    pbd = simulate(chosen.changed({"numerics.mu": "0.2 h", "numerics.substeps": 20}), 3)
    x, y = (np.array([found.final.cells.x, found.final.cells.y]) for found in (run, pbd))
    found = rows[(rows["kind"] == "pbd") & (rows["mu"] == 0.2)]
    expected = np.sqrt(((x - y) ** 2).sum() / (x**2).sum())
    assert found["relative"].tolist() == pytest.approx([expected], rel=1e-10)
    assert found["rms"].tolist() == pytest.approx([np.sqrt(((x - y) ** 2).sum() / x.shape[1])], rel=1e-10)


def test_other_noise_is_another_run(rows):
    assert set(rows["kind"]) == {"step", "run", "pbd", "other noise"}
    same = rows.loc[(rows["kind"] == "pbd") & (rows["mu"] == 0.14), "rms"].item()
    assert 0 < same < rows.loc[rows["kind"] == "other noise", "rms"].item()


def test_quartiles_are_of_steps_that_terminated_and_half_is_the_step_of_3_25():
    made = [{"kind": "step", "iterations": n, "terminated": True, "violation": 0.0} for n in (1000, 5000, 6000)]
    made.append({"kind": "step", "iterations": 100_000, "terminated": False, "violation": 0.5})
    found = daha.iterations(pd.DataFrame(made).assign(case=daha.PRINTED)).iloc[0]
    assert (found["low"], found["median"], found["high"]) == (3000, 5000, 5500)
    assert found["whole"] == pytest.approx(0.1 / (5000 * 1e-4))
    assert found["half"] == pytest.approx(0.1 / (5000 * 0.5e-4))
    assert (found["steps"], found["terminated"], found["violation"]) == (4, 3, 0.5)


def test_failures_are_runs_that_ended_early():
    made = pd.DataFrame({"t": [2.0, 4.0, 10.0, 10.0], "terminated": [False, False, True, True]})
    found = daha.failures(made.assign(kind="run", case=daha.PRINTED)).iloc[0]
    assert (found["failed"], found["share"], found["first"], found["last"]) == (2, 0.5, 2.0, 4.0)


def test_seeds_beyond_those_compared_have_how_they_end_alone():
    (row,) = daha.grown(KEY | {"seed": daha.SEEDS}, end=0.2)
    assert (row["kind"], row["terminated"]) == ("run", True)
    found = daha.shares(daha.failures(shipped("tissue_daha"))).set_index("case")
    assert found["runs"].to_dict() == dict.fromkeys(daha.READINGS, daha.OF_READINGS)
    assert found["failed"].to_dict() == {daha.PRINTED: 73, daha.TERMINATING: 0, daha.SQUARED: 0, daha.PROGRAM: 2}


def test_the_best_damping_of_a_parabola():
    mu = np.array(daha.DAMPINGS)
    assert daha.best(mu, 0.05 + np.log(mu / 0.18) ** 2) == pytest.approx(0.18)
    assert daha.best(mu, mu) == pytest.approx(mu[0])


def test_a_fit_over_seeds():
    mu = np.array(daha.DAMPINGS)
    seeds = [{"seed": k, "mu": mu, "relative": 0.1 + np.log(mu / best) ** 2} for k, best in enumerate((0.16, 0.25))]
    found = daha.fitted(pd.concat(map(pd.DataFrame, seeds)).assign(kind="pbd", case="any")).iloc[0]
    assert found["mu"] == pytest.approx(0.2, rel=1e-6)
    assert (found["mu_low"], found["mu_high"]) == pytest.approx((0.16, 0.25), rel=1e-6)


def test_what_is_left_of_the_gradient_is_nothing_at_a_minimum():
    state = Frozen(cells(10, 2), layers(10), numbers())
    least = accuracy.minimum(state.cells, state)
    assert accuracy.left_over(least.cells, state) < 1e-8
    assert least.energy < energy(*state)
    assert accuracy.left_over(state.cells, state) > 0.1


def test_judged_step(steps):
    at = steps.set_index("where")
    state = begun(floored(), 0, 1.0)
    assert at.loc["start", "energy"] == pytest.approx(energy(*state), rel=1e-12)
    assert at.loc["minimum", "energy"] < at.loc["DAHA", "energy"] < at.loc["start", "energy"]
    assert at["solved"].all()
    assert 0.01 < at.loc["DAHA", "gradient"] < 0.02
    assert at.loc["minimum", "gradient"] < accuracy.TOL
    table = pd.concat([steps, steps.assign(seed=1)])
    part = accuracy.summary(table).set_index("where")["part"]
    top, low = at.loc["start", "energy"], at.loc["minimum", "energy"]
    assert part["DAHA"] == pytest.approx((top - at.loc["DAHA", "energy"]) / (top - low))


def test_substeps_and_catch_up_approach_one_motion():
    t = np.array([accuracy.DT])
    known = accuracy.exact(t)
    off = {
        (run.__name__, n): known.off(run(None, accuracy.DT / n, t)).max()
        for run in (accuracy._substeps, accuracy._linearised, accuracy._midpoint)
        for n in (40, 80, 640)
    }
    assert known.error.max() < 1e-6
    assert off["_substeps", 640] < off["_substeps", 40] / 8
    assert off["_linearised", 80] < 0.7 * off["_linearised", 40]
    assert off["_midpoint", 80] < off["_midpoint", 40] / 2


def test_pbd_is_cheapest_where_little_accuracy_is_asked_for():
    won = accuracy.MOTION.result(shipped("tissue_motion")).cheapest([1e-2, 1e-4]).set_index("target")["cheapest"]
    assert won.to_dict() == {1e-2: "substeps of PBD", 1e-4: "MidpointCatchUp"}
