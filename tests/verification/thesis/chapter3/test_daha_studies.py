"""The studies of DAHA, of judged steps and of catch-up: tiny forms, each verdict against a small computation."""

import numpy as np
import pandas as pd
import pytest

from tests.executors import Here
from tests.tissue.states import cells, layers, numbers
from tests.verification.thesis.shortened_tissue import DAHA
from tests.verification.undrawn import draw_nothing
from tissue.files.parameters import preset
from tissue.model.energy import energy
from tissue.quasi_steady.judge import local_minimum
from tissue.quasi_steady.run import simulate_quasi_steady
from tissue.runs.simulate import simulate
from verification.page.context import Context
from verification.page.parts import Grid, Picture, Text
from verification.thesis.chapter3 import catch_up, daha, daha_ends, daha_fit, daha_limits, judged
from verification.thesis.chapter3.frozen import Frozen
from verification.thesis.chapter3.sections import catch_up as catch_up_section
from verification.thesis.chapter3.sections import daha as daha_section
from verification.thesis.chapter3.sections import judged as judged_section

HOUR = 1.0
KEY = {"case": daha.TERMINATING, "eps": 1e-6, "seed": 3}


@pytest.fixture(scope="module")
def rows():
    return pd.DataFrame(daha.compared(KEY, HOUR, (0.14,)))


@pytest.fixture(scope="module")
def steps():
    return pd.DataFrame(judged.judged({"seed": 0, "t": 1.0}, judged.floored()))


@pytest.fixture(scope="module")
def moved():
    form = catch_up.CatchUpForm(1, (20, 40, 640), (40, 80), 160)
    return pd.DataFrame(catch_up.moved({"seed": 0}, form, judged.floored()))


@pytest.mark.slow
def test_the_steps_are_those_of_the_quasi_steady_run(rows):
    chosen = preset("thesis").changed(
        {"rules.floor_rest_length": True, "numerics.t_end": "1 h", "numerics.keep": "1 h", "daha.eps": 1e-6}
    )
    run = simulate_quasi_steady(chosen, 3)
    assert rows.loc[rows["kind"] == "step", "iterations"].tolist() == run.iterations.tolist()
    pbd = simulate(chosen.changed({"numerics.mu": "0.2 h", "numerics.substeps": 20}), 3)
    x, y = (np.array([found.final.cells.x, found.final.cells.y]) for found in (run, pbd))
    found = rows[(rows["kind"] == "pbd") & (rows["mu"] == 0.2) & (rows["substeps"] == 20)]
    expected = np.sqrt(((x - y) ** 2).sum() / (x**2).sum())
    assert found["relative"].tolist() == pytest.approx([expected], rel=1e-10)
    assert found["rms"].tolist() == pytest.approx([np.sqrt(((x - y) ** 2).sum() / x.shape[1])], rel=1e-10)


def test_baselines_are_other_runs(rows):
    assert set(rows["kind"]) == {"step", "run", "pbd", "other noise", "pbd with itself"}
    same = rows[(rows["kind"] == "pbd") & (rows["mu"] == 0.14)].set_index("substeps")["rms"]
    itself, noisy = (rows.loc[rows["kind"] == kind, "rms"].item() for kind in ("pbd with itself", "other noise"))
    assert abs(same[20] - same[200]) <= itself
    assert noisy > 0
    assert noisy != same[20]


def test_quartiles_are_of_steps_that_terminated_and_half_is_the_step_of_3_25():
    made = [{"kind": "step", "iterations": n, "terminated": True, "violation": 0.0} for n in (1000, 5000, 6000)]
    made.append({"kind": "step", "iterations": 100_000, "terminated": False, "violation": 0.5})
    found = daha.iterations(pd.DataFrame(made).assign(case=daha.PRINTED, eps=1e-6)).iloc[0]
    assert (found["low"], found["median"], found["high"]) == (3000, 5000, 5500)
    assert found["whole"] == pytest.approx(0.1 / (5000 * 1e-4))
    assert found["half"] == pytest.approx(0.1 / (5000 * 0.5e-4))
    assert (found["steps"], found["terminated"], found["violation"]) == (4, 3, 0.5)


