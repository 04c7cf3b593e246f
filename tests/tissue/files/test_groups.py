"""EMT cells of a run: when their events begin, how many they are, where they stand (sections 2.2.6, 2.3)."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats

from tissue.events.known import row
from tissue.files.groups import drawn
from tissue.files.parameters import preset
from tissue.files.quantities import Timing, timing
from tissue.runs.simulate import simulate
from tissue.runs.start import started
from tissue.state.checkpoint import streams

NEVER = math.inf
# With fixed seeds a test either passes always or never; a sound one fails for one seed in a thousand.
RARE = 1e-3


# Timings


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("never", Timing()),
        ("12 h", Timing(12.0, 12.0)),
        ("30 min", Timing(0.5, 0.5)),
        ("6 h to 24 h", Timing(6.0, 24.0)),
        ("6 h to 24 h, 70 %", Timing(6.0, 24.0, 70.0)),
        ("6 h to 24 h,62.5%", Timing(6.0, 24.0, 62.5)),
        ("0 h to 0 h, 50 %", Timing(0.0, 0.0, 50.0)),
        ("18 h, 50 %", Timing(18.0, 18.0, 50.0)),
        (" 1/2 h ,0.1%", Timing(0.5, 0.5, 0.1)),
    ],
)
def test_texts_of_timings(text, expected):
    assert timing(text) == expected
    assert timing(str(expected)) == expected


@given(st.floats(1e-12, 1e6), st.just(0.0) | st.floats(1e-12, 1e6), st.sampled_from([100.0]) | st.floats(0, 100))
def test_a_timing_is_read_as_it_was_written(a, b, percent):
    written = Timing(min(a, b), max(a, b), percent)
    assert timing(str(written)) == written


def test_times_are_uniform_with_their_probability():
    """U^70%(6, 24): as many as a binomial number gives are finite, and these are uniform."""
    n, draws = 20_000, np.random.default_rng(3)
    times = Timing(6.0, 24.0, 70.0).times(draws.random(n), draws.random(n))
    ever = np.isfinite(times)
    assert stats.binomtest(int(ever.sum()), n, 0.7).pvalue > RARE
    assert stats.kstest(times[ever], stats.uniform(6.0, 18.0).cdf).pvalue > RARE
    assert (Timing().times(draws.random(5), draws.random(5)) == NEVER).all()
    assert (Timing(12.0, 12.0).times(draws.random(5), draws.random(5)) == 12.0).all()


# Groups


def test_events_of_cells_are_independent():
    """[P] waits for [B]; no two of the others tell of each other, nor does INM."""
    chance = Timing(6.0, 24.0, 50.0)
    group = preset("thesis").groups()[0]._replace(cells=20_000, inm=0.5, times=dict.fromkeys("absp", chance))
    at, inm = drawn(group, np.random.default_rng(0))
    assert (at[row("p")] >= at[row("b")]).all()
    assert ((at[row("p")] == NEVER) >= (at[row("b")] == NEVER)).all()
    had = np.array([np.isfinite(at[row("a")]), np.isfinite(at[row("b")]), np.isfinite(at[row("s")]), inm])
    correlations = np.corrcoef(had)[np.triu_indices(4, 1)]
    assert np.abs(correlations).max() < 4 / math.sqrt(20_000)
    assert stats.binomtest(int(np.isfinite(at[row("p")]).sum()), 20_000, 0.25).pvalue > RARE


@pytest.mark.parametrize(("cells", "group", "first"), [(60, 1, 29), (51, 1, 25), (45, 10, 17), (12, 10, 1)])
def test_the_group_stands_in_the_middle(cells, group, first):
    parameters = preset("thesis").changed({"tissue.cells": cells, "emt.cells": group, "emt.inm": 0.5, "emt.a": "9 h"})
    held, _ = started(parameters, streams(4))
    chosen = np.flatnonzero(held.cells.emt[:cells] >= 0)
    assert chosen.tolist() == list(range(first, first + group))
    assert held.cells.emt[chosen].tolist() == list(range(group))
    assert not held.cells.divides[chosen].any()
    others = np.setdiff1d(np.arange(cells), chosen)
    assert held.cells.divides[others].all()
    assert held.cells.moves[others].all()


def test_an_event_after_the_end_warns():
    late = preset("thesis").changed({"emt.cells": 1, "emt.a": "3 h", "numerics.t_end": "0.1 h"})
    with pytest.warns(UserWarning, match=r'^\[A\] never begins: emt.a = "3 h", and numerics.t_end = "0.1 h"$'):
        simulate(late)
    simulate(late.changed({"emt.a": "0.1 h"}))  # in the last step
    simulate(late.changed({"emt.cells": 0}))
