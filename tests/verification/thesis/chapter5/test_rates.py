"""Rates of W1 of the mean-field chapter: laws, what ships, streams."""

import numpy as np
import pandas as pd
import pytest

from verification.instruments.rates import IID, PAIR, QUANTILES, summarised
from verification.site.store import shipped
from verification.thesis.chapter5 import cases, exact, rates


@pytest.fixture(scope="module")
def found():
    return rates.results(shipped(rates.NAME))


def synthetic(law):
    """The means of 40 values for each size, alternately 10 % above and below the law."""
    counts = np.repeat([100, 300, 1000, 3000], 40)
    values = law(counts) * (1 + 0.1 * np.tile([-1, 1], 80))
    rows = pd.DataFrame({"N": counts, "t": 0.0, "w1": values, "error_y": 0.0})
    return rates.W1Rates(rows, *summarised(rows, random=True), PAIR)


def test_laws_of_synthetic_rates_are_distinguished():
    made = dict.fromkeys(rates.CUBES.values(), synthetic(lambda n: np.sqrt((0.4 + 0.13 * np.log(n)) / n)))
    found = rates.laws(made).set_index(["d", "law"]).loc[2]
    best = found.loc["((a + b log N) / N)^1/2"]
    assert (best["a"], best["b"]) == pytest.approx((0.4, 0.13), abs=1e-12)
    assert 0.01 < best["b_half"] < 0.04
    assert best["misfit"] < 1e-12
    assert found["misfit"].drop(best.name).min() > 2


def test_laws_of_the_cubes_are_those_of_theory(found):
    laws = rates.laws(found).set_index("law")
    assert abs(laws["a"].iloc[0] - np.sqrt(np.pi / 32)) < laws["a_half"].iloc[0]
    fits = laws[["d", "misfit"]].groupby("d")["misfit"]
    assert (fits.min() < 2).all()
    assert fits.idxmin().loc[[2, 3]].tolist() == ["((a + b log N) / N)^1/2", "a N^-1/3 + b N^-1/2"]


def test_powers_are_compared_with_those_of_theory(found):
    table = rates.fits(found)
    on_line = table[table["start"] == IID]
    assert (on_line["agrees"] == "yes").all()
    assert len(on_line) == 7
    assert (table.loc[(table["quantity"] == "error_y") & (table["start"] == QUANTILES), "agrees"] == "—").all()
    assert (table.loc[(table["quantity"] == "error_y") & (table["start"] != QUANTILES), "agrees"] == "yes").all()
    at_once = table[table["case"].isin(["Unit interval, quantiles", "Unit square"])].set_index("case")
    assert at_once.loc["Unit interval, quantiles", "slope"] == pytest.approx(-1, abs=1e-12)
    assert at_once.loc["Unit interval, quantiles", "agrees"] == "yes"
    assert at_once.loc["Unit square", "low"] > -0.5  # slower than without the logarithm


def test_the_limit_of_the_straight_fibre_is_the_closed_form():
    second = float(cases.law("uniform").moments()[1][0, 0])
    true = exact.harmonic("straight", np.array([[np.sqrt(second)]]), np.array([rates.T])).y
    assert rates.runs()["uniform StraightFibre, quantiles"].limit.y == pytest.approx(true, abs=1e-11)
