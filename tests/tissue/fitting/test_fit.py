"""Fits: what the emulator and the posterior say where the answer is known, the design of runs, files and commands."""

import re
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from scipy.stats import norm, sobol_indices, uniform
from typer.testing import CliRunner

import tissue
from dincl.errors import InvalidProblem
from tests.executors import Here
from tissue.cli.app import app
from tissue.fitting.design import design, measure_runs, sobol_points
from tissue.fitting.emulator import emulate
from tissue.fitting.plan import Range, load_fit
from tissue.fitting.posterior import posterior
from tissue.fitting.results import FitResults

FILE = """
title = "Damping"
base = "published"
data = "data.csv"
points = 24
replicates = 4
seed = 2
[overrides.tissue]
cells = 20
[parameters]
"numerics.mu" = ["0.05 h", "0.4 h", "log"]
tissue.two_daughters = [0, 0.5]
"""
DATA = "measure,time_h,value,standard_error\nheight_um,3,40,1\nheight_um,6,41,1\ncells,6,24,1\n"


@pytest.fixture
def file(tmp_path):
    """A fit file beside its data."""
    (tmp_path / "data.csv").write_text(DATA)
    (tmp_path / "fit.toml").write_text(FILE)
    return tmp_path / "fit.toml"


# The emulator and the posterior, on a model that is known: y_0 = 2 u_0 + u_0^3, y_1 = 5 + u_1 u_0, y_2 the sum, ...


def model(u):
    """The means of the outputs."""
    return np.column_stack([2 * u[:, 0] + u[:, 0] ** 3, 5 + u[:, 0] * u[:, 1], u[:, 0] + u[:, 1], 0 * u[:, 0]])


def runs_of(u, replicates, seed=0, spread=0.2):
    """Runs about the means, whose noise grows with u_0, and is common to the outputs to a half."""
    rng, found = np.random.default_rng(seed), model(u)
    noise = rng.normal(size=(len(u), replicates, 4)) + rng.normal(size=(len(u), replicates, 1))
    noise[..., 3] = 0.0  # a number that never changes
    return found[:, None] + spread * np.exp(u[:, :1, None] / 2) * noise / np.sqrt(2)


U = 2 * np.random.default_rng(1).random((100, 2)) - 1


def test_the_emulator_finds_mean_spread_correlation_and_its_own_error():
    e, at = emulate(U, list(runs_of(U, 8))), np.array([[0.5, -0.4], [-0.8, 0.1]])
    assert e.mean.at(at)[:, :3] == pytest.approx(model(at)[:, :3], abs=0.1)
    assert e.deviations(at)[:, :3] == pytest.approx(0.2 * np.exp(at[:, :1] / 2) * np.ones(3), rel=0.15)
    assert e.correlation[:3, :3] == pytest.approx(0.5 + 0.5 * np.eye(3), abs=0.1)
    assert np.array_equal(e.correlation[3], [0, 0, 0, 1])
    assert 0.9 < e.calibration() <= 1.0
    for tissues in (1, 10):  # the covariance of the mean of tissues, and a little for the emulator
        assert np.all(np.diagonal(e.covariance(at, tissues)[0])[:3] > e.deviations(at)[0, :3] ** 2 / tissues)
    few = emulate(U[:20], list(runs_of(U[:20], 2)))
    assert np.all(np.diagonal(few.covariance(at, 10**6)[0] - e.covariance(at, 10**6)[0])[:3] > 0)
    # What no polynomial has: at each point the first output is off by 1 or -1, the second one by the opposite.
    off = np.random.default_rng(2).choice([-1.0, 1.0], (100, 1, 1)) * [1.0, -1.0, 0.0, 0.0]
    rough = emulate(U, list(runs_of(U, 8, spread=0.02) + off))
    assert rough.lack[:2, :2] == pytest.approx(np.array([[1.0, -1.0], [-1.0, 1.0]]), rel=0.2)
    assert np.abs(rough.lack[2:]).max() < 0.01


def test_too_few_points_are_refused():
    with pytest.raises(InvalidProblem, match="11 points have two sound runs or more: must be at least 12"):
        emulate(U[:12], [*runs_of(U[:11], 4), np.zeros((1, 4))])


