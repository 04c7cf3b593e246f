"""The studies of the tissue: substeps, disturbances, growth measure what they say, seen by other means."""

import json

import numpy as np
import pandas as pd
import pytest
from scipy.stats import t as student

from tests.tissue.states import tissue
from tests.verification.thesis.shortened_tissue import simulated
from tissue.frames.observables import height
from verification.thesis.chapter2 import large_steps
from verification.thesis.chapter3 import disturbed, growing, growth, kernel, substeps
from verification.thesis.chapter3.growing import OUT_OF_BOUNDS, PRESETS, SUCCESS
from verification.thesis.chapter3.intervals import over_seeds

# What runs


@pytest.mark.parametrize("name", PRESETS)
def test_a_growing_run_is_a_simulation_whenever_it_is_looked_at(name):
    run, often = growing.growing(name, 3), growing.growing(name, 3)
    assert run.to(2.0)
    for t in (0.1, 0.7, 2.0):
        assert often.to(t)
    for one in (run.frame(), often.frame()):
        for here, there in zip(one.cells, simulated(name, 3, 2).final.cells, strict=True):
            np.testing.assert_array_equal(here, there)
    assert often.frame().t == pytest.approx(2.0)


def test_runs_with_other_noise_differ_in_positions_only():
    plain, other = growing.growing("thesis", 1), growing.with_noise(growing.growing("thesis", 1), 99)
    np.testing.assert_array_equal(plain.frame().cells.x, other.frame().cells.x)
    for run in (plain, other):
        run.to(3.0)
    here, there = plain.frame().cells, other.frame().cells
    np.testing.assert_array_equal(here.birth, there.birth)
    np.testing.assert_array_equal(here.cycle, there.cycle)
    assert growing.rms(growing.nuclei(plain.frame()), growing.nuclei(other.frame())) > 0.1


def test_a_disturbance_has_the_size_asked_for():
    plain, other = growing.growing("published", 1), growing.disturbed(growing.growing("published", 1), 1e-3)
    moves = growing.nuclei(other.frame()) - growing.nuclei(plain.frame())
    assert moves.std() == pytest.approx(1e-3, rel=0.3)
    np.testing.assert_array_equal(plain.frame().cells.ax, other.frame().cells.ax)


def test_lost_cells_end_a_run():
    run = growing.growing("thesis", 0, substeps=2)
    assert not run.to(5.0)
    assert run.status != SUCCESS
    made = run.made
    assert not run.to(6.0)
    assert run.made == made


def test_extent_and_distance():
    state = tissue([[1.0, 2.0]], [[0.0, -9.0]], [[3.0, 0.0]])
    assert growing.extent(state) == 9.0
    assert growing.far_from(state) == 10 * 9.0
    assert growing.extent(state._replace(ax=np.array([np.nan]))) == np.inf
    x = np.array([[0.0, 3.0], [0.0, 4.0]])
    assert growing.rms(x, np.zeros((2, 2))) == pytest.approx(np.sqrt(25 / 2))


def test_rows_of_the_tissue_depend_on_its_code_and_presets_and_others_do_not():
    made, other = substeps.study(substeps.FULL).provenance(), large_steps.study().provenance()
    reached = {"tissue.step.advance", "tissue.state.numbers", "dincl.compiled.functions"}
    assert reached <= json.loads(made["code"]).keys()
    presets = {f"tissue.files/presets/{name}.toml" for name in ("thesis", "published")}
    assert presets <= json.loads(made["data"]).keys()
    assert not any(name.startswith("tissue") for name in json.loads(other["code"]) | json.loads(other["data"]))
    assert {"dincl.schemes.base", "verification.thesis.chapter2.methods"} <= json.loads(other["code"]).keys()


# Substeps


def test_interval_is_that_of_student():
    values = np.array([1.0, 2.0, 4.0, 4.5])
    found = over_seeds(values)
    low, high = student.interval(0.95, 3, values.mean(), values.std(ddof=1) / 2)
    assert found == pytest.approx((values.mean(), low, high))
    assert np.isnan(over_seeds([1.0]).low)


