"""Who is cheapest at which error: interpolation between runs, winners, sentences."""

import math

import numpy as np
import pandas as pd
import pytest

from verification.thesis.chapter2 import cheapest
from verification.thesis.chapter2.methods import LINEARISED_DAQP, LSODA, METHODS, PBD, PBD_16


def measured(errors, seconds, reference_error=0.0, **columns):
    count = len(errors)
    return pd.DataFrame(
        {
            "scene": "s",
            "method": "pbd",
            "setting": 0.1 / 2.0 ** np.arange(count),
            "status": ["SUCCESS"] * count,
            "sup": errors,
            "final": errors,
            "seconds": seconds,
            "reference_error": reference_error,
        }
        | columns
    )


def test_time_to_an_error_follows_a_power_law_between_runs():
    error = np.array([1e-1, 3e-3, 2e-5])
    seconds = 0.5 * error**-0.7
    table = measured(error, seconds).sample(frac=1, random_state=1)
    for target in (5e-2, 1e-3, 1e-4, 2e-5):
        assert cheapest.seconds_to(table, target) == pytest.approx(0.5 * target**-0.7)


def test_nothing_is_extrapolated():
    table = measured([1e-1, 1e-3], [1.0, 3.0])
    assert cheapest.seconds_to(table, 9e-4) == math.inf
    assert cheapest.seconds_to(table, 0.5) == 1.0
    assert cheapest.seconds_to(table.head(0), 0.5) == math.inf
    better = measured([1e-9, 1e-9], [5.0, 4.0])
    assert cheapest.seconds_to(better, 1e-2) == 4.0


def test_an_error_that_is_small_by_chance_does_not_count():
    table = measured([1e-1, 1e-5, 1e-2, 1e-4], [1.0, 2.0, 4.0, 8.0])
    assert cheapest.seconds_to(table, 1e-3) == pytest.approx(math.sqrt(4.0 * 8.0))


def test_an_error_below_that_of_the_reference_does_not_count():
    table = measured([1e-1, 1e-7], [1.0, 2.0], reference_error=1e-3)
    assert cheapest.seconds_to(table, 1.9e-3) == math.inf
    assert cheapest.seconds_to(table, 2e-3) == pytest.approx(2.0)


def test_failed_runs_reach_nothing():
    table = measured([1e-1, np.nan, 1e-3], [1.0, 0.1, 4.0], status=["SUCCESS", "NON_FINITE", "SUCCESS"])
    assert cheapest.seconds_to(table, 1e-2) == pytest.approx(2.0)


@pytest.fixture(scope="module")
def three():
    pbd = measured([1e-1, 1e-3], [1.0, 4.0], method=PBD.name)
    more = measured([1e-1, 1e-3], [2.0, 8.0], method=PBD_16.name)
    lsoda = measured([1e-3, 1e-6], [6.0, 7.0], method=LSODA.name)
    return pd.concat([lsoda, more, pbd])


def test_winners(three):
    found = cheapest.winners(three, (1e-2, 1e-3, 1e-6, 1e-8))
    assert found["method"].tolist() == ["pbd", "pbd", "lsoda", ""]
    assert found["seconds"].tolist()[:3] == pytest.approx([2.0, 4.0, 7.0])
    assert found["runner_up"].tolist() == ["pbd_16", "lsoda", "", ""]
    assert found["runner_up_ratio"].tolist()[:2] == pytest.approx([2.0, 1.5])
    assert found["pbd_ratio"].tolist() == pytest.approx([1.0, 1.0, np.nan, np.nan], nan_ok=True)


def test_sentences(three):
    found = cheapest.winners(three, (1e-6, 1e-2, 1e-8))
    text = cheapest.sentence(found)
    assert text == (
        "To an error of 0.01 PBD is the cheapest, with 2 s (PBD, 16 sweeps takes 2 times as long); "
        "to an error of 1.0·10⁻⁶ penalty, LSODA is the cheapest, with 7 s (no other method gets there); "
        "no method reaches 1.0·10⁻⁸ in the time given."
    )
    assert cheapest.sentence(found.tail(1)) == "No method reaches 1.0·10⁻⁸ in the time given."
    whole = cheapest.summary(found)
    assert "Of 3 pairs of scene and error, 2 were reached" in whole
    assert "PBD is the cheapest at an error of 0.01 only" in whole
    assert "PBD is never the cheapest" in cheapest.summary(found[found["target"] < 1e-3])


def test_table_of_times(three):
    h = 0.1 / 2.0 ** np.arange(6)
    more = measured(3 * h**2, 1 / h, scene="other", method=LINEARISED_DAQP.name, final=h**2)
    failed = measured([1e-1], [1.0], scene="other", status=["OUT_OF_TIME"])
    left = measured([np.nan], [np.nan], scene="other", status=["LEFT_OUT"])
    found = cheapest.times(pd.concat([more, three, failed, left])).set_index(["scene", "method"])
    assert [name for scene, name in found.index if scene == "s"] == [
        name for name in METHODS if name in set(three["method"])
    ]
    daqp = found.loc[("other", LINEARISED_DAQP.name)]
    assert daqp["order"].startswith("2.00 [")
    assert daqp["best"] == pytest.approx(3 * h[-1] ** 2)
    assert daqp["at_end"] == pytest.approx(1 / 3)
    assert daqp["0.01"] == pytest.approx(math.sqrt(300.0))
    stopped = found.loc[("other", "pbd")]
    assert stopped["failed"] == 1
    assert stopped[["0.01", "best", "at_end"]].isna().all()
    assert found.loc[("s", "lsoda"), "order"] == ""
