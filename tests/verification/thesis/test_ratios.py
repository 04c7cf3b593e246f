"""Ratios of cells with their effective numbers, by category and by value; comparisons, and the runs they need."""

import math

import numpy as np
import pandas as pd
import pytest
from scipy.stats import binomtest

from dincl.errors import InvalidProblem
from tissue.study.categories import outcome
from verification.claims import Evidence, Verdict
from verification.thesis.chapter4 import frequencies
from verification.thesis.chapter4.frequencies import (
    CLAIM_LEVEL,
    MODEL,
    alike,
    averaged,
    evidence,
    in_readings,
    more,
    share,
)
from verification.thesis.chapter4.printed import against_printed, agrees
from verification.thesis.chapter4.ratios import (
    ProportionContrast,
    Ratio,
    by_order,
    difference,
    effective_size,
    given,
    happened,
    outcome_published,
    ratio,
    ratios,
    wilson,
)

TRIALS = 600
SLACK = 5 * (0.95 * 0.05 / TRIALS) ** 0.5


@pytest.mark.parametrize(("count", "of"), [(0, 1), (1, 1), (3, 10), (120, 400), (400, 400)])
def test_intervals_are_wilsons_and_differences_newcombes(count: int, of: int) -> None:
    known = binomtest(count, of).proportion_ci(0.99, method="wilson")
    assert Ratio(count, of).interval(0.99) == pytest.approx((known.low, known.high), abs=1e-14)
    # Newcombe (1998), Table II, method 10.
    assert difference(Ratio(56, 70), Ratio(48, 80)).interval() == pytest.approx((0.0524, 0.3339), abs=5e-5)
    assert difference(Ratio(9, 10), Ratio(3, 10)).interval() == pytest.approx((0.1705, 0.8090), abs=5e-5)


@pytest.mark.parametrize(
    ("count", "of", "effective"), [(1, 0, None), (3, 2, None), (-1, 2, None), (1, 2, 3), (1, 2, 0)]
)
def test_ratios_that_can_not_be(count: int, of: int, effective: float | None) -> None:
    with pytest.raises(InvalidProblem, match="must"):
        Ratio(count, of, effective)


def test_effective_numbers_of_cells_alone_and_of_equal_cells() -> None:
    assert effective_size([1, 0, 0, 1, 1], [1] * 5) == pytest.approx(5)
    assert effective_size([10, 0] * 500, [10] * 1000) == pytest.approx(1000, rel=0.01)
    assert effective_size([5] * 1000, [10] * 1000) == 10_000  # better than independent, but not counted so


@pytest.mark.parametrize(("p", "rho"), [(0.05, 0.5), (0.3, 0.1), (0.9, 0.3)])
def test_intervals_of_clustered_cells_cover_and_plain_ones_do_not(p: float, rho: float) -> None:
    rng = np.random.default_rng(7)
    hits = rng.binomial(10, rng.beta(p * (1 / rho - 1), (1 - p) * (1 / rho - 1), (TRIALS, 60)))
    sizes = np.array([effective_size(row, np.full(60, 10)) for row in hits])
    for size, covers in ((sizes, True), (np.full(TRIALS, 600.0), False)):
        low, high = wilson(hits.sum(axis=1) / 600, size)
        assert (np.mean((low <= p) & (p <= high)) >= 0.95 - SLACK) == covers


def test_ratios_of_categories() -> None:
    rng = np.random.default_rng(1)
    replicate, hit = pd.Series(np.repeat(np.arange(40), 6)), pd.Series(rng.random(240) < 0.3)
    kind = pd.Series(rng.choice(np.array(["b", "a"]), 240)).where(hit.index != 3, None)
    found = ratios(hit, replicate, kind)
    assert list(found.index) == ["a", "b"]
    assert found["of"].sum() == 239
    for name, row in found.iterrows():
        mine = kind == name
        one = ratio(hit[mine], replicate[mine])
        assert (row["count"], row["of"], row["effective"]) == (one.count, one.of, one.size)
        assert (row["low"], row["high"]) == one.interval()
        assert row["runs"] == replicate[mine].nunique()


# Comparisons


def apart(count: int, other: int = 500) -> ProportionContrast:
    """A difference of two ratios of 1000 cells each."""
    return difference(Ratio(count, 1000), Ratio(other, 1000))


