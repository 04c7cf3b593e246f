"""The kept reference of the pile of a thousand discs."""

import numpy as np
import pandas as pd
import pytest

import dincl
from verification.beyond.chart.pile_reference import COUNT, TIMES, table
from verification.beyond.chart.references import FILES


def kept_states():
    kept = pd.read_parquet(FILES["pile_1000"]).sort_values(["t", "particle"])
    return kept[["x", "y"]].to_numpy().reshape(len(TIMES), COUNT, 2), kept["error"].to_numpy()[::COUNT]


def test_a_table_has_the_state_of_each_time():
    x, error = np.arange(len(TIMES) * 6.0).reshape(len(TIMES), 3, 2), np.linspace(1e-9, 1e-8, len(TIMES))
    made = table(x, error)
    second = made[made["t"] == TIMES[1]]
    assert np.array_equal(second[["x", "y"]].to_numpy(), x[1])
    assert list(second["particle"]) == [0, 1, 2]
    assert (second["error"] == error[1]).all()


def test_the_kept_table_is_of_the_pile_and_known_to_ten_digits():
    x, error = kept_states()
    assert 0 < error.max() <= 1e-11
    assert all(dincl.scenes.pile(COUNT).violation(t, state) < 1e-12 for t, state in zip(TIMES, x, strict=True))


@pytest.mark.slow
def test_the_kept_table_is_made_again():
    x, error = kept_states()
    path = dincl.solve(dincl.scenes.pile(COUNT), dincl.EventDriven(1e-8), TIMES[:2])
    assert (np.sqrt(((path.x - x[:2]) ** 2).sum(axis=-1)).max(axis=-1) <= path.error + error[:2]).all()


@pytest.mark.slow
def test_midpoint_catch_up_comes_to_the_kept_table():
    """Another way to the same states: of few digits, but without events."""
    x, _ = kept_states()
    scheme = dincl.MidpointCatchUp(2.5e-4, dincl.ProjectedNewton(1e-9))
    path = dincl.solve(dincl.scenes.pile(COUNT), scheme, TIMES[:2])
    assert np.abs(path.x - x[:2]).max() <= 2e-5
