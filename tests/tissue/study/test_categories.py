"""What became of the cells of runs, on tables written by hand; and ratios in time."""

import pandas as pd
import pytest

from dincl.errors import InvalidProblem
from tissue.study.categories import control_shares, kept_times, outcome, run_shares, run_shares_in_time


def positions(*rows, step=0.5):
    """A table with the positions of cells at times 0, step, 2 step, ..."""
    columns = {f"ab_{step * k:g}h": column for k, column in enumerate(zip(*rows, strict=True))}
    below = {f"below_{step * k:g}h": [y < 0.2 for y in column] for k, column in enumerate(zip(*rows, strict=True))}
    return pd.DataFrame({"replicate": range(len(rows))} | columns | below)


def test_outcomes_by_the_thesis():
    cells = positions((0.5, -0.1), (0.1, 0.0), (1.0, 1.1))
    assert list(outcome(cells, "basal", 0.5)) == [True, False, False]
    assert list(outcome(cells, "apical", 0.5)) == [False, False, True]
    assert list(outcome(cells, "apical", 0)) == [False, False, False]
    assert list(outcome(cells, "below", 0)) == [False, True, False]


def test_outcomes_that_can_not_be():
    cells = positions((0.5, -0.1))
    with pytest.raises(InvalidProblem, match=r"t = 0\.7: must be an output time; these are \[0\.0, 0\.5\] h"):
        outcome(cells, "basal", 0.7)
    with pytest.raises(InvalidProblem, match="what = 'out': must be one of basal, apical, below"):
        outcome(cells, "out", 0.5)


def test_kept_times_are_in_order():
    cells = pd.DataFrame(columns=["ab_0h", "ab_10h", "ab_2h", "ab_0.5h", "onset_ab", "below_3h"])
    assert kept_times(cells) == [0, 0.5, 2, 10]


def test_runs_count_alike_however_many_cells_they_have():
    cells = positions((0.5, -0.1), (0.1, 0.0), (1.0, 1.1), (0.4, -0.2)).assign(replicate=[7, 7, 7, 3])
    assert run_shares(cells, "basal", 0.5).to_dict() == pytest.approx({3: 1.0, 7: 1 / 3})
    assert run_shares_in_time(cells)["basal"].tolist() == [[0.0, 1.0], [0.0, pytest.approx(1 / 3)]]
    columns = {"status": ["SUCCESS", "NON_FINITE", "SUCCESS", "SUCCESS"], "controls_1h": [50, 50, 0, 40]}
    runs = pd.DataFrame({"replicate": range(4), **columns, "controls_apical_1h": [5, 5, 0, 0]})
    assert control_shares(runs, "apical", 1.0).to_dict() == {0: 0.1, 3: 0.0}