def test_errors_are_distances_to_the_same_run_with_many_substeps():
    form = substeps.SubstepsForm({"published": (10,)}, {"published": 80}, 1, (1.0, 2.0))
    rows = pd.DataFrame(substeps.compared({"preset": "published", "seed": 4}, form))
    assert rows[["substeps", "t"]].to_numpy().tolist() == [[10, 1], [10, 2], [40, 1], [40, 2]]
    few, many = (simulated("published", 4, 2, **{"numerics.substeps": count}).final for count in (10, 80))
    x, y = growing.nuclei(few), growing.nuclei(many)
    last = rows.iloc[1]
    assert last["rms"] == pytest.approx(np.sqrt(((x - y) ** 2).sum() / x.shape[1]), rel=1e-12)
    assert last["relative"] == pytest.approx(np.linalg.norm(x - y) / np.linalg.norm(y), rel=1e-12)
    assert (last["height"], last["reference_height"]) == (height(few), height(many))
    # More substeps, smaller error, before nuclei part.
    assert rows.iloc[3]["rms"] < last["rms"] < 0.1


def made_up(order=1.0, lost=False):
    """A table of two seeds: errors h^order in the nuclei, deviations h in the heights, of 1/h substeps."""
    rows = []
    for count in (4, 8, 16, 32, 64, 128):
        for seed in range(2):
            fine = not (lost and count == 4 and seed == 1)
            height_then = 8 * (1 + 1 / count + 1e-4 * seed)
            numbers = {
                "rms": count**-order,
                "relative": count**-order / 9,
                "height": height_then,
                "reference_height": 8.0,
            }
            about = {"preset": "thesis", "seed": seed, "substeps": count, "h": 1 / count, "t": 10.0, "seconds": 0.1}
            rows.append(
                about | {"status": SUCCESS if fine else OUT_OF_BOUNDS} | (numbers if fine else dict.fromkeys(numbers))
            )
    return pd.DataFrame(rows)


def test_orders_and_the_error_of_the_reference():
    made = substeps.errors(made_up(order=1.5))
    assert made["substeps"].tolist() == [4, 8, 16, 32, 64]
    assert made["own"].to_numpy() == pytest.approx(substeps.SAFETY * 128**-1.5)
    found = substeps.orders(made).iloc[0]
    assert found["slope"] == pytest.approx(1.5, abs=0.05)
    assert substeps.errors(made_up(lost=True))["lost"].tolist() == [1, 0, 0, 0, 0]


def test_enough_substeps_are_those_whose_interval_is_within():
    made = substeps.heights(made_up(lost=True))
    assert np.isnan(made[["at_most", "height"]].iloc[0]).all()
    own = substeps.SAFETY * (1 / 128 + 5e-5)
    half = student.ppf(0.975, 1) * 1e-4 / 2
    assert made["at_most"].to_numpy()[1:] == pytest.approx([1 / n + 5e-5 + half + own for n in (8, 16, 32, 64, 128)])
    assert substeps.enough(made)["substeps"].tolist() == [0]
    made["own"], made["at_most"] = 0.0, made["high"]
    assert substeps.enough(made)["substeps"].tolist() == [128]
    made["at_most"] = [np.nan, 0.001, 0.02, 0.001, 0.01, 0.001]
    assert substeps.enough(made)["substeps"].tolist() == [32]


# Disturbances


def apart():
    """Distances e^{t/5} of 1e-6, and 1 with other noise; of 1e-3 one of two runs has parted."""
    rows = []
    for seed in range(2):
        for t in (0.0, 1.0, 10.0):
            for size, far in ((1e-6, 1e-6 * np.exp(t / 5 + 0.01 * seed * t)), (1e-3, 0.6 * seed + 1e-3), (np.inf, 1.0)):
                rows.append({"preset": "thesis", "substeps": 20, "seed": seed, "size": size, "t": t, "rms": far})
    return pd.DataFrame(rows)


def test_rates_of_growth_and_runs_that_part():
    found = disturbed.rates(apart()).set_index("size")
    assert found.loc[1e-6, "rate"] == pytest.approx(0.205)
    assert found.loc[1e-6, ["low", "high"]].to_numpy() == pytest.approx(
        0.205 + np.array([-1, 1]) * student.ppf(0.975, 1) * 0.005
    )
    assert found["jumped"].to_dict() == {1e-6: 0.0, 1e-3: 0.5}


