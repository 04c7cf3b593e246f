"""Iterations or smaller steps: the study that ships, and the rule that follows from it."""

import numpy as np
import pandas as pd
import pytest

import dincl
from dincl.study import read_sealed
from verification.beyond.iterations import study as iterations
from verification.page.kept import STUDIES
from verification.thesis.chapter2.stability.carried import CASES

KEY = ["scene", "method", "total", "sweeps"]


@pytest.fixture(scope="module")
def shipped() -> pd.DataFrame:
    return read_sealed(STUDIES / "iterations.parquet")


@pytest.mark.parametrize("method", iterations.METHODS)
@pytest.mark.parametrize("scene", ["four discs", "chain of 20 links", "stack of 6 intervals"])
def test_a_run_comes_out_as_it_ships(shipped: pd.DataFrame, scene: str, method: str) -> None:
    found = iterations.run({"scene": scene, "method": method, "total": 256, "sweeps": 8})[0]
    row = shipped.set_index(KEY).loc[(scene, method, 256, 8)]
    assert found["corrections"] == row["corrections"] > 0
    assert found["error"] == pytest.approx(row["error"], rel=1e-6)
    assert found["overlap"] == pytest.approx(row["overlap"], rel=1e-6)


def test_it_is_complete_and_its_references_resolve_its_errors(shipped: pd.DataFrame) -> None:
    assert len(shipped) == len(iterations.study().runs)
    assert (shipped["status"] == "SUCCESS").all()
    assert (shipped["reference_error"] < 1e-3 * shipped["error"]).all()


def test_small_steps_are_never_far_from_the_best(shipped: pd.DataFrame) -> None:
    best = iterations.best_splits(shipped)
    assert best["one"].max() < 2.0
    four = best[(best["scene"] == "four discs") & ~best["method"].str.contains("compliance")]
    assert (four["best"] == 1).all()
    assert four["most"].min() > 30


def test_a_chain_is_pulled_straight_and_a_column_stands() -> None:
    far = dincl.solve(iterations.chain(), dincl.EventDriven(1e-8), t=[20.0]).final
    links = np.linalg.norm(np.diff(far, axis=0), axis=1)
    assert links == pytest.approx(np.ones(iterations.LINKS - 1), abs=1e-6)
    rest = dincl.solve(iterations.column(), dincl.EventDriven(1e-8), t=[5.0]).final
    assert rest[:, 0] == pytest.approx(0.5 + np.arange(iterations.COLUMN), abs=1e-6)


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.id)
def test_multipliers_that_are_carried_fail_as_predicted(case) -> None:
    assert case.find().agrees


def test_multipliers_that_are_reset_let_go_at_once_and_hold_the_load() -> None:
    pull = dincl.Problem([[0.0]], lambda t, x: x * 0 + (-1.0 if t < 1 - 1e-9 else 1.0), [dincl.HalfSpace(normal=(1,))])
    assert dincl.solve(pull, dincl.XPBD(1e-3), t=[1.5]).final[0, 0] == pytest.approx(0.5, abs=2e-3)
    rest = dincl.solve(pull, dincl.XPBD(1e-3, compliance=2e-3), t=[1.0]).final[0, 0]
    assert rest == pytest.approx(-2e-3, rel=1e-6)