def test_indices_are_those_that_scipy_samples():
    e = emulate(U, list(runs_of(U, 8, spread=0.01)))
    found = e.sensitivity()
    theirs = sobol_indices(func=lambda u: model(u.T).T[:3], n=4096, dists=[uniform(-1, 2)] * 2, rng=3)
    assert found[:, :3, 0, 0] == pytest.approx(theirs.first_order.T, abs=0.02)
    assert found[:, :3, 1, 0] == pytest.approx(theirs.total_order.T, abs=0.02)
    assert np.all(found[..., 1] <= found[..., 0])
    assert np.all(found[..., 0] <= found[..., 2])
    assert not found[:, 3].any()
    never = emulate(U, [np.full((8, 1), 40.1 + 1e-14 * k) for k in range(100)])  # but for rounding
    assert not never.sensitivity().any()
    rough = emulate(U[:30], list(runs_of(U[:30], 2, spread=1.0))).sensitivity()
    assert (rough[:, :3, 0, 2] - rough[:, :3, 0, 1]).min() > 5 * (found[:, :3, 0, 2] - found[:, :3, 0, 1]).max()


@pytest.mark.parametrize("d", [1, 4, 6])
def test_the_posterior_of_a_linear_model_is_normal(d):
    """y = u with errors s: mean z, standard deviation sqrt(s^2 + that of runs), cut at the ends of the ranges."""
    u = 2 * sobol_like(d, 128) - 1
    rng = np.random.default_rng(0)
    e = emulate(u, list(u[:, None] + 0.03 * rng.normal(size=(128, 8, d))))
    z, s = np.linspace(-0.3, 0.4, d), 0.05
    found = posterior(e, z, np.full(d, s), 1)
    sd = np.hypot(s, 0.03)
    assert found.quantiles() == pytest.approx(norm.ppf([0.025, 0.5, 0.975], z[:, None], sd), abs=0.015)
    assert found.correlations() == pytest.approx(np.eye(d), abs=0.1)
    assert found.effective > 200
    assert found.drawn(2000).std(axis=0) == pytest.approx(sd, rel=0.1)
    cut = posterior(e, np.full(d, 1.5), np.full(d, 0.5), 1)
    assert np.all(cut.quantiles()[:, 2] <= 1)
    wide = posterior(e, z, np.full(d, 100.0), 1)  # of no use: the ranges remain
    assert wide.quantiles() == pytest.approx(np.tile([-0.95, 0.0, 0.95], (d, 1)), abs=0.02)


def sobol_like(d, n):
    """Points in [0, 1]^d."""
    return np.random.default_rng(4).random((n, d))


# Files


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ("seed = 2", "", "seed is missing"),
        ("points = 24", "points = 4", "points = 4: must be a whole number from 8"),
        ("points = 24", "points = 1048576", "points = 1048576: must be a whole number from 8 to 16384"),
        ('"0.05 h", "0.4 h"', '"0.4 h", "0.05 h"', "the lower value first"),
        ("[0, 0.5]", '[0, 0.5, "log"]', '> 0 with "log"'),
        ("[0, 0.5]", "[0, 1.5]", "tissue.two_daughters = 1.5: must be a number from 0 to 1"),
        ("[0, 0.5]", "0.5", 'parameters."tissue.two_daughters" = 0.5: must be a range'),
        ("tissue.two_daughters", "tissue.two_sons", "unknown key"),
        ('"numerics.mu" = ["0.05 h"', '"numerics.dt" = ["0.05 h"', "all runs of a design share this one"),
        ("data.csv", "no.csv", "no.csv: must be a readable CSV file"),
        ("cells = 20", "cells = 0", "tissue.cells = 0"),
        ("cells = 20", 'cells = 20\n[overrides.numerics]\nt_end = "3 h"', "overrides.numerics.t_end = '3 h': must be"),
        ("cells = 20", 'cells = 20\n[overrides.numerics]\nkeep = "3 h"', "overrides.numerics.keep = '3 h': must be"),
    ],
)
def test_a_bad_fit_file_is_refused(file, old, new, says):
    file.write_text(FILE.replace(old, new))
    with pytest.raises(InvalidProblem, match=re.escape(says)) as refused:
        load_fit(file)
    assert str(refused.value).startswith(str(file))


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ("value,", "values,", "has no column 'value'"),
        ("cells,6", "cell,6", "line 4: measure = 'cell': must be one of cells, divisions, height_um"),
        ("6,41,1", "6,41,0", "line 3: standard_error = 0"),
        ("6,41,1", "6,n. m.,1", "line 3: value = 'n. m.': must be a number"),
        ("6,41,1", "6,41,1e200", "line 3: standard_error = 1e+200: must be a number > 0 up to 1e+50"),
        ("cells,6", "below,6", "emt.cells = 0: must be more, since 'below' is a share of the EMT cells"),
        ("3,40,1", "3,,1", "line 2: value = nan"),
        ("height_um,6", "height_um,3", "line 3: must be the only one of this measure and time"),
        ("height_um,3", "height_um,-1", "line 2: time_h = -1"),
        ("height_um,3", "height_um,3.0001", "numerics.keep"),
    ],
)
def test_bad_data_are_refused(file, old, new, says):
    (file.parent / "data.csv").write_text(DATA.replace(old, new))
    with pytest.raises(InvalidProblem, match=re.escape(says)):
        load_fit(file)


