"""Charts of inclusions: what is drawn of zeros, of what blows up and of what fails."""

import numpy as np
import pytest

from verification.explore.inclusions.charts import COARSEST, FINEST, Compared, against_dt, in_time
from verification.explore.inclusions.runs import Measured

END = 2.0
STEPS = [2**k for k in range(COARSEST, FINEST + 1)]


def course(error: float, overlap: float, fault: str = "") -> Measured:
    return Measured(np.array([0.0, END]), np.array([0.0, overlap]), np.array([0.0, error]), fault)


def runs(size: float = 10.0) -> Compared:
    """A method of order 1 without overlap, one that blows up, and one that fails at the two largest dt."""
    known = {("catch-up", steps): course(END / steps, 1e-15) for steps in STEPS}
    known |= {("penalty 100", steps): course(1e40 if steps < 64 else 0.1, 0.01) for steps in STEPS}
    known |= {("PBD", steps): course(0.5, 0.5, "failed" if steps <= 8 else "") for steps in STEPS}
    return Compared(known, ["PBD", "catch-up", "penalty 100"], "PBD", 64, END, size)


def series(options: dict, name: str) -> np.ndarray:
    (found,) = [one for one in options["series"] if one.get("name") == name]
    return np.array(found["data"])


@pytest.mark.parametrize("draw", [against_dt, in_time])
def test_zeros_are_at_the_lower_end_and_labelled_so(draw) -> None:
    options = draw("overlap", runs())
    low = options["yAxis"]["min"]
    assert (series(options, "catch-up")[:, 1] == low).all()
    assert low < 0.01
    assert "≤" in options["yAxis"]["axisLabel"][":formatter"]


def test_what_blows_up_leaves_the_chart_and_a_run_that_fails_is_crossed() -> None:
    options = against_dt("error", runs())
    assert options["yAxis"]["max"] == 1.0
    assert series(options, "penalty 100")[:, 1].max() > 1e30
    assert series(options, "PBD")[:, 0].max() == END / 16
    (crosses,) = [one for one in options["series"] if one["type"] == "scatter"]
    assert [one["value"] for one in crosses["data"]] == [[END / 4, 1.0], [END / 8, 1.0]]


def test_slopes_and_the_present_dt_are_marked() -> None:
    options = against_dt("error", runs())
    guides = [np.log(one["data"]) for one in options["series"] if "endLabel" in one]
    slopes = [np.diff(guide[:, 1]) / np.diff(guide[:, 0]) for guide in guides]
    np.testing.assert_allclose(np.ravel(slopes), [1, 2])
    marks = [one["markLine"]["data"] for one in options["series"] if "markLine" in one]
    assert marks == [[{"xAxis": END / 64}]]


def test_orders_are_told_where_there_are_any() -> None:
    assert runs().order("catch-up") == pytest.approx(1)
    assert runs().order("penalty 100") is None
    assert runs()._replace(steps=8).order("PBD") is None
    assert runs()._replace(steps=16).order("PBD") is None


def test_nothing_known_is_an_empty_chart() -> None:
    empty = runs()._replace(known={})
    assert empty.left() == 3 * len(STEPS)
    for draw in (against_dt, in_time):
        assert not [one for one in draw("error", empty)["series"] if one.get("name") and len(one["data"])]
    assert runs().left() == 0
