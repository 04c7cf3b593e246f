"""Runs of every instrument are rows of a table: interrupted calls go on, any executor makes them, the smallest form."""

import os
import subprocess
import sys
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

import dincl
import meanfield as mf
import verification as v
from dincl.study import read_sealed
from verification.instruments.orders import OrderRuns
from verification.instruments.rates import W1Runs
from verification.instruments.speed_accuracy import WorkPrecisionRuns
from verification.instruments.stability import StabilityRuns
from verification.instruments.stored import settings_of

WALL = dincl.Problem(
    x0=[[0.0, 1.0]],
    drift=dincl.drifts.constant([0.0, -1.0]),
    constraints=[dincl.HalfSpace(normal=(0, 1), offset=0.0, radius=0.5)],
)
STEPS = [0.2 / 2**k for k in range(6)]
METHODS = {"PBD": dincl.PBD, "second": dincl.SecondOrderPBD}


def fallen(t: Any) -> np.ndarray:
    """The solution: free fall at unit speed, then rest on the wall."""
    return np.stack([np.zeros_like(t), np.maximum(1.0 - np.asarray(t), 0.5)], axis=-1)[:, None, :]


def run_alone(a: float, b: float) -> v.Outcome:
    """A run of any program, judged by itself."""
    if a * b > 1.5:
        raise ArithmeticError("too stiff")
    return v.Outcome.CONVERGED if a * b <= 1 else v.Outcome.UNSTABLE


T = [0.33, 0.71]
LAW = mf.Density.uniform(0.0, 1.0)
# The call, the runs behind it, columns that do not depend on the machine, how many runs it has and its smallest form.
INSTRUMENTS = {
    "orders": (v.order_study, OrderRuns, (WALL, METHODS, STEPS, T, fallen), ["method", "setting", "largest"], 2, 10),
    "speed": (
        v.work_precision,
        WorkPrecisionRuns,
        (WALL, METHODS, STEPS, T, fallen, v.DriftEvaluations(10**5)),
        ["method", "setting", "largest", "steps"],
        2,
        4,
    ),
    "stability": (
        v.stability_map,
        StabilityRuns,
        (WALL, dincl.Penalty, ("dt", [0.01, 0.1, 0.2]), ("strength", [1.0, 30.0])),
        ["dt", "strength", "outcome", "growth"],
        6,
        4,
    ),
    "alone": (
        v.stability_map,
        StabilityRuns,
        (None, run_alone, ("a", [0.5, 1.0, 2.0]), ("b", [0.5, 1.0])),
        ["a", "b", "outcome", "status"],
        6,
        4,
    ),
    "rates": (v.w1_rates, W1Runs, (None, LAW, [4, 8, 16, 32], 3, 1), ["N", "repeat", "w1"], 12, 6),
}


@pytest.fixture(params=INSTRUMENTS)
def instrument(request: pytest.FixtureRequest) -> tuple[Any, ...]:
    return INSTRUMENTS[request.param]