def test_values_at_parts_of_a_range_and_points_that_begin_alike(file):
    plan = load_fit(file)
    mu, p = plan.ranges
    assert (mu.value(0.5), p.value(0.5)) == (pytest.approx(np.sqrt(0.05 * 0.4)), 0.25)
    assert (mu.label, mu.in_file(1.0), Range("tissue.cells", 10, 20, whole=True).in_file(0.33)) == (
        "numerics.mu [h]",
        "0.4 h",
        13,
    )
    counts, parts = Range("tissue.cells", 10, 20, whole=True), np.array([0.0, 0.33, 1.0])
    assert counts.of_runs(parts) == pytest.approx([0.0, 0.3, 1.0])
    logs = replace(counts, log=True)
    assert logs.value(logs.of_runs(parts)) == pytest.approx([10, 13, 20])
    assert plan.outputs == ["height_um_3h", "height_um_6h", "cells_6h"]
    assert plan.base.t_end == 6.0
    assert plan.parameters(np.array([0.0, 1.0])).numerics.mu.value == 0.05
    assert np.array_equal(sobol_points(plan, 12), sobol_points(plan, 40)[:12])


# The design and what comes of it


@pytest.mark.slow
def test_runs_are_those_of_simulate_and_measures_those_of_its_summary(file):
    """Of each run beside others; shares of EMT cells are those of its table."""
    text = FILE.replace("[overrides.tissue]", '[overrides.emt]\ncells = 5\na = "1 h"\nb = "1 h"\n[overrides.tissue]')
    file.write_text(text)
    (file.parent / "data.csv").write_text(DATA + "basal,6,0.2,0.1\nbelow,6,0.2,0.1\nmean_y_ab,0,0.5,0.1\n")
    plan = load_fit(file)
    given = [plan.parameters(u) for u in sobol_points(plan, 3)]
    rows = measure_runs(given, [5, 6, 7], plan)
    for row, parameters, seed in zip(rows, given, (5, 6, 7), strict=True):
        run = tissue.simulate(parameters, seed)
        table = run.summary().set_index("time_h")
        assert row["height_um_3h"] == table["height_um"][3.0]
        assert (row["cells_6h"], row["mean_y_ab_0h"]) == (table["cells"][6.0], table["mean_y_ab"][0.0])
        final = run.table().query("time_h == 6 and emt >= 0")
        assert row["basal_6h"] == (final["y_ab"] < 0).mean()


@pytest.mark.slow
def test_a_design_goes_on_where_it_was_stopped_and_with_more_points(file, tmp_path):
    plan, out = replace(load_fit(file), points=14), tmp_path / "out"
    first = tissue.fit(plan, out, Here())
    stored = (out / "design.parquet").stat().st_mtime_ns
    assert len(first.runs) == 14 * 4
    tissue.fit(plan, out, Here())
    assert (out / "design.parquet").stat().st_mtime_ns == stored
    more = tissue.fit(replace(plan, points=16), out, Here())
    pd.testing.assert_frame_equal(more.runs.iloc[: 14 * 4], first.runs)
    alone = design(replace(plan, points=16)).rows()
    pd.testing.assert_frame_equal(more.runs, alone[more.runs.columns], check_dtype=False)
    with pytest.raises(InvalidProblem, match=r"new, empty or the folder of this fit; it holds data.csv, fit.toml"):
        tissue.fit(plan, tmp_path, Here())
    with pytest.raises(InvalidProblem, match=r"data.csv: must be a folder that can be written to"):
        tissue.fit(plan, tmp_path / "data.csv", Here())


@pytest.fixture
def stand_in(file):
    """Results whose runs are those of the model above: mu is u_0, two_daughters u_1; data where u = (0.3, -0.2)."""
    rows = "".join(f"{name},{t},0,0.1\n" for name, t in (("height_um", 3), ("height_um", 6), ("cells", 6)))
    (file.parent / "data.csv").write_text(f"measure,time_h,value,standard_error\n{rows}")
    plan = replace(load_fit(file), points=100, replicates=8)
    u = 2 * sobol_points(plan, 100) - 1
    runs = runs_of(u, 8, spread=0.1)
    table = pd.DataFrame(runs[..., :3].reshape(-1, 3), columns=plan.outputs)
    table = table.assign(point=np.repeat(np.arange(100), 8), status="SUCCESS")
    truth = model(np.array([[0.3, -0.2]]))[0, :3]
    return FitResults(plan, table).given(plan.data.assign(value=truth))