@pytest.mark.parametrize(("count", "verdict"), [(700, Verdict.HOLDS), (300, Verdict.REFUTED), (500, Verdict.OPEN)])
def test_one_reading_decides(count: int, verdict: Verdict) -> None:
    def compare(preset: str) -> Evidence:
        return evidence([more("x", apart(count if preset == "published" else 1000 - count))])

    found = in_readings(compare)
    assert found.verdict is verdict
    opposite = {Verdict.HOLDS: Verdict.REFUTED, Verdict.REFUTED: Verdict.HOLDS, Verdict.OPEN: Verdict.OPEN}[verdict]
    assert [each.verdict for each in found.readings.values()] == [opposite, verdict, opposite]
    assert in_readings(compare, MODEL).verdict is opposite


def test_numbers_are_in_per_cent_and_points() -> None:
    """A lead of 20 points, and a ratio of 70 %, with 99 % intervals."""
    for sized in (more("x", apart(700)), alike("x", apart(700), 0.3), share("x", Ratio(700, 1000), 0.5)):
        found = sized.comparison
        assert found.value == pytest.approx(70 if "%" in found.what else 20)
        assert found.interval[1] - found.interval[0] == pytest.approx(7.5 if "%" in found.what else 11, abs=0.2)


def test_ratios_are_alike_within_a_margin() -> None:
    many = difference(Ratio(53_000, 100_000), Ratio(50_000, 100_000))
    assert alike("x", many).comparison.true is True
    assert alike("x", many, 0.01).comparison.true is False
    assert alike("x", apart(600)).comparison.true is None


def test_runs_are_those_of_the_comparison_that_needs_most() -> None:
    found = [more("x", apart(900)), more("x", apart(600)), more("x", apart(500))]
    assert found[2].runs is None
    assert evidence(found).runs_needed == found[1].runs > found[0].runs


def test_the_mean_of_equal_differences_has_the_interval_of_all_cells() -> None:
    """Four differences of 1000 cells each are one of 4000, as long as normal intervals are good."""
    found = averaged([apart(600)] * 4)
    low, high = difference(Ratio(2400, 4000), Ratio(2000, 4000)).interval(CLAIM_LEVEL)
    assert found.value == pytest.approx(0.1)
    assert found.interval(CLAIM_LEVEL) == pytest.approx((low, high), abs=1e-3)
    assert averaged([apart(600), apart(500)], [3.0, 1.0]).value == pytest.approx(0.075)


def test_agreement_with_a_printed_ratio() -> None:
    """Two samples of the same ratio agree nearly always, at 99 %; one that is 15 points off does not."""
    rng = np.random.default_rng(8)
    pairs = rng.binomial(400, 0.1, (1000, 2))
    same = [agrees(against_printed(Ratio(int(a), 400), b / 400, 400)) for a, b in pairs]
    assert np.mean(same) == pytest.approx(0.99, abs=0.012)
    assert not agrees(against_printed(Ratio(100, 400), 0.1, 400))
    assert agrees(against_printed(Ratio(100, 400), 0.1, 10))
    with pytest.raises(InvalidProblem, match="printed = 30"):
        against_printed(Ratio(1, 2), 30, 400)


def test_runs_by_the_width_of_an_interval_shrink_with_the_square_of_the_distance() -> None:
    """n = 1000 (h/m (2.576 + 0.842)/2.576)^2."""
    assert frequencies.runs_by_width(1000, 0.2, (0.1, 0.3)) == 441
    assert frequencies.runs_by_width(1000, 0.4, (0.3, 0.5)) == 111
    assert frequencies.runs_by_width(1000, 0.0, (-0.1, 0.1)) is None


def test_runs_for_a_bound_are_those_of_the_textbook() -> None:
    """((2.576 + 0.8416)/0.1)^2 (0.25 + 0.25) = 584 for two equal ratios of a half and a margin of ten points."""
    equal = difference(Ratio(500, 1000), Ratio(500, 1000))
    assert frequencies.runs_for_bound(equal, 0.1) == 584
    assert frequencies.runs_for_bound(equal, 0.2) == 146
    assert frequencies.runs_for_bound(equal, 0.0) is None
    assert frequencies.runs_for_bound(difference(Ratio(0, 9), Ratio(9, 9)), 0.0) is None


def test_a_multiple_of_a_ratio_has_the_interval_of_both_sides() -> None:
    """p - 1.5 q is below 0 for p = q, and near 0 for p = 1.5 q."""
    for count, true in ((500, False), (750, None), (999, True)):
        contrast = ProportionContrast((1.0, -1.5), (Ratio(count, 1000), Ratio(500, 1000)))
        assert more("x", contrast).comparison.true is true


# Categories

NEVER = math.inf
END = 48.0


