"""Variance-based sensitivity: indices of a function where they are known, noise that is taken out, plans as studies."""

import math
import tomllib

import numpy as np
import pytest

from dincl.errors import InvalidProblem
from tissue.files.parameters import preset
from tissue.statistics.ratios import Ratio
from tissue.study.sensitivity import analyse, indices, plan_sensitivity, point_name, sobol_points

# Ishigami: sin x1 + 7 sin^2 x2 + 0.1 x3^4 sin x1, x uniform in (-pi, pi).
ALONE, PAIR, SECOND = 0.5 * (1 + 0.1 * math.pi**4 / 5) ** 2, 0.01 * math.pi**8 * (1 / 18 - 1 / 50), 49 / 8
VARIANCE = ALONE + PAIR + SECOND
S1 = np.array([ALONE, SECOND, 0]) / VARIANCE
ST = np.array([ALONE + PAIR, SECOND, PAIR]) / VARIANCE
BOUNDS = {"cell.alpha_aa": (2, 8), "numerics.mu": ("0.1 h", "0.2 h"), "cell.hard_radius": ("1/3 R_soft", "0.4 R_soft")}


def ishigami(n, seed=1):
    x = sobol_points([(-math.pi, math.pi)] * 3, n, seed)
    return np.sin(x[:, 0]) + 7 * np.sin(x[:, 1]) ** 2 + 0.1 * x[:, 2] ** 4 * np.sin(x[:, 0])


def test_indices_of_a_known_function():
    y = ishigami(4096)
    found = indices(["x1", "x2", "x3"], y, 0 * y, seed=0)
    assert found.table["S1"].to_numpy() == pytest.approx(S1, abs=0.03)
    assert found.table["ST"].to_numpy() == pytest.approx(ST, abs=0.03)
    assert found.deviation == pytest.approx(math.sqrt(VARIANCE), rel=0.01)
    assert found.noise == 0


def test_intervals_cover():
    """Of 20 x 6 intervals of 95 % nearly all hold the known index."""
    inside = []
    for seed in range(20):
        y = ishigami(256, seed)
        table = indices(["x1", "x2", "x3"], y, 0 * y, seed=seed).table
        inside += list((table["S1_low"] <= S1) & (table["S1_high"] >= S1))
        inside += list((table["ST_low"] <= ST) & (table["ST_high"] >= ST))
    assert np.mean(inside) > 0.88


def additive(x):
    """A ratio of three parameters: the first matters most, the third not at all."""
    return 0.2 + 0.4 * x[:, 0] + 0.2 * x[:, 1]


@pytest.mark.parametrize("replicates", [20, 100])
def test_noise_of_few_replicates_is_taken_out(replicates):
    x = sobol_points([(0, 1)] * 3, 2048, seed=3)
    p = additive(x)
    measured = np.random.default_rng(1).binomial(replicates, p) / replicates
    variances = measured * (1 - measured) / (replicates - 1)
    names = ["much", "little", "nothing"]
    biased = indices(names, measured, 0 * variances, seed=0).table
    found = indices(names, measured, variances, seed=0)
    noise = np.mean(p * (1 - p)) / replicates
    share = noise / (noise + 0.2 / 12)
    assert found.noise == pytest.approx(share, rel=0.08)
    assert found.table["ST"].to_numpy() == pytest.approx([0.8, 0.2, 0], abs=0.08)
    assert found.table["S1"].to_numpy() == pytest.approx([0.8, 0.2, 0], abs=0.08)
    assert biased.loc["nothing", "ST"] == pytest.approx(share, rel=0.15)
    assert biased.loc["much", "S1"] == pytest.approx(0.8 * (1 - share), abs=0.05)
    assert found.deviation == pytest.approx(math.sqrt(0.2 / 12), rel=0.05)


def test_more_noise_than_anything_else_is_refused():
    y = np.random.default_rng(0).normal(size=5 * 64)
    with pytest.raises(InvalidProblem, match="more replicates or wider bounds are needed"):
        indices(["a", "b", "c"], y, np.ones_like(y), seed=0)
    with pytest.raises(InvalidProblem, match="must be at most 90 %"):
        indices(["a", "b", "c"], np.full(40, 0.3), np.zeros(40), seed=0)


