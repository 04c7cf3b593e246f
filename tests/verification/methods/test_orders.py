"""The experiments of chapter 2: orders, the reference and its check, penalty strengths, large steps; proofs."""

from typing import Any

import numpy as np
import pandas as pd
import pytest

import dincl
from verification.instruments.error_norms import distance
from verification.methods import large_steps, orders, proved, references, strengths
from verification.methods.methods import METHODS, MIDPOINT_ACTIVE, PBD, PENALTIES, NamedMethod
from verification.site.store import shipped

TOL = 1e-11
SLIDE: Any = dincl.scenes.sliding_disc()
TIMES = np.arange(0.25, 3.01, 0.25)


def test_pbd_has_order_one_midpoint_catch_up_two_and_a_soft_penalty_none() -> None:
    fits = orders.fits(shipped("orders"))
    first = fits[fits["error"] != "overlap"].set_index("method")
    pbd = first.loc[PBD.label]
    assert len(pbd) == 9
    assert ((pbd["slope"] - 1).abs() < 0.1).all()
    midpoint = first.loc[MIDPOINT_ACTIVE.label]["slope"].dropna()
    assert len(midpoint) == 3
    assert ((midpoint - 2).abs() < 0.1).all()
    assert (first.loc[PENALTIES[0].label]["slope"].abs() < 0.5).all()
    overlap = fits[fits["error"] == "overlap"].set_index(["problem", "method"])["finest_error"]
    assert (overlap.xs(METHODS["linearised_clarabel"].label, level="method") < 1e-9).all()
    assert (overlap.xs(PBD.label, level="method") > 1e-5).all()


def test_a_method_without_a_scheme_is_refused() -> None:
    assert METHODS["pbd"].make(0.1) == dincl.PBD(dt=0.1)
    with pytest.raises(dincl.InvalidProblem, match="method own: run = "):
        NamedMethod("own", run=lambda problem, dt, t: t, name="own").make(0.1)


# The reference and its check


def extrapolated(h: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    runs = [dincl.solve(SLIDE, dincl.CatchUp(dt, dincl.ActiveSet(TOL)), t=TIMES).x for dt in (h, h / 2, h / 4)]
    return references.extrapolate(runs[0], runs[1], runs[2], TOL)


@pytest.mark.parametrize("h", [0.1, 0.07, 0.05, 0.043, 0.03, 0.0213, 0.0125, 0.0071, 0.004])
def test_the_stated_error_of_a_limit_covers_the_true_one(h: float) -> None:
    x, error, _ = extrapolated(h)
    true = distance(x, SLIDE.exact(TIMES))
    assert (true <= error).all(), np.c_[TIMES, true, error]
    assert error.max() < h


def test_differences_that_do_not_halve_are_not_extrapolated() -> None:
    zero = np.zeros((3, 1, 2))
    coarse, middle, fine = zero.copy(), zero.copy(), zero.copy()
    coarse[0], middle[0] = 0.3, 0.1  # halves: 0.2, then 0.1
    coarse[1], middle[1] = 0.11, 0.1  # jumps
    x, error, ratio = references.extrapolate(coarse, middle, fine, TOL)
    assert x[:, 0, 0] == pytest.approx([-0.1, 0.0, 0.0])
    estimates = 0.0, 0.1 * np.sqrt(2), 0.0
    assert error == pytest.approx([2 * max(estimates[max(k - 1, 0) : k + 2]) for k in range(3)])
    assert np.isnan(ratio[2])


# Penalty strengths, large steps


def scanned(errors: list[float], largest: list[float]) -> pd.DataFrame:
    row = {"scene": "s", "dt": 0.1, "status": "SUCCESS", "mean": 0.0}
    tried = [1.0, 2.0, 4.0, 8.0]
    runs = [
        row | {"exponent": 2, "strength": s, "error": e, "largest": i}
        for s, e, i in zip(tried, errors, largest, strict=True)
    ]
    return pd.DataFrame([row | {"exponent": 0, "strength": 0.0, "error": 0.1, "largest": 0.1}, *runs])


@pytest.mark.parametrize(
    ("errors", "largest", "strength", "width"),
    [
        ([0.1, 0.1, 0.1, 0.1], [0.9, 0.3, 0.2, 0.41], 4.0, 2.0),
        ([0.1, 0.1, 0.1, 0.1], [0.3, 0.3, 0.2, 0.4], 4.0, 8.0),
        ([0.1, 0.5, 0.51, np.nan], [0.9, 0.3, 0.0, 0.0], 2.0, 1.0),  # discs thrown apart do not win
        ([9.0, 9.0, 7.0, np.nan], [0.9, 0.3, 0.0, 0.0], np.nan, np.nan),
    ],
)
def test_the_best_strength_and_the_width_of_the_optimum(
    errors: list[float], largest: list[float], strength: float, width: float
) -> None:
    best = strengths.best_strengths(scanned(errors, largest)).iloc[0]
    assert best[["strength", "width"]].tolist() == pytest.approx([strength, width], nan_ok=True)
    assert best["least_error"] == np.nanmin(errors)
    assert best["pbd_largest"] == 0.1


def test_the_scan_measures_overlap_and_error() -> None:
    row = strengths.measure({"scene": "ten_disks_corner", "dt": 0.05, "exponent": 0, "strength": 0.0})[0]
    assert row["largest"] > 0.1
    assert 0.0 < row["mean"] < row["largest"]
    assert 0.0 < row["error"] < 0.5


@pytest.mark.parametrize(("method", "stable"), [("pbd", True), ("penalty_10", True), ("penalty_1000", False)])
def test_large_steps_throw_discs_with_a_strong_penalty_only(method: str, stable: bool) -> None:
    row = large_steps.run({"scene": "ten_disks_corner", "method": method, "dt": 0.1})[0]
    assert row["stable"] is stable
    assert (row["growth"] <= large_steps.FAR) is stable


# Proved bounds


def test_all_bounds_are_reached() -> None:
    rows = shipped("proved_scenes")
    assert (rows["why"] == "").all()
    assert (rows["bound"] <= rows["asked"]).all()


def test_every_stated_error_is_above_the_proved_one() -> None:
    rows = shipped("proved_random")
    known = rows[rows["why"] == ""]
    assert rows["seed"].nunique() == proved.RANDOM
    assert known["seed"].nunique() >= 0.97 * proved.RANDOM
    assert (known["ratio"] <= 1).all()
    assert set(known["discs"]) == {2, 3, 4, 5, 6}