def cells_with(*times, inm=None):
    """A cell for each (T_A, T_B, T_S, T_P); [P] acts from max(T_P, T_B) on, as in stored tables."""
    table = pd.DataFrame(times, columns=["t_a_h", "t_b_h", "t_s_h", "t_p_h"], dtype=float)
    table["t_p_h"] = table[["t_p_h", "t_b_h"]].max(axis=1)
    return table.assign(inm=[True] * len(table) if inm is None else inm, replicate=range(len(table)))


TIMES = [
    (NEVER, NEVER, NEVER, NEVER),
    (6, NEVER, NEVER, NEVER),
    (6, 6, NEVER, NEVER),
    (12, 6, NEVER, NEVER),
    (6, NEVER, NEVER, 8),  # [P] without [B] never acts
    (NEVER, 6, NEVER, 3),  # [P] waits for [B]
    (7, 6, 5, 8),
    (6, 48 + 1e-14, NEVER, NEVER),  # [B] begins in the last step
    (6, 48.1, NEVER, NEVER),
]


def test_order():
    named = by_order(cells_with(*TIMES), END)
    assert list(named) == ["none", "[A]", "[AB]", "[BA]", "[A]", "[BP]", "[SBAP]", "[AB]", "[A]"]
    assert list(by_order(cells_with(*TIMES[:2], inm=[False, False]), END)) == ["none no INM", "[A] no INM"]


def test_an_earlier_end_has_fewer_events():
    cells = cells_with(*TIMES)
    assert happened(cells, 6.5).sum().to_dict() == {"A": 5, "B": 4, "S": 1, "P": 1}
    assert (by_order(cells, 3.0) == "none").all()


def test_conditional_curve_covers_the_truth():
    """P[hit | value] = 1 - value, ten cells with a common part in each replicate: bands of 95 % cover about 95 %."""
    rng, inside, wide = np.random.default_rng(6), [], []
    edges = np.linspace(0, 1, 6)
    for _ in range(60):
        shared = np.repeat(rng.random(80) < 0.5, 10)
        values = pd.Series(rng.random(800))
        limit = np.where(shared, rng.random(800), np.repeat(rng.random(80), 10))  # uniform, half of them common
        hits = pd.Series(limit > values)
        runs = pd.Series(np.repeat(np.arange(80), 10))
        curve = given(hits, runs, values, edges)
        plain = [Ratio(int(a), int(b)).interval() for a, b in zip(curve["count"], curve["of"], strict=True)]
        truth = 1 - (curve["low_edge"] + curve["high_edge"]) / 2
        inside += list((curve["low"] <= truth) & (truth <= curve["high"]))
        wide += [low <= t <= high for t, (low, high) in zip(truth, plain, strict=True)]
    assert np.mean(inside) > 0.92
    assert np.mean(wide) < np.mean(inside)


def test_conditional_curve_leaves_out_what_has_no_value():
    values = pd.Series([0.1, 0.9, math.inf, -1, 2, math.nan])
    hits, runs = pd.Series([True, False, True, True, True, True]), pd.Series(range(6))
    curve = given(hits, runs, values, [0, 0.5, 0.8, 1])
    assert list(curve["low_edge"]) == [0, 0.8]
    assert list(curve["high_edge"]) == [0.5, 1]
    assert list(curve["value"]) == [1, 0]
    assert given(hits, runs, values, [10, 20]).empty


def positions(*rows, step=0.5):
    """A table with the positions of cells at times 0, step, 2 step, ..."""
    columns = {f"ab_{step * k:g}h": column for k, column in enumerate(zip(*rows, strict=True))}
    below = {f"below_{step * k:g}h": [y < 0.2 for y in column] for k, column in enumerate(zip(*rows, strict=True))}
    return pd.DataFrame({"replicate": range(len(rows))} | columns | below)


def test_outcomes_by_the_published_rule():
    cells = positions(
        (-1, -1, -1, -1),
        (-1, 1, 1, -9),  # back within the hour
        (-1, 1, -1, 9),  # back later
        (-1, 1, -1, 0),  # for a moment only
        (0, -1, -1, -1),  # not yet
    )
    assert list(outcome_published(cells, "basal", 0)) == [True, False, False, True, False]
    assert list(outcome(cells, "basal", 0)) == [True, True, True, True, False]
    assert outcome_published(cells, "basal", 1.5).equals(outcome(cells, "basal", 1.5))
    assert outcome_published(cells, "apical", 0.5).equals(outcome(cells, "apical", 0.5))
