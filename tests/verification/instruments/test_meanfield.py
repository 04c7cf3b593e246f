"""The solvers of meanfield in the instruments, and W1 rates: streams, the fit and its interval, the flow, refusals."""

import pickle

import numpy as np
import pandas as pd
import pytest
from scipy.integrate import quad

import meanfield as mf
import verification as v
from dincl import InvalidProblem
from verification.instruments.rates import (
    IID,
    PAIR,
    QUANTILES,
    W1Runs,
    fitted_power,
    mean_of,
    slope,
    summarised,
    weighted_line,
)

T = [0.5, 1.0]
LAW = mf.Density.bump(1.0, 0.6)
SQUARE = mf.Density.uniform([0.0, 0.0], [1.0, 1.0])
FIBRE = mf.StraightFibre(m=1.0, k0=1.0, y_rest=1.5, k1=0.5)
WAVY = mf.WavyFibre(m=1.0, k0=1.0, y_rest=1.5, k1=0.5)
START = mf.State(X=LAW.sample(np.random.default_rng(1), 4), y=[1.0], v=[0.5])
PARTICLES, DENSITY = v.particle_methods(), v.density_methods()
STRAIGHT = v.DensityProblem(FIBRE, LAW, [1.0], [0.5])


def limit(t):
    return mf.solve_moments(FIBRE, mf.Moments(*LAW.moments()), [1.0], [0.5], t, 1e-13).y


# Methods


@pytest.mark.parametrize("name", PARTICLES)
def test_methods_of_particles_follow_their_tolerance(name):
    found = PARTICLES[name].run(v.ParticleProblem(FIBRE, START), 1e-9, T)
    np.testing.assert_allclose(found, mf.solve_ode(FIBRE, START, T, 1e-12).y, atol=1e-7)
    problem, method = pickle.loads(pickle.dumps((v.ParticleProblem(WAVY, START), PARTICLES[name])))
    same = PARTICLES[name].run(v.ParticleProblem(WAVY, START), 1e-6, T)
    np.testing.assert_array_equal(method.run(problem, 1e-6, T), same)


@pytest.mark.slow_with("ode")
@pytest.mark.parametrize("name", DENSITY)
def test_every_method_finds_the_limit(name):
    """N quantiles miss the second moment by some 1/(30 N); the grid has an error of second order in 1/cells."""
    settings = {"tol": 1e-9, "1/N": 1 / 32, "1/cells": 1 / 32}
    errors = {"tol": 1e-7, "1/N": 1e-3, "1/cells": 3e-3}
    method = DENSITY[name]
    found = method.run(STRAIGHT, settings[method.setting], T)
    assert found.shape == (2, 1)
    assert np.abs(found - limit(T)).max() < errors[method.setting]


@pytest.mark.slow
def test_all_levels_of_a_model_stand_on_one_chart():
    settings = {"tol": [1e-3, 1e-6], "1/N": [1 / 4, 1 / 128], "1/cells": [1 / 16, 1 / 32]}
    methods = [DENSITY[name] for name in ("ode", "moments", "pde")]
    chart = v.work_precision(STRAIGHT, methods, settings, T, limit, v.CpuSeconds(5.0), errors=("largest",))
    assert (chart.table["status"] == "SUCCESS").all()
    finest = chart.table.groupby("method")["largest"].min()
    assert finest["Moments"] < 1e-6 < finest["ODE (DOP853)"] < 1e-3
    assert len(chart.plot().lines) >= 3


def test_what_a_model_does_not_allow_is_refused():
    problem = v.DensityProblem(WAVY, LAW, [1.0], [0.5])
    study = v.order_study(problem, [DENSITY["moments"]], [10.0**-k for k in range(3, 8)], T, limit(T))
    assert study.table["status"].iloc[0] == "REFUSED"
    assert "do not close" in study.table["detail"].iloc[0]
    with pytest.raises(InvalidProblem, match=r"must be a ParticleProblem\(model, start\)"):
        PARTICLES["dae"].run(STRAIGHT, 1e-6, T)
    with pytest.raises(InvalidProblem, match="must be a DensityProblem"):
        DENSITY["pde"].run(v.ParticleProblem(FIBRE, START), 1e-2, T)


# Rates


@pytest.fixture(scope="module")
def flow():
    sizes, repeats, seed = np.array([8, 16, 32, 64]), np.int64(40), np.int32(3)  # as NumPy's arrays hold them
    return v.w1_rates(FIBRE, LAW, sizes, repeats, seed, t=[1.0, 2.0], y0=[1.0], v0=[0.5], tol=1e-8)


def made_up(power, scatter, repeats=40):
    rng = np.random.default_rng(5)
    rows = [
        {"N": n, "repeat": k, "t": 0.0, "w1": 3.0 * n**power * np.exp(scatter * rng.standard_normal()), "error_y": 0.0}
        for n in (10, 100, 1000, 10_000)
        for k in range(repeats)
    ]
    return pd.DataFrame(rows)


