"""Errors as users define them: norms over time, of dense output, of quantities of the state; several from one run."""

import numpy as np
import pytest

import dincl
import verification as v
from verification.instruments.error_norms import ErrorOf, checked_errors, reference_error
from verification.instruments.references import known_at, times_between

SLIDE = dincl.scenes.sliding_disc()
T = [0.5, 1.0, 3.0]
BUDGET = v.CpuSeconds(5.0)
LADDER = [0.1 / 2**k for k in range(5)]


def off_by(errors):
    """Make a method that is off by so much at the output times, in x."""
    shift = np.array([[1.0, 0.0]])
    return lambda problem, dt, t: SLIDE.exact(t) + np.interp(t, T, errors)[:, None, None] * shift


def height(x):
    return x[:, 1].max()


def test_norms_are_what_their_names_say():
    errors, names = [0.3, 0.0, 0.6], ("largest", "final", "L2", "dense")
    chart = v.work_precision(SLIDE, {"off": v.Method("off", run=off_by(errors))}, [0.1], T, SLIDE.exact, BUDGET, names)
    found = chart.table.iloc[0]
    # e is linear between (0, 0), (0.5, 0.3), (1, 0), (3, 0.6): the integral of e^2 is 0.09 (0.5 + 0.5) / 3 + 0.36 2 / 3
    assert found["L2"] == pytest.approx(np.sqrt((0.09 / 3 + 0.36 * 2 / 3) / 3.0), rel=1e-12)
    assert (found["largest"], found["final"]) == pytest.approx((0.6, 0.6), rel=1e-12)


def test_dense_output_is_compared_between_the_output_times():
    fine = times_between(np.array(T))
    exact = v.Method("exact", run=lambda problem, dt, t: SLIDE.exact(t))
    methods = [exact, v.Method("events", scheme=dincl.EventDriven, setting="tol")]
    settings = {"dt": [0.1], "tol": [1e-9]}
    chart = v.work_precision(SLIDE, methods, settings, T, SLIDE.exact, BUDGET, ("largest", "dense"))
    straight, events = chart.table.set_index("method")["dense"]
    assert chart.table["largest"].max() < 1e-8
    between = np.stack([np.interp(fine, [0, *T], [SLIDE.x0[0, k], *SLIDE.exact(np.array(T))[:, 0, k]]) for k in (0, 1)])
    assert straight == pytest.approx(np.linalg.norm(between.T - SLIDE.exact(fine)[:, 0], axis=1).max(), rel=1e-12)
    assert events < 1e-8
    with pytest.raises(dincl.InvalidProblem, match="errors of dense output need one that can be evaluated at any time"):
        v.work_precision(SLIDE, methods, settings, T, SLIDE.exact(np.array(T)), BUDGET, "dense")


def test_a_quantity_has_its_own_error_and_that_of_its_reference():
    reference = v.Known(np.array(T), SLIDE.exact(np.array(T)), np.full(3, 1e-6))
    errors = {"height": height, "both": lambda x: 3.0 * x[0], "largest": "largest"}
    chart = v.work_precision(SLIDE, {"PBD": dincl.PBD}, [0.1], T, reference, BUDGET, errors)
    row, path = chart.table.iloc[0], dincl.solve(SLIDE, dincl.PBD(0.1), t=T)
    away = path.x - reference.x
    assert row["height"] == pytest.approx(np.abs(away[:, 0, 1]).max(), rel=1e-12)
    assert row["both"] == pytest.approx(3.0 * np.abs(away).max(), rel=1e-12)
    assert reference_error(chart.table, "height").iloc[0] == pytest.approx(1e-6, rel=1e-6)
    assert reference_error(chart.table, "both").iloc[0] == pytest.approx(3e-6, rel=1e-6)
    assert reference_error(chart.table, "overlap").iloc[0] == 0.0
    assert ErrorOf("height", height, 1e-9).of_reference(reference) == 1e-9  # as it is stated
    assert "error of height" in chart.plot(error="height").get_ylabel()
    orders = v.order_study(SLIDE, {"PBD": dincl.PBD}, [0.1 / 2**k for k in range(5)], T, SLIDE.exact, lambda x: x[0, 0])
    assert orders.fits["error"].tolist() == ["quantity"]
    assert orders.fits["low"].iloc[0] < 1.05


def test_a_quantity_that_is_not_finite_is_named():
    known = known_at(SLIDE.exact, T)
    with pytest.raises(dincl.InvalidProblem, match="errors: 'logarithm' gave nan for a state of shape"):
        ErrorOf("logarithm", lambda _: np.nan).of_reference(known)
    with pytest.raises(dincl.InvalidProblem, match="errors = None: must be one or more of largest"):
        checked_errors([None])
    with pytest.raises(dincl.InvalidProblem, match="different names"):
        checked_errors([height, height])


def test_the_error_at_a_time_is_that_of_the_state_there():
    errors = (1.0, {"end": 3.0, "largest": "largest"})
    given = [v.order_study(SLIDE, {"PBD": dincl.PBD}, LADDER, T, SLIDE.exact, one) for one in errors]
    assert given[0].fits["error"].tolist() == ["t = 1"]
    path = dincl.solve(SLIDE, dincl.PBD(0.1), t=T)
    away = np.linalg.norm(path.x - SLIDE.exact(np.array(T)), axis=-1).max(axis=1)
    assert given[0].table["t = 1"].iloc[0] == pytest.approx(away[1], rel=1e-12)
    assert given[1].table["end"].iloc[0] == pytest.approx(away[2], rel=1e-12)
    with pytest.raises(dincl.InvalidProblem, match="must be among the times"):
        v.order_study(SLIDE, {"PBD": dincl.PBD}, LADDER, T, SLIDE.exact, 2.0)
