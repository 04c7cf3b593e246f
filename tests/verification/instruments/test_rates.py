"""W1 rates of an own density and model: streams, the fit and its interval, the flow, the picture, what is refused."""

from __future__ import annotations

import pickle

import numpy as np
import pandas as pd
import pytest
from scipy.integrate import quad

import meanfield as mf
import verification as v
from dincl import InvalidProblem
from verification.instruments.lines import slope, weighted_line
from verification.instruments.rates import IID, PAIR, QUANTILES, draw, fitted_power, mean_of, summarised

pytestmark = pytest.mark.slow

LAW = mf.Density.bump(1.0, 0.6)
SQUARE = mf.Density.uniform([0.0, 0.0], [1.0, 1.0])
FIBRE = mf.StraightFibre(m=1.0, k0=1.0, y_rest=1.5, k1=0.5)


@pytest.fixture(scope="module")
def flow() -> v.W1Rates:
    sizes, repeats, seed = np.array([8, 16, 32, 64]), np.int64(40), np.int32(3)  # as NumPy's arrays hold them
    return v.w1_rates(FIBRE, LAW, sizes, repeats, seed, t=[1.0, 2.0], y0=[1.0], v0=[0.5], tol=1e-8)


def made_up(power: float, scatter: float, repeats: int = 40) -> pd.DataFrame:
    rng = np.random.default_rng(5)
    rows = [
        {"N": n, "repeat": k, "t": 0.0, "w1": 3.0 * n**power * np.exp(scatter * rng.standard_normal()), "error_y": 0.0}
        for n in (10, 100, 1000, 10_000)
        for k in range(repeats)
    ]
    return pd.DataFrame(rows)


def test_values_are_those_of_their_streams(flow):
    rows = flow.table[(flow.table["N"] == 16) & (flow.table["repeat"] == 7)].set_index("t")
    X = LAW.sample(np.random.default_rng((3, 16, 7)), 16)
    assert rows.loc[0.0, "w1"] == mf.w1(X, LAW)
    motion = mf.solve_ode(FIBRE, mf.State(X=X, y=[1.0], v=[0.5]), [1.0, 2.0], 1e-8)
    second = float(LAW.moments()[1][0, 0])  # Example 5.2 depends on the second moment alone
    true = mf.solve_moments(FIBRE, mf.Moments(LAW.moments()[0], np.array([[second]])), [1.0], [0.5], [1.0, 2.0], 1e-11)
    np.testing.assert_allclose(rows["error_y"].iloc[1:], np.abs(motion.y - true.y)[:, 0], atol=1e-7)
    # X/y is constant, so that the density stretches like y.
    assert rows.loc[2.0, "w1"] == pytest.approx(mf.w1(motion.X[1], _stretched(true.y[1, 0])), rel=1e-6)


def _stretched(y: float) -> mf.Density:
    return mf.Density.bump(y, 0.6 * y)


def test_rates_of_random_starts_are_one_half_within_their_intervals(flow):
    assert flow.start == IID
    assert list(flow.fit["quantity"]) == ["w1", "w1", "w1", "error_y", "error_y"]
    assert ((flow.fit["low"] < -0.4) & (flow.fit["high"] > -0.6)).all()
    of_w1 = flow.fit[flow.fit["quantity"] == "w1"]
    assert (of_w1["high"] - of_w1["low"] < 0.6).all()  # by the scatter of four sizes about a line
    assert (flow.fit["low"] < flow.fit["slope"]).all()


def test_the_seed_decides_and_sizes_do_not_disturb_each_other():
    one = v.w1_rates(None, LAW, [4, 8, 16], 3, 1).table
    two = v.w1_rates(None, LAW, [4, 8, 16, 32], [3, 4, 2, 5], 1).table
    same = one.merge(two, on=["N", "repeat", "t"], suffixes=("", "_two"))
    kept = same[same["repeat"] < 2]
    assert len(kept) == 6
    np.testing.assert_array_equal(kept["w1"], kept["w1_two"])
    other = v.w1_rates(None, LAW, [4, 8, 16], 3, 2).table
    assert (one["w1"] != other["w1"]).all()


def test_pairs_of_samples_in_the_plane_are_compared():
    rates = v.w1_rates(None, SQUARE, [4, 8, 16], 2, 1)
    assert rates.start == PAIR
    X, other = draw(SQUARE, PAIR, 8, np.random.default_rng((1, 8, 1)))
    assert other is not None
    found = rates.table[(rates.table["N"] == 8) & (rates.table["repeat"] == 1)]["w1"].iloc[0]
    assert found == mf.w1(X, other)


def test_quantiles_converge_with_power_one_and_have_no_misfit():
    uniform = mf.Density.uniform(0.0, 1.0)
    rates = v.w1_rates(None, uniform, [10, 100, 1000], 1, 0, quantiles=True)
    assert rates.start == QUANTILES
    np.testing.assert_allclose(rates.table["w1"], [1 / (4 * n) for n in (10, 100, 1000)], rtol=1e-12)
    (fit,) = rates.fit.to_dict("records")
    assert fit["slope"] == pytest.approx(-1, abs=1e-10)
    assert np.isnan(fit["misfit"])


