"""The studies of the tissue: substeps, growth and stability measure what they say, seen by other means."""

import numpy as np
import pandas as pd
import pytest
from scipy.stats import t as student

from tests.tissue.states import THESIS, cells, layers, tissue
from tests.twins.tissue import make_substeps
from tests.verification.thesis.simulated import simulated
from tissue.frames.observables import height
from tissue.model.energy import energy
from verification.site.store import shipped
from verification.thesis.chapter3 import growing, growth, linear, stability, substeps
from verification.thesis.chapter3.frozen import Frozen, swing
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
        names = zip(linear.UNKNOWNS, along, strict=True)
        place = {name: getattr(state, name) + sign * step * part for name, part in names}
        return energy(state._replace(**place), network, THESIS)

    second = (moved(1) - 2 * moved(0) + moved(-1)) / step**2
    assert along @ linear.own_hessians(state, THESIS)[0] @ along == pytest.approx(second, rel=1e-4)


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
