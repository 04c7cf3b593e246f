"""All means of an independent program against ours: as many standard errors off as chance allows in so many means."""

import numpy as np
import pandas as pd
import pytest
from scipy.stats import norm

from tests.outside.eht import differences, parameters_of, theirs

# One sample in a hundred has a difference beyond the limit if there is none; the seeds are fixed.
LEVEL = 0.01
SCENARIOS = ("control", "none_noINM", "A12", "A12_noINM", "B12", "B12_noINM", "S12", "S12_noINM")
# Runs of the fast test, and of each scenario in the others.
FEW, SOME, MANY = 16, 112, 400


def limit(comparisons):
    """The largest difference of so many in standard errors (Bonferroni)."""
    return norm.isf(LEVEL / 2 / comparisons)


def compare(scenarios, runs):
    """Fail if a mean of these scenarios is off, or all of them together are."""
    found = pd.concat({name: differences(name, runs) for name in scenarios}, names=["scenario"])
    assert len(found) == theirs().index.get_level_values("scenario").isin(scenarios).sum()
    assert np.isfinite(found).all()
    far = found[found.abs() > limit(len(found))]
    assert far.empty, far
    # Of independent differences the mean square would be 1; one that is off by 1 each time adds as much.
    assert (found**2).mean() < 2.0


def test_control_cells_have_the_means_of_that_program():
    compare(["control"], FEW)


def test_the_scenarios_are_all_and_say_what_they_are_called():
    assert set(theirs().index.get_level_values("scenario")) == set(SCENARIOS)
    assert parameters_of("control").tissue.cells == 45
    given = parameters_of("S12_noINM")
    assert (given.tissue.cells, given.emt.cells, given.emt.inm) == (51, 1, 0)
    assert [name for name, time in given.emt.times().items() if time.ever] == ["s"]
    assert parameters_of("A12").emt.a.fixed == 12.1


@pytest.mark.slow
def test_all_means_are_those_of_that_program():
    compare(SCENARIOS, SOME)


@pytest.mark.xslow
def test_all_means_of_many_runs_are_those_of_that_program():
    compare(SCENARIOS, MANY)


@pytest.mark.slow
@pytest.mark.parametrize("wrong", ["A12_noINM", "B12", "S12"])
def test_the_comparison_sees_an_event_in_place_of_another(wrong, monkeypatch):
    """The runs of A12 against the means of another scenario."""
    there = theirs().loc[[wrong]].rename(index={wrong: "A12"})
    monkeypatch.setattr("tests.outside.eht.theirs", lambda: there)
    assert differences("A12", SOME).abs().max() > limit(360)
