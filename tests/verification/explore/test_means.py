"""Numbers of the answer: intervals of means that are valid at any time, and differences run by run."""

import numpy as np
import pandas as pd
import pytest
from scipy import stats

from verification.explore.sequences import bounded, runs_to_decide, unbounded
from verification.explore.tissues.answer import (
    DECIDED,
    HEIGHT,
    NO_INTERVAL,
    Answer,
    AnswerRow,
    Sample,
    TimeSeries,
    _needed,
    _plain,
    _row,
    _signed,
    difference,
    means_of,
)
from verification.explore.tissues.answer_panel import mean_chart

RNG = np.random.default_rng(3)
FIRST, SECOND = RNG.normal(1.0, 2.0, 40), RNG.normal(0.5, 0.7, 30)


def test_bands_in_time_are_students():
    low, high = stats.t.interval(0.95, 39, FIRST.mean(), stats.sem(FIRST))
    value, below, above = means_of(np.column_stack((FIRST, 2 * FIRST)))
    assert value == pytest.approx([FIRST.mean(), 2 * FIRST.mean()])
    assert (below[1], above[1]) == pytest.approx((2 * low, 2 * high))


def test_a_mean_has_an_interval_of_all_times():
    assert Sample(FIRST).interval() == unbounded(FIRST)
    shares = RNG.random(20)
    assert Sample(shares, (0.0, 1.0)).interval() == bounded(shares)


def test_a_difference_is_that_of_as_many_runs_as_both_have():
    gap = difference(Sample(FIRST), Sample(SECOND))
    assert gap.value == pytest.approx((FIRST[:30] - SECOND).mean())
    assert gap.bounds is None
    shares = difference(Sample(1.0 * (FIRST > 1), (0.0, 1.0)), Sample(1.0 * (SECOND > 1), (0.0, 1.0)))
    assert shares.bounds == (-1, 1)
    assert shares.interval() == bounded(shares.values, -1, 1)


def test_what_is_decided_is_said_by_these_intervals_alone():
    assert _needed(difference(Sample(FIRST + 5), Sample(SECOND))) == DECIDED
    assert _needed(difference(Sample(FIRST), Sample(FIRST))) == "equal so far"
    close = difference(Sample(FIRST), Sample(SECOND + 0.4))
    runs = int(_needed(close).split()[0].replace(" ", ""))
    assert runs == max(runs_to_decide(abs(close.value), close.values.std()) - 30, 1)
    assert AnswerRow._fields[-1] == "needed"


def test_few_values_have_no_interval_and_say_so():
    assert _row("height", Sample(FIRST[:3]), None, _plain, _signed).value.endswith(f", {NO_INTERVAL}")
    assert _row("height", Sample(FIRST), None, _plain, _signed).value.endswith("]")


def test_what_is_held_has_names_of_its_own():
    course = TimeSeries([0.0, 1.0], *np.array([[1.0, 2.0], [0.5, 1.0], [1.5, 3.0]]))
    answer = Answer(8, 0, {}, {}, pd.DataFrame(columns=["what", "time_h"]), {HEIGHT: course})
    assert mean_chart([answer], HEIGHT)["legend"]["data"] == [HEIGHT]
    chart = mean_chart([answer, answer], HEIGHT)
    assert chart["legend"] | {"data": [HEIGHT, f"{HEIGHT}, held"], "show": True} == chart["legend"]