@pytest.mark.slow
def test_values_are_those_of_their_streams_and_fall_with_a_root(flow, tmp_path):
    rows = flow.table[(flow.table["N"] == 16) & (flow.table["repeat"] == 7)].set_index("t")
    X = LAW.sample(np.random.default_rng((3, 16, 7)), 16)
    assert rows.loc[0.0, "w1"] == mf.w1(X, LAW)
    motion = mf.solve_ode(FIBRE, mf.State(X=X, y=[1.0], v=[0.5]), [1.0, 2.0], 1e-8)
    true = limit([1.0, 2.0])
    np.testing.assert_allclose(rows["error_y"].iloc[1:], np.abs(motion.y - true)[:, 0], atol=1e-7)
    # X/y is constant, so that the density stretches like y.
    stretched = mf.Density.bump(true[1, 0], 0.6 * true[1, 0])
    assert rows.loc[2.0, "w1"] == pytest.approx(mf.w1(motion.X[1], stretched), rel=1e-6)
    assert flow.start == IID
    assert list(flow.fit["quantity"]) == ["w1", "w1", "w1", "error_y", "error_y"]
    assert ((flow.fit["low"] < -0.4) & (flow.fit["high"] > -0.6) & (flow.fit["low"] < flow.fit["slope"])).all()
    of_w1 = flow.fit[flow.fit["quantity"] == "w1"]
    assert (of_w1["high"] - of_w1["low"] < 0.6).all()  # by the scatter of four sizes about a line
    assert repr(flow).startswith("W1Rates, iid against density\n  w1 at t = 0: N^-0.")
    axes = flow.plot()
    assert axes.get_xscale() == axes.get_yscale() == "log"
    assert len(axes.get_legend().get_texts()) == len(flow.fit)
    assert "Powers of N" in flow._repr_html_()
    pd.testing.assert_frame_equal(pd.read_parquet(flow.save(tmp_path) / "w1_rates.parquet"), flow.table)
    pd.testing.assert_frame_equal(pickle.loads(pickle.dumps(flow)).fit, flow.fit)


@pytest.mark.slow
def test_the_seed_decides_and_sizes_do_not_disturb_each_other():
    one = v.w1_rates(None, LAW, [4, 8, 16], 3, 1).table
    two = v.w1_rates(None, LAW, [4, 8, 16, 32], [3, 4, 2, 5], 1).table
    same = one.merge(two, on=["N", "repeat", "t"], suffixes=("", "_two"))
    kept = same[same["repeat"] < 2]
    assert len(kept) == 6
    np.testing.assert_array_equal(kept["w1"], kept["w1_two"])
    other = v.w1_rates(None, LAW, [4, 8, 16], 3, 2).table
    assert (one["w1"] != other["w1"]).all()


@pytest.mark.slow
def test_pairs_of_samples_in_the_plane_and_quantiles_on_a_line_are_compared():
    rates = v.w1_rates(None, SQUARE, [4, 8, 16], 2, 1)
    assert rates.start == PAIR
    X, other = W1Runs(None, SQUARE, [4, 8, 16], 2, 1).draw(8, np.random.default_rng((1, 8, 1)))
    found = rates.table[(rates.table["N"] == 8) & (rates.table["repeat"] == 1)]["w1"].iloc[0]
    assert found == mf.w1(X, other)
    model, law = mf.TissueElement(m=1.0, k0=1.0, y_rest=(1.2, 1.0, 0.1), k1=0.5), mf.Density.bump([0.6, 0.4], 0.4)
    moved = v.w1_rates(model, law, [4, 8, 16], 2, 0, t=[0.5], y0=[1.0, 1.1, 0.1], v0=[0.3, -0.2, 0.1], tol=1e-4)
    assert (moved.table["w1"] > 0).all()
    assert set(moved.fit["t"]) == {0.0, 0.5}
    rates = v.w1_rates(None, mf.Density.uniform(0.0, 1.0), [10, 100, 1000], 1, 0, quantiles=True)
    assert rates.start == QUANTILES
    np.testing.assert_allclose(rates.table["w1"], [1 / (4 * n) for n in (10, 100, 1000)], rtol=1e-12)
    (fit,) = rates.fit.to_dict("records")
    assert fit["slope"] == pytest.approx(-1, abs=1e-10)
    assert np.isnan(fit["misfit"])


@pytest.mark.slow
def test_fit_finds_power_constant_and_an_interval_that_covers():
    (row,) = summarised(made_up(-0.5, 0.3), random=True)[1].to_dict("records")
    assert row["low"] < -0.5 < row["high"]
    # Errors of 0.3 / sqrt(40) at log N = 2.3, ..., 9.2 alone make 0.036; the scatter of four means adds to it.
    assert 0.03 < row["high"] - row["low"] < 0.12
    assert row["constant"] == pytest.approx(3 * np.exp(0.3**2 / 2), rel=0.15)
    wide = summarised(made_up(-0.5, 0.3, repeats=4), random=True)[1].iloc[0]
    assert wide["high"] - wide["low"] > 0.09
    rng, inside = np.random.default_rng(8), 0
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


@pytest.mark.slow
def test_a_density_is_pushed_forward_in_one_dimension_and_keeps_its_mass():
    model, start = mf.WavyFibre(m=0.5, k0=1.0, y_rest=1.5, k1=0.5), np.array([1.0])
    flow = mf.solve_characteristics(model, LAW, start, [0.5], [1.0], 1e-10)
    law, x = mf.push_forward(model, LAW, start, flow.y[0]), flow.X[0, :, 0]
    for f in (np.ones_like, np.cos, np.square):
        ends = (x.min(), x.max())
        expected, _ = quad(lambda z, f=f: f(z) * law.density([[z]])[0], ends[0] - 0.1, ends[1] + 0.1, points=ends)
        assert flow.weights @ f(x) == pytest.approx(expected, abs=1e-6)
    assert pickle.loads(pickle.dumps(law)).density([[1.2]]) == law.density([[1.2]])
    with pytest.raises(InvalidProblem, match="nx = 2: must be 1"):
        mf.push_forward(model, SQUARE, start, flow.y[0])