def test_failures_are_runs_that_ended_early():
    made = pd.DataFrame({"t": [2.0, 4.0, 10.0, 10.0], "terminated": [False, False, True, True]})
    found = daha.failures(made.assign(kind="run", case=daha.PRINTED, eps=1e-6, stiffness=[5.0, 7.0, 1.0, 1.0])).iloc[0]
    assert (found["failed"], found["share"], found["first"], found["last"]) == (2, 0.5, 2.0, 4.0)
    assert found["stiffness"] == 6.0


def test_the_best_damping_of_a_parabola():
    mu = np.array(daha.DAMPINGS)
    assert daha_fit.best(mu, 0.05 + np.log(mu / 0.18) ** 2) == pytest.approx(0.18)
    assert daha_fit.best(mu, mu) == pytest.approx(mu[0])


def test_fit_and_equal_height_over_seeds():
    def seed(k, best):
        mu = np.array(daha.DAMPINGS)
        tall = {"height": 10 - np.log(mu / best), "reference_height": 10.0}
        return pd.DataFrame({"mu": mu, "relative": 0.1 + np.log(mu / best) ** 2, "seed": k} | tall)

    both = pd.concat([seed(0, 0.16), seed(1, 0.25)]).assign(kind="pbd", case="any", t=10.0, substeps=20)
    found = daha_fit.fitted(both).iloc[0]
    assert found["mu"] == pytest.approx(0.2, rel=1e-6)
    assert (found["mu_low"], found["mu_high"]) == pytest.approx((0.16, 0.25), rel=1e-6)
    assert found["equal"] == pytest.approx(0.205, rel=1e-6)


@pytest.mark.parametrize("c", [0.2, 2.0, 20.0])
def test_the_linear_limit_of_alpha_does_not_depend_on_c(c):
    def left(k):
        before = z = 1.0
        for _ in range(20_000):
            z, before = (2 * z - (1 - c / 2) * before - k * z) / (1 + c / 2), z
            if abs(z) > 1e6:
                break
        return abs(z)

    assert left(0.99 * daha_limits.limit()) < 1e-3
    assert left(1.01 * daha_limits.limit()) > 1e3


def test_outcomes_of_one_step():
    assert daha_limits.stepped("0", alpha=1.0)["outcome"] == "terminated"
    assert daha_limits.stepped("0", alpha=1e-2)["outcome"] == "violated"
    wild = daha_limits.stepped("0", alpha=1e3)
    assert wild["limit"] < 1e3
    assert wild["outcome"] in ("not terminated", "not finite")


def test_held_is_the_range_around_table_4():
    good, bad, lost = "terminated", "violated", "not terminated"
    line = pd.DataFrame({"x": [0.01, 0.1, 1.0, 10.0, 100.0], "y": 1.0, "outcome": [good, bad, good, good, lost]})
    across = pd.DataFrame({"x": 1.0, "y": [0.1, 10.0], "outcome": good})
    table = pd.concat([line, across]).assign(method="0", limit=50.0)
    found = daha_limits.held({plane.name: table for plane in daha_limits.PLANES}).set_index("parameter")
    assert found.loc["alpha", ["from", "to", "below", "above", "limit"]].tolist() == [1.0, 10.0, bad, lost, 50.0]
    assert found.loc["beta", ["from", "to", "below"]].tolist() == [0.1, 10.0, "as far as tried"]


def test_what_is_left_of_the_gradient_is_nothing_at_a_minimum():
    state = Frozen(cells(10, 2), layers(10), numbers())
    least = local_minimum(*state, 1e-7).cells
    assert judged.left_over(least, state) < 1e-6
    assert judged.left_over(state.cells, state) > 0.1