def test_densities_in_the_plane_go_through_the_flow_in_pairs():
    model = mf.TissueElement(m=1.0, k0=1.0, y_rest=(1.2, 1.0, 0.1), k1=0.5)
    law = mf.Density.bump([0.6, 0.4], 0.4)
    rates = v.w1_rates(model, law, [4, 8, 16], 2, 0, t=[0.5], y0=[1.0, 1.1, 0.1], v0=[0.3, -0.2, 0.1], tol=1e-4)
    assert (rates.table["w1"] > 0).all()
    assert set(rates.fit["t"]) == {0.0, 0.5}


def test_fit_finds_power_constant_and_honest_interval():
    _, fit = summarised(made_up(-0.5, 0.3), random=True)
    (row,) = fit.to_dict("records")
    assert row["low"] < -0.5 < row["high"]
    # Errors of 0.3 / sqrt(40) at log N = 2.3, ..., 9.2 alone make 0.036; the scatter of four means adds to it.
    assert 0.03 < row["high"] - row["low"] < 0.12
    assert row["constant"] == pytest.approx(3 * np.exp(0.3**2 / 2), rel=0.15)
    wide = summarised(made_up(-0.5, 0.3, repeats=4), random=True)[1].iloc[0]
    assert wide["high"] - wide["low"] > 0.09


def test_interval_covers_the_truth_in_most_of_many_studies():
    rng = np.random.default_rng(8)
    inside = 0
    for _ in range(200):
        groups = [
            {"N": n} | mean_of(pd.Series(n**-0.5 * np.exp(0.4 * rng.standard_normal(30))), random=True)
            for n in (10, 30, 100, 300, 1000)
        ]
        row = fitted_power(pd.DataFrame(groups))
        inside += row["low"] <= -0.5 <= row["high"]
    assert inside >= 185  # 95 % of 200 are 190


def test_weighted_line_with_equal_errors_is_the_plain_one():
    x = np.array([0.0, 1.0, 2.0, 4.0])
    y = 2 * x + [0.1, -0.2, 0.1, 0.05]
    plain, weighted = slope(x, y), weighted_line(x, y, np.zeros(4))
    np.testing.assert_allclose(weighted.slope, plain, rtol=1e-12)
    assert weighted.at_zero == pytest.approx(np.polynomial.Polynomial.fit(x, y, 1).convert().coef[0])
    small = weighted_line(x, y, np.full(4, 1e-3))
    np.testing.assert_allclose(small.slope, plain, rtol=1e-12)  # the scatter decides
    large = weighted_line(x, y, np.full(4, 10.0))
    assert large.slope.high - large.slope.low > 10 * (plain.high - plain.low)  # the errors do


def test_result_shows_itself(flow, tmp_path):
    text = repr(flow)
    assert text.startswith("W1Rates, iid against density\n  w1 at t = 0: N^-0.")
    axes = flow.plot()
    assert axes.get_xscale() == axes.get_yscale() == "log"
    assert len(axes.get_legend().get_texts()) == len(flow.fit)
    assert "Powers of N" in flow._repr_html_()
    folder = flow.save(tmp_path)
    pd.testing.assert_frame_equal(pd.read_parquet(folder / "w1_rates.parquet"), flow.table)
    assert (folder / "w1_rates.png").read_bytes()[:4] == b"\x89PNG"
    again = pickle.loads(pickle.dumps(flow))
    pd.testing.assert_frame_equal(again.fit, flow.fit)


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"sizes": [4, 8]}, "sizes = .*at least 3, increasing"),
        ({"sizes": [8, 4, 16]}, "sizes = .*at least 3, increasing"),
        ({"repeats": [2, 2]}, "repeats = .*one for each of 3"),
        ({"repeats": 1}, "repeats = 1: must be an integer >= 2"),
        ({"quantiles": True}, "repeats = 3: must be an integer from 1 to 1"),
        ({"density": SQUARE, "quantiles": True, "repeats": 1}, "quantiles = True in 2 dimensions: must be False"),
        ({"seed": -1}, "seed = -1"),
        ({"t": [1.0]}, "model = None with t"),
        ({"model": FIBRE}, "t, y0, v0, tol left out"),
        ({"model": FIBRE, "t": [0.0, 1.0], "y0": [1.0], "v0": [0.5], "tol": 1e-6}, "t = .*must be > 0"),
        ({"model": FIBRE, "t": [1.0], "y0": [1.0], "v0": [0.5], "tol": 2.0}, "tol = 2"),
    ],
)
def test_bad_input(changed, message):
    given = {"model": None, "density": LAW, "sizes": [4, 8, 16], "repeats": 3, "seed": 0} | changed
    with pytest.raises(InvalidProblem, match=message):
        v.w1_rates(**given)


def test_a_density_is_pushed_forward_in_one_dimension_and_keeps_its_mass():
    model = mf.WavyFibre(m=0.5, k0=1.0, y_rest=1.5, k1=0.5)
    start = np.array([1.0])
    flow = mf.solve_characteristics(model, LAW, start, [0.5], [1.0], 1e-10)
    law = mf.push_forward(model, LAW, start, flow.y[0])
    x = flow.X[0, :, 0]
    for f in (np.ones_like, np.cos, np.square):
        expected, _ = quad(
            lambda z, f=f: f(z) * law.density([[z]])[0], x.min() - 0.1, x.max() + 0.1, points=[x.min(), x.max()]
        )
        assert flow.weights @ f(x) == pytest.approx(expected, abs=1e-6)
    assert pickle.loads(pickle.dumps(law)).density([[1.2]]) == law.density([[1.2]])
    with pytest.raises(InvalidProblem, match="nx = 2: must be 1"):
        mf.push_forward(model, SQUARE, start, flow.y[0])
