"""Tables and sentences of who is cheapest on the scenes of the report."""

import math

import numpy as np
import pandas as pd
import pytest

from verification.beyond.chart import cheapest
from verification.beyond.chart.work_precision import Form
from verification.instruments.budget import CpuSeconds
from verification.thesis.chapter2.methods import LINEARISED_DAQP, LSODA, PBD, PBD_16

FORM = Form({}, CpuSeconds(100.0))
SLIDE, STACK = "sliding_disc", "stack"


def measured(errors, seconds, method=PBD, **columns):
    count = len(errors)
    return pd.DataFrame(
        {
            "scene": SLIDE,
            "method": method.name,
            "setting": 0.1 / 2.0 ** np.arange(count),
            "status": ["SUCCESS"] * count,
            "largest": errors,
            "final": errors,
            "cpu_seconds": seconds,
            "spread": 1.0,
            "disturbed": False,
            "reference_error": 0.0,
        }
        | columns
    )


@pytest.fixture(scope="module")
def three():
    pbd = measured([1e-1, 1e-3], [1.0, 4.0])
    more = measured([1e-1, 1e-3], [2.0, 8.0], method=PBD_16)
    lsoda = measured([1e-3, 1e-6], [6.0, 7.0], method=LSODA)
    return pd.concat([lsoda, more, pbd])


def test_winners(three):
    found = cheapest.winners(three, FORM, (1e-2, 1e-3, 1e-6, 1e-8))
    assert found["cheapest"].tolist() == [PBD.label, PBD.label, LSODA.label, "not reached"]
    assert found["next"].tolist() == [PBD_16.label, LSODA.label, "", ""]
    assert found["ratio"].tolist()[:2] == pytest.approx([2.0, 1.5])
    assert found["pbd_ratio"].tolist() == pytest.approx([1.0, 1.0, np.nan, np.nan], nan_ok=True)
    assert found["disturbed"].tolist() == [0] * 4


def test_one_table_for_all_scenes(three):
    found = cheapest.winners(three, FORM, (1e-6, 1e-2, 1e-8))
    wide = cheapest.wide(found)
    assert list(wide) == ["Scene", "0.01", "10⁻⁶", "10⁻⁸"]
    assert wide.iloc[0].tolist()[1:] == ["PBD", LSODA.label, "not reached"]


def test_what_the_reference_does_not_tell_is_said(three):
    found = cheapest.winners(three.assign(reference_error=1e-7), FORM, (1e-6, 1e-8))
    assert found["cheapest"].tolist() == [LSODA.label, "not resolved"]


def test_a_tie_and_the_limit_are_said(three):
    like = measured([1e-1, 1e-3], [1.1, 4.4], method=PBD_16)
    tied = cheapest.winners(pd.concat([measured([1e-1, 1e-3], [1.0, 4.0]), like]), FORM, (1e-2,))
    assert cheapest.wide(tied)["0.01"].tolist() == ["tie"]
    short = cheapest.winners(three, Form({}, CpuSeconds(5.0)), (1e-2,))
    assert cheapest.wide(short)["0.01"].tolist() == ["at the limit"]


def test_table_of_times(three):
    h = 0.1 / 2.0 ** np.arange(6)
    more = measured(3 * h**2, 1 / h, scene=STACK, method=LINEARISED_DAQP, final=h**2)
    failed = measured([1e-1], [1.0], scene=STACK, status=["OUT_OF_BUDGET"])
    left = measured([np.nan], [np.nan], scene=STACK, status=["LEFT_OUT"])
    found = cheapest.times(pd.concat([more, three, failed, left]), FORM).set_index(["scene", "method"])
    assert [name for scene, name in found.index if scene == SLIDE] == [PBD.label, PBD_16.label, LSODA.label]
    daqp = found.loc[(STACK, LINEARISED_DAQP.label)]
    assert daqp["order"].startswith("2.00 [")
    assert daqp["best"] == pytest.approx(3 * h[-1] ** 2)
    assert daqp["at_end"] == pytest.approx(1 / 3)
    assert daqp["0.01"] == pytest.approx(math.sqrt(300.0))
    stopped = found.loc[(STACK, PBD.label)]
    assert stopped["failed"] == 1
    assert stopped[["0.01", "best", "at_end"]].isna().all()
    assert found.loc[(SLIDE, LSODA.label), "order"] == ""


def test_an_order_is_that_of_falling_errors():
    """Finer steps than the best one only add up the tolerances of the solver."""
    h = 0.1 / 2.0 ** np.arange(10)
    errors = np.maximum(h**2, 1e-7 * 4.0 ** np.arange(-6, 4))
    found = cheapest.times(measured(errors, 1 / h), FORM)
    assert found["order"].iloc[0].startswith("2.00 [")