def test_an_interrupted_call_goes_on(
    instrument: tuple[Any, ...], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    call, plan, given, columns, count, _ = instrument
    whole, store = call(*given), tmp_path / "rows.parquet"
    kind = type(plan(*given).study().run)
    made, run = [], kind.__call__

    def stops(self: Any, key: Any) -> Any:
        made.append(key)
        if len(made) == 2:
            raise KeyboardInterrupt
        return run(self, key)

    monkeypatch.setattr(kind, "__call__", stops)
    with pytest.raises(KeyboardInterrupt):
        call(*given, store=store)
    resumed = call(*given, store=store)
    assert len(made) == count + 1
    pd.testing.assert_frame_equal(resumed.table[columns], whole.table[columns])
    again = call(*given, store=store)  # nothing is run
    assert len(made) == count + 1
    pd.testing.assert_frame_equal(again.table[columns], whole.table[columns])


def test_the_smallest_form_has_some_of_the_runs(instrument: tuple[Any, ...]) -> None:
    call, _, given, columns, _, few = instrument
    whole, small = call(*given).table[columns], call(*given, smallest=True).table[columns]
    assert len(small) == few
    assert len(small.merge(whole)) == few


def test_threads_make_the_same_rows(instrument: tuple[Any, ...]) -> None:
    call, _, given, columns, _, _ = instrument
    with ThreadPoolExecutor(2) as executor:
        pd.testing.assert_frame_equal(call(*given, executor=executor).table[columns], call(*given).table[columns])


@pytest.mark.slow
def test_processes_make_the_same_rows(tmp_path: Path) -> None:
    call, _, given, columns, _, _ = INSTRUMENTS["orders"]
    with ProcessPoolExecutor(1, get_context("spawn")) as executor:
        found = call(*given, store=tmp_path / "rows.parquet", executor=executor)
    pd.testing.assert_frame_equal(found.table[columns], call(*given).table[columns])


def test_what_cannot_be_sent_to_processes_is_refused() -> None:
    with ProcessPoolExecutor(1) as executor, pytest.raises(dincl.InvalidProblem, match="at top level of a module"):
        v.order_study(WALL, {"mine": lambda dt: dincl.PBD(dt, sweeps=2)}, STEPS, T, fallen, executor=executor)


def test_a_store_of_another_problem_starts_anew(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    store = tmp_path / "rows.parquet"
    v.order_study(WALL, METHODS, STEPS, T, fallen, store=store)
    v.order_study(WALL, {"PBD": lambda dt: dincl.PBD(dt, sweeps=2)}, STEPS, T, fallen, store=store)
    assert "setting methods" in capsys.readouterr().out
    assert set(read_sealed(store)["method"]) == {"PBD"}
    assert set(read_sealed(tmp_path / "superseded" / "rows.parquet")["method"]) == set(METHODS)


def test_failures_are_rows(tmp_path: Path) -> None:
    def breaks(dt: float) -> dincl.Scheme:
        if dt < 0.02:
            raise ArithmeticError("no smaller")
        return dincl.PBD(dt)

    store = tmp_path / "rows.parquet"
    study = v.order_study(WALL, {"breaks": breaks}, STEPS, T, fallen, store=store)
    assert (study.table["status"] == "FAILED").sum() == (read_sealed(store)["status"] == "FAILED").sum() == 2
    cells = v.stability_map(None, run_alone, ("a", [1.0, 2.0]), ("b", [1.0]))
    assert list(cells.table["outcome"]) == ["converged", "refused"]
    assert cells.table["detail"].iloc[1] == "ArithmeticError: too stiff"


@pytest.mark.parametrize("store", ["rows.csv", 3])
def test_a_store_that_is_no_parquet_file_is_refused(store: Any) -> None:
    with pytest.raises(dincl.InvalidProblem, match="store = "):
        v.order_study(WALL, METHODS, STEPS, T, fallen, store=store)


@pytest.mark.parametrize("found", ["fine", 1, {"outcome": "good"}, {}])
def test_a_run_that_judges_itself_must_return_an_outcome(found: Any) -> None:
    cells = v.stability_map(None, lambda a, b: found, ("a", [1.0]), ("b", [1.0]))
    assert cells.table["outcome"].iloc[0] == "refused"


class Pull:
    """A drift without a lasting text."""

    def __init__(self, rate: float) -> None:
        self.rate = rate

    def __call__(self, t: float, x: np.ndarray) -> np.ndarray:
        return -self.rate * x


def through(make: Any) -> Any:
    def made(dt: float) -> Any:
        return make(dt)

    return made


def by_default(k: int) -> Any:
    def made(dt: float, *, order: int = k) -> int:
        return order

    return made


@pytest.mark.parametrize(
    ("one", "two"),
    [
        (dincl.scenes.sliding_disc(), dincl.scenes.stack()),
        (v.reference(dincl.scenes.sliding_disc(), 1e-3), v.reference(dincl.scenes.sliding_disc(), 1e-9)),
        (dincl.Problem([[1.0]], Pull(1.0)), dincl.Problem([[2.0]], Pull(1.0))),
        (dincl.Problem([[1.0]], Pull(1.0)), dincl.Problem([[1.0]], Pull(2.0))),
        ({"a": Pull(1.0), "b": dincl.PBD}, {"a": Pull(1.0), "b": dincl.Penalty}),
        (through(dincl.PBD), through(dincl.Penalty)),
        (by_default(1), by_default(2)),
        (Pull(1.0).__call__, Pull(2.0).__call__),
    ],
)
def test_no_change_of_what_is_run_goes_unnoticed(one: Any, two: Any) -> None:
    assert settings_of(one=one) != settings_of(one=two)
    assert settings_of(one=one) == settings_of(one=one)


def test_functions_and_objects_may_hold_themselves() -> None:
    def again(k: int) -> int:
        return again(k - 1) if k else 0

    round_trip = Pull(1.0)
    round_trip.rate = {"itself": round_trip}  # type: ignore[assignment]
    assert settings_of(one=again) == settings_of(one=again)
    assert settings_of(one=round_trip) == settings_of(one=round_trip)


def test_sets_of_texts_have_one_name_in_all_processes() -> None:
    program = (
        "from dincl.study.record import record\n"
        "def chosen(name): return name in {'a', 'b', 'c', 'd', 'e', 'f'}\n"
        "print(record({'f': chosen})['settings'])"
    )
    run = [sys.executable, "-c", program]
    said = {subprocess.check_output(run, env=os.environ | {"PYTHONHASHSEED": str(k)}) for k in range(3)}
    assert len(said) == 1