def test_predicted_as_long_as_the_error_is_below_half_of_other_noise():
    errors = pd.DataFrame(
        {"preset": "thesis", "substeps": 20, "t": [0.0, 1.0, 10.0, 20.0], "rms": [9.0, 0.4, 0.6, 0.1]}
    )
    made = disturbed.medians(apart())
    assert disturbed.predicted(errors, made)["until"].tolist() == [1.0]
    assert disturbed.predicted(errors.assign(rms=0.4), made)["until"].tolist() == [10.0]
    assert disturbed.predicted(errors.assign(rms=[0.1, 0.6, 0.1, 0.1]), made)["until"].tolist() == [0.0]


def test_small_disturbances_stay_small():
    rows = pd.DataFrame(disturbed.followed({"preset": "published", "seed": 0, "substeps": 20}, (0.1, 5.0)))
    last = rows[rows["t"] == 5.0].set_index("size")["rms"]
    assert last[1e-9] < 1e-6
    assert last[np.inf] > 0.3
    assert last[1e-6] / last[1e-9] == pytest.approx(1000, rel=0.1)  # linear


# Growth


def test_heights_are_those_of_the_simulation():
    rows = pd.DataFrame(growth.grown({"preset": "thesis", "mu": 0.1, "substeps": 30}, 2, end=4.0))
    assert rows["t"].unique().tolist() == [0.0, 2.0, 4.0]
    run = simulated("thesis", 1, 4, **{"numerics.mu": "0.1 h", "numerics.substeps": 30})
    mine = rows[rows["seed"] == 1]["ratio"].to_numpy()
    assert mine == pytest.approx([1.0, height(run.frames[2]) / 8, height(run.frames[4]) / 8], rel=1e-12)


def test_substeps_keep_the_step_over_the_damping():
    assert growth.substeps_of("thesis", 0.15, 1 / 60) == (20, 40)
    assert growth.substeps_of("thesis", 0.025, 1 / 60) == (20, 240)
    assert growth.substeps_of("published", 0.2, 1 / 60) == (40,)


def test_the_damping_that_doubles(monkeypatch):
    rows = []
    for seed in range(3):
        for mu in (0.025, 0.05, 0.1, 0.2):
            for count in (20, 80):
                ratio = 2 - np.log(mu / (0.04 + 0.001 * seed)) / 3
                lost = count == 20 and mu < 0.04
                about = {"preset": "thesis", "seed": seed, "mu": mu, "substeps": count, "t": growth.FULL.end}
                rows.append(about | {"ratio": np.nan if lost else ratio, "status": OUT_OF_BOUNDS if lost else SUCCESS})
    made = pd.DataFrame(rows)
    found = growth.doubling(made).set_index("kind")
    assert found.loc["fine", "mu"] == pytest.approx(0.041)
    assert found.loc["as the preset", "mu"] == pytest.approx(0.041)  # on the line through those that were not lost
    ratios = growth.ratios(made).set_index(["substeps", "mu"])
    assert ratios.loc[(20, 0.025), ["lost", "to"]].tolist() == [3, OUT_OF_BOUNDS]
    assert np.isnan(ratios.loc[(20, 0.025), "ratio"])
    assert ratios.loc[(80, 0.1), "ratio"] == pytest.approx(2 - np.log(0.1 / 0.041) / 3, abs=1e-3)
    assert np.isnan(growth.doubling(made.assign(ratio=made["ratio"] - 1))["mu"]).all()


def test_what_the_text_says_of_growth():
    # After 12 h: energies as printed grow faster, a smaller damping, too; with 20 substeps it loses cells.
    ratio = {}
    for name, mu in (("thesis", 0.2), ("published", 0.2), ("published", 0.05)):
        run = simulated(name, 0, 12, **{"numerics.mu": f"{mu} h", "numerics.substeps": 40})
        ratio[name, mu] = height(run.final) / 8
    assert ratio["thesis", 0.2] > 1.1 > ratio["published", 0.2]
    assert ratio["published", 0.05] > 1.1 * ratio["published", 0.2]
    rows = growth.grown({"preset": "thesis", "mu": 0.025, "substeps": 20}, 1, growth.FULL.end)
    assert rows[-1]["status"] != SUCCESS
    assert np.isnan(rows[-1]["ratio"])


# Time


def test_the_exponent_of_the_time_per_substep():
    cells_then = np.array([60.0, 600.0, 6000.0])
    rows = pd.DataFrame({"preset": "thesis", "cells": cells_then, "us_best": 0.3 * cells_then**1.25})
    assert kernel.growth(rows)["exponent"].to_numpy() == pytest.approx([1.25])
