"""The studies of the tissue: substeps, growth, stability and DAHA measure what they say, seen by other means."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from matplotlib.container import ErrorbarContainer
from matplotlib.figure import Figure
from scipy.stats import t as student

from tests.tissue.states import THESIS, cells, layers, numbers, tissue
from tests.twins.tissue import make_substeps
from tissue.files.parameters import preset
from tissue.frames.observables import height
from tissue.model.energy import energy
from tissue.runs.simulate import simulate
from verification.site.store import shipped
from verification.thesis.chapter3 import accuracy, daha, growing, growth, page, stability, substeps
from verification.thesis.chapter3.growing import OUT_OF_BOUNDS, PRESETS, SUCCESS, Frozen, begun, floored, swing
from verification.thesis.chapter3.sampled import over_seeds
from verification.thesis.quasi_steady.daha import simulate_quasi_steady
from verification.tissues.needs import study


def simulated(name, seed, end, **changes):
    """A run of a preset until ``end`` [h], kept every hour, with some keys changed."""
    parameters = preset(name).changed({"numerics.t_end": f"{end} h", "numerics.keep": "1 h", **changes})
    return simulate(parameters, seed, throw=False)


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


def test_lost_cells_end_a_run():
    run = growing.growing("thesis", 0, substeps=2)
    assert not run.to(5.0)
    assert run.status != SUCCESS
    made = run.made
    assert not run.to(6.0)
    assert run.made == made


# Substeps


def test_interval_is_that_of_student():
    values = np.array([1.0, 2.0, 4.0, 4.5])
    found = over_seeds(values)
    low, high = student.interval(0.95, 3, values.mean(), values.std(ddof=1) / 2)
    assert found == pytest.approx((values.mean(), low, high))
    assert np.isnan(over_seeds([1.0]).low)


def test_errors_are_distances_to_the_same_run_with_many_substeps():
    rows = pd.DataFrame(substeps.compared({"preset": "published", "seed": 4}, (1.0, 2.0))).set_index(["substeps", "t"])
    few, many = (simulated("published", 4, 2, **{"numerics.substeps": count}).final for count in (10, 2560))
    x, y = growing.nuclei(few), growing.nuclei(many)
    assert rows.loc[(10, 2.0), "rms"] == pytest.approx(np.sqrt(((x - y) ** 2).sum() / x.shape[1]), rel=1e-12)
    assert rows.loc[(10, 2.0), "deviation"] == height(few) / height(many) - 1
    assert rows.loc[(1280, 2.0), "rms"] < rows.loc[(40, 2.0), "rms"] < rows.loc[(10, 2.0), "rms"]


def made_up(order=1.0, lost=False):
    """A table of two seeds: errors h^order in the nuclei, deviations h in the heights, of 1/h substeps."""
    rows = []
    for count in (4, 8, 16, 32, 64, 128):
        for seed in range(2):
            fine = not (lost and count == 4 and seed == 1)
            about = {"preset": "thesis", "seed": seed, "substeps": count, "t": 10.0, "seconds": 0.1}
            numbers = {"rms": count**-order, "deviation": 1 / count + 1e-4 * seed}
            rows.append(about | (numbers if fine else dict.fromkeys(numbers, np.nan)))
    return pd.DataFrame(rows)


def test_orders_and_the_error_of_the_reference():
    made = substeps.accuracy(made_up(order=1.5))
    assert made["own"].to_numpy() == pytest.approx(substeps.SAFETY * 128**-1.5)
    assert made["seconds"].tolist() == [0.1] * 6
    found = substeps.orders(made).iloc[0]
    assert found["nuclei"].startswith("1.50")
    assert substeps.accuracy(made_up(lost=True))["lost"].tolist() == [1, 0, 0, 0, 0, 0]


def test_enough_substeps_are_those_whose_interval_is_within():
    made = substeps.accuracy(made_up(lost=True))
    own, half = substeps.SAFETY * (1 / 128 + 5e-5), student.ppf(0.975, 1) * 1e-4 / 2
    assert made["at_most"].to_numpy()[1:] == pytest.approx([1 / n + 5e-5 + half + own for n in (8, 16, 32, 64, 128)])
    for at_most, enough in (
        ([1, 1, 1, 1, 1, 0.001], 128),
        ([np.nan, 0.001, 0.02, 0.001, 0.01, 0], 32),
        ([0.02] * 6, 0),
    ):
        assert substeps.orders(made.assign(at_most=at_most))["enough"].tolist() == [enough]


# Growth


def test_heights_are_those_of_the_simulation():
    rows = pd.DataFrame(growth.grown({"preset": "thesis", "mu": 0.1, "substeps": 30}, 2, end=4.0))
    assert rows["t"].unique().tolist() == [0.0, 2.0, 4.0]
    run = simulated("thesis", 1, 4, **{"numerics.mu": "0.1 h", "numerics.substeps": 30})
    mine = rows[rows["seed"] == 1]["ratio"].to_numpy()
    assert mine == pytest.approx([1.0, height(run.frames[2]) / 8, height(run.frames[4]) / 8], rel=1e-12)


def test_the_damping_that_doubles():
    rows = []
    for seed in range(3):
        for mu in (0.025, 0.05, 0.1, 0.2):
            for count in (20, 80):
                ratio = 2 - np.log(mu / (0.04 + 0.001 * seed)) / 3
                lost = count == 20 and mu < 0.04
                about = {"preset": "thesis", "seed": seed, "mu": mu, "substeps": count, "t": growth.END}
                rows.append(about | {"ratio": np.nan if lost else ratio, "status": OUT_OF_BOUNDS if lost else SUCCESS})
    made = pd.DataFrame(rows)
    found = growth.doubling(made).set_index("kind")
    assert found.loc["fine", "mu"] == pytest.approx(0.041)
    assert found.loc["as the preset", "mu"] == pytest.approx(0.041)  # on the line through those that were not lost
    ratios = growth.ratios(made).set_index(["substeps", "mu"])
    assert ratios.loc[(20, 0.025), "lost"] == 3
    assert np.isnan(ratios.loc[(20, 0.025), "ratio"])
    assert ratios.loc[(80, 0.1), "ratio"] == pytest.approx(2 - np.log(0.1 / 0.041) / 3, abs=1e-3)
    assert np.isnan(growth.doubling(made.assign(ratio=made["ratio"] - 1))["mu"]).all()


# Stability


def test_hessian_of_a_cell_is_that_of_its_energy(rng):
    state, network, step = tissue([[0, 3]], [[0.3, 8]], [[0, 0]]), layers(1, apical=[]), 1e-5
    along = rng.standard_normal(5)

    def moved(sign):
        names = zip(accuracy.UNKNOWNS, along, strict=True)
        place = {name: getattr(state, name) + sign * step * part for name, part in names}
        return energy(state._replace(**place), network, THESIS)

    second = (moved(1) - 2 * moved(0) + moved(-1)) / step**2
    assert along @ accuracy.own_hessians(state, THESIS)[0] @ along == pytest.approx(second, rel=1e-4)


def test_swing_is_the_period_two_part_of_the_substeps():
    state, network = cells(8, 1), layers(8)
    scale = 1 / 30
    h = THESIS._replace(dt=scale * THESIS.mu, substeps=1)
    path = [state]
    for _ in range(2):
        path.append(make_substeps(path[-1], network, h))
    x = [growing.nuclei(growing.Frame(0.0, one, network)) for one in path]
    expected = np.hypot(*(x[2] - 2 * x[1] + x[0])) / 4
    assert swing(Frozen(state, network, THESIS), scale) == pytest.approx(expected, abs=1e-9)


def test_maps_tell_jitter_from_loss():
    assert stability.mitotic_limit("thesis") == pytest.approx(2 / (30 * (1 + 1 / 49 + 1 / 7)))
    fine, coarse = (stability.grow("published", dt=dt, substeps=40.0) for dt in (0.05, 0.4))
    assert (fine["outcome"], coarse["outcome"]) == ("bounded", "inaccurate")
    assert fine["amplitude"] < 1e-4 < stability.SEEN < coarse["amplitude"]
    lost = stability.grow("thesis", mu=0.0125, substeps=20.0)
    assert np.isnan(lost["amplitude"])
    assert lost["outcome"] == "unstable"
    assert lost["status"] != SUCCESS
    assert lost["scale"] == pytest.approx(0.4)


def test_cells_are_lost_beyond_the_limit_that_is_drawn_only():
    table = shipped(stability.NAME)
    found = stability.losses(table)
    assert (found["mitosis"] < found["lost"]).all()
    drawn = stability.map_of(table).limits
    mine = drawn[drawn["method"] == "Thesis"]  # dt = substeps mu limit
    np.testing.assert_allclose(mine["x"] / mine["y"], 0.15 * stability.mitotic_limit("thesis"))


# DAHA and single steps

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


# Figures


def heights():
    made = substeps.accuracy(shipped("tissue_substeps"))
    return page.draw_substeps, (made,), 100 * made.loc[made["t"] == made["t"].max(), ["low", "high"]].dropna()


def dampings():
    table = shipped("tissue_daha")
    found = daha.distances(table)
    ends = found.loc[found["kind"] == "pbd", ["low", "high", "height_low", "height_high"]]
    return page.draw_damping, (found, daha.fitted(table)), 100 * ends


def needs():
    rows = shipped(study.NAME)
    rows = rows[rows["question"] == rows["question"].iloc[0]]
    return study.draw, (rows, "points", 100.0), 100 * rows[["low", "high"]].dropna()


@pytest.mark.parametrize("case", [heights, dampings, needs])
def test_intervals_are_drawn_from_end_to_end(case, tmp_path, monkeypatch):
    drawn = []
    monkeypatch.setattr(Figure, "savefig", lambda figure, file, **_: (drawn.append(figure), Path(file).touch()))
    draw, given, ends = case()
    draw(*given, tmp_path / "x.png")
    errors = [one for panel in drawn[0].axes for one in panel.containers if isinstance(one, ErrorbarContainer)]
    bars = np.array([bar for one in errors for lines in one[2] for bar in lines.get_segments() if len(bar)])
    along = np.ptp(bars, axis=1).argmax(axis=1)
    found = bars[np.arange(len(bars)), :, along]
    expected = ends.to_numpy().reshape(-1, 2)
    np.testing.assert_allclose(sorted(found.tolist()), sorted(expected.tolist()), atol=1e-12)