def test_what_is_not_identified_is_said_first(stand_in):
    low, high = stand_in.intervals()[["low", "high"]].to_numpy().T
    values = [one.value(part) for one, part in zip(stand_in.fit.ranges, (0.65, 0.4), strict=True)]
    assert np.all((low < values) & (values < high))
    assert stand_in.intervals()["identified"].all()
    assert stand_in.remarks() == []
    assert stand_in.p_value() > 0.5
    assert stand_in.predicted()["off"].abs().max() < 1
    data = stand_in.fit.data
    alone = stand_in.given(data[:1])
    assert alone.intervals()["identified"].tolist() == [True, False]
    assert alone.remarks()[0].startswith("tissue.two_daughters is not identified: its 95 % interval covers 9")
    assert alone._repr_html_().startswith(f"<ul><li>{alone.remarks()[0]}</li>")
    assert "<th>0</th>" not in alone._repr_html_()  # numbers of rows say nothing
    assert np.isnan(stand_in.given(data[2:]).p_value()) or stand_in.given(data[2:]).remarks()
    together = stand_in.given(data[2:].assign(standard_error=0.01))  # the sum alone
    assert any("are identified together only: their correlation is -0.9" in line for line in together.remarks())


def test_data_that_do_not_fit_and_weak_designs_are_noticed(stand_in):
    data = stand_in.fit.data
    off = stand_in.given(data.assign(value=data["value"] + [0, 0, 3.0]))
    assert off.p_value() < 1e-3
    assert any(line.startswith("The model does not fit the data (p = ") for line in off.remarks())
    end = stand_in.given(data.assign(value=model(np.array([[0.99, 0.0]]))[0, :3]))
    assert any("numerics.mu: its interval ends where the range ends" in line for line in end.remarks())
    failed = stand_in.runs.assign(status=np.where(stand_in.runs["point"] % 4 == 0, "FOLDED", "SUCCESS"))
    assert "25 % of the runs failed" in FitResults(stand_in.fit, failed).remarks()[-1]
    gone = np.repeat(sobol_points(stand_in.fit, 100)[:, 0] > 0.5, 8)  # mu of the data, and all above
    beyond = FitResults(stand_in.fit, stand_in.runs.assign(status=np.where(gone, "FOLDED", "SUCCESS")))
    assert "are left out, 100 % of those next to the posterior" in beyond.remarks()[-1]
    none = FitResults(stand_in.fit, stand_in.runs.assign(cells_6h=np.nan))
    with pytest.raises(InvalidProblem, match="of 800 runs 0 have cells_6h"):
        none.intervals()
    far = stand_in.given(data.assign(value=1e20))  # of densities so small that a digit is more than their differences
    assert any(line.startswith("The model does not fit") for line in far.remarks())
    with pytest.raises(InvalidProblem, match="height_um_5h was not kept of the runs"):
        stand_in.given(data.assign(time_h=5.0)[:1])


def test_means_of_many_tissues_say_more(stand_in):
    width = [row.high - row.low for row in stand_in.intervals().itertuples()]
    many = FitResults(replace(stand_in.fit, tissues=20), stand_in.runs)
    assert [row.high - row.low for row in many.intervals().itertuples()] < width


@pytest.mark.slow
def test_the_commands_write_a_page_a_sample_and_indices(file, tmp_path):
    out = tmp_path / "out"
    done = CliRunner().invoke(app, ["fit", str(file), "--out", str(out)])
    assert done.exit_code == 0, done.output
    assert "tissue.two_daughters is not identified" in done.output
    page = (out / "page.html").read_text()
    assert page.index("tissue.two_daughters is not identified") < page.index("Medians and 95 % intervals")
    for part in (
        "Pairs",
        "The model over the data",
        "Which parameter matters",
        "title = &#34;Damping&#34;",
        "data:image/webp",
    ):
        assert part in page
    assert list(pd.read_csv(out / "sample.csv")) == ["numerics.mu", "tissue.two_daughters"]
    (file.parent / "data.csv").write_text("measure,time_h\nheight_um,3\nheight_um,6\ncells,6\n")
    done = CliRunner().invoke(app, ["sensitivity", str(file), "--out", str(out)])
    assert done.exit_code == 0, done.output
    table = pd.read_csv(out / "sensitivity.csv")
    assert len(table) == 6
    assert not (out / "superseded").exists()  # the runs were those of the fit
    done = CliRunner().invoke(app, ["fit", str(file), "--out", str(out)])
    assert done.exit_code == 2
    assert "has no column 'value'" in done.output