def test_plan_is_a_study():
    base = preset("thesis")
    plan = plan_sensitivity(base, BOUNDS, 8, seed=0)
    assert len(plan.points) == 8 * 5
    text = plan.toml({"title": "S", "base": "thesis", "replicates": 64, "seed": 1}, {"numerics": {"keep": "6 h"}})
    study = tomllib.loads(text)
    assert study["scenarios"] == plan.scenarios()
    assert study["overrides"] == {"numerics": {"keep": "6 h"}}
    assert (study["title"], study["replicates"], len(study["scenarios"])) == ("S", 64, 40)
    point = base.changed(plan.points[7])
    assert 2 <= point.cell.alpha_aa <= 8
    assert 0.1 <= point.numerics.mu.value <= 0.2
    assert 1 / 3 <= point.cell.hard_radius.value <= 0.4
    assert point.cell.hard_radius.unit == "R_soft"
    values = np.array([base.changed(point).cell.alpha_aa for point in plan.points[::5]])
    assert len(set(values)) == 8
    assert np.sort(values) == pytest.approx(2 + 6 * (np.arange(8) + 0.5) / 8, abs=6 / 8)


def test_plan_depends_on_its_seed_alone():
    plans = [plan_sensitivity(preset("thesis"), BOUNDS, 8, seed=seed) for seed in (0, 0, 1)]
    assert plans[0] == plans[1] != plans[2]


@pytest.mark.parametrize(
    ("bounds", "says"),
    [
        ({}, "bounds are empty"),
        ({"cell.alpha_aa": (8, 2)}, "bounds of cell.alpha_aa = \\(8, 2\\): must rise"),
        ({"cell.alpha_zz": (1, 2)}, "alpha_zz"),
        ({"cell.alpha_aa": (-1, 2)}, "alpha_aa"),
        ({"cell.hard_radius": ("0.3 um", "0.4 R_soft")}, "in one unit"),
        ({"start.nuclei": ("box", "cylinder")}, "nuclei"),
        ({"cell.hard_radius": ("0.3 R_soft", "2 R_soft")}, "hard_radius"),
        ({"cell.min_cycle": ("10 h", "20 h"), "cell.max_cycle": ("11 h", "25 h")}, "max_cycle"),  # only together
    ],
)
def test_plans_that_can_not_be(bounds, says):
    with pytest.raises(InvalidProblem, match=says):
        plan_sensitivity(preset("thesis"), bounds, 8, seed=0)


@pytest.mark.parametrize("n", [4, 12, 16.0])
def test_number_of_points_is_a_power_of_two(n):
    with pytest.raises(InvalidProblem, match="n = "):
        sobol_points([(0, 1)], n, 0)


def ratios_of(plan, replicates):
    """Binomial ratios of the points: alpha_aa matters most, mu a little."""
    rng = np.random.default_rng(0)
    aa = np.array([point["cell.alpha_aa"] for point in plan.points])
    mu = np.array([float(point["numerics.mu"].split()[0]) for point in plan.points])
    p = 0.1 + 0.6 * (aa - 2) / 6 + 0.2 * (mu - 0.1) / 0.1
    return {point_name(k): Ratio(int(rng.binomial(replicates, p[k])), replicates) for k in range(len(p))}


def test_analysis_of_a_plan():
    plan = plan_sensitivity(preset("thesis"), BOUNDS, 64, seed=2)
    ratios = ratios_of(plan, 200)
    found = analyse(plan, ratios, seed=0)
    assert list(found.table.index) == list(BOUNDS)
    assert found.table["ST"].to_numpy() == pytest.approx([0.9, 0.1, 0], abs=0.25)
    assert list(found.table["ST"].rank()) == [3, 2, 1]
    assert found.noise == pytest.approx(
        0.2 / 200 / (0.6**2 / 12 + 0.2**2 / 12 + 0.2 / 200), rel=0.15
    )  # p (1 - p) = 0.2
    assert found.table.equals(analyse(plan, dict(reversed(ratios.items())), seed=0).table)
    few = analyse(plan, ratios_of(plan, 10), seed=0)
    assert few.noise > 5 * found.noise


def test_analysis_needs_all_points():
    plan = plan_sensitivity(preset("thesis"), BOUNDS, 8, seed=2)
    ratios = ratios_of(plan, 100)
    with pytest.raises(InvalidProblem, match="no ratio for 1 scenarios, such as 'point 00003'"):
        analyse(plan, {name: ratio for name, ratio in ratios.items() if name != "point 00003"}, seed=0)
    with pytest.raises(InvalidProblem, match="ratio of 'point 00003'"):
        analyse(plan, ratios | {"point 00003": Ratio(1, 1)}, seed=0)
    with pytest.raises(InvalidProblem, match="level = 95"):
        analyse(plan, ratios, seed=0, level=95)