def test_judged_step(steps):
    at = steps.set_index("where")
    state = judged.begun(judged.floored(), 0, 1.0)
    assert at.loc["start", "energy"] == pytest.approx(energy(*state), rel=1e-12)
    assert at.loc["minimum from DAHA", "energy"] < at.loc["DAHA", "energy"] < at.loc["start", "energy"]
    assert at["solved"].all()
    assert 0.01 < at.loc["DAHA", "gradient"] < 0.02
    assert at.loc["minimum", "gradient"] < 1e-6
    table = pd.concat([steps, steps.assign(seed=1)])
    part = judged.summary(table).set_index("where")["part"]
    top, low = at.loc["start", "energy"], at.loc["minimum from DAHA", "energy"]
    assert part["DAHA"] == pytest.approx((top - at.loc["DAHA", "energy"]) / (top - low))


@pytest.mark.slow
def test_catch_up_and_pbd_have_one_limit(moved):
    error = moved.set_index(["method", "steps"])["rms"]
    assert (moved["own"] < 1e-4).all()
    assert error["PBD", 640] < error["PBD", 40] / 8
    assert error["LinearisedCatchUp", 80] < 0.7 * error["LinearisedCatchUp", 40]
    assert error["MidpointCatchUp", 80] < error["MidpointCatchUp", 40] / 2
    assert 20 < moved["least"].iloc[0] < 80


def test_errors_are_medians_and_lost_runs_are_counted():
    made = pd.DataFrame({"rms": [1.0, 2.0, 9.0, np.nan], "seconds": 1.0, "own": 0.1, "least": 3.0})
    found = catch_up.errors(made.assign(method="PBD", steps=[5, 5, 5, 1])).set_index("steps")
    assert found.loc[5, "rms"] == 2.0
    assert found["lost"].tolist() == [1, 0]


@pytest.mark.slow
def test_sections_say_what_the_tables_say(monkeypatch, tmp_path):
    draw_nothing(monkeypatch)
    context = Context(tmp_path, False, Here(), DAHA)
    shown = {}
    for section in (daha_section, judged_section, catch_up_section):
        section.PART.run(context)
        found = section.PART.section(context)
        shown[found.title] = " ".join(part.html for part in found.parts if isinstance(part, Text))
        assert all(part.path.exists() for part in found.parts if isinstance(part, Picture))
        assert all(
            len(part.rows.columns) == len(set(part.rows.columns)) for part in found.parts if isinstance(part, Grid)
        )
    made = context.tables["tissue_daha"]
    done = made[(made["kind"] == "step") & (made["case"] == daha.PRINTED) & (made["eps"] == 1e-6)]["iterations"]
    assert f"takes {done.median():.0f} iterations" in shown["Do DAHA and PBD grow the same tissue?"]
    assert "1 of 1 fail" in shown["Do DAHA and PBD grow the same tissue?"]
    own = context.tables["tissue_judged_steps"].set_index("where").loc["DAHA", "part"]
    assert f"goes {100 * own:.0f} % [" in shown["How far from a minimum does a step end?"]
    assert "nan" not in " ".join(shown.values()).lower()


@pytest.mark.slow
def test_runs_of_daha_end_by_some_readings_of_the_model_only():
    study = daha_ends.study(daha_ends.EndsForm(1))
    assert len(study.runs) == len(daha_ends.READINGS)
    lost, ended = (study.run({"reading": name, "seed": 0})[0] for name in ("as printed", "squared denominators"))
    assert (lost["ended"], ended["ended"], ended["t"]) == (False, True, daha.END)
    assert lost["status"] == "NOT_CONVERGED"
    assert 2.0 < lost["t"] < 6.0
    found = daha_ends.shares(pd.DataFrame([lost, ended])).set_index("reading")
    assert found["share"].to_dict() == {"as printed": 1.0, "squared denominators": 0.0}
    assert (found["low"] < 1).all()
